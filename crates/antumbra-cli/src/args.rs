//! Arguments that several commands share, and how their values are read. What is not a value at all is a usage error.

use antumbra::{Encoding, Filter, Interior, Kernel, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{Blend, Inverted};
use anyhow::bail;
use clap::{Args, ValueEnum};
use glam::DVec3;

/// Which triangles cast shadows, and how they are judged.
#[derive(Args, Clone, Debug)]
pub struct CasterArgs {
    /// Nodes that cast no baked shadow, by name; `*` and `?` are wildcards; may be repeated
    ///
    /// So do nodes with the glTF extras {"antumbra": "dynamic"}.
    #[arg(long, value_name = "NAME-GLOB")]
    pub exclude: Vec<String>,
    /// Whether triangles of alphaMode BLEND cast (those of MASK cast where their texture is there)
    #[arg(long, value_enum, default_value_t = BlendArg::Skip)]
    pub blend: BlendArg,
    /// What closed parts are that are turned inside out and lie in no solid
    #[arg(long, value_enum, default_value_t = InvertedArg::Open)]
    pub inverted: InvertedArg,
}

/// `--blend`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlendArg {
    /// They cast nothing
    Skip,
    /// They cast as if opaque
    Opaque,
}

/// `--inverted`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvertedArg {
    /// Open surfaces, such as a room seen from inside
    Open,
    /// Solids that were exported inside out
    Solid,
}

impl CasterArgs {
    /// As the baker wants it.
    #[must_use]
    pub fn blend(&self) -> Blend {
        match self.blend {
            BlendArg::Skip => Blend::Skip,
            BlendArg::Opaque => Blend::Opaque,
        }
    }

    /// As the baker wants it.
    #[must_use]
    pub fn inverted(&self) -> Inverted {
        match self.inverted {
            InvertedArg::Open => Inverted::Open,
            InvertedArg::Solid => Inverted::Solid,
        }
    }
}

/// How a command runs.
#[derive(Args, Clone, Copy, Debug)]
pub struct RunArgs {
    /// Threads to run on [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Show no progress and no summary
    #[arg(long)]
    pub quiet: bool,
}

impl RunArgs {
    /// Threads, 0 for one per core.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.unwrap_or(0) as usize
    }

    /// Threads to run a command's parallel parts on.
    pub fn pool(&self) -> anyhow::Result<rayon::ThreadPool> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build();
        pool.map_err(|e| anyhow::anyhow!("cannot start {} threads: {e}; ask for fewer with --threads", self.threads()))
    }
}

/// `--kernel`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelArg {
    /// All taps weigh the same
    Box,
    /// Weights fall off linearly from the middle
    Tent,
}

/// `--filter` and `--kernel`.
#[derive(Args, Clone, Copy, Debug)]
pub struct FilterArgs {
    /// Filter over K x K texels: odd, 1 to 17 [default: 1, a plain lookup]
    #[arg(long, value_name = "K", value_parser = parse_taps)]
    pub filter: Option<u32>,
    /// Weights of the filter's taps
    #[arg(long, value_enum, default_value_t = KernelArg::Box)]
    pub kernel: KernelArg,
    /// Hard shadows without texels: by the casters' own edges, between the middles of texels too. Needs a bake of silhouettes
    #[arg(long, conflicts_with_all = ["filter", "kernel"])]
    pub continuous: bool,
}

impl FilterArgs {
    /// The filter, of `default_taps` unless told otherwise.
    pub fn filter(&self, default_taps: u32) -> anyhow::Result<Filter> {
        if self.continuous {
            return Ok(Filter::continuous());
        }
        let kernel = match self.kernel {
            KernelArg::Box => Kernel::Box,
            KernelArg::Tent => Kernel::Tent,
        };
        Ok(Filter::new(self.filter.unwrap_or(default_taps), kernel)?)
    }
}

impl FilterArgs {
    /// The same, for lookups in a file: continuous ones need silhouettes.
    pub fn of_file(&self, default_taps: u32, file: &ShadowFile) -> anyhow::Result<Filter> {
        if self.continuous && file.encoding() != Encoding::Silhouette {
            bail!(
                "--continuous needs silhouettes, which know the casters' edges; bake again with --encoding silhouette"
            );
        }
        self.filter(default_taps)
    }
}

fn parse_taps(text: &str) -> Result<u32, String> {
    let taps: u32 = text.parse().map_err(|_| "it must be a whole number".to_owned())?;
    Filter::new_box(taps).map(Filter::taps).map_err(|e| e.to_string())
}

/// Where the sun stands, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunAngles {
    azimuth: f64,
    elevation: f64,
}

impl SunAngles {
    /// Unit vector along which its light travels.
    #[must_use]
    pub fn direction_world(self) -> DVec3 {
        let (sin_azimuth, cos_azimuth) = sin_cos_degrees(self.azimuth);
        let (sin_elevation, cos_elevation) = sin_cos_degrees(self.elevation);
        let towards = DVec3::new(cos_elevation * sin_azimuth, sin_elevation, -cos_elevation * cos_azimuth);
        // Adding zero turns -0 into 0.
        DVec3::ZERO - towards
    }
}

/// Sine and cosine by `libm`, so that every machine bakes the same sun; exact at right angles.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let degrees = degrees % 360.0;
    let quarter = libm::round(degrees / 90.0);
    let (sin, cos) = libm::sincos((degrees - 90.0 * quarter).to_radians());
    match (quarter as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// `AZIMUTH,ELEVATION`.
pub fn parse_sun(text: &str) -> Result<SunAngles, String> {
    let [azimuth, elevation] = parse_numbers(text)?;
    if !(-90.0..=90.0).contains(&elevation) {
        return Err(format!("the elevation is {elevation} degrees: give -90 to 90"));
    }
    Ok(SunAngles { azimuth, elevation })
}

/// `X,Y,Z`.
pub fn parse_point(text: &str) -> Result<DVec3, String> {
    parse_numbers(text).map(DVec3::from_array)
}

/// `X0,Y0,Z0,X1,Y1,Z1`: the least corner, then the greatest.
pub fn parse_bounds(text: &str) -> Result<[DVec3; 2], String> {
    let [x0, y0, z0, x1, y1, z1] = parse_numbers(text)?;
    let (min, max) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
    if min.cmple(max).all() { Ok([min, max]) } else { Err("the first corner must not exceed the second".to_owned()) }
}

fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|n| n.is_finite()));
    let numbers: Option<Vec<f64>> = numbers.collect();
    let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
    numbers.ok_or_else(|| format!("it must be {N} finite numbers separated by commas"))
}

/// A length in metres, more than zero.
pub fn parse_metres(text: &str) -> Result<f64, String> {
    let [metres] = parse_numbers(text)?;
    if metres > 0.0 { Ok(metres) } else { Err("it must be more than 0".to_owned()) }
}

/// A power of two from 64 to 1048576.
pub fn parse_resolution(text: &str) -> Result<Resolution, String> {
    let resolution = text.parse().ok().and_then(Resolution::new);
    resolution.ok_or_else(|| "it must be a power of two from 64 to 1048576".to_owned())
}

/// `auto`, `open`, `closed`, `thickness=METRES` or `static=METRES`.
pub fn parse_interior(text: &str) -> Result<Interior, String> {
    match text.split_once('=') {
        None if text == "auto" => Ok(Interior::Auto),
        None if text == "open" => Ok(Interior::Open),
        None if text == "closed" => Ok(Interior::Closed),
        Some(("thickness", metres)) => parse_metres(metres).map(Interior::Thickness),
        Some(("static", metres)) => parse_metres(metres).map(Interior::Static),
        _ => Err("it must be auto, open, closed, thickness=METRES or static=METRES".to_owned()),
    }
}

/// What [`parse_interior`] reads as that policy.
#[must_use]
pub fn interior_argument(interior: Interior) -> String {
    match interior {
        Interior::Thickness(metres) | Interior::Static(metres) => format!("{}={metres}", interior.name()),
        Interior::Auto | Interior::Open | Interior::Closed => interior.name().to_owned(),
    }
}

/// A number of bytes: `K`, `M`, `G`, `T` and `KiB`, ... stand for powers of 1024, `KB`, ... for powers of 1000.
pub fn parse_size(text: &str) -> Result<u64, String> {
    let problem = || "it must be a number of bytes such as 512M, 1.5G or 1GiB".to_owned();
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = (text[..split].trim(), text[split..].to_ascii_uppercase());
    let (letter, base) = match unit.strip_suffix('B') {
        None => (unit.as_str(), 1024_f64),
        Some(unit) => unit.strip_suffix('I').map_or((unit, 1000.0), |letter| (letter, 1024.0)),
    };
    let power = ["", "K", "M", "G", "T"].iter().position(|known| *known == letter).ok_or_else(problem)?;
    let bytes = number.parse::<f64>().map_err(|_| problem())? * base.powi(power as i32);
    if bytes >= 1.0 && bytes < 2_f64.powi(63) { Ok(bytes as u64) } else { Err(problem()) }
}

/// `WxH`, in pixels.
pub fn parse_picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.filter(|sides| !sides.contains(&0)).ok_or_else(|| "it must be WIDTHxHEIGHT, such as 1280x720".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_it_should() {
        let towards = |text| DVec3::ZERO - parse_sun(text).expect(text).direction_world();
        assert_eq!(towards("0,0"), DVec3::NEG_Z);
        assert_eq!(towards("90,0"), DVec3::X);
        assert_eq!(towards("-90, 0"), DVec3::NEG_X);
        assert_eq!(towards("540,0"), DVec3::Z);
        assert_eq!(towards("123,90"), DVec3::Y);
        assert!((towards("45,30") - DVec3::new(0.612_372_4, 0.5, -0.612_372_4)).length() < 1e-6);
        for wrong in ["", "1", "1,2,3", "nan,0", "0,91", "x,y"] {
            assert!(parse_sun(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes() {
        let good = [
            ("4096", 4096),
            ("1k", 1024),
            ("512M", 512 << 20),
            ("1GiB", 1 << 30),
            ("1.5G", 3 << 29),
            ("2kb", 2000),
            ("7 B", 7),
        ];
        for (text, bytes) in good {
            assert_eq!(parse_size(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "G", "-1M", "1X", "1GG", "1Gi", "nan", "0", "1e30", "1BB", "é"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn values() {
        assert_eq!(parse_interior("thickness=0.5"), Ok(Interior::Thickness(0.5)));
        for policy in ["auto", "open", "closed", "thickness=0.5", "static=0.1"] {
            assert_eq!(parse_interior(policy).map(interior_argument).as_deref(), Ok(policy));
        }
        for wrong in ["", "solid", "thickness", "thickness=", "static=-1", "thickness=inf", "auto=1"] {
            assert!(parse_interior(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_bounds("0,0,0,1,2,3"), Ok([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]));
        assert!(parse_bounds("0,0,0,1,-2,3").is_err());
        assert_eq!(parse_picture_size("1280x720"), Ok([1280, 720]));
        assert!(["1280", "0x1", "ax2", "-1x2"].iter().all(|wrong| parse_picture_size(wrong).is_err()));
        assert!(["63", "65", "2097152", "-64", "64.0"].iter().all(|wrong| parse_resolution(wrong).is_err()));
    }
}
