//! Which lights reach what is seen.

mod source;

pub(crate) mod reference;

pub use source::ShadowSource;
pub(crate) use source::baked_light;
pub(crate) use source::{Place, Shadows};

use glam::Vec3;

use crate::{light::Lamplight, surface::Surface};

/// One light on one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// Unit vector towards the light.
    pub towards: Vec3,
    /// Irradiance of a surface that faces the light, nothing in the way.
    pub irradiance: Vec3,
    /// 0 in shadow to 1 in full light; never 0 in [`Beams`].
    pub visible: f32,
}

/// The lights on each sample of a row.
#[derive(Default)]
pub(crate) struct Beams {
    beams: Vec<Beam>,
    /// Where each sample's beams end.
    ends: Vec<usize>,
}

impl Beams {
    /// The beams of each sample, in order.
    pub(crate) fn by_sample(&self) -> impl Iterator<Item = &[Beam]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.beams[start..end])
    }
}

/// Whether light can fall on the side that is seen: the triangle's own side decides, not its smooth normal's, or light
/// would come through from behind.
fn faces(surface: &Surface, towards: Vec3) -> bool {
    surface.face_normal.dot(towards) > 0.0 && surface.normal.dot(towards) > 0.0
}

impl Beam {
    fn of_lamp(light: Lamplight, visible: f32) -> Self {
        Self { towards: light.towards, irradiance: light.irradiance, visible }
    }
}
