//! Procedural scenes: the same name, seed and scale give the same scene, bit for bit, on every machine.
//!
//! For that only integer arithmetic, `+ - * /` and square roots in a written order, and the `libm` crate for the rest
//! are used; nothing depends on the order of a hash map.
//!
//! A new scene is a module with a `build(&Options) -> Scene` and a row in `SCENES`.

mod city;
mod foliage;
mod landscape;
mod noise;
mod palette;
mod rng;
mod solids;

#[cfg(test)]
mod tests;
mod view;

use crate::model::Scene;

/// What a procedural scene is made from besides its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of everything that is left to chance.
    pub seed: u64,
    /// Size, 1 by default: the number of triangles grows with its square. Within [`SCALE_RANGE`].
    pub scale: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1, scale: 1.0 }
    }
}

/// The smallest and the largest [`Options::scale`].
pub const SCALE_RANGE: (f64, f64) = (0.05, 4.0);

/// Why a procedural scene cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProceduralError {
    /// No scene has that name.
    #[error("no procedural scene is called `{name}`; there are: {known}", known = known_names())]
    UnknownScene {
        /// The name asked for.
        name: String,
    },
    /// The scale is not a number or out of range.
    #[error("scale {scale} is out of range; give a number from {} to {}", SCALE_RANGE.0, SCALE_RANGE.1)]
    Scale {
        /// The scale asked for.
        scale: f64,
    },
}

struct Recipe {
    name: &'static str,
    summary: &'static str,
    build: fn(&Options) -> Scene,
}

const SCENES: [Recipe; 2] = [
    Recipe {
        name: "city",
        summary: "a downtown by a river: about a million triangles, all closed solids",
        build: city::build,
    },
    Recipe {
        name: "landscape",
        summary: "mountains, valleys and a lake: about two million triangles, one closed solid",
        build: landscape::build,
    },
];

/// Name and one-line description of every procedural scene.
pub const NAMES: &[(&str, &str)] = &{
    let mut names = [("", ""); SCENES.len()];
    let mut i = 0;
    while i < SCENES.len() {
        names[i] = (SCENES[i].name, SCENES[i].summary);
        i += 1;
    }
    names
};

/// Builds the scene of that name.
///
/// # Errors
/// [`ProceduralError`] when there is no such scene or the scale is outside [`SCALE_RANGE`].
pub fn build(name: &str, options: &Options) -> Result<Scene, ProceduralError> {
    let recipe = SCENES
        .iter()
        .find(|recipe| recipe.name == name)
        .ok_or_else(|| ProceduralError::UnknownScene { name: name.to_owned() })?;
    if !(SCALE_RANGE.0..=SCALE_RANGE.1).contains(&options.scale) {
        return Err(ProceduralError::Scale { scale: options.scale });
    }
    Ok((recipe.build)(options))
}

fn known_names() -> String {
    NAMES.iter().map(|&(name, _)| name).collect::<Vec<_>>().join(", ")
}
