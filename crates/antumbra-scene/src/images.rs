//! Decodes texture files: PNG, JPEG and WebP, recognised by their first bytes.

use std::io::Cursor;

use image::{ImageError, ImageReader, Limits};

use crate::error::SceneError;
use crate::model::Image;

/// Pixels per side.
const MAX_SIDE: u32 = 16384;
/// Pixels over all images of a scene: 4 GiB.
const MAX_PIXELS: u64 = 1 << 30;
/// What a decoder may allocate for one image: the largest with 16 bits per channel.
const MAX_ALLOCATION: u64 = 8 * (MAX_SIDE as u64) * (MAX_SIDE as u64);

/// Images decoded so far, within the limits for a whole scene.
#[derive(Default)]
pub(crate) struct ImageStore {
    pub images: Vec<Image>,
    pixels: u64,
}

impl ImageStore {
    /// Decodes an image and returns its index.
    pub fn add(&mut self, name: String, bytes: &[u8]) -> Result<usize, SceneError> {
        let (width, height) = reader(bytes).into_dimensions().map_err(|e| explain(&name, &e))?;
        self.pixels += u64::from(width) * u64::from(height);
        if self.pixels > MAX_PIXELS {
            return Err(SceneError::limit(format!("its images have more than {MAX_PIXELS} pixels together")));
        }
        let decoded = reader(bytes).decode().map_err(|e| explain(&name, &e))?.into_rgba8();
        let (width, height) = decoded.dimensions();
        self.images.push(Image { name, width, height, rgba: decoded.into_raw() });
        Ok(self.images.len() - 1)
    }
}

/// Decodes an image file: PNG, JPEG, WebP or, reduced to eight bits, HDR.
///
/// # Errors
/// [`SceneError`] names what is too large or cannot be decoded.
pub fn decode_image(name: &str, bytes: &[u8]) -> Result<Image, SceneError> {
    let decoded = reader(bytes).decode();
    let wrong = |error| SceneError::Picture { file: name.to_owned(), problem: problem(&error) };
    let decoded = decoded.map_err(wrong)?.into_rgba8();
    let (width, height) = decoded.dimensions();
    Ok(Image { name: name.to_owned(), width, height, rgba: decoded.into_raw() })
}

fn reader(bytes: &[u8]) -> ImageReader<Cursor<&[u8]>> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = image::guess_format(bytes) {
        reader.set_format(format);
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_ALLOCATION);
    reader.limits(limits);
    reader
}

fn explain(name: &str, error: &ImageError) -> SceneError {
    let problem = format!("its image {name:?} {}", problem(error));
    match error {
        ImageError::Limits(_) => SceneError::limit(problem),
        _ => SceneError::format(problem),
    }
}

fn problem(error: &ImageError) -> String {
    match error {
        ImageError::Limits(_) => format!("is larger than {MAX_SIDE} by {MAX_SIDE} pixels"),
        ImageError::Unsupported(_) => "is of a kind that is not supported (PNG, JPEG and WebP are)".to_owned(),
        _ => format!("cannot be decoded ({error})"),
    }
}
