//! Numbers of a leaf's 64 rays side by side, ray 8*y + x in lane 8*y + x. Plain loops over them, without branches, become
//! vector code; masks of rays are lanes of all or no bits, so that they do as well.

/// Rays of a leaf.
pub(super) const TEXELS: usize = 64;
/// One number per ray.
pub(super) type Lanes = [u32; TEXELS];

/// All bits where the condition holds, else none.
#[inline(always)]
pub(super) fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// `a` where the mask is set, else `b`.
#[inline(always)]
pub(super) fn select(mask: u32, a: u32, b: u32) -> u32 {
    (a & mask) | (b & !mask)
}

/// Whether any lane has a bit.
#[inline(always)]
pub(super) fn any(lanes: &Lanes) -> bool {
    lanes.iter().fold(0, |all, lane| all | lane) != 0
}

/// The least of the lanes.
#[inline(always)]
pub(super) fn least(lanes: &Lanes) -> u32 {
    lanes.iter().fold(u32::MAX, |least, lane| least.min(*lane))
}

/// Lane by lane.
#[inline(always)]
pub(super) fn map2(a: &Lanes, b: &Lanes, f: impl Fn(u32, u32) -> u32) -> Lanes {
    core::array::from_fn(|i| f(a[i], b[i]))
}

/// Bit i is set where the mask's lane i is.
#[inline(always)]
pub(super) fn bits(mask: &Lanes) -> u64 {
    let word = |half: usize| {
        let mut eight = [0u32; 8];
        for group in 0..4 {
            for (i, lanes) in eight.iter_mut().enumerate() {
                *lanes |= (mask[32 * half + 8 * group + i] & (1 << i)) << (8 * group);
            }
        }
        eight.iter().fold(0, |all, lanes| all | lanes)
    };
    u64::from(word(0)) | (u64::from(word(1)) << 32)
}

/// The mask whose lane i is set where bit i is.
#[inline(always)]
pub(super) fn spread(bits: u64) -> Lanes {
    let words = [bits as u32, (bits >> 32) as u32];
    core::array::from_fn(|i| ((words[i / 32] >> (i % 32)) & 1).wrapping_neg())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_and_bits_are_two_ways_of_writing_the_same() {
        for i in 0..1000u64 {
            let word = i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let lanes = spread(word);
            assert_eq!(bits(&lanes), word);
            assert_eq!(any(&lanes), word != 0);
            assert!((0..TEXELS).all(|t| lanes[t] == mask((word >> t) & 1 != 0)));
        }
    }
}
