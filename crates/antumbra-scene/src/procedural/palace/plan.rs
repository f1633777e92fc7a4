//! The palace's plan, metres. The court's middle is the origin, its floor is y = 0; north is -Z.

use glam::DVec2;

use crate::procedural::solids::Turn;

/// Width of a bay of the court and of the cellar.
pub(super) const BAY: f64 = 3.2;
/// Half the court, measured to the axes of its columns: five bays by four.
pub(super) const COURT: DVec2 = DVec2::new(2.5 * BAY, 2.0 * BAY);
/// Width of the walks around the court, from the columns' axes to the wall.
pub(super) const WALK: f64 = 3.0;
/// Thickness of the court's walls.
pub(super) const WALL: f64 = 0.4;
/// Height of a column with its base and capital.
pub(super) const COLUMN: f64 = 3.4;
/// The gallery's floor.
pub(super) const GALLERY: f64 = 4.6;
/// The gallery's ceiling.
pub(super) const CEILING: f64 = 2.0 * GALLERY - 0.3;
/// Half the width of the chamber behind the gallery's north wall, and how deep it is.
pub(super) const CHAMBER: DVec2 = DVec2::new(3.4, 4.2);
/// Half the width, and the height, of a door.
pub(super) const DOOR: DVec2 = DVec2::new(0.6, 2.3);

/// The cellar's floor.
pub(super) const FLOOR: f64 = -4.0;
/// Where the cellar's vaults begin, and how high they rise from there.
pub(super) const SPRING: f64 = FLOOR + 1.6;
pub(super) const RISE: f64 = 1.4;
/// Underside of the court's floor.
pub(super) const UNDER: f64 = -0.7;
/// Half the cellar's hall: five bays by two.
pub(super) const HALL: DVec2 = DVec2::new(2.5 * BAY, 4.2);
/// Thickness of the cellar's walls.
pub(super) const THICK: f64 = 0.5;
/// Middle of the doorway to the anteroom and of the one to the lumber room, along z.
pub(super) const EAST_DOOR_Z: f64 = 2.1;
pub(super) const WEST_DOOR_Z: f64 = -2.1;
/// How far the anteroom reaches, along x and z.
pub(super) const ANTEROOM: [[f64; 2]; 2] = [[HALL.x + THICK, 12.6], [-0.4, 4.2]];
/// How far the lumber room reaches, along x and z.
pub(super) const LUMBER: [[f64; 2]; 2] = [[-13.2, -HALL.x - THICK], [-4.2, 0.2]];
/// How far the vault behind the grille reaches, along x and z.
pub(super) const STRONGROOM: [[f64; 2]; 2] = [[-2.3, 2.3], [HALL.y + THICK, 7.8]];
/// Half the width of the opening that the grille fills, and where its arch begins and ends.
pub(super) const GRILLE: [f64; 3] = [1.2, FLOOR + 1.7, FLOOR + 2.45];

/// A side of the court: seen from the middle, with its columns ahead along -Z, after this turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub turn: Turn,
    pub bays: usize,
    /// From the court's middle to the columns' axis.
    pub away: f64,
}

impl Side {
    /// North, west, south, east.
    pub fn all() -> [Self; 4] {
        core::array::from_fn(|i| {
            let (bays, away) = if i % 2 == 0 { (5, COURT.y) } else { (4, COURT.x) };
            Self { turn: Turn::quarters(i), bays, away }
        })
    }

    /// Where a column stands along the side; bay `i` lies between columns `i` and `i + 1`.
    pub fn column_x(&self, i: usize) -> f64 {
        BAY * (i as f64 - self.bays as f64 * 0.5)
    }
}
