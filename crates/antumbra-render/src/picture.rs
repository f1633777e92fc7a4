//! Finished pictures.

use std::io::{self, Write};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

/// A picture: what a screen shows, and the light it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<u8>,
    pub(crate) hdr: Vec<[f32; 3]>,
    pub(crate) exposure: f32,
}

impl Picture {
    /// Pixels per row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// sRGB, 3 bytes per pixel, rows from the top.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Linear RGB radiance before exposure and tone mapping, rows from the top. The unit is the sun's irradiance
    /// outside the atmosphere, per steradian, by day and by night: 128,000 cd/m².
    #[must_use]
    pub fn hdr(&self) -> &[[f32; 3]] {
        &self.hdr
    }

    /// What [`Picture::hdr`] was multiplied by before tone mapping: give it to
    /// [`RenderOptions::exposure`](crate::RenderOptions::exposure) to make another picture that compares.
    #[must_use]
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// When `writer` has an error.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let encoder = PngEncoder::new(writer);
        encoder.write_image(&self.rgb, self.width, self.height, ExtendedColorType::Rgb8).map_err(|error| match error {
            image::ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    }

    /// The picture as a PNG file's bytes.
    ///
    /// # Errors
    /// When the encoder fails, which takes more than 2^32 bytes.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }
}
