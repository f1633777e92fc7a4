//! The lookups in WGSL give what the CPU's give: bit for bit from whole voxel coordinates on, and to a voxel's rounding from
//! positions.

use std::sync::LazyLock;

use antumbra::shaders::Lookup;
use antumbra::{Encoding, FacePoint, Filter, Kernel, LightShadow, Prefilter, ShadowFile};
use antumbra_testbed::query::{Answer, Card, Op, Query};
use antumbra_testbed::{Random, baked, first_lights, gpu, procedural, voxel};
use glam::{DVec3, IVec3, UVec3};

/// A village with a sun, a few spot lights and point lights, and a city whose pool is large, in both encodings.
static FILES: LazyLock<Vec<ShadowFile>> = LazyLock::new(|| {
    let village = procedural("village", 0.4);
    let city = procedural("city", 0.2);
    let files = [Encoding::Dag8, Encoding::Silhouette].map(|encoding| {
        [
            baked(&village, &first_lights(&village, [1, 0, 0]), 4096, encoding),
            baked(&village, &first_lights(&village, [0, 2, 2]), 1024, encoding),
            baked(&city, &first_lights(&city, [1, 0, 0]), 16384, encoding),
        ]
    });
    files.into_iter().flatten().collect()
});

/// Calls `each` for every light and face of every file, with what a card makes of it.
fn for_each_face(lookup: Lookup, mut each: impl FnMut(&Card<'_>, LightShadow<'_>, usize, &mut Random)) {
    let gpu = gpu();
    let mut random = Random(1);
    for file in &*FILES {
        let card = Card::new(&gpu, file, lookup, DVec3::ZERO);
        for light in file.lights() {
            for face in 0..light.faces() {
                each(&card, light, face, &mut random);
            }
        }
    }
}

const POINTS: usize = 4000;

#[test]
fn points_are_the_same_bit_for_bit() {
    for top_grid in [true, false] {
        let (mut lit, mut all) = (0, 0);
        for_each_face(Lookup { top_grid, ..Lookup::default() }, |card, light, face, random| {
            let voxels: Vec<_> = (0..POINTS).map(|_| voxel(random, light, face)).collect();
            let ask = |v: &UVec3| Query { voxel: v.as_ivec3(), ..card.query(Op::IsLit, light, face) };
            for (v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
                assert_eq!(answer.words[0] == 1, light.is_lit(face, v.to_array()), "{v} of {}", light.name());
                lit += answer.words[0];
                all += 1;
            }
        });
        assert!(all >= 120_000 && lit > all / 8 && lit < all - all / 8, "{lit} of {all} lit: too easy");
    }
}

fn filters() -> impl Iterator<Item = Filter> {
    let of = |kernel| (0..9).map(move |radius| Filter::new(2 * radius + 1, kernel).expect("an odd number"));
    of(Kernel::Box).chain(of(Kernel::Tent))
}

#[test]
fn filters_are_the_same_bit_for_bit() {
    for top_grid in [true, false] {
        for_each_face(Lookup { top_grid, ..Lookup::default() }, |card, light, face, random| {
            for filter in filters() {
                let voxels: Vec<_> = (0..POINTS / 8).map(|_| near_or_outside(random, light, face)).collect();
                let ask = |v: &IVec3| Query {
                    voxel: *v,
                    arguments: [filter.radius(), u32::from(filter.kernel() == Kernel::Tent), 0, 0],
                    ..card.query(Op::Weights, light, face)
                };
                for (v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
                    let [lit, inside, all, ..] = answer.words;
                    let share = (lit + all - inside) as f32 / all as f32;
                    let at = FacePoint { face, voxel: v.as_dvec3() + 0.5 };
                    assert_eq!(share, light.voxel_filtered(at, filter), "{v} {filter:?} of {}", light.name());
                }
            }
        });
    }
}

/// A voxel, now and then one beside the grid, before it or behind it.
fn near_or_outside(random: &mut Random, light: LightShadow<'_>, face: usize) -> IVec3 {
    let side = light.record().resolution() as i32;
    let inside = voxel(random, light, face).as_ivec3();
    match random.below(12) {
        0 => IVec3::new(random.below(20) as i32 - 10, inside.y, inside.z),
        1 => IVec3::new(inside.x, side - 10 + random.below(20) as i32, inside.z),
        2 => inside.with_z(-1),
        3 => inside.with_z(side + random.below(100) as i32),
        4 => IVec3::new(-1_000_000_000, inside.y, 1_000_000_000),
        _ => inside,
    }
}

#[test]
fn means_are_the_same_bit_for_bit() {
    for_each_face(Lookup::default(), |card, light, face, random| {
        for level in 0..=light.record().log2_resolution {
            let voxels: Vec<_> = (0..POINTS / 8).map(|_| voxel(random, light, face)).collect();
            let ask = |v: &UVec3| Query {
                voxel: v.as_ivec3(),
                arguments: [level, 0, 0, 0],
                ..card.query(Op::Mean, light, face)
            };
            for (v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
                let mean = f32::from_bits(answer.words[0]);
                assert_eq!(mean, light.voxel_mean(face, v.to_array(), level), "{v} level {level}");
            }
        }
    });
}

#[test]
fn coarse_levels_are_the_same_bit_for_bit() {
    for_each_face(Lookup::default(), |card, light, face, random| {
        assert!(light.has_levels());
        for level in 1..=light.record().log2_resolution - 6 {
            let voxels: Vec<_> = (0..POINTS / 8).map(|_| voxel(random, light, face) >> level).collect();
            let ask = |v: &UVec3| Query { voxel: v.as_ivec3(), level, ..card.query(Op::IsLit, light, face) };
            for (v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
                assert_eq!(answer.words[0] == 1, light.is_lit_on_level(level, face, v.to_array()), "{v} {level}");
            }
        }
    });
}

#[test]
fn enter_windows_are_the_same_bit_for_bit() {
    let (mut found, mut all) = (0, 0);
    for_each_face(Lookup::default(), |card, light, face, random| {
        let side = light.record().resolution();
        let windows: Vec<_> = (0..POINTS)
            .map(|_| {
                let v = voxel(random, light, face);
                let log2 = random.below(light.record().log2_resolution);
                let radius = random.below(1 << log2);
                let first = [v.x.saturating_sub(radius), v.y.saturating_sub(radius)];
                (first, [(v.x + radius).min(side - 1), (v.y + radius).min(side - 1)], v.z)
            })
            .collect();
        let ask = |&([x0, y0], [x1, y1], z): &([u32; 2], [u32; 2], u32)| Query {
            voxel: IVec3::new(0, 0, z as i32),
            arguments: [x0, y0, x1, y1],
            ..card.query(Op::EnterWindow, light, face)
        };
        for (&(first, last, z), answer) in windows.iter().zip(card.ask(windows.iter().map(ask))) {
            let [least, greatest] = light.enter_window(face, first, last, z).map_or([0xffff; 2], |w| w.map(u32::from));
            assert_eq!(answer.words[..2], [least, greatest], "{first:?} {last:?} {z}");
            found += u32::from(least != 0xffff);
            all += 1;
        }
    });
    assert!(found > all / 8 && found < all, "{found} of {all}");
}

#[test]
fn boxes_of_a_walk_hold_what_the_lookups_say() {
    for_each_face(Lookup::default(), |card, light, face, random| {
        let voxels: Vec<_> = (0..POINTS).map(|_| voxel(random, light, face)).collect();
        let ask = |v: &UVec3| Query { voxel: v.as_ivec3(), ..card.query(Op::Cell, light, face) };
        for (&v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
            let first = UVec3::from_slice(&answer.words[0..3]);
            let end = UVec3::from_slice(&answer.words[4..7]);
            assert!(first.cmple(v).all() && end.cmpgt(v).all() && end.max_element() <= light.record().resolution());
            let is_lit = answer.words[3] == 1;
            for _ in 0..4 {
                let inside = first + UVec3::from_array((end - first).to_array().map(|size| random.below(size)));
                assert_eq!(light.is_lit(face, inside.to_array()), is_lit, "{inside} in {first} to {end}");
            }
        }
    });
}

#[test]
fn pools_in_pages_are_the_same() {
    let gpu = gpu();
    let city = procedural("city", 0.2);
    // Software drivers take minutes for a shader of silhouettes on many pages, which pools of half a gigabyte would need.
    for (encoding, pages) in [(Encoding::Dag8, 2), (Encoding::Dag8, 5), (Encoding::Silhouette, 2)] {
        let file = baked(&city, &first_lights(&city, [1, 0, 0]), 8192, encoding);
        let bytes = 4 * file.pool().len() as u64;
        let light = file.lights().next().expect("a sun");
        let mut random = Random(7);
        let voxels: Vec<_> = (0..20_000).map(|_| voxel(&mut random, light, 0)).collect();
        let card = Card::paged(&gpu, &file, Lookup::default(), DVec3::ZERO, bytes / pages + 4);
        assert!(card.pages() >= pages as usize);
        let ask = |v: &UVec3| Query { voxel: v.as_ivec3(), ..card.query(Op::IsLit, light, 0) };
        for (v, answer) in voxels.iter().zip(card.ask(voxels.iter().map(ask))) {
            assert_eq!(answer.words[0] == 1, light.is_lit(0, v.to_array()));
        }
    }
}

/// A point within a light's reach, most often near a shadow's border, and a unit normal.
fn place(random: &mut Random, light: LightShadow<'_>) -> (DVec3, DVec3) {
    let face = random.below(light.faces() as u32) as usize;
    let within = DVec3::new(random.unit(), random.unit(), random.unit());
    let v = voxel(random, light, face).as_dvec3() + within;
    let normal = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5).normalize();
    (light.unproject(FacePoint { face, voxel: v }).expect("a place"), normal)
}

/// Calls `each` with every light of every file and points about it, which the card gets relative to a camera.
fn for_each_place(mut each: impl FnMut(&Card<'_>, LightShadow<'_>, &[(DVec3, DVec3)])) {
    let gpu = gpu();
    let mut random = Random(3);
    for file in &*FILES {
        for light in file.lights() {
            let places: Vec<_> = (0..POINTS).map(|_| place(&mut random, light)).collect();
            let card = Card::new(&gpu, file, Lookup::default(), places[0].0 + DVec3::Y);
            each(&card, light, &places);
        }
    }
}

/// The projected voxel of an answer, with its fraction.
fn voxel_of(answer: &Answer) -> (usize, IVec3, DVec3) {
    let words = answer.words;
    let whole = IVec3::new(words[1] as i32, words[2] as i32, words[3] as i32);
    let fraction = DVec3::from_array([4, 5, 6].map(|i| f64::from(f32::from_bits(words[i]))));
    (words[0] as usize, whole, fraction)
}

#[test]
fn projections_differ_by_rounding_alone() {
    for_each_place(|card, light, places| {
        let ask = |&(p, _): &(DVec3, DVec3)| card.at(Op::Project, light, p, DVec3::ZERO);
        let mut elsewhere = 0;
        for (&(p, _), answer) in places.iter().zip(card.ask(places.iter().map(ask))) {
            let (face, whole, fraction) = voxel_of(&answer);
            let exact = light.project(p);
            if face != exact.face {
                elsewhere += 1;
                continue;
            }
            let off = (whole.as_dvec3() + fraction - exact.voxel).abs();
            assert!(off.max_element() < 0.25, "{} voxels off at {} of {}", off, exact.voxel, light.name());
        }
        assert!(elsewhere <= places.len() / 500, "{elsewhere} points on another face");
    });
}

#[test]
fn lookups_by_position_answer_for_the_voxel_they_find() {
    let filters = [Filter::new_box(1), Filter::new_box(9), Filter::new_tent(17)].map(|f| f.expect("a filter"));
    for_each_place(|card, light, places| {
        for filter in filters {
            let tent = u32::from(filter.kernel() == Kernel::Tent);
            let ask = |op| {
                let arguments = [filter.radius(), tent, 0, 0];
                let of = |&(p, n): &(DVec3, DVec3)| Query { arguments, ..card.at(op, light, p, n) };
                card.ask(places.iter().map(of).collect::<Vec<_>>())
            };
            let mut agree = 0;
            for ((&(p, n), found), answer) in places.iter().zip(ask(Op::ProjectBiased)).zip(ask(Op::Filtered)) {
                let visible = f32::from_bits(answer.words[0]);
                let (face, whole, _) = voxel_of(&found);
                let there = light.voxel_filtered(FacePoint { face, voxel: whole.as_dvec3() + 0.5 }, filter);
                if !light.is_outside_cone(p) {
                    assert!((visible - there).abs() < 1e-6, "{visible} {there} {filter:?}");
                }
                agree += usize::from((visible - light.filtered(p, Some(n), filter)).abs() < 1e-6);
            }
            assert!(agree > places.len() * 95 / 100, "{agree} of {} {filter:?} of {}", places.len(), light.name());
        }
    });
}

/// Between the middles of texels both compute with fractions: they may differ where a place lies on an edge or a plane but for rounding.
#[test]
fn continuous_lookups_agree() {
    const CONTINUOUS: u32 = 3;
    for_each_place(|card, light, places| {
        let ask = |op| {
            let arguments = [0, CONTINUOUS, 0, 0];
            let of = |&(p, n): &(DVec3, DVec3)| Query { arguments, ..card.at(op, light, p, n) };
            card.ask(places.iter().map(of).collect::<Vec<_>>())
        };
        let (mut agree, mut inside, mut between) = (0, 0, 0);
        for ((&(p, _), found), answer) in places.iter().zip(ask(Op::ProjectBiased)).zip(ask(Op::Filtered)) {
            if light.is_outside_cone(p) {
                continue;
            }
            let (face, whole, fraction) = voxel_of(&found);
            let at = FacePoint { face, voxel: whole.as_dvec3() + fraction };
            let there = light.voxel_filtered(at, Filter::continuous());
            agree += usize::from(f32::from_bits(answer.words[0]) == there);
            between += usize::from(there != light.voxel_visibility(at));
            inside += 1;
        }
        assert!(agree * 500 >= inside * 499, "{agree} of {inside} of {}", light.name());
        println!("{}: {between} of {inside} are not their voxels' answers", light.name());
    });
}

#[test]
fn prefiltered_lookups_agree() {
    let tent = Filter::new_tent(5).expect("a filter");
    for_each_place(|card, light, places| {
        for (op, how, rounding) in
            [(Op::Prefiltered, Prefilter::Mean, 0.0), (Op::Levels, Prefilter::Levels(tent), 2e-5)]
        {
            let texel_m = light.frame(places[0].0).texel_m;
            for texels in [0.6, 3.3, 11.0, 50.0, 1000.0] {
                let arguments = [tent.radius(), 1, (texels * texel_m as f32).to_bits(), 0];
                let of = |&(p, n): &(DVec3, DVec3)| Query { arguments, ..card.at(op, light, p, n) };
                let mut agree = 0;
                for (&(p, n), answer) in places.iter().zip(card.ask(places.iter().map(of))) {
                    let visible = f32::from_bits(answer.words[0]);
                    let exact = light.prefiltered(p, Some(n), f64::from(f32::from_bits(arguments[2])), how);
                    agree += usize::from((visible - exact).abs() <= rounding);
                }
                assert!(agree > places.len() * 97 / 100, "{agree} of {} {how:?} {texels}", places.len());
            }
        }
    });
}

#[test]
fn blockers_agree() {
    for_each_place(|card, light, places| {
        let radius_m = 5.0 * light.frame(places[0].0).texel_m;
        let arguments = [0, 0, (radius_m as f32).to_bits(), 0];
        let of = |&(p, _): &(DVec3, DVec3)| Query { arguments, ..card.at(Op::Blocker, light, p, DVec3::ZERO) };
        let (mut agree, mut found) = (0, 0);
        for (&(p, _), answer) in places.iter().zip(card.ask(places.iter().map(of))) {
            let [least, greatest] = [0, 1].map(|i| f64::from(f32::from_bits(answer.words[i])));
            let exact = light.blocker(p, f64::from(f32::from_bits(arguments[2])));
            found += usize::from(exact.is_some());
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-3 * b.abs() + 2.0 * light.frame(p).slice_m;
            agree += usize::from(match exact {
                None => least < 0.0,
                Some(b) => close(least, b.least_m) && close(greatest, b.greatest_m),
            });
        }
        assert!(agree > places.len() * 97 / 100, "{agree} of {} of {}", places.len(), light.name());
        assert!(found > places.len() / 4);
    });
}

#[test]
fn lit_shares_of_segments_agree() {
    let mut worst: f64 = 0.0;
    for_each_place(|card, light, places| {
        let ends: Vec<_> = places.windows(2).map(|w| (w[0].0, w[1].0)).take(1000).collect();
        let of = |&(from, to): &(DVec3, DVec3)| card.at(Op::LitShare, light, from, to - from);
        let mut off = 0;
        for (&(from, to), answer) in ends.iter().zip(card.ask(ends.iter().map(of))) {
            let share = f64::from(f32::from_bits(answer.words[0]));
            // From the same rounded points.
            let exact = light.lit_share(card.rounded(from), card.rounded(from) + card.direction(to - from));
            worst = worst.max((share - exact).abs());
            off += usize::from((share - exact).abs() > 2e-3);
        }
        assert!(off <= ends.len() / 100, "{off} of {} of {}", ends.len(), light.name());
    });
    assert!(worst < 0.05, "{worst}");
}
