//! A crate edge is a dependency edge: fails when a crate depends on one that it must not.

use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// What each crate of the workspace may depend on within it. The program may see everything but dev/.
const MAY_DEPEND_ON: [(&str, &[&str]); 6] = [
    ("antumbra", &[]),
    ("antumbra-scene", &[]),
    ("antumbra-bake", &["antumbra", "antumbra-scene"]),
    ("antumbra-render", &["antumbra", "antumbra-scene"]),
    ("antumbra-viewer", &["antumbra", "antumbra-scene", "antumbra-bake", "antumbra-render"]),
    ("antumbra-cli", &["antumbra", "antumbra-scene", "antumbra-bake", "antumbra-render", "antumbra-viewer"]),
];

/// What the runtime, which games ship, may take from elsewhere.
const RUNTIME_MAY_USE: [&str; 6] = ["bytemuck", "glam", "libm", "miniz_oxide", "thiserror", "xxhash-rust"];

/// Reads `cargo metadata` and checks every edge that is not for tests alone.
pub fn check() -> Result<()> {
    let output = Command::new("cargo").args(["metadata", "--format-version", "1", "--no-deps"]).output()?;
    if !output.status.success() {
        bail!("cargo metadata failed: {}", String::from_utf8_lossy(&output.stderr));
    }
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let mut wrong = Vec::new();
    for package in packages {
        wrong.extend(wrong_edges(package));
    }
    if !wrong.is_empty() {
        bail!("crates depend on what they must not:\n  {}", wrong.join("\n  "));
    }
    println!("crate edges: {} packages as they should be", packages.len());
    Ok(())
}

fn wrong_edges(package: &Value) -> Vec<String> {
    let name = package["name"].as_str().unwrap_or_default();
    let is_in =
        |folder: &str| package["manifest_path"].as_str().is_some_and(|path| path.replace('\\', "/").contains(folder));
    let in_dev = is_in("/dev/") || is_in("/examples/");
    let Some((_, allowed)) = MAY_DEPEND_ON.iter().find(|(known, _)| *known == name) else {
        let unknown = format!("{name} is not in the list of dev/xtask/src/edges.rs");
        return if in_dev { Vec::new() } else { vec![unknown] };
    };
    let edges = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
    let used = edges.iter().filter(|d| d["kind"] != "dev");
    used.filter_map(|d| {
        let to = d["name"].as_str().unwrap_or_default();
        let sibling = d["path"].is_string();
        let foreign = name == "antumbra" && !sibling && !RUNTIME_MAY_USE.contains(&to);
        ((sibling && !allowed.contains(&to)) || foreign).then(|| format!("{name} -> {to}"))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn package(name: &str, dependencies: Value) -> Value {
        json!({"name": name, "manifest_path": format!("/w/crates/{name}/Cargo.toml"), "dependencies": dependencies})
    }

    #[test]
    fn finds_forbidden_edges() {
        let edge = |to: &str, kind: Value| json!({"name": to, "kind": kind, "path": "/w"});
        let bad = package("antumbra-render", json!([edge("antumbra-bake", Value::Null)]));
        assert_eq!(wrong_edges(&bad), ["antumbra-render -> antumbra-bake"]);
        let test_only = package("antumbra-render", json!([edge("antumbra-bake", json!("dev"))]));
        assert!(wrong_edges(&test_only).is_empty());
        let heavy = package("antumbra", json!([{"name": "rayon", "kind": null}]));
        assert_eq!(wrong_edges(&heavy), ["antumbra -> rayon"]);
        assert_eq!(wrong_edges(&package("antumbra-new", json!([]))).len(), 1);
    }
}
