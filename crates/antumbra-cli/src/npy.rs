//! Points in and answers out, as NumPy's `.npy`.

use anyhow::{Context, Result, bail, ensure};
use glam::DVec3;
use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar, WriterBuilder};

/// NumPy's own headers are shorter than 128 bytes.
const MAX_HEADER_BYTES: usize = 4096;
/// A dictionary with a tuple in it takes two.
const MAX_BRACKETS: usize = 16;
/// Fewer digits than this, and no product of a header's numbers leaves 64 bits.
const MAX_DIGITS: usize = 18;

/// Reads an array of shape (n, 3), float32 or float64, in any byte order and either order of axes.
///
/// # Errors
/// One sentence, without the file's name.
pub fn read_points(bytes: &[u8]) -> Result<Vec<DVec3>> {
    check_header(bytes)?;
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).context("its .npy header cannot be read")?;
    let &[points, 3] = header.shape() else {
        bail!("its shape is {:?}; points have the shape (n, 3)", header.shape());
    };
    let size = float_size(&header.dtype())?;
    let needed = points.saturating_mul(3 * size);
    ensure!(
        needed <= data.len() as u64,
        "it is cut off: {points} points take {needed} bytes, and {} are there",
        data.len()
    );
    let order = header.order();
    let numbers = if size == 4 { numbers::<f32>(header, data)? } else { numbers::<f64>(header, data)? };
    Ok(gather(&numbers, order))
}

/// Refuses headers that npyz's parser is no match for: it allocates what a header says, recurses with each bracket and
/// multiplies without looking.
fn check_header(bytes: &[u8]) -> Result<()> {
    ensure!(bytes.starts_with(b"\x93NUMPY"), "it is no .npy file");
    let (start, length) = match bytes.get(6..12) {
        Some(&[1, _, low, high, ..]) => (10, usize::from(u16::from_le_bytes([low, high]))),
        Some(&[_, _, a, b, c, d]) => (12, u32::from_le_bytes([a, b, c, d]) as usize),
        _ => bail!("its .npy header is cut off"),
    };
    ensure!(length <= MAX_HEADER_BYTES, "its .npy header is absurdly long ({length} bytes)");
    let text = bytes.get(start..start + length).context("its .npy header is cut off")?;
    let brackets = text.iter().filter(|b| b"([{".contains(b)).count();
    let digits = text.iter().filter(|b| b.is_ascii_digit()).count();
    ensure!(brackets <= MAX_BRACKETS && digits <= MAX_DIGITS, "its .npy header describes no (n, 3) array of floats");
    Ok(())
}

/// Bytes of a number.
fn float_size(dtype: &DType) -> Result<u64> {
    match dtype {
        DType::Plain(scalar) if scalar.type_char() == TypeChar::Float && [4, 8].contains(&scalar.size_field()) => {
            Ok(scalar.size_field())
        }
        other => bail!("its type is {}; points are float32 or float64", other.descr()),
    }
}

/// All numbers, in the file's order. The caller has checked that they are there.
fn numbers<T: Deserialize + Into<f64>>(header: NpyHeader, data: &[u8]) -> Result<Vec<f64>> {
    let file = NpyFile::with_header(header, data);
    let reader = file.data::<T>().map_err(|e| anyhow::anyhow!("its numbers cannot be read: {e}"))?;
    reader.map(|number| Ok(number?.into())).collect()
}

fn gather(numbers: &[f64], order: Order) -> Vec<DVec3> {
    match order {
        Order::C => numbers.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)).collect(),
        Order::Fortran => {
            let (x, rest) = numbers.split_at(numbers.len() / 3);
            let (y, z) = rest.split_at(x.len());
            x.iter().zip(y).zip(z).map(|((&x, &y), &z)| DVec3::new(x, y, z)).collect()
        }
    }
}

/// The bytes of a float32 array of shape (n,).
pub fn write_values(values: &[f32]) -> Result<Vec<u8>> {
    write_array(values, &[values.len() as u64])
}

/// The bytes of a float32 array of shape (n, 2).
pub fn write_pairs(pairs: &[[f32; 2]]) -> Result<Vec<u8>> {
    write_array(pairs.as_flattened(), &[pairs.len() as u64, 2])
}

fn write_array(values: &[f32], shape: &[u64]) -> Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(128 + 4 * values.len());
    let options = npyz::WriteOptions::new().default_dtype().shape(shape);
    let mut writer = options.writer(&mut bytes).begin_nd()?;
    writer.extend(values)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn header(descr: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn every_layout_of_points_is_read() {
        let rows = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0];
        let columns = [1.0_f64, 4.0, 2.0, 5.0, 3.0, 6.0];
        let little: Vec<u8> = rows.iter().flat_map(|v| v.to_le_bytes()).collect();
        let big: Vec<u8> = rows.iter().flat_map(|v| v.to_be_bytes()).collect();
        let turned: Vec<u8> = columns.iter().flat_map(|v| v.to_le_bytes()).collect();
        let wanted = vec![DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)];
        for (descr, fortran, data) in [("<f4", "False", little), (">f4", "False", big), ("<f8", "True", turned)] {
            let bytes = npy(&header(descr, fortran, "(2, 3)"), &data);
            assert_eq!(read_points(&bytes).expect(descr), wanted, "{descr}");
        }
        let none = npy(&header("<f4", "False", "(0, 3)"), &[]);
        assert_eq!(read_points(&none).expect("no points"), []);
    }

    #[test]
    fn what_is_no_list_of_points_is_refused() {
        let f4 = |shape: &str| npy(&header("<f4", "False", shape), &[0; 24]);
        for shape in ["(6,)", "(3, 2)", "(1, 2, 3)", "()", "(-2, 3)", "(3, 3)", "(999999999999999, 3)"] {
            assert!(read_points(&f4(shape)).is_err(), "{shape}");
        }
        assert!(read_points(&f4("(99999999999999999999, 3)")).is_err());
        assert!(read_points(&f4(&"(".repeat(4000))).is_err());
        for descr in ["<i4", "<f2", "|O", "<c8", "|S12", "nonsense"] {
            assert!(read_points(&npy(&header(descr, "False", "(2, 3)"), &[0; 48])).is_err(), "{descr}");
        }
        let mut endless = f4("(2, 3)");
        endless[6] = 2;
        endless[8..12].fill(255);
        assert!(read_points(&endless).is_err());
    }

    #[test]
    fn values_come_back() {
        let bytes = write_values(&[0.0, 0.5, 1.0]).expect("a small array");
        let file = NpyFile::new(&bytes[..]).expect("a sound file");
        assert_eq!(file.shape(), [3]);
        assert_eq!(file.into_vec::<f32>().expect("float32"), [0.0, 0.5, 1.0]);
    }

    proptest! {
        #[test]
        fn damage_never_panics(at in 0usize..160, byte: u8, length in 0usize..160) {
            let mut bytes = npy(&header("<f8", "False", "(3, 3)"), &[0; 72]);
            let at = at % bytes.len();
            bytes[at] = byte;
            bytes.truncate(length);
            let _ = read_points(&bytes);
        }
    }
}
