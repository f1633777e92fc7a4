//! Light that surfaces send on, as many points of light: Keller 1997, *Instant radiosity*; the lights that Selgrad, Müller,
//! Reintges and Stamminger (2016) cull shadow maps for.
//!
//! Paths leave the lamps and area lights, as many from each as it gives light. Where a path meets a surface it leaves a virtual light, which
//! sends on what a Lambertian surface would, and goes on by Russian roulette with the surface's albedo for odds, so that each
//! path carries the same power until it ends. Directions come from a low-discrepancy sequence: the same lights every time. The sun's and
//! environments' light is not traced.

use antumbra_scene::{Light, LightKind, Scene};
use glam::{DVec3, Vec2, Vec3};

use super::{Lamp, luminance};
use crate::area::{AreaLight, AreaShape};
use crate::sampling::{cosine_direction, r2, unit};
use crate::surface::Surfaces;
use crate::trace::{Ray, Tracer};

/// How virtual lights are traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightTracing {
    /// About as many virtual lights as are wanted, 1 to 4096.
    pub lights: u32,
    /// Most surfaces that a path meets, 1 to 16: 1 for light that is reflected once.
    pub bounces: u32,
}

/// A point of a surface that sends on light, more the less it goes aside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirtualLight {
    /// Where it is, metres: a little off its surface.
    pub position_world: DVec3,
    /// The surface's unit normal, on the side that was lit.
    pub normal_world: DVec3,
    /// Linear RGB irradiance that it gives a surface 1 m away along its normal, in the unit of pictures.
    pub intensity: Vec3,
}

impl Default for LightTracing {
    fn default() -> Self {
        Self { lights: 192, bounces: 2 }
    }
}

/// Nearer than this share of the scene's diagonal a virtual light gets no brighter.
const CORE: f64 = 0.01;
/// By how much of the diagonal it lies off its surface.
const LIFT: f64 = 1e-5;
/// Most odds of a path to go on: it ends sooner or later, between white surfaces too.
const MOST_ODDS: f32 = 0.95;
/// Paths tried for each light that is wanted.
const TRIES: u32 = 64;

/// Where paths begin.
enum Emitter<'a> {
    Lamp(Lamp),
    Area(&'a AreaLight),
}

/// A path about to leave a light or a surface.
struct Path<'a> {
    ray: Ray,
    /// Linear RGB power that it carries, irradiance times square metres.
    power: Vec3,
    /// The lamp that it leaves, whose light fades towards its range.
    lamp: Option<&'a Lamp>,
}

impl VirtualLight {
    /// As lamps are known.
    pub(crate) fn lamp(&self, index: usize, diagonal_m: f64) -> Lamp {
        let name = format!("virtual light {index}");
        Lamp::of_surface(name, self.position_world, self.normal_world, self.intensity, CORE * diagonal_m)
    }
}

impl LightTracing {
    /// Virtual lights of a scene's lamps and of area lights; fewer, or none, where their light meets nothing. Paths are traced until there
    /// are enough, so a handful of lights is a little too bright on average.
    pub(crate) fn trace(
        &self,
        scene: &Scene,
        tracer: &Tracer,
        surfaces: &Surfaces<'_>,
        area: &[AreaLight],
    ) -> Vec<VirtualLight> {
        let diagonal_m = tracer.bounds().diagonal();
        let is_lamp = |light: &&Light| light.kind != LightKind::Directional;
        let lamps = scene.lights.iter().filter(is_lamp).filter_map(|light| Lamp::of_light(light, diagonal_m));
        let area = area.iter().filter(|light| light.shape != AreaShape::Environment).map(Emitter::Area);
        let emitters: Vec<Emitter<'_>> = lamps.map(Emitter::Lamp).chain(area).collect();
        let powers: Vec<f32> = emitters.iter().map(|emitter| luminance(emitter.power(tracer))).collect();
        let all: f32 = powers.iter().sum();
        if !(all > 0.0 && all.is_finite()) {
            return Vec::new();
        }
        let wanted = self.lights.clamp(1, 4096);
        let (mut found, mut paths) = (Vec::new(), 0);
        while (found.len() as u32) < wanted && paths < wanted * TRIES {
            let (emitter, share) = pick(&powers, all, halton(paths, 2));
            // All paths of the scene share out its power.
            if let Some(path) =
                emitters[emitter].path(tracer, [3, 5, 17, 19].map(|base| halton(paths, base)), 1.0 / share)
            {
                self.follow(tracer, surfaces, path, paths, &mut found);
            }
            paths += 1;
        }
        for light in &mut found {
            light.intensity /= paths as f32;
        }
        found
    }

    fn follow(
        &self,
        tracer: &Tracer,
        surfaces: &Surfaces<'_>,
        path: Path<'_>,
        index: u32,
        found: &mut Vec<VirtualLight>,
    ) {
        let lift_m = LIFT * tracer.bounds().diagonal();
        let Path { mut ray, mut power, lamp } = path;
        for bounce in 0..self.bounces.clamp(1, 16) {
            let Some(hit) = tracer.closest_if(&ray, |hit| surfaces.casts_shadow(tracer, hit)) else { return };
            if let Some(lamp) = lamp.filter(|_| bounce == 0) {
                power *= lamp.window(hit.t) as f32;
            }
            let surface = surfaces.at(tracer, &ray, &hit, 0.0);
            let normal = surface.face_normal.as_dvec3();
            let albedo = surface.albedo * (1.0 - surface.metallic);
            let position_world = surface.position + normal * lift_m;
            let sent = power * albedo;
            if luminance(sent) > 0.0 {
                // A Lambertian surface that sends a power all in all sends a share 1 / pi of it along its normal.
                let intensity = sent / std::f32::consts::PI;
                found.push(VirtualLight { position_world, normal_world: normal, intensity });
            }
            // Russian roulette: what survives carries on what the others would have.
            let odds = albedo.max_element().min(MOST_ODDS);
            let dice = match bounce {
                0 => [7, 11, 13].map(|base| halton(index, base) as f32),
                _ => [0, 1, 2].map(|i| unit(index, bounce, i)),
            };
            if dice[0] >= odds {
                return;
            }
            power = sent / odds;
            let direction = cosine_direction(surface.face_normal, Vec2::new(dice[1], dice[2]));
            ray = Ray::new(position_world, direction.as_dvec3());
        }
    }
}

impl Emitter<'_> {
    /// Linear RGB power, about.
    fn power(&self, tracer: &Tracer) -> Vec3 {
        match self {
            Self::Lamp(lamp) => (0..64).map(|i| lamp.emitted(r2(i).into()).1).sum::<Vec3>() / 64.0,
            Self::Area(light) => {
                let of_point = |i: u32| {
                    let point = light.point(r2(i), &tracer.bounds());
                    point.radiance * (std::f64::consts::PI * point.area_m2) as f32
                };
                (0..64).map(of_point).sum::<Vec3>() / 64.0
            }
        }
    }

    /// A path with all its power, times a weight.
    fn path(&self, tracer: &Tracer, [x, y, u, v]: [f64; 4], weight: f32) -> Option<Path<'_>> {
        match self {
            Self::Lamp(lamp) => {
                let (direction, per_power) = lamp.emitted([x, y]);
                let ray = Ray::new(lamp.position_world, direction).between(lamp.near_m, lamp.range_m);
                (luminance(per_power) > 0.0).then_some(Path { ray, power: per_power * weight, lamp: Some(lamp) })
            }
            Self::Area(light) => {
                let point = light.point(glam::DVec2::new(x, y), &tracer.bounds());
                let at = Vec2::new(u as f32, v as f32);
                let direction = cosine_direction(point.normal_world.as_vec3(), at).as_dvec3();
                let power = point.radiance * (std::f64::consts::PI * point.area_m2) as f32;
                Some(Path { ray: Ray::new(point.position_world, direction), power: power * weight, lamp: None })
            }
        }
    }
}

/// An emitter by a share of the power of all, and its own share.
fn pick(powers: &[f32], all: f32, at: f64) -> (usize, f32) {
    let mut left = at as f32 * all;
    for (i, power) in powers.iter().enumerate() {
        if left < *power {
            return (i, power / all);
        }
        left -= power;
    }
    let last = powers.iter().rposition(|power| *power > 0.0).unwrap_or(0);
    (last, powers[last] / all)
}

/// Halton's sequence: the digits of an index mirrored at the point.
fn halton(index: u32, base: u32) -> f64 {
    let (mut left, mut share, mut sum) = (u64::from(index) + 1, 1.0, 0.0);
    while left > 0 {
        share /= f64::from(base);
        sum += (left % u64::from(base)) as f64 * share;
        left /= u64::from(base);
    }
    sum
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{Material, Mesh, Node, Primitive};
    use glam::DAffine3;

    use super::*;
    use crate::light::LUX;

    /// A closed room of one colour, and a lamp in it.
    fn room(albedo: f32) -> Scene {
        let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -2.0f32 } else { 2.0 });
        let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let primitive = Primitive {
            positions: (0..8).map(corner).collect(),
            triangles: sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            material: Some(0),
            ..Primitive::default()
        };
        let node = Node { name: "room".into(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
        let lamp = Light {
            name: "lamp".into(),
            kind: LightKind::Point,
            position_world: DVec3::new(0.3, 0.2, -0.4),
            direction_world: DVec3::NEG_Y,
            color: [1.0; 3],
            intensity: 100.0,
            range_m: None,
            dynamic: false,
        };
        let base_color = [albedo, albedo, albedo, 1.0];
        Scene {
            meshes: vec![Mesh { name: "room".into(), primitives: vec![primitive] }],
            nodes: vec![node],
            materials: vec![Material { base_color, ..Material::default() }],
            lights: vec![lamp],
            ..Scene::default()
        }
    }

    /// Each reflection takes its share of the lamp's power, however the dice fall: a furnace.
    #[test]
    fn surfaces_send_on_what_they_receive() {
        for albedo in [0.3, 0.5, 1.0] {
            let scene = room(albedo);
            let tracer = Tracer::new(&scene, |_, _| true);
            let surfaces = Surfaces::new(&scene);
            let power = 4.0 * std::f32::consts::PI * 100.0 * LUX;
            let mut expected = 0.0;
            for bounces in 1..=4 {
                expected += power * albedo.powi(bounces as i32);
                let how = LightTracing { lights: 4096, bounces };
                let lights = how.trace(&scene, &tracer, &surfaces, &[]);
                let sent: f32 = lights.iter().map(|light| light.intensity.x * std::f32::consts::PI).sum();
                assert!((sent / expected - 1.0).abs() < 0.04, "{albedo}, {bounces}: {sent} of {expected}");
                assert!(lights.iter().all(|light| light.position_world.abs().max_element() < 2.0));
                assert!(lights.iter().all(|light| light.normal_world.dot(light.position_world) < 0.0));
                assert!(lights.len() >= 4096 && lights.len() < 4096 + bounces as usize);
            }
        }
    }

    #[test]
    fn without_light_there_are_none() {
        let mut scene = room(0.5);
        scene.lights.clear();
        let tracer = Tracer::new(&scene, |_, _| true);
        let trace = |scene: &Scene, tracer: &Tracer| {
            LightTracing::default().trace(scene, tracer, &Surfaces::new(scene), &[]).len()
        };
        assert_eq!(trace(&scene, &tracer), 0);
        // A lamp with nothing around it.
        let open = Scene { lights: room(0.5).lights, ..Scene::default() };
        assert_eq!(trace(&open, &Tracer::new(&open, |_, _| true)), 0);
    }
}
