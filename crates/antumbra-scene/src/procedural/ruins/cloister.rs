//! The cloister, south of the nave: arcades around a garth, and the walls of what once stood around them, all of a
//! single sheet. And the precinct's gate.

use super::Site;
use super::church::AISLE;
use super::stone::{Opening, Wall};
use crate::procedural::noise::smoothstep;

/// The cloister's outer walls.
pub(super) const WEST: f64 = -25.0;
pub(super) const EAST: f64 = 3.0;
pub(super) const SOUTH: f64 = AISLE + 28.0;
/// Width of the walks.
pub(super) const WALK: f64 = 4.2;
/// Height at which the arches of the garth begin.
const SPRING: f64 = 2.1;
const PITCH: f64 = 2.45;

pub(super) fn walls(site: &Site) -> Vec<Wall> {
    let mut walls = garth();
    walls.extend(ranges());
    walls.extend(gate());
    for wall in &mut walls {
        wall.ivy *= site.rng.fork(700 + wall.tag).range(0.6, 1.3);
    }
    walls
}

/// The arcades around the garden in the middle, seen from it.
fn garth() -> Vec<Wall> {
    let (west, east, north, south) = (WEST + WALK, EAST - WALK, AISLE + WALK, SOUTH - WALK);
    let arcade = |tag: u64, from: (f64, f64), to: (f64, f64), top: fn(f64) -> f64| {
        let wall = Wall::straight(tag, from, to, 0.0, top);
        let count = (wall.length / PITCH).floor();
        let first = (wall.length - (count - 1.0) * PITCH) * 0.5;
        let arches = (0..count as usize).map(|i| {
            // Every third goes down to the ground.
            let sill = if i % 3 == 1 { -1.0 } else { 0.55 };
            Opening::round(first + PITCH * i as f64, 0.92, sill, SPRING)
        });
        Wall { height: 6.0, ..wall.with(arches).with_ivy(0.7) }
    };
    vec![
        arcade(30, (east, north), (west, north), |_| 4.5),
        arcade(31, (east, south), (east, north), |s| 4.5 - 3.6 * smoothstep(12.0, 6.0, s)),
        arcade(32, (west, south), (east, south), |s| 4.4 - 3.3 * smoothstep(8.0, 13.0, s)),
        arcade(33, (west, north), (west, south), |s| 4.5 - 1.2 * smoothstep(10.0, 18.0, s)),
    ]
}

/// What is left of the dormitory, the refectory and the cellars.
fn ranges() -> Vec<Wall> {
    let windows = |first: f64, pitch: f64, count: u32, sill: f64| {
        (0..count).map(move |i| Opening::round(first + pitch * f64::from(i), 0.55, sill, sill + 1.3))
    };
    let doors = |first: f64, pitch: f64, count: u32| {
        (0..count).map(move |i| Opening::round(first + pitch * f64::from(i), 0.8, -1.0, 1.7))
    };
    let wall = |tag: u64, from: (f64, f64), to: (f64, f64), top: fn(f64) -> f64| {
        Wall { height: 10.0, ..Wall::straight(tag, from, to, 0.0, top) }.with_ivy(0.9)
    };
    vec![
        wall(40, (WEST, AISLE), (WEST, SOUTH), |s| 5.4 - 2.6 * smoothstep(16.0, 24.0, s))
            .with(windows(3.5, 4.0, 6, 2.6))
            .with(doors(9.5, 12.0, 2)),
        wall(41, (WEST, SOUTH), (EAST, SOUTH), |s| 2.2 + 4.8 * smoothstep(9.0, 16.0, s))
            .with(windows(12.6, 3.8, 4, 2.9))
            .with(doors(7.0, 14.0, 2)),
        wall(42, (EAST, SOUTH), (EAST, AISLE), |s| 6.6 - 3.8 * smoothstep(10.0, 4.0, (s - 20.0).abs()))
            .with(windows(2.4, 4.3, 6, 2.9))
            .with(doors(12.0, 8.6, 2)),
        wall(43, (EAST + 9.0, SOUTH), (EAST + 9.0, AISLE + 9.0), |s| 4.8 - 0.17 * s).with(windows(3.0, 4.3, 4, 1.6)),
        wall(44, (EAST, SOUTH), (EAST + 9.0, SOUTH), |s| 6.4 - 0.25 * s).with(windows(4.5, 2.0, 1, 2.6)),
        wall(45, (WEST - 8.5, AISLE + 4.0), (WEST - 8.5, SOUTH), |s| 2.6 - 0.6 * smoothstep(8.0, 14.0, s))
            .with(doors(6.0, 9.0, 2)),
        wall(46, (WEST - 8.5, SOUTH), (WEST, SOUTH), |s| 3.4 - 0.2 * s),
    ]
}

/// A gatehouse without roof or floors, west of the church, and the wall that joins it.
fn gate() -> Vec<Wall> {
    let (west, east, north, south) = (-62.0, -56.5, -13.0, -6.0);
    let wall = |tag: u64, from: (f64, f64), to: (f64, f64), top: fn(f64) -> f64| {
        Wall { height: 11.0, ..Wall::straight(tag, from, to, 0.0, top) }.with_ivy(1.1)
    };
    let arch = || [Opening::round(3.5, 1.7, -1.0, 2.4)];
    let slit = |s: f64| [Opening::round(s, 0.28, 5.2, 6.4)];
    vec![
        wall(50, (west, north), (west, south), |_| 8.6).with(arch()).with(slit(3.5)),
        wall(51, (east, south), (east, north), |s| 9.0 - 0.5 * s).with(arch()).with(slit(2.2)),
        wall(52, (west, south), (east, south), |_| 8.8).with(slit(2.75)),
        wall(53, (east, north), (west, north), |s| 4.6 + 0.6 * s),
        wall(54, (-59.0, south), (-55.0, 16.0), |s| 3.2 - 0.09 * s),
        wall(55, (-55.0, -31.0), (-59.0, north), |s| 1.6 + 0.08 * s),
    ]
}
