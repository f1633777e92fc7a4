//! Scripts: a camera's way to replay, for tests and recordings. One step per line; `#` begins a comment.
//!
//! ```text
//! wait-bake                        wait for the bake in the background
//! set KEY VALUE                    technique baked|maps|none, filter K, kernel box|tent|continuous, prefilter none|mean|levels,
//!                                  penumbra DEG, cascades N, lists tiled|clustered, time day|night|auto, samples N,
//!                                  fog PER-METRE, sun AZ,EL, scatter G; area lights: area on|off,
//!                                  shape rectangle|disc|sphere|environment, light X,Y,Z, aim X,Y,Z, size W,H, color R,G,B,
//!                                  luminance CD, area-shadows voxels|one-by-one|maps|none, vpls N, voxels N, maps N,
//!                                  alpha N, theta N, phi N, gather full|interleaved|half, airlight exact|average,
//!                                  interpolation none|plain|fast, video SECONDS, moving on|off; lamps:
//!                                  lamp-maps cube|paraboloid|off, map-size N, culling voxels|frusta|none, grid N,
//!                                  virtual-lights N
//! frame X,Y,Z X,Y,Z                draw a frame from an eye, looking at a target; metres
//! screenshot PATH.png              save the window's picture, with its panel
//! ```

use std::path::PathBuf;

use antumbra::Kernel;
use antumbra_render::Time;
use antumbra_render::area::{Airlight, AreaTechnique, Gathering, Interpolation, VoxelResolution};
use antumbra_scene::Scene;
use glam::DVec3;

use crate::ViewError;
use crate::area::Area;
use crate::settings::{Averaging, Settings, Technique};

/// A script's steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    pub(crate) steps: Vec<Step>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    WaitBake,
    Set(String, String),
    Frame { eye: DVec3, target: DVec3 },
    Screenshot(PathBuf),
}

impl Script {
    /// Reads a script's text.
    ///
    /// # Errors
    /// [`ViewError::Script`] names the first line that is wrong.
    pub fn parse(text: &str) -> Result<Self, ViewError> {
        let mut steps = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let words: Vec<&str> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
            let wrong = |reason: String| ViewError::Script { line: number + 1, reason };
            steps.push(match words[..] {
                [] => continue,
                ["wait-bake"] => Step::WaitBake,
                ["set", key, value] => {
                    // Tried out, so that what is wrong shows before the window opens.
                    set(&mut Settings::new(&Scene::default()), key, value).map_err(wrong)?;
                    Step::Set(key.to_owned(), value.to_owned())
                }
                ["frame", eye, target] => {
                    let [eye, target] = [eye, target].map(numbers::<3>);
                    let (eye, target) = (eye.map_err(wrong)?, target.map_err(wrong)?);
                    Step::Frame { eye: DVec3::from_array(eye), target: DVec3::from_array(target) }
                }
                ["screenshot", path] => Step::Screenshot(PathBuf::from(path)),
                _ => {
                    let known = "wait-bake, set KEY VALUE, frame EYE TARGET, screenshot PATH";
                    return Err(wrong(format!("`{}` is no step; there are: {known}", line.trim())));
                }
            });
        }
        Ok(Self { steps })
    }
}

/// Numbers separated by commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parsed: Option<Vec<f64>> =
        text.split(',').map(|word| word.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    parsed
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("`{text}`: give {N} numbers separated by commas"))
}

/// Changes one setting.
pub(crate) fn set(settings: &mut Settings, key: &str, value: &str) -> Result<(), String> {
    let one_of = |known: &str| format!("`{value}` is not one of: {known}");
    let within = |low: f64, high: f64| {
        let number = numbers::<1>(value)?[0];
        if (low..=high).contains(&number) { Ok(number) } else { Err(format!("`{value}`: give {low} to {high}")) }
    };
    match key {
        "technique" => {
            settings.technique = match value {
                "baked" => Technique::Baked,
                "maps" => Technique::Maps,
                "none" => Technique::None,
                _ => return Err(one_of("baked, maps, none")),
            }
        }
        "filter" => {
            let taps = within(1.0, 17.0)?;
            if taps % 2.0 != 1.0 {
                return Err(format!("`{value}`: give an odd number"));
            }
            settings.taps = taps as u32;
        }
        "kernel" => {
            settings.kernel = match value {
                "box" => Kernel::Box,
                "tent" => Kernel::Tent,
                "continuous" => Kernel::Continuous,
                _ => return Err(one_of("box, tent, continuous")),
            }
        }
        "prefilter" => {
            settings.averaging = match value {
                "none" => Averaging::None,
                "mean" => Averaging::Mean,
                "levels" => Averaging::Levels,
                _ => return Err(one_of("none, mean, levels")),
            }
        }
        "penumbra" => settings.penumbra_deg = within(0.0, 30.0)?,
        "cascades" => settings.cascades = within(1.0, 8.0)? as u32,
        "lists" => {
            settings.is_clustered = match value {
                "tiled" => false,
                "clustered" => true,
                _ => return Err(one_of("tiled, clustered")),
            }
        }
        "time" => {
            settings.time = match value {
                "day" => Some(Time::Day),
                "night" => Some(Time::Night),
                "auto" => None,
                _ => return Err(one_of("day, night, auto")),
            }
        }
        "samples" => settings.samples = within(1.0, 64.0)? as u32,
        "fog" => settings.fog_per_m = within(0.0, 10.0)?,
        "sun" => {
            let [azimuth, elevation] = numbers(value)?;
            if !(-90.0..=90.0).contains(&elevation) {
                return Err(format!("`{value}`: give an elevation from -90 to 90 degrees"));
            }
            settings.sun_deg = [azimuth.rem_euclid(360.0), elevation];
        }
        "scatter" => settings.anisotropy = within(-0.95, 0.95)?,
        "video" => settings.video_s = within(0.0, 1e6)?,
        "moving" => settings.is_moving = on_or_off(value)?,
        _ => match settings.lamps.set(key, value, within) {
            Some(result) => return result,
            None => return set_area(&mut settings.area, key, value, within),
        },
    }
    Ok(())
}

fn on_or_off(value: &str) -> Result<bool, String> {
    match value {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("`{value}` is not one of: on, off")),
    }
}

/// Changes a setting of area lights.
fn set_area(
    area: &mut Area,
    key: &str,
    value: &str,
    within: impl Fn(f64, f64) -> Result<f64, String>,
) -> Result<(), String> {
    let one_of = |known: &str| Err(format!("`{value}` is not one of: {known}"));
    let samples = || {
        let number = within(32.0, 512.0)?;
        if number % 32.0 == 0.0 { Ok(number as u32) } else { Err(format!("`{value}`: give a multiple of 32")) }
    };
    match key {
        "area" => area.is_on = on_or_off(value)?,
        "shape" => {
            let size = area.size_m();
            area.reshape(value, size)?;
        }
        "light" => area.light().position_world = DVec3::from_array(numbers(value)?),
        "aim" => area.aim(DVec3::from_array(numbers(value)?))?,
        "size" => {
            let size: [f64; 2] = numbers(value)?;
            if size.iter().any(|side| *side <= 0.0) {
                return Err(format!("`{value}`: give more than 0 metres"));
            }
            let shape = area.shape_name();
            area.reshape(shape, size.into())?;
        }
        "color" => {
            let (luminance, color) = (area.luminance().0, numbers::<3>(value)?);
            area.light().luminance = color.map(|c| c.clamp(0.0, 1.0) as f32 * luminance);
        }
        "luminance" => {
            let (luminance, color) = (within(0.0, 1e9)? as f32, area.luminance().1);
            area.light().luminance = (color * luminance).to_array();
        }
        "area-shadows" => {
            area.technique = match value {
                "voxels" => AreaTechnique::Voxels,
                "one-by-one" => AreaTechnique::OneByOne,
                "maps" => AreaTechnique::MarchedMaps,
                "none" => AreaTechnique::None,
                _ => return one_of("voxels, one-by-one, maps, none"),
            }
        }
        "vpls" => area.vpls = within(1.0, 1024.0)? as u32,
        "voxels" => area.voxels = VoxelResolution::cube(samples()?),
        "maps" => area.voxels.map = samples()?,
        "alpha" => area.voxels.alpha = samples()?,
        "theta" => area.voxels.theta = samples()?,
        "phi" => area.voxels.phi = samples()?,
        "gather" => {
            area.gathering = match value {
                "full" => Gathering::Full,
                "interleaved" => Gathering::Interleaved,
                "half" => Gathering::Half,
                _ => return one_of("full, interleaved, half"),
            }
        }
        "airlight" => {
            area.airlight = match value {
                "exact" => Airlight::Exact,
                "average" => Airlight::Average,
                _ => return one_of("exact, average"),
            }
        }
        "interpolation" => {
            area.interpolation = match value {
                "none" => Interpolation::None,
                "plain" => Interpolation::Plain,
                "fast" => Interpolation::Fast,
                _ => return one_of("none, plain, fast"),
            }
        }
        _ => return Err(format!("there is no setting `{key}`")),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read_in_order() {
        let text = "# a way\nwait-bake\nset filter 9 # taps\n\nframe 1,2,3 0,0,0\nscreenshot a.png\n";
        let script = Script::parse(text).expect("a script");
        let frame = Step::Frame { eye: DVec3::new(1.0, 2.0, 3.0), target: DVec3::ZERO };
        let set = Step::Set("filter".to_owned(), "9".to_owned());
        assert_eq!(script.steps, [Step::WaitBake, set, frame, Step::Screenshot("a.png".into())]);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, line, word) in [
            ("\nfly", 2, "fly"),
            ("frame 1,2 0,0,0", 1, "3 numbers"),
            ("frame 1,2,nan 0,0,0", 1, "numbers"),
            ("set filter 4", 1, "odd"),
            ("set colour red", 1, "colour"),
            ("wait-bake\nset sun 10,100", 2, "-90"),
            ("set time noon", 1, "auto"),
            ("set voxels 100", 1, "multiple"),
            ("set area maybe", 1, "off"),
            ("set size 0,1", 1, "more than 0"),
            ("set gather some", 1, "interleaved"),
            ("set lamp-maps sphere", 1, "paraboloid"),
            ("set culling some", 1, "frusta"),
            ("set map-size 10", 1, "64"),
            ("set virtual-lights -1", 1, "4096"),
        ] {
            let error = Script::parse(text).expect_err("a wrong script").to_string();
            assert!(error.starts_with(&format!("line {line} ")) && error.contains(word), "{error}");
        }
    }
}
