//! The filters of meshopt-compressed buffer views: what an unpacked element stands for.
//!
//! After the extensions EXT_meshopt_compression and KHR_meshopt_compression, section "Filters". Each works in place on
//! elements of four components.

use std::array;

use crate::error::SceneError;

/// Applies a filter by its name in the file.
pub(super) fn apply(filter: &str, bytes: &mut [u8], stride: usize) -> Result<(), SceneError> {
    match (filter, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => each8(bytes, |v| octahedral(v.map(|b| f32::from(b.cast_signed())), 127.0)),
        ("OCTAHEDRAL", 8) => each16(bytes, |v| octahedral(v.map(|b| f32::from(b.cast_signed())), 32767.0)),
        ("QUATERNION", 8) => each16(bytes, quaternion),
        ("EXPONENTIAL", _) => bytes.as_chunks_mut().0.iter_mut().for_each(|word| *word = exponential(*word)),
        ("COLOR", 4) => each8(bytes, |v| color(v.map(i32::from), 8)),
        ("COLOR", 8) => each16(bytes, |v| color(v.map(i32::from), 16)),
        _ => {
            return Err(SceneError::format(format!(
                "a compressed buffer view has filter {filter:?} at stride {stride}"
            )));
        }
    }
    Ok(())
}

/// Maps elements of four bytes. A result of `None` in a component keeps it.
fn each8(bytes: &mut [u8], map: impl Fn([u8; 4]) -> [Option<i32>; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let mapped = map(*element);
        *element = array::from_fn(|c| mapped[c].map_or(element[c], |v| v as u8));
    }
}

/// As [`each8`] for four halfwords.
fn each16(bytes: &mut [u8], map: impl Fn([u16; 4]) -> [Option<i32>; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let old: [u16; 4] = array::from_fn(|c| u16::from_le_bytes([element[2 * c], element[2 * c + 1]]));
        let mapped = map(old);
        let new: [u16; 4] = array::from_fn(|c| mapped[c].map_or(old[c], |v| v as u16));
        *element = array::from_fn(|b| new[b / 2].to_le_bytes()[b % 2]);
    }
}

fn round(v: f32) -> i32 {
    (v + 0.5_f32.copysign(v)) as i32
}

/// A unit vector from two octahedral coordinates; the third component holds the value of 1.0. The fourth stays.
fn octahedral([x, y, one, _]: [f32; 4], max: f32) -> [Option<i32>; 4] {
    let z = one - x.abs() - y.abs();
    // Unfold the lower half.
    let t = z.min(0.0);
    let x = if x >= 0.0 { x + t } else { x - t };
    let y = if y >= 0.0 { y + t } else { y - t };
    let scale = max / (x * x + y * y + z * z).sqrt();
    [Some(round(x * scale)), Some(round(y * scale)), Some(round(z * scale)), None]
}

/// A unit quaternion from its three smallest components; the fourth holds their scale and, in two bits, which one is
/// missing.
fn quaternion(v: [u16; 4]) -> [Option<i32>; 4] {
    let one = f32::from((v[3] | 3).cast_signed());
    let [x, y, z] = [v[0], v[1], v[2]].map(|c| f32::from(c.cast_signed()));
    let w = (one * one * 2.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let scale = 32767.0 * std::f32::consts::FRAC_1_SQRT_2 / one;
    let largest = usize::from(v[3] & 3);
    let mut out = [None; 4];
    for (i, c) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + i) & 3] = Some(round(c * scale));
    }
    out
}

/// A float from an 8-bit exponent over a 24-bit mantissa.
fn exponential(word: [u8; 4]) -> [u8; 4] {
    let word = i32::from_le_bytes(word);
    let mantissa = word << 8 >> 8;
    let power = f32::from_bits(((word >> 24) + 127).cast_unsigned() << 23);
    (power * mantissa as f32).to_le_bytes()
}

/// RGBA from luma, two chroma differences and an alpha whose highest set bit says how many bits all four have.
fn color([y, co, cg, a]: [i32; 4], bits: u32) -> [Option<i32>; 4] {
    let sign_extend = |v: i32| v << (32 - bits) >> (32 - bits);
    let (co, cg) = (sign_extend(co), sign_extend(cg));
    let ones = a | a >> 1;
    let ones = ones | ones >> 2;
    let ones = ones | ones >> 4;
    let ones = ones | ones >> 8;
    let alpha = (a << 1 & ones) | (a & 1);
    let scale = ((1 << bits) - 1) as f32 / ones as f32;
    [y + co - cg, y + cg, y - co - cg, alpha].map(|v| Some((v as f32 * scale + 0.5) as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn halfwords(v: &[u16]) -> Vec<u8> {
        v.iter().flat_map(|w| w.to_le_bytes()).collect()
    }

    // Expected values from meshoptimizer's own tests.

    #[test]
    fn octahedral_vectors() {
        let mut bytes = [0, 1, 127, 0, 0, 187, 127, 1, 255, 1, 127, 0, 14, 130, 127, 1];
        apply("OCTAHEDRAL", &mut bytes, 4).expect("known");
        assert_eq!(bytes, [0, 1, 127, 0, 0, 159, 82, 1, 255, 1, 127, 0, 1, 130, 241, 1]);
        let mut bytes = halfwords(&[0, 1870, 2047, 1, 14, 1300, 2047, 1]);
        apply("OCTAHEDRAL", &mut bytes, 8).expect("known");
        assert_eq!(bytes, halfwords(&[0, 32621, 3088, 1, 307, 28541, 16093, 1]));
    }

    #[test]
    fn quaternions() {
        let mut bytes = halfwords(&[0, 1, 0, 0x7fc, 0, 1870, 0, 0x7fd, 2017, 1, 0, 0x7fe, 14, 1300, 0, 0x7ff]);
        apply("QUATERNION", &mut bytes, 8).expect("known");
        let expected = [32767, 0, 11, 0, 0, 25013, 0, 21166, 11, 0, 23504, 22830, 158, 14715, 0, 29277];
        assert_eq!(bytes, halfwords(&expected));
        let mut negative = halfwords(&[(-1870_i16).cast_unsigned(), 0, 0, 0x7fc]);
        apply("QUATERNION", &mut negative, 8).expect("known");
        assert_eq!(negative[2..4], (-21166_i16).to_le_bytes());
    }

    #[test]
    fn exponentials() {
        let mut bytes: Vec<u8> =
            [0_u32, 0xff00_0003, 0x02ff_fff7, 0xfe7f_ffff].iter().flat_map(|w| w.to_le_bytes()).collect();
        apply("EXPONENTIAL", &mut bytes, 4).expect("known");
        let expected: Vec<u8> =
            [0_u32, 0x3fc0_0000, 0xc210_0000, 0x49ff_fffe].iter().flat_map(|w| w.to_le_bytes()).collect();
        assert_eq!(bytes, expected);
    }

    #[test]
    fn colors() {
        let mut bytes = [64, 127, 193, 255, 127, 0, 127, 255, 64, 129, 192, 192, 255, 0, 0, 128];
        apply("COLOR", &mut bytes, 4).expect("known");
        assert_eq!(bytes, [254, 1, 0, 255, 0, 254, 0, 255, 1, 0, 255, 128, 255, 255, 255, 0]);
        let mut bytes = halfwords(&[0x4000, 0x7fff, 0xc001, 0xffff, 0x4000, 0x8001, 0xc000, 0xc000]);
        apply("COLOR", &mut bytes, 8).expect("known");
        assert_eq!(bytes, halfwords(&[0xfffe, 1, 0, 0xffff, 1, 0, 0xffff, 0x8000]));
    }

    #[test]
    fn hostile_values_do_not_panic() {
        for filter in ["OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR", "NONE"] {
            for fill in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = [fill; 16];
                let _ = apply(filter, &mut bytes, 8);
                let _ = apply(filter, &mut bytes, 4);
            }
        }
        assert!(apply("UNHEARD_OF", &mut [0; 8], 8).is_err());
    }
}
