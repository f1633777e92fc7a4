//! Curves as SVG with SVG's own text: panels side by side, each curve named at its end.

use std::ops::Range;

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

/// A file to be.
pub struct Plot {
    pub file_name: String,
    pub svg: String,
}

/// A curve's name, colour and points.
#[derive(Clone)]
pub struct Curve {
    /// May be empty, where a panel has one curve.
    pub name: &'static str,
    pub color: RGBColor,
    pub points: Vec<(f64, f64)>,
}

/// A coordinate system with its curves.
pub struct Panel {
    pub title: String,
    pub curves: Vec<Curve>,
    pub x: Axis,
    pub y: Axis,
}

/// Colours of curves; they differ in lightness, too.
pub const GREY: RGBColor = RGBColor(120, 120, 120);
pub const ORANGE: RGBColor = RGBColor(213, 94, 0);
pub const AMBER: RGBColor = RGBColor(225, 160, 30);
pub const BLUE: RGBColor = RGBColor(0, 90, 160);
pub const GREEN: RGBColor = RGBColor(90, 160, 110);

/// Of a panel, pixels.
const SIZE: (u32, u32) = (640, 400);
const MARGIN: u32 = 12;
/// Least distance of two names, pixels.
const NAME_DISTANCE: i32 = 16;
/// A letter of a name is so wide, pixels.
const LETTER_WIDTH: u32 = 8;
/// Curves of more points than these are drawn without dots.
const MOST_DOTS: usize = 24;
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

/// One axis.
#[derive(Clone)]
pub struct Axis {
    name: &'static str,
    range: Range<f64>,
    ticks: Vec<f64>,
    is_logarithmic: bool,
    /// What a tick says.
    label: fn(&f64) -> String,
}

/// A logarithmic axis of 1, 2, 5, 10, 20, ... has no more ticks than these.
const MOST_TICKS: usize = 10;

impl Axis {
    /// From the first tick to the last.
    fn of_ticks(name: &'static str, ticks: Vec<f64>, is_logarithmic: bool, label: fn(&f64) -> String) -> Self {
        let range = ticks.first().copied().unwrap_or(1.0)..ticks.last().copied().unwrap_or(1.0);
        Self { name, range, ticks, is_logarithmic, label }
    }

    /// Resolutions that curves have points at.
    pub fn resolutions(curves: &[&Curve]) -> Self {
        let mut ticks: Vec<f64> = curves.iter().flat_map(|curve| &curve.points).map(|p| p.0).collect();
        ticks.sort_by(f64::total_cmp);
        ticks.dedup();
        Self::of_ticks("N, texels per side and slices", ticks, true, resolution_label)
    }

    /// Bytes, logarithmically: a tick at every factor of 16, or of less where that makes too few.
    pub fn bytes(name: &'static str, curves: &[&Curve]) -> Self {
        let (least, most) = extent(curves);
        let ticks = |step: f64| around(least.max(1.0).log2(), most.max(1.0).log2(), step);
        let logs = [4.0, 2.0].map(ticks).into_iter().find(|ticks| ticks.len() > 3).unwrap_or_else(|| ticks(1.0));
        Self::of_ticks(name, logs.into_iter().map(f64::exp2).collect(), true, byte_label)
    }

    /// Logarithmically, with ticks at 1, 2, 5, 10, or at powers of ten where those are too many.
    pub fn logarithmic(name: &'static str, curves: &[&Curve]) -> Self {
        let (least, most) = extent(curves);
        let tens = around(least.max(1e-6).log10(), most.max(1e-6).log10(), 1.0);
        let steps: Vec<f64> = tens.iter().map(|log| 10_f64.powf(*log)).flat_map(|t| [t, 2.0 * t, 5.0 * t]).collect();
        let first = steps.iter().rposition(|step| *step <= least).unwrap_or(0);
        let last = steps.iter().position(|step| *step >= most).unwrap_or(steps.len() - 1).max(first + 1);
        let axis = Self::of_ticks(name, steps[first..=last].to_vec(), true, plain_label);
        if axis.ticks.len() <= MOST_TICKS {
            return axis;
        }
        let (from, to) = (axis.range.start, axis.range.end);
        let ticks = steps.into_iter().step_by(3).filter(|ten| (from..=to).contains(ten)).collect();
        Self { ticks, ..axis }
    }

    /// Ranks, from none to so many.
    pub fn ranks(name: &'static str, count: usize) -> Self {
        let most = count.max(1) as f64;
        let ten = 10_f64.powf((most / 8.0).log10().floor()).max(1.0);
        let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * ten);
        let step = steps.into_iter().find(|step| most / step <= 8.0).unwrap_or(steps[3]);
        let ticks = around(0.0, most, step).into_iter().filter(|tick| *tick <= most).collect();
        Self { name, range: 0.0..most, ticks, is_logarithmic: false, label: plain_label }
    }

    /// Growth per doubling, from 1 to beyond the greatest.
    pub fn growth(curves: &[&Curve]) -> Self {
        let most = extent(curves).1.max(4.0);
        let ticks = (0..=(2.0 * most).ceil() as u32 + 1).map(|t| 0.5 * f64::from(t)).skip(2).collect();
        Self::of_ticks("bytes(N) / bytes(N/2)", ticks, false, |growth| format!("{growth:.1}"))
    }

    fn place(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.log2() } else { value }
    }
}

/// Least and greatest value of curves, of those above zero.
fn extent(curves: &[&Curve]) -> (f64, f64) {
    let values = || curves.iter().flat_map(|curve| &curve.points).map(|p| p.1).filter(|value| *value > 0.0);
    if values().next().is_none() {
        return (1.0, 1.0);
    }
    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
}

/// Multiples of a step, from the last that is not above `least` to the first that is not below `most`; two at least.
fn around(least: f64, most: f64, step: f64) -> Vec<f64> {
    let first = (least / step).floor() as i64;
    let last = ((most / step).ceil() as i64).max(first + 1);
    (first..=last).map(|i| i as f64 * step).collect()
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, pixels: (i32, i32)) -> i32 {
        let range = self.range();
        let (first, last) = (self.place(range.start), self.place(range.end));
        // What has no logarithm lies on the edge, and a lone tick in the middle.
        let value = value.max(range.start);
        let share = if last > first { (self.place(value) - first) / (last - first) } else { 0.5 };
        pixels.0 + (share * f64::from(pixels.1 - pixels.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        (self.label)(value)
    }
}

fn resolution_label(n: &f64) -> String {
    if *n >= 1024.0 { format!("{}K", n / 1024.0) } else { format!("{n}") }
}

fn byte_label(bytes: &f64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
    match units.into_iter().map(|(power, unit)| (f64::from(1u32 << power), unit)).find(|(size, _)| bytes >= size) {
        Some((size, unit)) => format!("{} {unit}", bytes / size),
        None => format!("{bytes} B"),
    }
}

/// Without the digits that come of binary fractions.
fn plain_label(value: &f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

/// A plot's file; safe as a name, whatever the scene is called.
pub fn file_name(table: &str, scene: &str, what: &str) -> String {
    let safe: String = scene.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    format!("{table}-{safe}-{what}.svg")
}

impl Plot {
    /// Draws panels side by side.
    pub fn new(file_name: String, panels: &[Panel]) -> Result<Self> {
        let mut svg = String::new();
        draw_into(&mut svg, panels).map_err(|e| anyhow!("cannot draw {file_name}: {e}"))?;
        Ok(Self { file_name, svg })
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

fn draw_into(svg: &mut String, panels: &[Panel]) -> Drawn {
    let root = SVGBackend::with_string(svg, (SIZE.0 * panels.len() as u32, SIZE.1)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((1, panels.len()));
    areas.iter().zip(panels).try_for_each(|(area, panel)| draw_panel(area, panel))?;
    root.present()
}

fn draw_panel(area: &Area<'_>, panel: &Panel) -> Drawn {
    let font = |size: u32| ("sans-serif", size).into_font().color(&INK);
    let letters = panel.curves.iter().map(|curve| curve.name.chars().count() as u32).max().unwrap_or(0);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, font(20))
        .margin(MARGIN)
        // Room for the curves' names beside them.
        .margin_right(MARGIN.max(LETTER_WIDTH * letters + 4) + MARGIN / 2)
        .x_label_area_size(44)
        .y_label_area_size(78)
        .build_cartesian_2d(panel.x.clone(), panel.y.clone())?;
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style(font(14))
        .x_desc(panel.x.name)
        .y_desc(panel.y.name)
        .draw()?;
    let mut names = Vec::new();
    for Curve { name, color, points } in &panel.curves {
        chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?;
        if points.len() <= MOST_DOTS {
            chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, color.filled())))?;
        }
        if let Some(last) = points.last().filter(|_| !name.is_empty()) {
            names.push((chart.backend_coord(last).1, *name, *color));
        }
    }
    let (left, top) = area.get_base_pixel();
    let end = chart.plotting_area().get_x_axis_pixel_range().end;
    draw_names(area, end - left + 10, names.into_iter().map(|(y, name, color)| (y - top - 8, name, color)).collect())
}

/// Names beside the panel, as high as their curves end; where two would touch, the lower one gives way.
fn draw_names(area: &Area<'_>, x: i32, mut names: Vec<(i32, &str, RGBColor)>) -> Drawn {
    names.sort_by_key(|(y, ..)| *y);
    let mut free_from = i32::MIN;
    for (y, name, color) in names {
        let y = y.max(free_from);
        free_from = y + NAME_DISTANCE;
        area.draw(&Text::new(name, (x, y), ("sans-serif", 16).into_font().color(&color)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Curve {
        Curve { name: "ours", color: BLUE, points: points.to_vec() }
    }

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks.iter().map(axis.label).collect()
    }

    #[test]
    fn ticks_go_around_what_is_shown() {
        let logarithmic = |least, most| Axis::logarithmic("seconds", &[&curve(&[(512.0, least), (1024.0, most)])]);
        assert_eq!(labels(&logarithmic(0.3, 0.7)), ["0.2", "0.5", "1"]);
        assert_eq!(labels(&logarithmic(0.3, 0.3)), ["0.2", "0.5"]);
        let wide = logarithmic(0.003, 42.0);
        assert_eq!(
            (labels(&wide), wide.range()),
            (["0.01", "0.1", "1", "10"].map(str::to_owned).to_vec(), 0.002..50.0)
        );
        let bytes = Axis::bytes("bytes", &[&curve(&[(1.0, 3e6), (2.0, 5e6)])]);
        assert_eq!(labels(&bytes), ["2 MiB", "4 MiB", "8 MiB"]);
        let ranks = Axis::ranks("lights", 165);
        assert_eq!((labels(&ranks).last().map(String::as_str), ranks.range()), (Some("150"), 0.0..165.0));
        assert_eq!(labels(&Axis::ranks("lights", 2)), ["0", "1", "2"]);
    }

    #[test]
    fn a_single_point_zero_and_none_are_drawn() {
        for curves in [vec![curve(&[(512.0, 1.0)])], vec![curve(&[(512.0, 0.0)])], vec![]] {
            let all: Vec<&Curve> = curves.iter().collect();
            let (x, y) = (Axis::resolutions(&all), Axis::logarithmic("seconds", &all));
            let panel = Panel { title: "t".to_owned(), curves, x, y };
            let plot = Plot::new(file_name("table", "a/b", "seconds"), &[panel]).expect("a plot");
            assert_eq!(plot.file_name, "table-a-b-seconds.svg");
            assert!(plot.svg.starts_with("<svg") && !plot.svg.contains("NaN") && !plot.svg.contains("inf"));
        }
    }
}
