//! Curves over resolution, as SVG with SVG's own text.

use std::ops::Range;

use anyhow::{Result, anyhow};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

/// A file to be.
pub struct Plot {
    pub file_name: String,
    pub svg: String,
}

/// A curve's name, and its points: resolution and value.
pub struct Curve {
    pub name: &'static str,
    pub points: Vec<(f64, f64)>,
}

const SIZE: (u32, u32) = (640, 400);
/// Room for the curves' names beside them.
const RIGHT_MARGIN: u32 = 140;
/// Least distance of two names, pixels.
const NAME_DISTANCE: i32 = 16;
/// One colour per curve; they differ in lightness, too.
const COLORS: [RGBColor; 3] = [RGBColor(120, 120, 120), RGBColor(213, 94, 0), RGBColor(0, 90, 160)];
const INK: RGBColor = RGBColor(40, 40, 40);

/// One axis, from its first tick to its last.
struct Axis {
    name: &'static str,
    ticks: Vec<f64>,
    /// What a tick says.
    label: fn(&f64) -> String,
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, pixels: (i32, i32)) -> i32 {
        let range = self.range();
        let share = (value - range.start) / (range.end - range.start);
        pixels.0 + (share * f64::from(pixels.1 - pixels.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        let (first, last) = (self.ticks.first().copied().unwrap_or(0.0), self.ticks.last().copied().unwrap_or(1.0));
        // A single resolution is a range, too.
        first..if last > first { last } else { first + 1.0 }
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        (self.label)(value)
    }
}

impl Plot {
    /// Bytes over resolution, both axes logarithmic.
    pub fn bytes(scene: &str, curves: &[Curve]) -> Result<Self> {
        let logs = |curve: &Curve| Curve {
            name: curve.name,
            points: curve.points.iter().map(|(n, bytes)| (n.log2(), bytes.max(1.0).log2())).collect(),
        };
        let curves: Vec<Curve> = curves.iter().map(logs).collect();
        let values = || curves.iter().flat_map(|curve| &curve.points).map(|p| p.1);
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        // A tick at every factor of 16.
        let ticks = (least / 4.0).floor() as u32..=(most / 4.0).ceil() as u32;
        let y = Axis { name: "bytes", ticks: ticks.map(|t| f64::from(4 * t)).collect(), label: byte_label };
        let title = format!("{scene}: bytes over resolution");
        Ok(Self { file_name: file_name(scene, "bytes"), svg: draw(&title, &curves, resolution_axis(&curves), y)? })
    }

    /// Growth per doubling of the resolution.
    pub fn growth(scene: &str, curves: &[Curve]) -> Result<Self> {
        let logs = |curve: &Curve| Curve {
            name: curve.name,
            points: curve.points.iter().map(|(n, growth)| (n.log2(), *growth)).collect(),
        };
        let curves: Vec<Curve> = curves.iter().map(logs).collect();
        let most = curves.iter().flat_map(|curve| &curve.points).map(|p| p.1).fold(4.0, f64::max);
        let ticks = (0..=(2.0 * most).ceil() as u32 + 1).map(|t| 0.5 * f64::from(t)).skip(2).collect();
        let y = Axis { name: "bytes(N) / bytes(N/2)", ticks, label: |growth| format!("{growth:.1}") };
        let title = format!("{scene}: growth per doubling of the resolution");
        Ok(Self { file_name: file_name(scene, "growth"), svg: draw(&title, &curves, resolution_axis(&curves), y)? })
    }
}

fn resolution_axis(curves: &[Curve]) -> Axis {
    let mut ticks: Vec<f64> = curves.iter().flat_map(|curve| &curve.points).map(|p| p.0).collect();
    ticks.sort_by(f64::total_cmp);
    ticks.dedup();
    Axis { name: "N, texels per side and slices", ticks, label: resolution_label }
}

fn resolution_label(log2: &f64) -> String {
    let n = log2.exp2().round();
    if n >= 1024.0 { format!("{}K", n / 1024.0) } else { format!("{n}") }
}

fn byte_label(log2: &f64) -> String {
    let bytes = log2.exp2();
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
    match units.into_iter().find(|(power, _)| *log2 >= f64::from(*power)) {
        Some((power, unit)) => format!("{} {unit}", bytes / f64::from(1u32 << power)),
        None => format!("{bytes} B"),
    }
}

/// Safe as a file's name, whatever the scene is called.
fn file_name(scene: &str, what: &str) -> String {
    let safe: String = scene.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    format!("ablations-{safe}-{what}.svg")
}

fn draw(title: &str, curves: &[Curve], x: Axis, y: Axis) -> Result<String> {
    let mut svg = String::new();
    draw_into(&mut svg, title, curves, x, y).map_err(|e| anyhow!("cannot draw \"{title}\": {e}"))?;
    Ok(svg)
}

type Drawn = Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

fn draw_into(svg: &mut String, title: &str, curves: &[Curve], x: Axis, y: Axis) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let font = |size: u32| ("sans-serif", size).into_font().color(&INK);
    let (x_name, y_name) = (x.name, y.name);
    let mut chart = ChartBuilder::on(&root)
        .caption(title, font(20))
        .margin(12)
        .margin_right(RIGHT_MARGIN)
        .x_label_area_size(44)
        .y_label_area_size(78)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .bold_line_style(RGBColor(225, 225, 225))
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style(font(14))
        .x_desc(x_name)
        .y_desc(y_name)
        .draw()?;
    let mut names = Vec::new();
    for (curve, color) in curves.iter().zip(COLORS) {
        chart.draw_series(LineSeries::new(curve.points.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(curve.points.iter().map(|p| Circle::new(*p, 3, color.filled())))?;
        if let Some(last) = curve.points.last() {
            names.push((chart.backend_coord(last), curve.name, color));
        }
    }
    names.sort_by_key(|(at, ..)| at.1);
    let mut free_from = i32::MIN;
    for ((x, y), name, color) in names {
        let y = (y - 8).max(free_from);
        free_from = y + NAME_DISTANCE;
        root.draw(&Text::new(name, (x + 10, y), ("sans-serif", 16).into_font().color(&color)))?;
    }
    root.present()
}
