//! bench ablations: what it prints and writes.

use std::fs;

use serde_json::Value;

use crate::folder::{folder, run};

/// Keys that every row of an ablation has.
const KEYS: [(&str, &[&str]); 6] = [
    ("space", &["interior", "resolution", "world_bytes", "light_bytes", "world_nodes", "light_nodes", "columns_bytes"]),
    ("leaves", &["interior", "resolution", "flat_bytes", "cubic_bytes", "pcf9_flat_reads", "pcf17_cubic_sectors"]),
    ("growth", &["interior", "resolution", "pool_bytes", "file_bytes", "shadow_map_bytes", "growth"]),
    ("undefined", &["resolution", "old_bytes", "new_bytes", "columns_bytes", "old_over_new"]),
    ("depth_heights", &["resolution", "nears", "distance_m", "log_slice_m", "ndc_slice_m"]),
    ("depth", &["resolution", "distribution", "open_bytes", "auto_bytes", "wrong_near", "points_near", "wrong_far"]),
];

fn of<'a>(rows: &'a [Value], ablation: &str) -> Vec<&'a Value> {
    rows.iter().filter(|row| row["ablation"] == ablation).collect()
}

#[test]
fn every_ablation_has_its_rows_and_files() {
    let folder = folder();
    let table = run(folder.path(), "bench ablations --scale 0.05 --largest 64 --json --out {out}").json();
    assert_eq!(table["table"], "ablations");
    assert!(table["machine"]["cores"].as_u64() > Some(0) && table["machine"].get("model").is_some());
    let rows = table["rows"].as_array().expect("rows");
    for (ablation, keys) in KEYS {
        let rows = of(rows, ablation);
        assert!(rows.iter().any(|row| row["scene"] == "city"), "{ablation}");
        for (row, key) in rows.iter().flat_map(|row| keys.iter().map(move |key| (row, *key))) {
            assert!(row.get(key).is_some(), "{ablation}: no {key} in {row}");
        }
    }
    let known = |row: &&Value| KEYS.iter().any(|(ablation, _)| row["ablation"] == *ablation);
    assert!(rows.iter().all(|row| row["scene"].is_string() && known(&row)));
    let out = folder.path().join("out");
    let read = |name: &str| fs::read_to_string(out.join(name)).expect(name);
    assert_eq!(serde_json::from_str::<Value>(&read("ablations.json")).expect("JSON"), table);
    assert_eq!(read("ablations.md").matches("\n## ").count(), KEYS.len());
    assert!(read("ablations-landscape-bytes.svg").contains("shadow map"));
}

#[test]
fn what_nothing_is_free_in_costs_the_same_however_it_is_built() {
    let folder = folder();
    let table = run(folder.path(), "bench ablations {city} --only space --largest 128 --json --quiet").json();
    let rows = table["rows"].as_array().expect("rows");
    for row in rows.iter().filter(|row| row["interior"] == "open") {
        assert_eq!(row["light_bytes"], row["columns_bytes"], "{row}");
    }
    assert_eq!(rows.len(), 4);
}

#[test]
fn growth_is_drawn() {
    let folder = folder();
    let text = run(folder.path(), "bench ablations {city} --only growth --largest 1024 --out {out}").ok();
    assert!(text.starts_with("# Ablations of the papers\n") && text.contains("\n| city | auto | 1024 |"), "{text}");
    for name in ["ablations-city-bytes.svg", "ablations-city-growth.svg"] {
        let svg = fs::read_to_string(folder.path().join("out").join(name)).expect(name);
        assert!(svg.starts_with("<svg") && svg.contains("16-bit shadow map") && !svg.contains("NaN"), "{name}");
    }
}

#[test]
fn what_cannot_be_measured_is_told() {
    let folder = folder();
    run(folder.path(), "bench everything").fails(&["\"everything\" is not in this version", "ablations"]);
    run(folder.path(), "bench ablations {city} --light moon").fails(&["\"moon\"", "sun"]);
    run(folder.path(), "bench ablations {city} --only depth --largest 64").fails(&["spot or point light"]);
    run(folder.path(), "bench ablations {x.glb}").fails(&["cannot read", "x.glb"]);
    run(folder.path(), "bench ablations --only everything").misused("space");
    run(folder.path(), "bench ablations --light sun").misused("SCENE");
}
