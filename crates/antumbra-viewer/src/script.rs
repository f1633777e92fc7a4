//! Scripts: a camera's way to replay, for tests and recordings. One step per line; `#` begins a comment.
//!
//! ```text
//! wait-bake                        wait for the bake in the background
//! set KEY VALUE                    technique baked|maps|none, filter K, kernel box|tent, prefilter none|mean|levels,
//!                                  penumbra DEG, cascades N, lists tiled|clustered, time day|night|auto, samples N,
//!                                  fog PER-METRE, sun AZ,EL
//! frame X,Y,Z X,Y,Z                draw a frame from an eye, looking at a target; metres
//! screenshot PATH.png              save the window's picture, with its panel
//! ```

use std::path::PathBuf;

use antumbra::Kernel;
use antumbra_render::Time;
use glam::DVec3;

use crate::ViewError;
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
                    set(&mut Settings::new(&[]), key, value).map_err(wrong)?;
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
                _ => return Err(one_of("box, tent")),
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
        ] {
            let error = Script::parse(text).expect_err("a wrong script").to_string();
            assert!(error.starts_with(&format!("line {line} ")) && error.contains(word), "{error}");
        }
    }
}
