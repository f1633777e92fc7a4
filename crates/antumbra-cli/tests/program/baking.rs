//! bake, info, validate, scene: what they write and print.

use std::fs;

use serde_json::Value;

use crate::folder::{arguments, edit_glb, folder, run};

#[test]
fn bake_and_info_agree_on_what_the_file_holds() {
    let folder = folder();
    let bake = "bake {city} -o {b} --resolution 256 --light sun --sun 225,30 --json --threads 2";
    run(folder.path(), "bake {city} -o {b} --resolution 256 --sun 100,50").ok();
    let one = run(folder.path(), "info {b} --json").json();
    let baked = run(folder.path(), bake).json();
    let info = run(folder.path(), "info {b} --json").json();
    for (key, value) in baked["lights"][0].as_object().expect("a light") {
        let told = &info["lights"][0][key];
        let only_the_bake_knows = ["build_seconds", "stages"].contains(&key.as_str());
        assert!(if only_the_bake_knows { told.is_null() } else { told == value }, "{key}: {told}, not {value}");
    }
    for key in ["file_bytes", "triangles"] {
        assert_eq!(baked[key], info[key], "{key}");
    }
    assert_eq!(baked["threads"], 2);
    assert_eq!(baked["lights"][0]["kind"], "directional");
    assert_eq!(baked["lights"][0]["resolution"], 256);
    assert!(baked["warnings"].as_array().expect("warnings").is_empty());
    for stage in [&baked["stages"][0], &baked["lights"][0]["stages"][0]] {
        assert!(stage["name"].is_string() && stage["seconds"].is_number(), "{stage}");
    }
    let seconds = ["read_seconds", "write_seconds", "wall_seconds"].map(|key| baked[key].as_f64().expect(key));
    assert!(seconds[2] >= seconds[0] + seconds[1]);
    assert!(cfg!(not(unix)) || baked["cpu_seconds"].as_f64() > Some(0.0));
    assert!(cfg!(not(target_os = "linux")) || baked["peak_rss_bytes"].as_u64() > Some(1 << 20));
    // --sun takes the place of the light of its name: there is still one, and it shines from elsewhere.
    assert_eq!(info["lights"].as_array().expect("lights").len(), 1);
    assert_ne!(one["lights"][0]["direction_world"], info["lights"][0]["direction_world"]);
    let sections: u64 = info["sections"].as_array().expect("sections").iter().map(|s| bytes(&s["bytes"])).sum();
    assert!(sections < bytes(&info["file_bytes"]));
}

#[test]
fn silhouettes_are_baked_told_of_and_looked_up() {
    let folder = folder();
    let bake = "bake {city} -o {s} --resolution 1024 --sun 225,30 --enter-depths --json";
    let baked = run(folder.path(), bake).json();
    let graph = run(folder.path(), "bake {city} -o {g} --resolution 1024 --sun 225,30 --encoding dag8 --json").json();
    let plain = run(folder.path(), "bake {city} -o {w} --resolution 1024 --sun 225,30 --unpacked --json").json();
    let info = run(folder.path(), "info {s} --json").json();
    assert_eq!(info["lights"][0]["encoding"], "silhouette");
    for key in ["name", "bytes", "nodes"] {
        assert_eq!(info["lights"][0][key], baked["lights"][0][key], "{key}");
    }
    assert!(bytes(&info["lights"][0]["nodes"]["cuts"]) > 100);
    assert!(3 * bytes(&baked["file_bytes"]) < 2 * bytes(&plain["file_bytes"]));
    assert!(bytes(&plain["file_bytes"]) < bytes(&graph["file_bytes"]));
    assert_eq!(plain["lights"][0]["nodes"], baked["lights"][0]["nodes"]);
    run(folder.path(), "validate {w}").ok();
    run(folder.path(), "validate {s}").ok();
    run(folder.path(), "compare {s} {city} --samples 20000").ok();
    run(folder.path(), "render {city} -o {p.png} --size 64x36 --samples 1 --shadows {s} --filter 9").ok();
    let levels = "render {city} -o {q.png} --size 64x36 --shadows {s} --device gpu --prefilter levels --filter 5";
    run(folder.path(), levels).ok();
    run(folder.path(), "bake {city} -o {l} --encoding silhouette --method kampe2015")
        .fails(&["kampe2015", "--encoding dag8"]);
    run(folder.path(), "bake {city} -o {l} --encoding dag8 --unpacked").fails(&["--unpacked", "silhouette"]);
    // Their methods make their own encoding.
    let theirs = run(folder.path(), "bake {city} -o {l} --resolution 256 --method kampe2015 --json").json();
    assert_eq!(theirs["lights"][0]["nodes"]["cuts"], 0);
}

#[test]
fn bench_encodings_measures_both() {
    let folder = folder();
    let line = "bench encodings {city} --sun 225,30 --smallest 256 --largest 512 --points 1000 --out {tables} --json";
    let rows = run(folder.path(), line).json()["rows"].clone();
    let rows = rows.as_array().expect("rows");
    assert_eq!(rows.len(), 4);
    for pair in rows.chunks(2) {
        assert_eq!((&pair[0]["encoding"], &pair[1]["encoding"]), (&"dag8".into(), &"silhouette".into()));
        let ratio = bytes(&pair[1]["file_bytes"]) as f64 / bytes(&pair[0]["file_bytes"]) as f64;
        assert!((pair[1]["bytes_ratio"].as_f64().expect("a ratio") - ratio).abs() < 1e-9);
        assert!(pair[1]["differing_share"].as_f64().expect("a share") < 0.2);
        assert!(
            ["random_per_us", "coherent_per_us", "filtered_per_us"].iter().all(|key| pair[1][key].as_f64() > Some(0.0))
        );
    }
    assert!(rows[0]["growth"].is_null() && rows[2]["growth"].as_f64() > Some(1.0));
    for file in ["encodings.md", "encodings.json"] {
        assert!(folder.path().join("tables").join(file).exists(), "{file}");
    }
    run(folder.path(), "bench encodings {city} --smallest 512 --largest 256").fails(&["--smallest"]);
}

fn bytes(value: &Value) -> u64 {
    value.as_u64().expect("a number")
}

#[test]
fn several_lights_share_their_nodes() {
    let folder = folder();
    let city = run(folder.path(), "bake {city} -o {one} --resolution 256 --json").json();
    let glb = with_lights(&fs::read(&arguments(folder.path(), "{city}")[0]).expect("the city"));
    fs::write(folder.path().join("two.glb"), glb).expect("a file");
    let done = run(folder.path(), "bake {two.glb} -o {b} --resolution 256 --json");
    let baked = done.json();
    assert!(baked["warnings"].as_array().expect("warnings").is_empty());
    let info = run(folder.path(), "info {b} --json").json();
    assert_eq!(baked["lights"].as_array().expect("lights").len(), 3);
    assert_eq!(info["lights"][2]["kind"], "point");
    for (baked, info) in [0, 1, 2].map(|i| (&baked["lights"][i], &info["lights"][i])) {
        assert_eq!((&baked["name"], &baked["bytes"], &baked["nodes"]), (&info["name"], &info["bytes"], &info["nodes"]));
    }
    // The twin of a light adds nothing to a graph; to silhouettes it adds no edges and planes.
    assert_eq!(
        (&baked["lights"][0]["bytes"], &info["lights"][0]["encoding"]),
        (&city["lights"][0]["bytes"], &"silhouette".into())
    );
    assert!(bytes(&baked["lights"][1]["bytes"]) < bytes(&baked["lights"][0]["bytes"]));
    run(folder.path(), "validate {b}").ok();
    let graph = run(folder.path(), "bake {two.glb} -o {b} --resolution 256 --encoding dag8 --json").json();
    assert_eq!(graph["lights"][1]["bytes"], 0);
    run(folder.path(), "validate {b}").ok();

    let only = run(folder.path(), "bake {two.glb} -o {b} --resolution 64 --light twin --json").json();
    assert_eq!((&only["lights"][0]["name"], only["lights"].as_array().map(Vec::len)), (&"twin".into(), Some(1)));
    let lamp = run(folder.path(), "bake {two.glb} -o {b} --resolution 64 --near 2 --light lamp --json").json();
    assert_eq!((&lamp["lights"][0]["name"], &lamp["lights"][0]["kind"]), (&"lamp".into(), &"point".into()));
    let info = run(folder.path(), "info {b} --json").json();
    assert_eq!((info["lights"][0]["near_m"].as_f64(), info["lights"][0]["faces"].as_u64()), (Some(2.0), Some(6)));
    run(folder.path(), "validate {b}").ok();
    run(folder.path(), "bake {two.glb} -o {b} --light lamp --near 1e6").fails(&["lamp", "--near"]);
    run(folder.path(), "bake {two.glb} -o {b} --light moon").fails(&["\"moon\"", "twin"]);
}

/// A GLB with a twin of its first light and a point light besides.
fn with_lights(glb: &[u8]) -> Vec<u8> {
    edit_glb(glb, |root| {
        let nodes = root["nodes"].as_array().expect("nodes");
        let is_light = |node: &&Value| node["extensions"]["KHR_lights_punctual"].is_object();
        let [mut twin, mut lamp] = [(); 2].map(|()| nodes.iter().find(is_light).expect("a light").clone());
        let first = nodes.len();
        twin["name"] = "twin".into();
        lamp["name"] = "lamp".into();
        let definitions = root["extensions"]["KHR_lights_punctual"]["lights"].as_array_mut().expect("lights");
        lamp["extensions"]["KHR_lights_punctual"]["light"] = definitions.len().into();
        definitions.push(serde_json::json!({ "type": "point" }));
        root["nodes"].as_array_mut().expect("nodes").extend([twin, lamp]);
        root["scenes"][0]["nodes"].as_array_mut().expect("a scene").extend([first, first + 1].map(Value::from));
    })
}

#[test]
fn threads_do_not_show_in_the_bytes() {
    let folder = folder();
    let bakes = [1, 2, 3].map(|threads| {
        run(folder.path(), &format!("bake {{city}} -o {{b}} --resolution 2048 --threads {threads} --quiet")).ok();
        fs::read(folder.path().join("b")).expect("a bake")
    });
    assert!(bakes[0] == bakes[1] && bakes[1] == bakes[2]);
}

#[test]
fn quiet_is_quiet() {
    let folder = folder();
    for line in [
        "scene city --scale 0.05 -o {c.glb} --quiet",
        "bake {c.glb} -o {b} --resolution 64 --quiet",
        "compare {b} {c.glb} --samples 100 --quiet",
        "render {c.glb} --size 8x8 -o {p.png} --quiet",
    ] {
        let done = run(folder.path(), line);
        assert_eq!((done.code, done.stdout.as_str(), done.stderr.as_str()), (0, "", ""), "{line}");
    }
}

#[test]
fn texels_are_as_small_as_asked_for() {
    let folder = folder();
    let baked = run(folder.path(), "bake {city} -o {b} --texel-size 0.9 --json").json();
    let texel = baked["lights"][0]["texel_size_m"].as_f64().expect("a number");
    assert!(texel <= 0.9 && texel > 0.45, "{texel}");
    run(folder.path(), "bake {city} -o {b} --texel-size 1e-9").fails(&["1048576", "at least"]);
}

#[test]
fn excluding_is_by_name() {
    let folder = folder();
    run(folder.path(), "bake {city} -o {b} --exclude submarine*").fails(&["\"submarine*\"", "it has:"]);
    run(folder.path(), "bake {city} -o {b} --exclude *").fails(&["no triangles that cast shadows"]);
}

#[test]
fn memory_is_kept_within_limits() {
    let folder = folder();
    run(folder.path(), "bake {city} -o {b} --resolution 16384 --memory-limit 1M")
        .fails(&["--memory-limit", "allow more"]);
    if cfg!(target_os = "linux") {
        let limit = 200 << 20;
        let line = format!("bake {{city}} -o {{b}} --resolution 4096 --memory-limit {limit} --json");
        let baked = run(folder.path(), &line).json();
        assert!(baked["peak_rss_bytes"].as_u64() < Some(limit));
    }
}

#[test]
fn a_failure_leaves_the_old_file_alone() {
    let folder = folder();
    let old = folder.path().join("b");
    fs::write(&old, "precious").expect("a file");
    run(folder.path(), "bake {city} -o {b} --resolution 64 --no-culling").fails(&["--method kampe2015"]);
    run(folder.path(), "bake {b} -o {b}").fails(&["unknown kind"]);
    assert_eq!(fs::read(&old).expect("still there"), b"precious");
    run(folder.path(), "bake {city} -o {b} --resolution 64").ok();
    run(folder.path(), "validate {b}").ok();
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "something was left beside the file");
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder();
    let [real, link] = ["real", "link"].map(|name| folder.path().join(name));
    fs::write(&real, "old").expect("a file");
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).expect("permissions");
    symlink(&real, &link).expect("a link");
    run(folder.path(), "bake {city} -o {link} --resolution 64").ok();
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert_eq!(fs::metadata(&real).expect("there").permissions().mode() & 0o777, 0o640);
    run(folder.path(), "validate {real}").ok();
    run(folder.path(), "bake {city} -o /dev/null --resolution 64").ok();
    assert!(!fs::metadata("/dev/null").expect("there").is_file());
}

#[test]
fn damaged_files_are_refused() {
    let folder = folder();
    let [city, baked] = ["{city}", "{baked}"].map(|name| arguments(folder.path(), name).remove(0));
    let (glb, bytes) = (fs::read(city).expect("a scene"), fs::read(baked).expect("a bake"));
    for length in [0, 7, 8, 63, 64, 200, bytes.len() / 2, bytes.len() - 1] {
        fs::write(folder.path().join("d"), &bytes[..length]).expect("a file");
        for line in ["validate {d}", "info {d}", "compare {d} {city}", "render {city} --shadows {d} -o {p}"] {
            run(folder.path(), line).fails(&["d: "]);
        }
    }
    for at in [9, 30, 100, 300, bytes.len() / 2, bytes.len() - 1] {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x55;
        fs::write(folder.path().join("d"), bytes).expect("a file");
        run(folder.path(), "validate {d}").fails(&["d: "]);
    }
    for length in [0, 11, 100, glb.len() / 2, glb.len() - 1] {
        fs::write(folder.path().join("d.glb"), &glb[..length]).expect("a file");
        run(folder.path(), "bake {d.glb} -o {b}").fails(&["d.glb: "]);
        run(folder.path(), "render {d.glb} -o {p}").fails(&["d.glb: "]);
    }
}
