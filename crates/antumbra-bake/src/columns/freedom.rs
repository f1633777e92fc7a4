//! What an interior policy leaves free behind the first surface of a ray, beside the inside of closed parts.

use antumbra::Interior;

use crate::light_space::LocalSpace;

/// Where a ray's transition may lie although no solid hides it. In slices; the inside of solids comes on top.
#[derive(Clone, Debug)]
pub enum Freedom {
    /// Nowhere: open surfaces are exact.
    None,
    /// So far behind the first surface.
    Thickness(Shift),
    /// Up to so far before the second surface: for receivers on the scene's own surfaces.
    Static(Shift),
}

/// Moves a slice by a length along the light.
#[derive(Clone, Debug)]
pub enum Shift {
    /// By so many slices.
    Even(u32),
    /// To the slice that the table has for each; the last one holds for all behind.
    Table(Vec<u32>),
}

impl Shift {
    fn deeper(&self, slice: u32) -> u32 {
        match self {
            Self::Even(slices) => slice.saturating_add(*slices),
            Self::Table(table) => table.get(slice as usize).copied().unwrap_or(u32::MAX),
        }
    }

    fn nearer(&self, slice: u32) -> u32 {
        match self {
            Self::Even(slices) => slice.saturating_sub(*slices),
            Self::Table(table) => table[(slice as usize).min(table.len() - 1)],
        }
    }
}

impl Freedom {
    /// Of a directional light with slices of a size in metres. Rounded to the side of less freedom.
    #[must_use]
    pub fn directional(interior: Interior, slice_size_m: f64) -> Self {
        match interior {
            Interior::Open | Interior::Closed | Interior::Auto => Self::None,
            Interior::Thickness(m) => Self::Thickness(Shift::Even((m / slice_size_m).floor() as u32)),
            Interior::Static(m) => Self::Static(Shift::Even((m / slice_size_m).ceil() as u32)),
        }
    }

    /// Of a local light: a table with an entry for each slice. A thickness is measured along the most slanted ray of a
    /// face, so that none gets more of it; a margin along the face's axis, so that none gets less.
    #[must_use]
    pub fn local(interior: Interior, space: &LocalSpace) -> Self {
        match interior {
            Interior::Open | Interior::Closed | Interior::Auto => Self::None,
            Interior::Thickness(m) => {
                let tangent = space.tangent_of_grid();
                let along = m / (1.0 + 2.0 * tangent * tangent).sqrt();
                Self::Thickness(Shift::Table(table(space, along)))
            }
            Interior::Static(m) => Self::Static(Shift::Table(table(space, -m))),
        }
    }

    /// First slice that must be shadowed on a ray that is shadowed from `enter` on and meets its second surface in slice
    /// `second`, solids apart; `u32::MAX` stands for no second surface and for no such slice.
    #[inline(always)]
    pub(super) fn exit(&self, enter: u32, second: u32) -> u32 {
        match self {
            Self::None => enter,
            Self::Thickness(thickness) => thickness.deeper(enter),
            Self::Static(_) if second == u32::MAX => u32::MAX,
            Self::Static(margin) => margin.nearer(second).max(enter),
        }
    }

    /// The margin before second surfaces, if it is so many slices everywhere.
    pub(super) fn even_margin(&self) -> Option<u32> {
        if let Self::Static(Shift::Even(slices)) = self { Some(*slices) } else { None }
    }

    /// Whether rays may be free behind open surfaces.
    #[inline(always)]
    pub(crate) fn is_behind_open(&self) -> bool {
        !matches!(self, Self::None)
    }

    /// Whether the second surface counts.
    #[inline(always)]
    pub(super) fn is_static(&self) -> bool {
        matches!(self, Self::Static(_))
    }
}

/// For each slice up to N: the last one that begins no deeper than the slice's own beginning and so many metres.
fn table(space: &LocalSpace, metres: f64) -> Vec<u32> {
    let n = space.resolution().texels();
    let slices = f64::from(n);
    let (near, far) = (space.near_m(), space.far_m());
    let log_ratio = libm::log(far / near);
    let is_ndc = space.distribution() == antumbra::DepthDistribution::Ndc;
    let depth = |slice: u32| {
        let share = f64::from(slice) / slices;
        if is_ndc { near / (1.0 - share * (1.0 - near / far)) } else { near * libm::exp(share * log_ratio) }
    };
    let slice_at = |depth: f64| {
        let share =
            if is_ndc { (1.0 - near / depth) / (1.0 - near / far) } else { libm::log(depth / near) / log_ratio };
        share * slices
    };
    let moved = |slice: u32| {
        let to = depth(slice) + metres;
        if to <= near { 0 } else { slice_at(to).floor() as u32 }
    };
    // A logarithm's last digit must not move a slice the wrong way, nor let a deeper one end up nearer.
    let right_way = |slice: u32| if metres >= 0.0 { moved(slice).max(slice) } else { moved(slice).min(slice) };
    let deepest_so_far = |deepest: &mut u32, slice: u32| {
        *deepest = slice.max(*deepest);
        Some(*deepest)
    };
    (0..=n).map(right_way).scan(0, deepest_so_far).collect()
}
