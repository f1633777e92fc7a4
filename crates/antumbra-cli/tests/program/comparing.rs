//! compare: it passes what is right, fails what is wrong, and says the same every time.

use std::fs;

use crate::folder::{arguments, edit_glb, folder, run};

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
