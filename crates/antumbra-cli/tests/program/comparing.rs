//! compare: it passes what is right, fails what is wrong, and says the same every time.

use std::fs;
use std::path::Path;

use antumbra::format::write::{Contents, write};
use antumbra::{Interior, LightRecord, ShadowFile};
use serde_json::Value;

use crate::folder::{arguments, edit_glb, folder, run};
use crate::stage::{LIGHTS, Stage};

#[test]
fn a_bake_agrees_with_its_scene() {
    let folder = folder();
    let line = "compare {baked} {city} --samples 20000 --json --threads";
    let [one, two] = [1, 2].map(|threads| run(folder.path(), &format!("{line} {threads}")).json());
    assert_eq!(one, two);
    assert_eq!((&one["ok"], &one["too_far"], &one["samples"]), (&true.into(), &0.into(), &60_000.into()));
    let light = &one["lights"][0];
    assert_eq!(light["name"], "sun");
    for kind in ["air", "surfaces", "off_surfaces"] {
        let tally = &light[kind];
        let counts = ["agreeing", "undefined", "disagreeing"].map(|key| tally[key].as_u64().expect(key));
        assert_eq!(counts.iter().sum::<u64>(), 20_000);
        assert!(counts[0] > 15_000, "{tally}");
        let shares = ["robust_share", "near_edge_share", "inside_share"].map(|key| tally[key].as_f64().expect(key));
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{tally}");
        assert!((0.05..0.95).contains(&tally["lit_share"].as_f64().expect("lit")), "{tally}");
    }
    let text = run(folder.path(), "compare {baked} {city} --samples 1000 --seed 7").ok();
    assert!(text.contains("in the air") && text.contains("\nok: "), "{text}");
}

/// A bake that lies a few texels aside is found out in the air and off surfaces.
#[test]
fn a_bake_that_is_a_few_texels_aside_is_found_out() {
    let folder = folder();
    let glb = fs::read(&arguments(folder.path(), "{city}")[0]).expect("the city");
    let texel = run(folder.path(), "info {baked} --json").json()["lights"][0]["texel_size_m"].as_f64().expect("a size");
    for (texels, ok) in [(0.25, true), (6.0, false)] {
        let moved = edit_glb(&glb, |root| {
            for node in root["nodes"].as_array_mut().expect("nodes") {
                let [x, y, z] = [0, 1, 2].map(|i| node["translation"][i].as_f64().unwrap_or(0.0));
                node["translation"] = serde_json::json!([x + texels * texel, y, z]);
            }
        });
        fs::write(folder.path().join("m.glb"), moved).expect("a file");
        let done = run(folder.path(), "compare {baked} {m.glb} --samples 20000 --json");
        assert_eq!(done.code, i32::from(!ok), "{}", done.stderr);
        let told: serde_json::Value = serde_json::from_str(&done.stdout).expect("JSON alone on stdout");
        for kind in ["air", "off_surfaces"] {
            assert_eq!(told["lights"][0][kind]["too_far"] == 0, ok, "{kind}");
        }
    }
}

#[test]
fn every_policy_agrees() {
    let folder = folder();
    for interior in ["open", "closed"] {
        run(folder.path(), &format!("bake {{city}} -o {{b}} --resolution 512 --interior {interior}")).ok();
        let told = run(folder.path(), "compare {b} {city} --samples 5000 --json").json();
        assert_eq!(told["ok"], true);
        assert!(interior != "open" || told["undefined"] == 0);
    }
}

#[test]
fn a_bake_of_something_else_is_found_out() {
    let folder = folder();
    run(folder.path(), "scene city --seed 2 --scale 0.15 -o {other.glb}").ok();
    let done = run(folder.path(), "compare {baked} {other.glb} --samples 2000");
    assert_eq!(done.code, 1);
    assert!(done.stderr.starts_with("error: ") && done.stderr.contains("farther than one texel"), "{}", done.stderr);
    assert!(done.stdout.contains("not ok: ") && done.stdout.contains("from an edge"), "{}", done.stdout);
}

const KINDS: [&str; 3] = ["air", "surfaces", "off_surfaces"];

/// Every kind of light under every policy, with masked casters.
#[test]
fn every_kind_of_light_agrees_under_every_policy() {
    let folder = folder();
    fs::write(folder.path().join("stage.glb"), Stage::default().glb()).expect("a file");
    for interior in ["open", "closed", "auto", "thickness=0.3", "static=0.1"] {
        bake_stage(folder.path(), interior);
        let told = run(folder.path(), "compare {b} {stage.glb} --samples 4000 --json").json();
        assert_eq!(told["ok"], true, "{interior}: {told}");
        for (light, name) in told["lights"].as_array().expect("lights").iter().zip(LIGHTS) {
            let word = interior.split('=').next();
            assert_eq!((light["name"].as_str(), light["interior"].as_str()), (Some(name), word));
            for kind in KINDS {
                let tally = &light[kind];
                assert_eq!((&tally["samples"], &tally["too_far"]), (&4000.into(), &0.into()));
                assert!((0.05..0.95).contains(&tally["lit_share"].as_f64().expect("lit")), "{name}, {kind}: {tally}");
                let is_defined = tally["behind_share"] == 0.0;
                assert!(is_defined != interior.contains('=') || kind != "air", "{name}, {interior}: {tally}");
                assert!(tally["free"].as_u64() >= tally["undefined"].as_u64());
                assert!((tally["free"] != 0) || kind != "air" || interior == "open", "{name}, {interior}: {tally}");
            }
        }
    }
}

/// A bake whose lights stand, or whose grids lie, a little aside; a texel is 3 to 9 centimetres.
#[test]
fn a_light_that_is_not_where_it_was_baked_is_found_out() {
    for interior in ["auto", "thickness=0.1", "static=0.05"] {
        assert_every_light_is_wrong(
            interior,
            &edit_stage(interior, |record| {
                record.origin_world[0] += 0.3;
            }),
        );
    }
    // A turned grid.
    assert_every_light_is_wrong("open", &edit_stage("open", |record| record.linear.swap(0, 1)));
}

/// A bake that says that it promises more than it does.
#[test]
fn a_bake_of_another_policy_is_found_out() {
    let says = |interior| {
        move |record: &mut LightRecord| (record.interior, record.interior_parameter_m) = Interior::to_record(interior)
    };
    let wrong = [
        ("auto", Interior::Open),
        ("thickness=1", Interior::Open),
        ("thickness=1", Interior::Thickness(0.2)),
        ("static=0.1", Interior::Open),
        ("static=0.1", Interior::Thickness(0.1)),
    ];
    for (baked, said) in wrong {
        assert_every_light_is_wrong(baked, &edit_stage(baked, says(said)));
    }
    // Margins show where two surfaces lie as close, which not every light sees.
    let near = edit_stage("static=0.01", says(Interior::Static(0.6)));
    assert_eq!(compare_with_stage(&near, Stage::default())["ok"], false);
    // It may promise less.
    let right = edit_stage("open", says(Interior::Static(0.1)));
    assert_eq!(compare_with_stage(&right, Stage::default())["ok"], true);
}

#[test]
fn moved_casters_are_found_out() {
    for interior in ["open", "auto", "thickness=0.1", "static=0.05"] {
        let baked = edit_stage(interior, |_| {});
        let moved = compare_with_stage(&baked, Stage { moved_m: 0.3, ..Stage::default() });
        assert!(is_wrong(&moved).iter().all(|wrong| *wrong), "{interior}: {moved}");
        let holes = compare_with_stage(&baked, Stage { other_holes: true, ..Stage::default() });
        // The card stands beside the spot light's cone.
        assert!(is_wrong(&holes)[..2] == [true; 2], "{interior}: {holes}");
    }
}

/// Many lights get one table, and a line for each that is wrong.
#[test]
fn many_lights_are_summed_up() {
    let folder = folder();
    let many = |names: &[&str]| {
        edit_glb(&Stage::default().glb(), |root| {
            let nodes = root["nodes"].as_array_mut().expect("nodes");
            let lamp = nodes.iter().find(|node| node["name"] == "lamp").expect("the lamp").clone();
            for name in names {
                let mut another = lamp.clone();
                another["name"] = (*name).into();
                nodes.push(another);
            }
            root["scenes"][0]["nodes"] = (0..nodes.len()).collect();
        })
    };
    let names = ["l1", "l2", "l3", "l4", "l5"];
    fs::write(folder.path().join("stage.glb"), many(&names)).expect("a file");
    bake_stage(folder.path(), "auto");
    let text = run(folder.path(), "compare {b} {stage.glb} --samples 200").ok();
    assert!(text.starts_with("9 lights, in the air, on surfaces and moved off them\n"), "{text}");
    assert!(text.lines().count() < 16 && !text.contains("l3"), "{text}");
    let edited =
        edit(&folder.path().join("b"), |record, name| record.origin_world[0] += if name == "l3" { 0.5 } else { 0.0 });
    fs::write(folder.path().join("b"), edited).expect("a file");
    let done = run(folder.path(), "compare {b} {stage.glb} --samples 2000");
    let wrong: Vec<&str> = done.stdout.lines().filter(|line| line.starts_with("not ok: l")).collect();
    assert!(done.code == 1 && wrong.len() == 1 && wrong[0].starts_with("not ok: l3 (point): "), "{}", done.stdout);
}

fn bake_stage(folder: &Path, interior: &str) {
    run(folder, &format!("bake {{stage.glb}} -o {{b}} --resolution 256 --interior {interior}")).ok();
}

/// The stage's bake with its records changed.
fn edit_stage(interior: &str, change: impl Fn(&mut LightRecord)) -> Vec<u8> {
    let folder = folder();
    fs::write(folder.path().join("stage.glb"), Stage::default().glb()).expect("a file");
    bake_stage(folder.path(), interior);
    edit(&folder.path().join("b"), |record, _| change(record))
}

/// A bake with its records changed.
fn edit(baked: &Path, change: impl Fn(&mut LightRecord, &str)) -> Vec<u8> {
    let file = ShadowFile::from_bytes(&fs::read(baked).expect("a bake")).expect("a sound bake");
    let names: String = file.lights().map(|light| light.name()).collect();
    let mut records = Vec::new();
    let mut offset = 0;
    for light in file.lights() {
        let mut record = LightRecord { name_offset: offset, ..*light.record() };
        offset += record.name_length;
        change(&mut record, light.name());
        records.push(record);
    }
    write(&Contents::new(&records, &names, file.pool(), file.stats().expect("statistics")))
}

fn compare_with_stage(baked: &[u8], stage: Stage) -> Value {
    let folder = folder();
    fs::write(folder.path().join("stage.glb"), stage.glb()).expect("a file");
    fs::write(folder.path().join("b"), baked).expect("a file");
    let done = run(folder.path(), "compare {b} {stage.glb} --samples 4000 --json");
    let told: Value = serde_json::from_str(&done.stdout).expect("JSON alone on stdout");
    assert_eq!(done.code, i32::from(told["ok"] == false), "{}", done.stderr);
    told
}

/// For each light, whether it was found wrong.
fn is_wrong(told: &Value) -> Vec<bool> {
    let lights = told["lights"].as_array().expect("lights");
    lights.iter().map(|light| light["ok"] == false && KINDS.iter().any(|kind| light[kind]["too_far"] != 0)).collect()
}

#[track_caller]
fn assert_every_light_is_wrong(interior: &str, baked: &[u8]) {
    let told = compare_with_stage(baked, Stage::default());
    assert_eq!(is_wrong(&told), [true; LIGHTS.len()], "{interior}: {told}");
}
