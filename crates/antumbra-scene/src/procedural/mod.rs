//! Procedural scenes: the same name, seed and scale give the same scene, bit for bit, on every machine.
//!
//! For that only integer arithmetic, `+ - * /` and square roots in a written order, and the `libm` crate for the rest
//! are used; nothing depends on the order of a hash map.
//!
//! A new scene is a module with a `build(&Options) -> Scene` and a row in `SCENES`.

mod city;
mod foliage;
mod hairball;
mod landscape;
mod market;
mod noise;
mod palace;
mod palette;
mod props;
mod rng;
mod ruins;
mod screen;
mod shapes;
mod sheets;
mod solids;
mod textures;
mod view;
mod village;

#[cfg(test)]
mod tests;

use crate::model::Scene;

/// What a procedural scene is made from besides its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of everything that is left to chance.
    pub seed: u64,
    /// Size, 1 by default: the number of triangles grows with its square. Within [`SCALE_RANGE`].
    pub scale: f64,
    /// Spot lights along the streets of `city`, named `spot001`, `spot002`, ...; up to [`MAX_LAMPS`]. More of them leave
    /// the earlier ones where they were. Other scenes have lights of their own and take 0 only.
    pub lamps: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1, scale: 1.0, lamps: 0 }
    }
}

/// The smallest and the largest [`Options::scale`].
pub const SCALE_RANGE: (f64, f64) = (0.05, 4.0);

/// The most [`Options::lamps`]: with the sun, no more lights than a shadow file holds.
pub const MAX_LAMPS: u32 = 4000;

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
    /// Lamps were asked for in a scene that does not take them.
    #[error("`{name}` takes no lamps; `city` does")]
    NoLamps {
        /// The scene asked for.
        name: String,
    },
    /// More lamps than [`MAX_LAMPS`].
    #[error("{lamps} lamps are too many; give at most {MAX_LAMPS}")]
    TooManyLamps {
        /// The number asked for.
        lamps: u32,
    },
}

struct Recipe {
    name: &'static str,
    summary: &'static str,
    /// Whether it heeds [`Options::lamps`].
    takes_lamps: bool,
    build: fn(&Options) -> Scene,
}

static SCENES: [Recipe; 12] = [
    Recipe {
        name: "cellar",
        summary: "a palace's wine cellar in the light of a caged lantern next door: about 200,000 triangles",
        takes_lamps: false,
        build: palace::cellar,
    },
    Recipe {
        name: "city",
        summary: "a downtown by a river: about a million triangles, all closed solids",
        takes_lamps: true,
        build: city::build,
    },
    Recipe {
        name: "door",
        summary: "a palace's gallery in the light from an open door; for light that bounces once",
        takes_lamps: false,
        build: palace::door,
    },
    Recipe {
        name: "flag",
        summary: "flags in a palace's gallery, in the light off its wall; for light that bounces once",
        takes_lamps: false,
        build: palace::flag,
    },
    Recipe {
        name: "grille",
        summary: "a grille in a palace's cellar, lit from behind by a wall; for light that bounces once",
        takes_lamps: false,
        build: palace::grille,
    },
    Recipe {
        name: "hairball",
        summary: "a ball of fibres in the light of a screen: about 350,000 triangles, all closed; for area lights",
        takes_lamps: false,
        build: hairball::build,
    },
    Recipe {
        name: "landscape",
        summary: "mountains, valleys and a lake: about two million triangles, one closed solid",
        takes_lamps: false,
        build: landscape::build,
    },
    Recipe {
        name: "market",
        summary: "a night market on a foggy square: moving lanterns and people, lamps, a screen, the moon",
        takes_lamps: false,
        build: market::build,
    },
    Recipe {
        name: "room",
        summary: "a lumber room in a palace's cellar, in the light off a carpet; for light that bounces once",
        takes_lamps: false,
        build: palace::room,
    },
    Recipe {
        name: "ruins",
        summary: "an overgrown abbey: thin open walls and vaults, leaves cut out by alpha masks",
        takes_lamps: false,
        build: ruins::build,
    },
    Recipe {
        name: "screen",
        summary: "a large television in a street at night, with onlookers; an area light that shows a video",
        takes_lamps: false,
        build: screen::build,
    },
    Recipe {
        name: "village",
        summary: "a village at night: closed houses, street lamps and lit windows as point and spot lights",
        takes_lamps: false,
        build: village::build,
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
/// As [`check`].
pub fn build(name: &str, options: &Options) -> Result<Scene, ProceduralError> {
    Ok((checked(name, options)?.build)(options))
}

/// Whether a scene can be built, at no cost.
///
/// # Errors
/// [`ProceduralError`] when there is no such scene, the scale is outside [`SCALE_RANGE`], or the scene does not take that
/// many lamps.
pub fn check(name: &str, options: &Options) -> Result<(), ProceduralError> {
    checked(name, options).map(|_| ())
}

fn checked(name: &str, options: &Options) -> Result<&'static Recipe, ProceduralError> {
    let recipe = SCENES
        .iter()
        .find(|recipe| recipe.name == name)
        .ok_or_else(|| ProceduralError::UnknownScene { name: name.to_owned() })?;
    if !(SCALE_RANGE.0..=SCALE_RANGE.1).contains(&options.scale) {
        return Err(ProceduralError::Scale { scale: options.scale });
    }
    if options.lamps > 0 && !recipe.takes_lamps {
        return Err(ProceduralError::NoLamps { name: name.to_owned() });
    }
    if options.lamps > MAX_LAMPS {
        return Err(ProceduralError::TooManyLamps { lamps: options.lamps });
    }
    Ok(recipe)
}

fn known_names() -> String {
    NAMES.iter().map(|&(name, _)| name).collect::<Vec<_>>().join(", ")
}
