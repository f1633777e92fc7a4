//! What all VPLs' light does to one sample: on its surface, and in the fog before it.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;

use super::airlight::{Airlight, Beside, STEEPEST};
use super::epipolar::{Epipolar, Place};
use crate::area::{self, Vpl};
use crate::surface::Surface;

/// Lookups are moved towards the light and the eye by so many voxels, or surfaces would shadow themselves (Wyman and Dai
/// 2013, section 5).
const ALPHA_BIAS: f32 = -2.25;
const PHI_BIAS: f32 = -1.0;

/// A sample: what it sees, relative to the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<'s> {
    /// Unit vector from the eye.
    pub ray: Vec3,
    /// How far away its surface is; without one, as far as fog reaches.
    pub distance: f32,
    /// How far it looks through fog: no farther than that.
    pub fog_m: f32,
    pub surface: Option<&'s Surface>,
}

/// What is the same for all samples.
pub(crate) struct Gather<'g> {
    /// Extinction per metre; all of it is scattering.
    pub sigma_t: f32,
    pub airlight: &'g Airlight,
    pub how: area::Airlight,
    pub interpolate: bool,
}

/// A VPL's voxels in its space.
pub(crate) struct Volume {
    pub vpl: Vpl,
    pub space: Epipolar,
    /// See [`super::scan::voxels`]; empty where nothing casts shadows.
    pub voxels: Vec<u32>,
}

impl Gather<'_> {
    /// Adds what a VPL does to a sample: light that its surface gets and where from, and airlight.
    pub fn add(&self, volume: &Volume, sample: &Sample<'_>, mut reflect: impl FnMut(Vec3, Vec3), air: &mut Vec3) {
        let Volume { vpl, space, .. } = volume;
        let place = space.place(sample.ray, sample.distance);
        // Behind what is no surface nothing stands before the light.
        let stop = if sample.surface.is_some() { sample.distance } else { f32::INFINITY };
        let rows = volume.rows(&place, stop, self.interpolate);
        if let Some(surface) = sample.surface {
            let towards = vpl.position - sample.ray * sample.distance;
            let r = towards.length().max(1e-9);
            let towards = towards / r;
            let emitted = -vpl.normal.dot(towards);
            if emitted > 0.0 && surface.normal.dot(towards) > 0.0 && surface.face_normal.dot(towards) > 0.0 {
                let visible = volume.visible(&rows, place.phi, self.interpolate);
                let clear = (-self.sigma_t * (r - vpl.start_m)).exp();
                let falloff = emitted * clear / (r * r + vpl.radius_m * vpl.radius_m);
                if visible > 0.0 {
                    reflect(towards, vpl.intensity * (falloff * visible));
                }
            }
        }
        if self.sigma_t > 0.0 {
            let lit = self.scattered(volume, sample, &place, &rows);
            *air += vpl.intensity * (self.sigma_t * lit);
        }
    }

    /// Airlight of a VPL per intensity and scattering.
    fn scattered(&self, volume: &Volume, sample: &Sample<'_>, place: &Place, rows: &Rows) -> f32 {
        let (vpl, space) = (&volume.vpl, &volume.space);
        let foot = space.distance * sample.ray.dot(space.axis);
        let from_light = sample.ray * foot - vpl.position;
        let h = from_light.length();
        let beside = Beside {
            foot,
            h: h.max(vpl.radius_m).max(1e-4 * space.distance),
            a: vpl.normal.dot(from_light) / h.max(1e-9),
            b: vpl.normal.dot(sample.ray),
            sigma_t: self.sigma_t,
            start: vpl.start_m,
        };
        // From an angle at the light to theta; nearer to the ray than the light's own radius, by way of the place on the ray.
        let theta = |phi: f32| {
            let exact = phi - FRAC_PI_2 + place.alpha;
            if beside.h > h { (h / beside.h * exact.clamp(-STEEPEST, STEEPEST).tan()).atan() } else { exact }
        };
        let [from, to] = beside.lit(beside.theta(0.0), beside.theta(sample.fog_m));
        let behind = |phi: f32| beside.behind(self.airlight, theta(phi).clamp(from, to));
        let end = space.place(sample.ray, sample.fog_m).phi;
        let whole = || beside.behind(self.airlight, from) - beside.behind(self.airlight, to);
        match (self.how, rows) {
            (_, Rows::Lit) => whole(),
            (_, Rows::Dark) => 0.0,
            (area::Airlight::Average, Rows::Texels(first, second, share)) => {
                let lit = |texel| volume.share_lit(texel, end);
                whole() * (lit(*first) * (1.0 - share) + lit(*second) * share)
            }
            (area::Airlight::Exact, Rows::Texels(first, second, share)) => {
                let first_lit = volume.runs(*first, end, behind);
                if *share == 0.0 {
                    return first_lit;
                }
                first_lit * (1.0 - share) + volume.runs(*second, end, behind) * share
            }
        }
    }
}

/// Which texels a ray reads.
pub(crate) enum Rows {
    /// None: nothing is in the way.
    Lit,
    /// None: what is seen stands between the eye and the light.
    Dark,
    /// Two of neighbouring planes, by their first words, and how much the second counts.
    Texels(usize, usize, f32),
}

impl Volume {
    pub(super) fn rows(&self, place: &Place, stop: f32, interpolate: bool) -> Rows {
        let space = &self.space;
        if self.voxels.is_empty() {
            return Rows::Lit;
        }
        // At the epipole a voxel is as long as the ray: what is seen stands before the light, or nothing does.
        if place.alpha * space.alpha_scale < -ALPHA_BIAS {
            return if stop < space.distance { Rows::Dark } else { Rows::Lit };
        }
        let column = (place.alpha - space.alpha_min) * space.alpha_scale + ALPHA_BIAS;
        let column = (column.max(0.0) as u32).min(space.size.alpha - 1);
        let words = space.size.phi / 32;
        let texel = |row: u32| ((row * space.size.alpha + column) * words) as usize;
        let index = space.theta_index(place.theta);
        if !interpolate {
            let own = texel(space.row(index.floor() as i32));
            return Rows::Texels(own, own, 0.0);
        }
        let first = (index - 0.5).floor();
        let rows = [first as i32, first as i32 + 1].map(|row| texel(space.row(row)));
        Rows::Texels(rows[0], rows[1], index - 0.5 - first)
    }

    fn is_dark(&self, texel: usize, phi: i32) -> bool {
        let bit = phi.clamp(0, self.space.size.phi as i32 - 1) as usize;
        self.voxels[texel + bit / 32] >> (bit % 32) & 1 == 1
    }

    /// How much of the light arrives at an angle, from 0 to 1.
    fn visible(&self, rows: &Rows, phi: f32, interpolate: bool) -> f32 {
        let (first, second, share) = match rows {
            Rows::Lit => return 1.0,
            Rows::Dark => return 0.0,
            Rows::Texels(first, second, share) => (*first, *second, *share),
        };
        let index = phi * self.space.phi_scale + PHI_BIAS;
        let lit = |texel, bit: f32| if self.is_dark(texel, bit as i32) { 0.0 } else { 1.0 };
        if !interpolate {
            return lit(first, index.floor());
        }
        let bit = (index - 0.5).floor();
        let weight = index - 0.5 - bit;
        let along = |texel| lit(texel, bit) * (1.0 - weight) + lit(texel, bit + 1.0) * weight;
        along(first) * (1.0 - share) + along(second) * share
    }

    /// The share of a texel's bits up to an angle that are lit.
    pub(super) fn share_lit(&self, texel: usize, end: f32) -> f32 {
        let bits = ((end * self.space.phi_scale) as u32).clamp(1, self.space.size.phi);
        let word = |i: u32| {
            let own = self.voxels[texel + i as usize];
            let left = bits - 32 * i;
            (if left < 32 { own & ((1 << left) - 1) } else { own }).count_ones()
        };
        let dark: u32 = (0..bits.div_ceil(32)).map(word).sum();
        1.0 - dark as f32 / bits as f32
    }

    /// The sum over a texel's lit runs, up to an angle, of differences of a function: one call for each change.
    pub(super) fn runs(&self, texel: usize, end: f32, behind: impl Fn(f32) -> f32) -> f32 {
        let space = &self.space;
        let end_index = end * space.phi_scale;
        let bits = (end_index.ceil() as u32).clamp(1, space.size.phi);
        let mut dark = self.voxels[texel] & 1;
        let mut sum = if dark == 0 { behind(0.0) } else { 0.0 };
        for i in 0..bits.div_ceil(32) {
            let own = self.voxels[texel + i as usize];
            let mut changes = own ^ (own << 1 | dark);
            while changes != 0 {
                let bit = 32 * i + changes.trailing_zeros();
                changes &= changes - 1;
                if bit as f32 >= end_index {
                    break;
                }
                dark ^= 1;
                let there = behind(bit as f32 / space.phi_scale);
                sum += if dark == 1 { -there } else { there };
            }
        }
        if dark == 0 { sum - behind(end.min(PI)) } else { sum }
    }
}
