//! Numbers of a leaf's 64 rays side by side, ray 8*y + x in lane 8*y + x. Plain loops over them, without branches, become
//! vector code; masks of rays are lanes of all or no bits, so that they do as well.

/// Rays of a leaf.
pub(crate) const TEXELS: usize = 64;
/// One number per ray.
pub(crate) type Lanes = [u32; TEXELS];

/// All bits where the condition holds, else none.
#[inline(always)]
pub(crate) fn mask(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

/// `a` where the mask is set, else `b`.
#[inline(always)]
pub(crate) fn select(mask: u32, a: u32, b: u32) -> u32 {
    (a & mask) | (b & !mask)
}

/// All lanes taken together.
#[inline(always)]
fn reduce(lanes: &Lanes, f: impl Fn(u32, u32) -> u32) -> u32 {
    let mut eight = [0; 8];
    eight.copy_from_slice(&lanes[..8]);
    for group in 1..8 {
        for i in 0..8 {
            eight[i] = f(eight[i], lanes[8 * group + i]);
        }
    }
    let [a, b, c, d, e, g, h, i] = eight;
    f(f(f(a, b), f(c, d)), f(f(e, g), f(h, i)))
}

/// Whether any lane has a bit.
#[inline(always)]
pub(crate) fn any(lanes: &Lanes) -> bool {
    reduce(lanes, |a, b| a | b) != 0
}

/// The least of the lanes.
#[inline(always)]
pub(crate) fn least(lanes: &Lanes) -> u32 {
    reduce(lanes, u32::min)
}

/// The greatest of the lanes.
#[inline(always)]
pub(crate) fn greatest(lanes: &Lanes) -> u32 {
    reduce(lanes, u32::max)
}

/// Lane by lane. (Arrays' own `map` and `from_fn` are not always inlined, and then are no vector code.)
#[inline(always)]
pub(crate) fn map<A: Copy, B: Copy + Default>(a: &[A; TEXELS], f: impl Fn(A) -> B) -> [B; TEXELS] {
    let mut mapped = [B::default(); TEXELS];
    for i in 0..TEXELS {
        mapped[i] = f(a[i]);
    }
    mapped
}

/// Lane by lane.
#[inline(always)]
pub(crate) fn map2(a: &Lanes, b: &Lanes, f: impl Fn(u32, u32) -> u32) -> Lanes {
    let mut mapped = [0; TEXELS];
    for i in 0..TEXELS {
        mapped[i] = f(a[i], b[i]);
    }
    mapped
}

/// Bit i is set where the mask's lane i is.
#[inline(always)]
pub(crate) fn bits(mask: &Lanes) -> u64 {
    let mut eight = [[0u32; 8]; 2];
    for half in 0..2 {
        for group in 0..4 {
            for i in 0..8 {
                eight[half][i] |= (mask[32 * half + 8 * group + i] & (1 << i)) << (8 * group);
            }
        }
    }
    let word = |lanes: &[u32; 8]| u64::from(lanes.iter().fold(0, |word, lane| word | lane));
    word(&eight[0]) | (word(&eight[1]) << 32)
}

/// The mask whose lane i is set where bit i is.
#[inline(always)]
pub(crate) fn spread(bits: u64) -> Lanes {
    let mut mask = [0; TEXELS];
    for i in 0..32 {
        mask[i] = ((bits as u32 >> i) & 1).wrapping_neg();
        mask[32 + i] = (((bits >> 32) as u32 >> i) & 1).wrapping_neg();
    }
    mask
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
