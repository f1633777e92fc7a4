//! Which taps a filtered lookup takes, and how they weigh.

use crate::FilterError;

/// Weights of a filter's taps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// All taps weigh the same.
    Box,
    /// Weights fall off linearly from the middle, along x and y separately (their product is a tap's weight).
    Tent,
    /// No taps: whether the point itself is lit, by the casters' own edges and planes, which the encoding `silhouette` knows between
    /// the middles of texels too ([`Filter::continuous`]). Elsewhere as a single tap.
    Continuous,
}

/// A square PCF filter of K x K texels, K odd, at one depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    taps: u32,
    kernel: Kernel,
}

/// Most taps per side.
pub const MAX_TAPS: u32 = 17;

impl Default for Filter {
    /// One tap: a hard shadow.
    fn default() -> Self {
        Self { taps: 1, kernel: Kernel::Box }
    }
}

impl Filter {
    /// K x K taps of the given kernel.
    ///
    /// # Errors
    /// [`FilterError`] unless `taps` is odd and at most 17, of continuous lookups 1.
    pub fn new(taps: u32, kernel: Kernel) -> Result<Self, FilterError> {
        if kernel == Kernel::Continuous && taps != 1 {
            return Err(FilterError { taps });
        }
        if taps % 2 == 1 && taps <= MAX_TAPS { Ok(Self { taps, kernel }) } else { Err(FilterError { taps }) }
    }

    /// A hard shadow without texels: its edges run where the casters' do, however near they are seen.
    ///
    /// Files of the encoding `silhouette` alone know that; of others it is a plain lookup. Between the middles of texels an answer is not
    /// held against the voxels': where an edge leaves a tile between two rows of middles, a shadow may end up to half a texel beside it, and where
    /// only masks tell the depths (foliage) there are texels still.
    #[must_use]
    pub fn continuous() -> Self {
        Self { taps: 1, kernel: Kernel::Continuous }
    }

    /// K x K taps of equal weight.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn new_box(taps: u32) -> Result<Self, FilterError> {
        Self::new(taps, Kernel::Box)
    }

    /// K x K taps whose weights fall off linearly.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn new_tent(taps: u32) -> Result<Self, FilterError> {
        Self::new(taps, Kernel::Tent)
    }

    /// A tent of so many taps on either side of the middle one, at most 8.
    pub(crate) fn tent_of_radius(radius: u32) -> Self {
        Self { taps: 2 * radius.min(MAX_TAPS / 2) + 1, kernel: Kernel::Tent }
    }

    /// Taps per side.
    #[must_use]
    pub fn taps(self) -> u32 {
        self.taps
    }

    /// The weights' shape.
    #[must_use]
    pub fn kernel(self) -> Kernel {
        self.kernel
    }

    /// Taps on either side of the middle one.
    #[must_use]
    pub fn radius(self) -> u32 {
        self.taps / 2
    }

    /// Weight along one axis of the tap at a distance from the middle, in texels: 0 beyond the radius.
    #[inline(always)]
    #[must_use]
    pub fn weight(self, distance: u32) -> u32 {
        let radius = self.radius();
        match self.kernel {
            _ if distance > radius => 0,
            Kernel::Box | Kernel::Continuous => 1,
            Kernel::Tent => radius + 1 - distance,
        }
    }

    /// The filter's effective width, texels: that of a box of the middle tap's weight.
    #[must_use]
    pub fn width(self) -> u32 {
        match self.kernel {
            Kernel::Box | Kernel::Continuous => self.taps,
            Kernel::Tent => self.radius() + 1,
        }
    }

    /// Sum of the weights along one axis.
    #[must_use]
    pub fn axis_weight(self) -> u32 {
        match self.kernel {
            Kernel::Box | Kernel::Continuous => self.taps,
            Kernel::Tent => (self.radius() + 1) * (self.radius() + 1),
        }
    }
}
