//! What all VPLs' light does to one sample: on its surface, and in the fog before it.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;

use super::AreaLit;
use super::airlight::{Airlight, Beside, STEEPEST};
use super::epipolar::{Epipolar, Place};
use super::splat::{Map, Paraboloid};
use crate::area::{self, Vpl};
use crate::surface::Surface;

/// Surfaces are looked up so many cells of light rays or maps before themselves, along their normals, and so many columns towards
/// the light, or they would shadow themselves; fog is looked up where it is. (Wyman and Dai 2013, section 5, move both by 2.25
/// columns and a bit: along a surface that light grazes that is too little, and in fog before a wall light leaks by it.)
const CELLS_OFF: f32 = 0.6;
const ALPHA_BIAS: f32 = -1.0;

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

/// A VPL, its space, and its shadows.
pub(crate) struct Volume {
    pub vpl: Vpl,
    pub space: Epipolar,
    pub shadows: Shadows,
}

/// What is known of a VPL's shadows.
pub(crate) enum Shadows {
    /// Everything is lit.
    None,
    /// See [`super::scan::voxels`].
    Voxels(Vec<u32>),
    /// Its map, as seen by view rays step by step.
    Map(Map, Paraboloid),
}

/// Words of the longest texel.
const MOST_WORDS: usize = 16;
/// A map's surfaces shadow what is farther away than they by more than this share.
const MAP_BIAS: f32 = 0.03;

impl Gather<'_> {
    /// Adds what a VPL does to a sample.
    pub fn add(&self, volume: &Volume, sample: &Sample<'_>, lit: &mut AreaLit) {
        let Volume { vpl, space, .. } = volume;
        let place = space.place(sample.ray, sample.distance);
        // Behind what is no surface nothing stands before the light.
        let stop = if sample.surface.is_some() { sample.distance } else { f32::INFINITY };
        if let Some(surface) = sample.surface {
            let towards = vpl.position - sample.ray * sample.distance;
            let r = towards.length().max(1e-9);
            let towards = towards / r;
            let emitted = -vpl.normal.dot(towards);
            if emitted > 0.0 && surface.normal.dot(towards) > 0.0 && surface.face_normal.dot(towards) > 0.0 {
                let of_map = 2.0 * vpl.spread * (1.0 + emitted) / space.size.map as f32;
                let cell = r * (1.0 / space.phi_scale).max(place.phi.sin() / space.theta_scale).max(of_map);
                let at = sample.ray * sample.distance + surface.face_normal * (CELLS_OFF * cell);
                let visible = volume.visible(at, stop, self.interpolate);
                let clear = (-self.sigma_t * (r - vpl.start_m)).exp();
                let falloff = emitted * clear / (r * r + vpl.radius_m * vpl.radius_m);
                lit.receive(surface, towards, vpl.intensity * (falloff * visible));
            }
        }
        if self.sigma_t > 0.0 {
            let rows = volume.rows(&place, stop, 0.0, self.interpolate);
            let scattered = self.scattered(volume, sample, &place, &rows);
            lit.airlight += vpl.intensity * (self.sigma_t * scattered);
        }
    }

    /// Airlight of a VPL per intensity and scattering.
    fn scattered(&self, volume: &Volume, sample: &Sample<'_>, place: &Place, rows: &Rows<'_>) -> f32 {
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
        let texel = |words: &[u32]| match self.how {
            area::Airlight::Average => whole() * space.share_lit(words, end),
            area::Airlight::Exact => space.runs(words, end, behind),
        };
        match rows {
            Rows::Lit => whole(),
            Rows::Dark => 0.0,
            Rows::Texels(first, _, 0.0) => texel(first),
            Rows::Texels(first, second, share) => texel(first) * (1.0 - share) + texel(second) * share,
            Rows::Map(map, paraboloid) => {
                let words = space.marched(vpl, map, paraboloid, sample.ray, place, end);
                texel(&words)
            }
        }
    }
}

/// What a ray reads.
pub(crate) enum Rows<'v> {
    /// Nothing: nothing is in the way.
    Lit,
    /// Nothing: what is seen stands between the eye and the light.
    Dark,
    /// Two texels of neighbouring planes, and how much the second counts.
    Texels(&'v [u32], &'v [u32], f32),
    /// A map, which is looked up again and again.
    Map(&'v Map, &'v Paraboloid),
}

impl Volume {
    pub(super) fn rows(&self, place: &Place, stop: f32, bias: f32, interpolate: bool) -> Rows<'_> {
        let space = &self.space;
        let voxels = match &self.shadows {
            Shadows::None => return Rows::Lit,
            Shadows::Map(map, paraboloid) => return Rows::Map(map, paraboloid),
            Shadows::Voxels(voxels) => voxels,
        };
        // At the epipole a voxel is as long as the ray: what is seen stands before the light, or nothing does.
        if place.alpha * space.alpha_scale < 1.0 {
            return if stop < space.distance { Rows::Dark } else { Rows::Lit };
        }
        let column = (place.alpha - space.alpha_min) * space.alpha_scale + bias;
        let column = (column.max(0.0) as u32).min(space.size.alpha - 1);
        let words = (space.size.phi / 32) as usize;
        let texel = |row: u32| {
            let first = (row * space.size.alpha + column) as usize * words;
            &voxels[first..first + words]
        };
        let index = space.theta_index(place.theta);
        if !interpolate {
            let own = texel(space.row(index.floor() as i32));
            return Rows::Texels(own, own, 0.0);
        }
        let first = (index - 0.5).floor();
        let [one, other] = [first as i32, first as i32 + 1].map(|row| texel(space.row(row)));
        Rows::Texels(one, other, index - 0.5 - first)
    }

    /// How much of the light arrives at a place, from 0 to 1.
    fn visible(&self, at: Vec3, stop: f32, interpolate: bool) -> f32 {
        let space = &self.space;
        let t = at.length();
        let place = space.place(at / t.max(1e-9), t);
        let (first, second, share) = match self.rows(&place, stop, ALPHA_BIAS, interpolate) {
            Rows::Lit => return 1.0,
            Rows::Dark => return 0.0,
            Rows::Map(map, paraboloid) => return if is_dark(&self.vpl, map, paraboloid, at) { 0.0 } else { 1.0 },
            Rows::Texels(first, second, share) => (first, second, share),
        };
        let index = place.phi * space.phi_scale;
        let lit = |texel: &[u32], bit: f32| {
            let bit = (bit as i32).clamp(0, space.size.phi as i32 - 1) as usize;
            (texel[bit / 32] >> (bit % 32) & 1 ^ 1) as f32
        };
        if !interpolate {
            return lit(first, index.floor());
        }
        let bit = (index - 0.5).floor();
        let weight = index - 0.5 - bit;
        let along = |texel| lit(texel, bit) * (1.0 - weight) + lit(texel, bit + 1.0) * weight;
        along(first) * (1.0 - share) + along(second) * share
    }
}

/// Whether a place lies in the shadow of what a map shows.
fn is_dark(vpl: &Vpl, map: &Map, paraboloid: &Paraboloid, at: Vec3) -> bool {
    let away = at - vpl.position;
    let r = away.length();
    let seen = paraboloid.texel(away / r.max(1e-9)).and_then(|(texel, _)| map.between(texel));
    seen.is_some_and(|blocked| r > blocked * (1.0 + MAP_BIAS))
}

impl Epipolar {
    /// The texel of a view ray, up to an angle, found by as many lookups of a map.
    fn marched(
        &self,
        vpl: &Vpl,
        map: &Map,
        paraboloid: &Paraboloid,
        ray: Vec3,
        place: &Place,
        end: f32,
    ) -> [u32; MOST_WORDS] {
        let mut words = [0; MOST_WORDS];
        let bits = ((end * self.phi_scale).ceil() as u32).clamp(1, self.size.phi);
        for bit in 0..bits {
            let phi = self.phi_at(bit);
            let t = self.distance * phi.sin() / (place.alpha + phi).sin().max(1e-6);
            words[bit as usize / 32] |= u32::from(is_dark(vpl, map, paraboloid, ray * t)) << (bit % 32);
        }
        words
    }

    /// The share of a texel's bits up to an angle that are lit.
    pub(super) fn share_lit(&self, words: &[u32], end: f32) -> f32 {
        let bits = ((end * self.phi_scale) as u32).clamp(1, self.size.phi);
        let word = |i: u32| {
            let left = bits - 32 * i;
            (if left < 32 { words[i as usize] & ((1 << left) - 1) } else { words[i as usize] }).count_ones()
        };
        let dark: u32 = (0..bits.div_ceil(32)).map(word).sum();
        1.0 - dark as f32 / bits as f32
    }

    /// The sum over a texel's lit runs, up to an angle, of differences of a function: one call for each change.
    pub(super) fn runs(&self, words: &[u32], end: f32, behind: impl Fn(f32) -> f32) -> f32 {
        let end_index = end * self.phi_scale;
        let bits = (end_index.ceil() as u32).clamp(1, self.size.phi);
        let mut dark = words[0] & 1;
        let mut sum = if dark == 0 { behind(0.0) } else { 0.0 };
        for i in 0..bits.div_ceil(32) {
            let own = words[i as usize];
            let mut changes = own ^ (own << 1 | dark);
            while changes != 0 {
                let bit = 32 * i + changes.trailing_zeros();
                changes &= changes - 1;
                if bit as f32 >= end_index {
                    break;
                }
                dark ^= 1;
                let there = behind(bit as f32 / self.phi_scale);
                sum += if dark == 1 { -there } else { there };
            }
        }
        if dark == 0 { sum - behind(end.min(PI)) } else { sum }
    }
}
