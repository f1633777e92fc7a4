//! Reads the files that commands work on.

use std::path::Path;

use antumbra::{LightShadow, ShadowFile};
use antumbra_scene::Scene;
use anyhow::{Context, Result, bail};

use crate::table::printable;

/// How many names an error lists.
const NAMES_LISTED: usize = 8;

/// Reads a scene and leaves out what matches the globs.
pub fn scene(path: &Path, exclude: &[String]) -> Result<Scene> {
    let mut scene = antumbra_scene::load(path)?;
    let matched = scene.exclude(exclude);
    if let Some((glob, _)) = exclude.iter().zip(matched).find(|(_, nodes)| *nodes == 0) {
        let names = listed(scene.nodes.iter().map(|node| node.name.as_str()));
        bail!("--exclude \"{glob}\" matches no node of {}; it has: {names}", path.display());
    }
    Ok(scene)
}

/// Reads and validates a shadow file; returns its length in bytes too.
pub fn shadows(path: &Path) -> Result<(ShadowFile, u64)> {
    let bytes = file(path)?;
    let file = ShadowFile::from_bytes(&bytes).with_context(|| path.display().to_string())?;
    Ok((file, bytes.len() as u64))
}

/// The light of that name.
pub fn light<'a>(file: &'a ShadowFile, path: &Path, name: &str) -> Result<LightShadow<'a>> {
    file.light(name).with_context(|| {
        let names = listed(file.lights().map(LightShadow::name));
        format!("{} has no light \"{name}\"; it has: {names}", path.display())
    })
}

/// A file's bytes.
pub fn file(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}

/// A few different names, for an error.
#[must_use]
pub fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut seen = Vec::new();
    for name in names {
        if seen.len() > NAMES_LISTED {
            break;
        }
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    let mut list: Vec<String> = seen.iter().take(NAMES_LISTED).map(|name| printable(name)).collect();
    if seen.len() > NAMES_LISTED {
        list.push("...".to_owned());
    }
    if list.is_empty() { "none".to_owned() } else { list.join(", ") }
}

/// What a scene's file is called, without its folder and ending.
#[must_use]
pub fn scene_name(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
