//! Area lights, and the virtual point lights that stand for them: the first pass.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use antumbra_scene::{AreaShape, Bounds};
use glam::{DVec2, DVec3, Vec3};

use super::Emission;
use crate::RenderError;
use crate::light::{LUX, luminance};

/// A light with a surface that is equally bright from wherever it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLight {
    /// Its surface.
    pub shape: AreaShape,
    /// Its middle, metres.
    pub position_world: DVec3,
    /// Unit vector along which a rectangle or disc shines.
    pub direction_world: DVec3,
    /// Unit vector at a right angle to it: up in the picture.
    pub up_world: DVec3,
    /// Linear RGB luminance, candela per square metre, by which the picture is multiplied.
    pub luminance: [f32; 3],
    /// What it shows; `None` for plain light.
    pub emission: Option<Arc<Emission>>,
}

/// A point of a light's surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightPoint {
    pub position_world: DVec3,
    /// Unit vector outward: nothing is emitted backwards.
    pub normal_world: DVec3,
    /// Radiance in the unit of pictures.
    pub radiance: Vec3,
    /// What surface stands behind it in all: intensity per radiance, times the number of points.
    pub area_m2: f64,
    /// Distance from it before which there is no fog.
    pub start_m: f64,
    /// Tangent of half the angle about its normal that all casters lie within.
    pub spread: f64,
}

/// A virtual point light, relative to the eye: emits an intensity times the cosine to its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vpl {
    pub position: Vec3,
    pub normal: Vec3,
    /// In the unit of pictures, times m².
    pub intensity: Vec3,
    /// Radius of the disc that it stands for: light comes from no nearer than that.
    pub radius_m: f32,
    pub start_m: f32,
    pub spread: f32,
}

/// An environment's points lie this many times as far away as the scene's radius.
const FAR: f64 = 16.0;

impl AreaLight {
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let sizes = match self.shape {
            AreaShape::Rectangle { width_m, height_m } => [width_m, height_m],
            AreaShape::Disc { radius_m } | AreaShape::Sphere { radius_m } => [radius_m; 2],
            AreaShape::Environment => [1.0; 2],
        };
        let is_size = |m: f64| m.is_finite() && m > 0.0;
        let wrong = if !sizes.into_iter().all(is_size) {
            "its size is not a positive number of metres"
        } else if !self.position_world.is_finite() {
            "its position is not finite"
        } else if !self.luminance.iter().all(|l| l.is_finite() && *l >= 0.0) {
            "its luminance is not finite, or below 0"
        } else if !self.direction_world.is_normalized() || !self.up_world.is_normalized() {
            "its direction or its up are no unit vectors"
        } else if self.direction_world.dot(self.up_world).abs() > 1e-6 {
            "its up is not at a right angle to its direction"
        } else {
            return Ok(());
        };
        Err(RenderError::AreaLight(wrong.to_owned()))
    }

    /// A light that shines from one point towards another, its picture upright.
    ///
    /// # Errors
    /// [`RenderError::AreaLight`] when the points coincide.
    pub fn towards(
        shape: AreaShape,
        position_world: DVec3,
        target_world: DVec3,
        luminance: [f32; 3],
    ) -> Result<Self, RenderError> {
        let direction = (target_world - position_world).try_normalize();
        let Some(direction_world) = direction else {
            return Err(RenderError::AreaLight("it shines nowhere: its position is its target".to_owned()));
        };
        let right = direction_world.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
        let up_world = right.cross(direction_world).normalize();
        Ok(Self { shape, position_world, direction_world, up_world, luminance, emission: None })
    }

    /// Left in the picture, as one sees it who looks at the light.
    pub(crate) fn left(&self) -> DVec3 {
        self.direction_world.cross(self.up_world)
    }

    fn area_m2(&self, scene: &Bounds) -> f64 {
        match self.shape {
            AreaShape::Rectangle { width_m, height_m } => width_m * height_m,
            AreaShape::Disc { radius_m } => PI * radius_m * radius_m,
            AreaShape::Sphere { radius_m } => 4.0 * PI * radius_m * radius_m,
            AreaShape::Environment => 4.0 * PI * (FAR * 0.5 * scene.diagonal()).powi(2),
        }
    }

    fn radiance(&self, uv: DVec2) -> Vec3 {
        let own = Vec3::from(self.luminance) * LUX;
        self.emission.as_ref().map_or(own, |emission| own * emission.at(uv))
    }

    /// The point of its surface for a point of the unit square; evenly over the surface.
    pub(crate) fn point(&self, at: DVec2, scene: &Bounds) -> LightPoint {
        let (left, up) = (self.left(), self.up_world);
        let flat = |x: f64, y: f64, uv| (self.position_world + left * x + up * y, self.direction_world, uv);
        let round = || {
            let (sin, cos) = (TAU * (at.x - 0.5)).sin_cos();
            let height = 1.0 - 2.0 * at.y;
            let level = (1.0 - height * height).max(0.0).sqrt();
            let out = DVec3::new(sin * level, height, -cos * level);
            (out, DVec2::new(at.x, height.clamp(-1.0, 1.0).acos() / PI))
        };
        let (mut start_m, mut spread) = (0.0, 1.0);
        let (position_world, normal_world, uv) = match self.shape {
            AreaShape::Rectangle { width_m, height_m } => flat((0.5 - at.x) * width_m, (0.5 - at.y) * height_m, at),
            AreaShape::Disc { radius_m } => {
                let (sin, cos) = (TAU * at.x).sin_cos();
                let (x, y) = (cos * at.y.sqrt(), sin * at.y.sqrt());
                flat(x * radius_m, y * radius_m, DVec2::new(0.5 - 0.5 * x, 0.5 - 0.5 * y))
            }
            AreaShape::Sphere { radius_m } => {
                let (out, uv) = round();
                (self.position_world + out * radius_m, out, uv)
            }
            AreaShape::Environment => {
                let (out, uv) = round();
                let radius = 0.5 * scene.diagonal();
                start_m = (FAR - 1.0) * radius;
                // A little more than the scene's sphere.
                spread = (0.5 * (1.05 / FAR).asin()).tan();
                (scene.center() + out * (FAR * radius), -out, uv)
            }
        };
        let area_m2 = self.area_m2(scene);
        LightPoint { position_world, normal_world, radiance: self.radiance(uv), area_m2, start_m, spread }
    }

    /// What the light shows along a ray: how far away, and its radiance.
    pub(crate) fn seen(&self, origin: DVec3, direction: DVec3) -> Option<(f64, Vec3)> {
        let from = origin - self.position_world;
        let plane = || {
            let t = -from.dot(self.direction_world) / direction.dot(self.direction_world);
            let is_front = t > 0.0 && direction.dot(self.direction_world) < 0.0;
            let at = from + direction * t;
            is_front.then(|| (t, DVec2::new(at.dot(self.left()), at.dot(self.up_world))))
        };
        let angles = |out: DVec3| {
            let u = out.x.atan2(-out.z) / TAU + 0.5;
            DVec2::new(u, out.y.clamp(-1.0, 1.0).acos() / PI)
        };
        match self.shape {
            AreaShape::Rectangle { width_m, height_m } => {
                let (t, at) = plane()?;
                let uv = DVec2::new(0.5 - at.x / width_m, 0.5 - at.y / height_m);
                let inside = uv.min_element() >= 0.0 && uv.max_element() <= 1.0;
                inside.then(|| (t, self.radiance(uv)))
            }
            AreaShape::Disc { radius_m } => {
                let (t, at) = plane()?;
                let uv = DVec2::splat(0.5) - at / (2.0 * radius_m);
                (at.length() <= radius_m).then(|| (t, self.radiance(uv)))
            }
            AreaShape::Sphere { radius_m } => {
                let b = from.dot(direction);
                let root = (b * b - from.length_squared() + radius_m * radius_m).sqrt();
                let t = -b - root;
                (t > 0.0).then(|| (t, self.radiance(angles((from + direction * t) / radius_m))))
            }
            AreaShape::Environment => Some((f64::INFINITY, self.radiance(angles(direction)))),
        }
    }

    /// What it emits in all, up to a factor.
    fn power(&self, scene: &Bounds) -> f64 {
        let mean = self.emission.as_ref().map_or(Vec3::ONE, |emission| emission.mean());
        f64::from(luminance(Vec3::from(self.luminance) * mean)) * self.area_m2(scene)
    }
}

/// Point `index` of the sequence of Halton (1960) in bases 2 and 3: any run of points from the first on is spread evenly.
fn halton(index: u32) -> DVec2 {
    let radical = |base: u32| {
        let (mut n, mut share, mut sum) = (index + 1, 1.0, 0.0);
        while n > 0 {
            share /= f64::from(base);
            sum += share * f64::from(n % base);
            n /= base;
        }
        sum
    };
    DVec2::new(radical(2), radical(3))
}

/// Virtual point lights of some lights, shared out by power; relative to an eye.
pub(crate) fn sampled(lights: &[AreaLight], vpls: u32, scene: &Bounds, eye: DVec3) -> Vec<Vpl> {
    let mut powers: Vec<f64> = lights.iter().map(|light| light.power(scene)).collect();
    if powers.iter().all(|power| *power == 0.0) {
        powers.fill(1.0);
    }
    let all: f64 = powers.iter().sum();
    let mut out = Vec::with_capacity(vpls as usize);
    let mut before = 0.0;
    for (light, power) in lights.iter().zip(powers) {
        let share = |sum: f64| (f64::from(vpls) * sum / all).round() as u32;
        let count = share(before + power) - share(before);
        before += power;
        out.extend((0..count).map(|i| Vpl::new(&light.point(halton(i), scene), count, eye)));
    }
    out
}

impl Vpl {
    /// One of so many points of a light.
    pub(crate) fn new(point: &LightPoint, count: u32, eye: DVec3) -> Self {
        let area_m2 = point.area_m2 / f64::from(count);
        Self {
            position: (point.position_world - eye).as_vec3(),
            normal: point.normal_world.as_vec3(),
            intensity: point.radiance * area_m2 as f32,
            radius_m: if point.start_m > 0.0 { 0.0 } else { (area_m2 / PI).sqrt() as f32 },
            start_m: point.start_m as f32,
            spread: point.spread as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: Bounds = Bounds { min: DVec3::splat(-5.0), max: DVec3::splat(5.0) };

    /// Irradiance of a surface by 1024 VPLs, nothing in the way.
    fn irradiance(light: &AreaLight, at: DVec3, normal: DVec3) -> f64 {
        let lit = |vpl: &Vpl| {
            let towards = vpl.position.as_dvec3();
            let r = towards.length();
            let cos = (towards.dot(normal) / r).max(0.0) * (-towards.dot(vpl.normal.as_dvec3()) / r).max(0.0);
            f64::from(vpl.intensity.x) * cos / (r * r)
        };
        sampled(std::slice::from_ref(light), 1024, &SCENE, at).iter().map(lit).sum::<f64>() / f64::from(LUX)
    }

    /// A polygon's irradiance by Lambert's formula, for a point and a normal that see all of it.
    fn polygon(corners: &[DVec3], normal: DVec3) -> f64 {
        let edge = |(a, b): (&DVec3, &DVec3)| {
            let (a, b) = (a.normalize(), b.normalize());
            a.dot(b).acos() * a.cross(b).normalize().dot(normal)
        };
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(edge).sum::<f64>().abs()
    }

    #[test]
    fn rectangles_discs_spheres_and_skies_light_by_their_closed_forms() {
        let light = |shape| AreaLight::towards(shape, DVec3::ZERO, DVec3::NEG_Z, [1.0; 3]).expect("a light");
        let (width_m, height_m) = (2.0, 1.0);
        let rectangle = light(AreaShape::Rectangle { width_m, height_m });
        for at in [DVec3::new(0.3, 0.2, -2.0), DVec3::new(2.0, -1.0, -3.0), DVec3::new(0.0, 0.0, -1.0)] {
            let corners = [(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5)].map(|(x, y)| DVec3::new(x, y, 0.0) - at);
            let (ours, exact) = (irradiance(&rectangle, at, DVec3::Z), polygon(&corners, DVec3::Z));
            assert!((ours / exact - 1.0).abs() < 0.01, "rectangle at {at}: {ours} {exact}");
        }
        // On the axis of a disc: pi r^2 / (r^2 + d^2). Outside a sphere: pi (r / d)^2.
        let disc = irradiance(&light(AreaShape::Disc { radius_m: 1.5 }), DVec3::NEG_Z * 2.0, DVec3::Z);
        assert!((disc / (PI * 2.25 / 6.25) - 1.0).abs() < 0.01, "disc {disc}");
        let sphere = irradiance(&light(AreaShape::Sphere { radius_m: 1.0 }), DVec3::NEG_Z * 3.0, DVec3::Z);
        assert!((sphere / (PI / 9.0) - 1.0).abs() < 0.01, "sphere {sphere}");
        let sky = irradiance(&light(AreaShape::Environment), DVec3::ZERO, DVec3::Y);
        assert!((sky / PI - 1.0).abs() < 0.01, "environment {sky}");
    }

    #[test]
    fn what_is_seen_is_what_shines() {
        let shapes = [
            AreaShape::Rectangle { width_m: 2.0, height_m: 1.0 },
            AreaShape::Disc { radius_m: 1.5 },
            AreaShape::Sphere { radius_m: 1.0 },
            AreaShape::Environment,
        ];
        let rgba: Vec<u8> = (0..64 * 64).flat_map(|i| [4 * (i % 64) as u8, 4 * (i / 64) as u8, 99, 255]).collect();
        let image = antumbra_scene::Image { name: String::new(), width: 64, height: 64, rgba };
        for shape in shapes {
            let mut light =
                AreaLight::towards(shape, DVec3::ONE, DVec3::new(0.0, 0.5, 3.0), [1.0; 3]).expect("a light");
            light.emission = Emission::of_image(&image).map(Arc::new);
            for i in 0..200 {
                let point = light.point(halton(i), &SCENE);
                // From in front of the point, at the point.
                let origin = point.position_world + point.normal_world * 0.7 + light.up_world * 0.1;
                let Some((t, radiance)) = light.seen(origin, (point.position_world - origin).normalize()) else {
                    panic!("{shape:?} is not seen at {i}");
                };
                let at_infinity = shape == AreaShape::Environment;
                let near = (t - (point.position_world - origin).length()).abs() < 1e-9;
                // Where longitudes meet, and at an infinite distance, pictures are not the same to the texel.
                let alike = (radiance - point.radiance).length() < LUX * if at_infinity { 1.0 } else { 1e-4 };
                assert!((near || at_infinity) && alike, "{shape:?} {i}: {t} {radiance} {}", point.radiance);
            }
        }
    }
}
