//! The church: a nave with aisles, a crossing with transepts, a choir and its apse. West to east along +x.

use core::f64::consts::FRAC_PI_2;

use glam::DVec2;

use super::Site;
use super::stone::{Course, FOOT_M, Opening, Wall};
use crate::procedural::noise::smoothstep;

/// The west front.
pub(super) const WEST: f64 = -30.0;
/// Distance between columns.
pub(super) const BAY: f64 = 5.6;
/// Bays of the nave.
pub(super) const BAYS: usize = 8;
/// The crossing, a square.
pub(super) const CROSSING: (f64, f64) = (WEST + BAY * BAYS as f64, WEST + BAY * BAYS as f64 + 10.0);
/// From the middle of the nave to its arcades.
pub(super) const NAVE: f64 = 5.0;
/// From the middle of the nave to the walls of the aisles.
pub(super) const AISLE: f64 = 9.8;
/// Where arches of the arcades begin.
pub(super) const ARCADE_SPRING: f64 = 4.6;
/// Where the choir ends and its apse begins.
pub(super) const CHOIR: f64 = 34.0;
/// The round window of the west front: its centre's height and its radius.
pub(super) const ROSE: (f64, f64) = (9.4, 2.1);
const THICK: f64 = 0.85;

/// 1 between two places, falling to 0 within `soft` metres outside.
fn between(x: f64, from: f64, to: f64, soft: f64) -> f64 {
    smoothstep(from - soft, from, x) * (1.0 - smoothstep(to, to + soft, x))
}

/// Height of what is left of the north arcade at a place.
pub(super) fn north_arcade(x: f64) -> f64 {
    12.4 * between(x, WEST, -13.5, 5.0) + 11.0 * between(x, 6.0, CROSSING.0, 7.0)
}

/// Height of what is left of the south arcade: little, so that the sun comes in.
pub(super) fn south_arcade(x: f64) -> f64 {
    11.6 * between(x, WEST, -26.0, 3.5) + 9.8 * between(x, 2.5, CROSSING.0, 4.0)
}

pub(super) fn walls(site: &Site) -> Vec<Wall> {
    let mut walls = vec![west_front()];
    walls.extend(nave());
    walls.extend(crossing());
    walls.extend(transepts());
    walls.extend(choir());
    // Ivy has not been everywhere: the seed says where it has.
    for wall in &mut walls {
        wall.ivy *= site.rng.fork(700 + wall.tag).range(0.7, 1.25);
    }
    walls
}

fn west_front() -> Wall {
    let gable = |s: f64| {
        let z = s - AISLE;
        let nave = 12.6 + 5.2 * (1.0 - z.abs() / NAVE);
        let aisle = 8.2 - 0.5 * (z.abs() - NAVE);
        let whole = if z.abs() < NAVE { nave } else { aisle };
        // The north corner has come down.
        whole - 5.5 * smoothstep(-4.0, -9.0, z) - 2.6 * between(z, 1.8, 4.6, 0.8)
    };
    let openings = [
        Opening::pointed(AISLE, 1.35, -1.0, 3.0),
        Opening::circle(AISLE, ROSE.0, ROSE.1),
        Opening::pointed(AISLE - 7.4, 0.7, 2.6, 4.6),
        Opening::pointed(AISLE + 7.4, 0.7, 2.6, 4.6),
    ];
    Wall::straight(1, (WEST, -AISLE), (WEST, AISLE), THICK, gable).with(openings).with_ivy(0.75)
}

fn nave() -> Vec<Wall> {
    let bay = |i: usize| BAY * (i as f64 + 0.5);
    let arcade = |tag: u64, z: f64, top: fn(f64) -> f64| {
        let arches = (0..BAYS).map(|i| Opening::pointed(bay(i), BAY * 0.5 - 0.42, -1.0, ARCADE_SPRING));
        let clerestory = (0..BAYS).map(|i| Opening::pointed(bay(i), 0.75, 8.3, 9.6));
        let wall = Wall::straight(tag, (WEST, z + 0.4), (CROSSING.0, z + 0.4), 0.8, move |s| {
            let top = top(WEST + s);
            if top > ARCADE_SPRING + 1.0 { top } else { -3.0 }
        });
        let wall = wall.with(arches).with(clerestory).with_ivy(0.8);
        // Nothing but the columns stands below the arches.
        Wall { foot: ARCADE_SPRING - 0.2, ..wall }
    };
    let windows = || (0..BAYS).map(|i| Opening::pointed(bay(i), 0.85, 2.3, 4.9));
    let north = Wall::straight(4, (CROSSING.0, -AISLE), (WEST, -AISLE), THICK, |s| {
        8.0 - 4.6 * between(s, 14.0, 20.0, 3.0) - 1.5 * between(s, 34.0, 37.0, 2.0)
    });
    let south = Wall::straight(5, (WEST, AISLE), (CROSSING.0, AISLE), THICK, |s| {
        7.6 - 5.2 * between(s, 2.5, 10.0, 4.0) - 1.4 * between(s, 31.0, 36.0, 3.0)
    });
    let door = Opening::round(bay(6), 0.9, -1.0, 1.9);
    vec![
        arcade(2, -NAVE, north_arcade),
        arcade(3, NAVE, south_arcade),
        north.with(windows()).with_ivy(0.9),
        south.with(windows().enumerate().filter(|(i, _)| *i != 6).map(|(_, w)| w)).with([door]).with_ivy(0.9),
    ]
}

/// Two of the four great arches that carried the tower, and what is left of the others.
fn crossing() -> Vec<Wall> {
    let (west, east) = CROSSING;
    let arch = || [Opening::pointed(NAVE, NAVE - 0.95, -1.0, 8.6)];
    vec![
        Wall::straight(6, (west - 0.5, -NAVE), (west - 0.5, NAVE), 1.0, |s| 19.0 - 0.35 * (s - 4.0) * (s - 4.0).abs())
            .with(arch())
            .with_ivy(0.5),
        Wall::straight(7, (east, -NAVE - 0.5), (west, -NAVE - 0.5), 1.0, |s| 14.0 + 0.42 * s)
            .with(arch())
            .with_ivy(0.6),
        Wall::straight(8, (east + 0.5, NAVE), (east + 0.5, -NAVE), 1.0, |s| 15.0 * smoothstep(4.5, 9.0, s) - 1.0)
            .with(arch())
            .with_ivy(0.4),
        Wall::straight(9, (west, NAVE + 0.5), (east, NAVE + 0.5), 1.0, |s| {
            11.0 * (1.0 - smoothstep(1.0, 4.0, s)) - 1.0
        })
        .with(arch())
        .with_ivy(0.7),
    ]
}

fn transepts() -> Vec<Wall> {
    const DEEP: f64 = 12.0;
    let (west, east) = CROSSING;
    let end = NAVE + DEEP;
    let lancets = |from: f64| (0..2).map(move |i| Opening::pointed(from + 4.6 * f64::from(i), 0.8, 3.2, 7.2));
    let gable = |s: f64| 11.0 + 4.6 * (1.0 - (s - 5.0).abs() / 5.0) - 3.0 * smoothstep(6.5, 9.5, s);
    let great = [Opening::pointed(5.0, 2.3, 3.0, 7.0)];
    vec![
        Wall::straight(10, (west, -NAVE), (west, -end), THICK, |s| 10.5 - 2.5 * between(s, 6.0, 8.0, 2.0))
            .with([Opening::pointed(8.5, 0.8, 3.2, 7.2)]),
        Wall::straight(11, (east, -end), (west, -end), THICK, gable).with(great).with_ivy(0.9),
        Wall::straight(12, (east, -NAVE), (east, -end), THICK, |s| 10.8 - 0.25 * s).with(lancets(3.6)).with_ivy(0.8),
        Wall::straight(13, (west, NAVE), (west, end), THICK, |s| 8.0 - 0.62 * s).with_ivy(1.0),
        Wall::straight(14, (west, end), (east, end), THICK, |s| 3.4 + 1.4 * between(s, 6.0, 10.0, 3.0)).with_ivy(1.0),
        Wall::straight(15, (east, end), (east, NAVE), THICK, |s| 2.4 + 0.5 * s).with(lancets(2.0)).with_ivy(1.0),
    ]
}

fn choir() -> Vec<Wall> {
    let (east, long) = (CROSSING.1, CHOIR - CROSSING.1);
    let lancets = || (0..2).map(|i| Opening::pointed(2.4 + 4.4 * f64::from(i), 0.75, 2.6, 6.4));
    let apse = Wall {
        course: Course::Round { center: DVec2::new(CHOIR, 0.0), radius: NAVE + 0.4, start: -FRAC_PI_2 },
        length: core::f64::consts::PI * (NAVE + 0.4),
        foot: FOOT_M,
        height: 14.0,
        thick: THICK,
        openings: (0..3).map(|i| Opening::pointed(3.4 + 5.1 * f64::from(i), 0.85, 2.6, 6.4)).collect(),
        top: Box::new(|s| 9.8 - 3.8 * smoothstep(6.0, 1.0, s)),
        tag: 18,
        ivy: 0.8,
    };
    vec![
        Wall::straight(16, (CHOIR, -NAVE - 0.4), (east, -NAVE - 0.4), THICK, |_| 9.8).with(lancets()).with_ivy(0.8),
        Wall::straight(17, (east, NAVE + 0.4), (CHOIR, NAVE + 0.4), THICK, move |s| 3.0 + 2.4 * s / long)
            .with(lancets())
            .with_ivy(1.0),
        apse,
    ]
}
