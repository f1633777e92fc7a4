//! bench construction and bench lamps: what they print and write.

use std::fs;

use serde_json::Value;

use crate::folder::{Done, arguments, command, folder, run};

const KEYS: [&str; 17] = [
    "scene",
    "light",
    "method",
    "culling",
    "interior",
    "resolution",
    "threads",
    "seconds",
    "build_seconds",
    "stages",
    "read_seconds",
    "write_seconds",
    "wall_seconds",
    "cpu_seconds",
    "peak_bytes",
    "bytes",
    "file_bytes",
];

fn rows(table: &Value) -> &[Value] {
    table["rows"].as_array().expect("rows")
}

#[track_caller]
fn row<'a>(table: &'a Value, wanted: &[(&str, Value)]) -> &'a Value {
    let is_it = |row: &&Value| wanted.iter().all(|(key, value)| row[*key] == *value);
    rows(table).iter().find(is_it).unwrap_or_else(|| panic!("no {wanted:?} in {table:#}"))
}

#[test]
fn every_construction_has_its_row_and_its_files() {
    let folder = folder();
    let bench = "bench construction --scale 0.1 --smallest 256 --largest 512 --largest-baseline 256 --threads 1 \
                 --json --out {out}";
    let table = run(folder.path(), bench).json();
    assert_eq!(table["table"], "construction");
    for row in rows(&table) {
        assert!(KEYS.iter().all(|key| row.get(key).is_some()), "{row}");
    }
    // Two scenes, two policies: four methods at 256, columns at 512, and both with two threads, too.
    assert_eq!(rows(&table).len(), 2 * 2 * (4 + 1 + 2));
    let kampe = |culling: bool| row(&table, &[("method", "kampe2015".into()), ("culling", culling.into())]);
    assert_eq!(kampe(false)["bytes"], kampe(true)["bytes"]);
    assert!(row(&table, &[("method", "sintorn2014".into())])["culling"].is_null());
    let out = folder.path().join("out");
    let read = |name: &str| fs::read_to_string(out.join(name)).expect(name);
    assert_eq!(serde_json::from_str::<Value>(&read("construction.json")).expect("JSON"), table);
    let text = read("construction.md");
    for heading in ["Table 1", "Table 2", "Table 3", "Table 4", "The papers' methods", "Growth", "Threads"] {
        assert!(text.contains(&format!("\n## {heading}")), "no {heading} in:\n{text}");
    }
    for name in ["seconds", "memory", "bytes"] {
        let svg = read(&format!("construction-landscape-{name}.svg"));
        assert!(svg.starts_with("<svg") && svg.contains("columns") && !svg.contains("NaN"), "{name}");
    }
}

#[test]
fn a_row_is_what_a_bake_says() {
    let folder = folder();
    let bench = "bench construction {city} --largest 512 --methods columns,columns --interiors thickness=0.5,closed \
                 --threads-list 1 --threads 1 --repeat 2 --json --quiet";
    let table = run(folder.path(), bench).json();
    assert_eq!(rows(&table).len(), 2);
    let bake = "bake {city} -o {b} --light sun --resolution 512 --encoding dag8 --json --interior";
    for interior in ["thickness=0.5", "closed"] {
        let baked = run(folder.path(), &format!("{bake} {interior}")).json();
        let row = row(&table, &[("interior", interior.into())]);
        assert_eq!((&row["bytes"], &row["file_bytes"]), (&baked["lights"][0]["bytes"], &baked["file_bytes"]));
        assert_eq!((&row["scene"], &row["light"], &row["threads"]), (&"city".into(), &"sun".into(), &1.into()));
    }
}

#[test]
fn what_needs_too_much_memory_is_a_row() {
    let folder = folder();
    let bench =
        "bench construction {city} --smallest 256 --largest 512 --methods columns --interiors open --memory-limit";
    let table = run(folder.path(), &format!("{bench} 1M --json --threads-list 1 --threads 1")).json();
    assert_eq!(rows(&table).len(), 2);
    assert!(rows(&table)[0]["error"].as_str().is_some_and(|words| words.contains("--memory-limit")), "{table}");
    assert!(rows(&table)[1]["error"].as_str().is_some_and(|words| words.contains("at 256")), "{table}");
    let text = run(folder.path(), &format!("{bench} 1M")).ok();
    assert!(text.contains("| city | open | columns | out of memory | out of memory |"), "{text}");
}

#[test]
fn lamps_are_measured_one_by_one() {
    let folder = folder();
    let bench = "bench lamps --scale 0.1 --lamps 5 --resolution 128 --threads 2 --frames 2 --size 64x48 --out {out}";
    let text = run(folder.path(), bench).ok();
    assert!(text.contains("| lights | 5 | 165 |") && text.contains(" on 1 thread(s) |"), "{text}");
    let table: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/lamps.json")).expect("a file")).expect("JSON");
    // Five lamps, and two frames of the flight in four ways.
    assert_eq!((&table["table"], rows(&table).len()), (&"lamps".into(), 5 + 2 * 4));
    let (lamps, frames) = rows(&table).split_at(5);
    for row in frames {
        assert_eq!((&row["lights"], &row["width"], &row["height"]), (&5.into(), &64.into(), &48.into()));
        assert!(row["ms"]["shading"].is_number() && row["lights_per_pixel"].is_number(), "{row}");
    }
    assert!(text.contains("| 9 x 9 taps, tiled |"), "{text}");
    for row in lamps {
        assert_eq!((&row["kind"], &row["resolution"], &row["scene"]), (&"spot".into(), &128.into(), &"city".into()));
        assert!(row["build_seconds"].is_number() && row["light"].is_string());
        assert_eq!(row["shadow_map_bytes"], 2 * 128 * 128);
    }
    run(folder.path(), "scene city --scale 0.1 --lamps 5 -o {c.glb}").ok();
    let all = run(folder.path(), "bake {c.glb} -o {b} --resolution 128 --encoding dag8 --json").json();
    let bytes: u64 = lamps.iter().filter_map(|row| row["bytes"].as_u64()).sum();
    assert_eq!(table["summary"]["bytes"], bytes);
    // The sun of the same file shares nodes with the lamps.
    let with_sun: u64 = all["lights"].as_array().expect("lights").iter().filter_map(|l| l["bytes"].as_u64()).sum();
    assert!(bytes > 0 && bytes < with_sun);
    let svg = fs::read_to_string(folder.path().join("out/lamps-city-distribution.svg")).expect("a plot");
    assert!(svg.starts_with("<svg") && !svg.contains("NaN"));
}

#[test]
fn baked_shadows_are_held_against_shadow_maps() {
    let folder = folder();
    let bench = "bench csm --scale 0.1 --resolution 2048 --frames 2 --size 96x64 --truth 4 --out {out}";
    let text = run(folder.path(), bench).ok();
    assert!(text.contains("| csm, 4 maps, 2 x 2 |") && text.contains("| dag, 9 x 9 |"), "{text}");
    let table: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/csm.json")).expect("a file")).expect("JSON");
    for row in rows(&table) {
        assert!(["csm", "dag"].contains(&row["technique"].as_str().unwrap_or_default()), "{row}");
        assert!(
            row["ms"].as_f64() > Some(0.0) && row["rmse"].as_f64().is_some_and(|e| (0.0..64.0).contains(&e)),
            "{row}"
        );
    }
    for name in ["csm-city-error.svg", "csm-city-truth.png", "csm-city-dag-1.png", "csm-city-csm-2x2.png"] {
        assert!(folder.path().join("out").join(name).exists(), "no {name}");
    }
    run(folder.path(), "bench csm {dark.glb} --frames 1").fails(&["cannot read"]);
}

#[test]
fn soft_shadows_are_timed_and_held_against_the_truth() {
    let folder = folder();
    run(folder.path(), "scene screen --scale 0.1 -o {screen.glb} --quiet").ok();
    let bench = "bench ivsv {screen.glb} --size 48x32 --truth 16 --vpls 8 --voxels 32 --figures --out {out}";
    let text = run(folder.path(), bench).ok();
    for words in
        ["| 8 | total |", "| marched maps |", "| interpolated bit by bit |", "| theta | 32 |", "| 1 VPL, 512 samples |"]
    {
        assert!(text.contains(words), "no {words} in {text}");
    }
    let table: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/ivsv.json")).expect("a file")).expect("JSON");
    let steps = rows(&table).iter().filter(|row| row["table"] == "steps");
    for row in steps {
        assert!(row["naive_ms"].as_f64() > Some(0.0) && row["ours_ms"].as_f64() > Some(0.0), "{row}");
    }
    let errors: Vec<f64> = rows(&table).iter().filter_map(|row| row["rmse"].as_f64()).collect();
    assert!(errors.len() > 20 && errors.iter().all(|error| (0.0..80.0).contains(error)), "{errors:?}");
    for name in ["vpls.svg", "resolution.svg", "truth.png", "media.png", "sizes.png", "interpolation.png"] {
        assert!(folder.path().join("out").join(format!("ivsv-screen-{name}")).exists(), "no {name}");
    }
    run(folder.path(), "bench ivsv {city}").fails(&["no area light", "--area-light"]);
}

#[test]
fn voxel_culling_is_timed_beside_frusta_and_none() {
    let folder = folder();
    run(folder.path(), "scene village --scale 0.1 -o {village.glb} --quiet").ok();
    let bench = "bench culling {village.glb} --grid 16 --size 64x36 --map 64 --map 128 --lights 4 --frames 1 --ablations \
                 --counts 2 --counts 4 --out {out} --json --quiet";
    let table = run(folder.path(), bench).json();
    for map in ["cube", "paraboloid"] {
        for size in [64, 128] {
            let of = |technique: &str| {
                row(&table, &[("map", map.into()), ("size", size.into()), ("technique", technique.into())]).clone()
            };
            let [none, frustum, voxel] = ["none", "frustum", "voxel"].map(of);
            let triangles = |row: &Value| row["triangles"].as_u64().expect("a number");
            assert!(
                triangles(&voxel) < triangles(&frustum) && triangles(&frustum) < triangles(&none),
                "{voxel} {frustum}"
            );
            for row in [&none, &frustum, &voxel] {
                assert_eq!(row["pixels_differing"], 0, "{row}");
                assert!(["shadow_ms", "total_ms"].iter().all(|key| row[*key].as_f64() > Some(0.0)), "{row}");
            }
        }
    }
    let of = |what: &str| rows(&table).iter().filter(|row| row["what"] == what).count();
    assert_eq!(["marking", "binning", "clusters", "grid", "lamps at once"].map(of), [4, 4, 4, 6, 3]);
    assert_eq!(rows(&table).iter().filter(|row| row["fps"].as_f64() > Some(0.0)).count(), 2);
    for name in ["culling-village-picture.png", "culling-village-lights.svg"] {
        assert!(folder.path().join("out").join(name).exists(), "no {name}");
    }
    run(folder.path(), "bench culling {city}").fails(&["no spot or point lights"]);
    run(folder.path(), "bench culling {village.glb} --grid 7").misused("8..=128");
}

#[test]
fn a_bench_that_fails_says_why_and_leaves_nothing() {
    let folder = folder();
    let temporary = folder.path().join("tmp");
    fs::create_dir(&temporary).expect("a folder");
    let bench = |line: &str| -> Done {
        let arguments = arguments(folder.path(), line);
        command(arguments).env("TMPDIR", &temporary).output().expect("the program runs").into()
    };
    bench("bench construction {city} --light moon").fails(&["\"moon\"", "sun"]);
    bench("bench construction {x.glb}").fails(&["cannot read", "x.glb"]);
    bench("bench lamps {city}").fails(&["no spot or point light"]);
    bench("bench construction {city} --largest 64 --interiors open --methods columns --threads-list 1 --quiet").ok();
    bench("bench lamps --scale 0.05 --lamps 1 --resolution 64 --quiet").ok();
    assert_eq!(fs::read_dir(&temporary).expect("a folder").count(), 0);
}
