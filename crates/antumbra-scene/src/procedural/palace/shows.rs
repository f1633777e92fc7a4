//! The five scenes in the palace: what is open, hung or lit in each, and from where it is seen.

use glam::DVec3;

use super::flags::LANTERN;
use super::plan::{COURT, EAST_DOOR_Z, FLOOR, GALLERY, HALL, LUMBER, STRONGROOM, WALK, WEST_DOOR_Z};
use crate::model::{Camera, Light};
use crate::procedural::view::{Cone, camera, point, spot};

/// Warm lamplight.
const WARM: [f32; 3] = [1.0, 0.82, 0.58];
/// A whiter lamp.
const PALE: [f32; 3] = [1.0, 0.93, 0.8];

/// A scene in the palace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Show {
    Door,
    Grille,
    Room,
    Flag,
    Cellar,
}

impl Show {
    pub fn name(self) -> &'static str {
        match self {
            Self::Door => "door",
            Self::Grille => "grille",
            Self::Room => "room",
            Self::Flag => "flag",
            Self::Cellar => "cellar",
        }
    }

    /// All light there is: it is night.
    pub fn lights(self) -> Vec<Light> {
        let lamp = |name: &str, at: DVec3, to: DVec3, inner_deg: f64, outer_deg: f64, candela: f32, color: [f32; 3]| {
            let cone = Cone { axis: to - at, inner_deg, outer_deg };
            spot(name.to_owned(), at, cone, 40.0, candela, color)
        };
        let wall = -COURT.y - WALK;
        match self {
            // In the chamber, out through the door at a slant: over the gallery's floor and balustrade to the far side.
            Self::Door => {
                let (at, to) = (DVec3::new(-1.9, GALLERY + 2.1, wall - 3.0), DVec3::new(0.05, GALLERY + 0.9, wall));
                vec![lamp("lamp", at, to, 18.0, 26.0, 9_000.0, PALE)]
            }
            // In the strongroom, beside the grille, at the bare strip of the wall behind it.
            Self::Grille => {
                let (at, to) =
                    (DVec3::new(1.45, FLOOR + 1.9, HALL.y + 0.9), DVec3::new(-0.1, FLOOR + 1.3, STRONGROOM[1][1]));
                vec![lamp("lamp", at, to, 16.0, 23.0, 6_000.0, WARM)]
            }
            // In the hall, through the open door, down to the carpet.
            Self::Room => {
                let (at, to) = (
                    DVec3::new(-HALL.x + 0.9, FLOOR + 2.3, WEST_DOOR_Z),
                    DVec3::new(LUMBER[0][1] - 0.9, FLOOR, WEST_DOOR_Z - 0.1),
                );
                vec![lamp("lamp", at, to, 12.0, 17.0, 6_000.0, WARM)]
            }
            // On the gallery's floor, up at its wall.
            Self::Flag => [("lamp01", -0.4), ("lamp02", 4.2)]
                .map(|(name, x)| {
                    let (at, to) = (DVec3::new(x, GALLERY + 0.25, wall + 2.3), DVec3::new(x, GALLERY + 2.2, wall));
                    lamp(name, at, to, 32.0, 44.0, 4_000.0, PALE)
                })
                .to_vec(),
            Self::Cellar => vec![point("lantern".to_owned(), LANTERN, 40.0, 900.0, WARM)],
        }
    }

    /// Cameras; the first is the one that the scene is known by.
    pub fn cameras(self) -> Vec<Camera> {
        let gallery = |x: f64, up: f64, z: f64| DVec3::new(x, GALLERY + up, z);
        let cellar = |x: f64, up: f64, z: f64| DVec3::new(x, FLOOR + up, z);
        match self {
            Self::Door => vec![
                camera("overview", gallery(-3.4, 1.6, -9.05), gallery(2.2, 0.9, -5.9), 64.0),
                camera("across", gallery(5.6, 1.65, 6.9), gallery(-0.6, 0.6, -6.4), 52.0),
            ],
            Self::Grille => vec![
                camera("overview", cellar(2.3, 1.55, 1.5), cellar(-0.7, 0.65, 3.4), 60.0),
                camera("hall", cellar(-4.6, 1.6, 0.9), cellar(1.4, 0.8, 3.9), 60.0),
            ],
            Self::Room => vec![
                camera("overview", cellar(-9.35, 1.7, -0.1), cellar(-12.0, 0.75, -2.3), 58.0),
                camera("corner", cellar(-12.4, 1.8, -0.5), cellar(-10.2, 0.5, -2.4), 66.0),
            ],
            Self::Flag => vec![
                camera("overview", gallery(-6.2, 1.6, -8.95), gallery(0.6, 1.5, -5.2), 60.0),
                camera("court", gallery(6.2, 1.65, 6.9), gallery(-1.5, 1.2, -6.4), 55.0),
            ],
            Self::Cellar => vec![
                camera("overview", cellar(1.2, 1.6, -2.5), cellar(5.2, 0.75, 2.2), 62.0),
                camera("doorway", cellar(1.2, 1.6, 1.3), cellar(9.0, 1.35, EAST_DOOR_Z), 55.0),
            ],
        }
    }
}
