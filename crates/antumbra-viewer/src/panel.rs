//! The panel over the picture: choices, figures and plots.

use std::collections::VecDeque;

use antumbra::Kernel;
use antumbra_render::area::{Airlight, AreaTechnique, Gathering, Interpolation};
use antumbra_render::gpu::PassTime;
use antumbra_render::{MapProjection, Time};
use antumbra_scene::Camera;
use egui::{Color32, ComboBox, DragValue, Panel, Pos2, Sense, Slider, Stroke, Ui, Vec2};

use crate::area::Area;
use crate::lamps::{CULLINGS, Lamps};
use crate::settings::{Averaging, Settings, Technique};

/// What the panel shows beside the choices.
pub(crate) struct Facts<'a> {
    pub scene: &'a str,
    pub triangles: u64,
    pub lights: usize,
    pub bake_bytes: Option<u64>,
    pub has_levels: bool,
    pub has_enters: bool,
    pub card: &'a str,
    /// What goes on in the background.
    pub state: Option<&'a str>,
    /// What to tell the user, and whether it is something that went wrong.
    pub message: Option<(&'a str, bool)>,
    pub cameras: &'a [Camera],
    pub lights_per_pixel: f64,
    pub frame_ms: f64,
    pub speed: f64,
}

/// What the user wants besides other settings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wishes {
    pub screenshot: bool,
    /// A camera of the scene.
    pub camera: Option<usize>,
}

/// Times of the last frames' passes.
#[derive(Default)]
pub(crate) struct History {
    frames: VecDeque<Vec<PassTime>>,
}

/// Frames in the plot.
const KEPT: usize = 120;

impl History {
    pub fn add(&mut self, times: Vec<PassTime>) {
        self.frames.push_back(times);
        if self.frames.len() > KEPT {
            self.frames.pop_front();
        }
    }

    /// Passes in the last frame's order.
    fn names(&self) -> Vec<&'static str> {
        self.frames.back().map_or(Vec::new(), |times| times.iter().map(|time| time.name).collect())
    }

    fn ms(frame: &[PassTime], name: &str) -> f64 {
        frame.iter().filter(|time| time.name == name).map(|time| time.ms).sum()
    }

    /// Mean times of passes.
    pub fn means(&self) -> Vec<PassTime> {
        self.names().into_iter().map(|name| PassTime { name, ms: self.mean_ms(name) }).collect()
    }

    fn mean_ms(&self, name: &str) -> f64 {
        let sum: f64 = self.frames.iter().map(|frame| Self::ms(frame, name)).sum();
        sum / self.frames.len().max(1) as f64
    }
}

/// Draws the panel and changes the settings.
pub(crate) fn show(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>, history: &History) -> Wishes {
    let mut wishes = Wishes::default();
    Panel::left("panel").default_size(270.0).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            ui.heading(facts.scene);
            ui.label(format!("{} triangles, {} lights", facts.triangles, facts.lights));
            if let Some(state) = facts.state {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label(state);
                });
            }
            match facts.message {
                Some((message, true)) => drop(ui.colored_label(Color32::from_rgb(240, 120, 90), message)),
                Some((message, false)) => drop(ui.label(message)),
                None => {}
            }
            ui.separator();
            shadows(ui, settings, facts);
            ui.separator();
            light(ui, settings);
            ui.separator();
            lamps(ui, &mut settings.lamps);
            ui.separator();
            area_light(ui, &mut settings.area);
            ui.separator();
            cameras(ui, facts, &mut wishes);
            ui.separator();
            figures(ui, facts, history);
        });
    });
    wishes
}

/// A choice of one from a few.
fn choose<T: PartialEq + Copy>(ui: &mut Ui, label: &str, value: &mut T, all: &[(T, &str)]) {
    let name = all.iter().find(|(one, _)| one == value).map_or("", |(_, name)| name);
    ComboBox::from_label(label).selected_text(name).show_ui(ui, |ui| {
        for (one, name) in all {
            ui.selectable_value(value, *one, *name);
        }
    });
}

fn shadows(ui: &mut Ui, settings: &mut Settings, facts: &Facts<'_>) {
    let techniques = [(Technique::Baked, "baked"), (Technique::Maps, "shadow maps"), (Technique::None, "none")];
    choose(ui, "shadows", &mut settings.technique, &techniques);
    let mut radius = settings.taps / 2;
    ui.add(Slider::new(&mut radius, 0..=8).text("filter").custom_formatter(|r, _| format!("{0} x {0}", 2.0 * r + 1.0)));
    settings.taps = 2 * radius + 1;
    let kernels = [(Kernel::Box, "box"), (Kernel::Tent, "tent"), (Kernel::Continuous, "continuous (no taps)")];
    choose(ui, "kernel", &mut settings.kernel, &kernels);
    match settings.technique {
        Technique::Baked => {
            let mut ways = vec![(Averaging::None, "none"), (Averaging::Mean, "mean of the footprint")];
            ways.extend(facts.has_levels.then_some((Averaging::Levels, "coarse levels")));
            choose(ui, "prefilter", &mut settings.averaging, &ways);
            if facts.has_enters {
                ui.add(Slider::new(&mut settings.penumbra_deg, 0.0..=5.0).text("sun's width, degrees"));
            }
            ui.checkbox(&mut settings.has_top_grid, "top grid");
        }
        Technique::Maps => {
            ui.add(Slider::new(&mut settings.cascades, 1..=8).text("maps"));
        }
        Technique::None => {}
    }
    ui.checkbox(&mut settings.is_clustered, "clustered lists of lamps");
}

fn light(ui: &mut Ui, settings: &mut Settings) {
    choose(
        ui,
        "time",
        &mut settings.time,
        &[(None, "as suits"), (Some(Time::Day), "day"), (Some(Time::Night), "night")],
    );
    ui.add(Slider::new(&mut settings.sun_deg[0], 0.0..=360.0).text("sun's azimuth"));
    ui.add(Slider::new(&mut settings.sun_deg[1], 2.0..=90.0).text("elevation"));
    ui.add(Slider::new(&mut settings.exposure_stops, -4.0..=4.0).text("exposure"));
    ui.add(Slider::new(&mut settings.fog_per_m, 0.0..=0.3).logarithmic(true).smallest_positive(1e-5).text("fog"));
    ui.add(Slider::new(&mut settings.anisotropy, -0.9..=0.9).text("scatters forwards"));
    ui.checkbox(&mut settings.is_moving, "move what is dynamic");
    ui.add(Slider::new(&mut settings.samples, 1..=8).text("samples"));
}

/// Shadow maps of lamps that no bake holds, and over one of what moves; and light that surfaces send on.
fn lamps(ui: &mut Ui, lamps: &mut Lamps) {
    ui.checkbox(&mut lamps.is_on, "shadow maps of lamps");
    if lamps.is_on {
        let projections = [(MapProjection::Cube, "cubes"), (MapProjection::Paraboloid, "paraboloids")];
        choose(ui, "drawn as", &mut lamps.projection, &projections);
        let mut log2 = lamps.size.ilog2();
        ui.add(
            Slider::new(&mut log2, 6..=12)
                .text("texels at most")
                .custom_formatter(|log2, _| format!("{}", log2.exp2())),
        );
        lamps.size = 1 << log2;
        choose(ui, "culled by", &mut lamps.culling, &CULLINGS);
        ui.add(Slider::new(&mut lamps.grid, 8..=128).text("cells"));
    }
    ui.add(Slider::new(&mut lamps.virtual_lights, 0..=1024).text("virtual lights"));
}

/// A light to drag, resize, recolour and feed, and how its shadows are found.
fn area_light(ui: &mut Ui, area: &mut Area) {
    ui.checkbox(&mut area.is_on, "area light");
    if !area.is_on {
        return;
    }
    ui.label(
        "Drag it with the right button; scroll then for its distance. Drop a picture, or a folder of frames, to show.",
    );
    let (mut shape, size) = (area.shape_name(), area.size_m());
    let mut sides = size.to_array();
    choose(ui, "shape", &mut shape, &["rectangle", "disc", "sphere", "environment"].map(|name| (name, name)));
    ui.add(Slider::new(&mut sides[0], 0.01..=100.0).logarithmic(true).text("width, metres"));
    if shape == "rectangle" {
        ui.add(Slider::new(&mut sides[1], 0.01..=100.0).logarithmic(true).text("height, metres"));
    }
    if shape != area.shape_name() || sides != size.to_array() {
        // All names are known.
        let _ = area.reshape(shape, sides.into());
    }
    ui.horizontal(|ui| {
        for (axis, name) in area.light().position_world.as_mut().iter_mut().zip(["x ", "y ", "z "]) {
            ui.add(DragValue::new(axis).speed(0.02).prefix(name));
        }
    });
    let before = crate::settings::angles(area.light().direction_world);
    let mut turned = before;
    ui.add(Slider::new(&mut turned[0], 0.0..=360.0).text("shines towards, azimuth"));
    ui.add(Slider::new(&mut turned[1], -89.0..=89.0).text("elevation"));
    if turned != before {
        area.turn(turned);
    }
    let (mut luminance, color) = area.luminance();
    let mut rgb = color.to_array();
    ui.add(Slider::new(&mut luminance, 1.0..=1e6).logarithmic(true).text("candela per m²"));
    ui.horizontal(|ui| {
        ui.color_edit_button_rgb(&mut rgb);
        ui.label("colour");
    });
    area.light().luminance = rgb.map(|c| c * luminance);
    let techniques = [
        (AreaTechnique::Voxels, "voxels"),
        (AreaTechnique::OneByOne, "voxels, one by one"),
        (AreaTechnique::MarchedMaps, "marched maps"),
        (AreaTechnique::None, "none"),
    ];
    choose(ui, "its shadows", &mut area.technique, &techniques);
    ui.add(Slider::new(&mut area.vpls, 1..=1024).logarithmic(true).text("points of light"));
    for (samples, name) in [
        (&mut area.voxels.map, "maps"),
        (&mut area.voxels.alpha, "alpha"),
        (&mut area.voxels.theta, "theta"),
        (&mut area.voxels.phi, "phi"),
    ] {
        ui.add(Slider::new(samples, 32..=512).step_by(32.0).text(name));
    }
    let gatherings =
        [(Gathering::Full, "all"), (Gathering::Interleaved, "a ninth, shared"), (Gathering::Half, "half size")];
    choose(ui, "each pixel gathers", &mut area.gathering, &gatherings);
    choose(ui, "airlight", &mut area.airlight, &[(Airlight::Exact, "exact"), (Airlight::Average, "average")]);
    let ways = [
        (Interpolation::None, "none"),
        (Interpolation::Plain, "bit by bit"),
        (Interpolation::Fast, "four bits at once"),
    ];
    choose(ui, "interpolation", &mut area.interpolation, &ways);
}

fn cameras(ui: &mut Ui, facts: &Facts<'_>, wishes: &mut Wishes) {
    ui.horizontal_wrapped(|ui| {
        for (i, camera) in facts.cameras.iter().enumerate() {
            if ui.button(&camera.name).clicked() {
                wishes.camera = Some(i);
            }
        }
        wishes.screenshot = ui.button("screenshot (F12)").clicked();
    });
    ui.small(format!("W A S D Q E fly at {:.1} m/s (wheel), shift faster, drag to look", facts.speed));
}

fn figures(ui: &mut Ui, facts: &Facts<'_>, history: &History) {
    ui.label(format!("{:.1} ms a frame", facts.frame_ms));
    if let Some(bytes) = facts.bake_bytes {
        ui.label(format!("bake: {:.1} MB", bytes as f64 * 1e-6));
    }
    if facts.lights_per_pixel > 0.0 {
        ui.label(format!("{:.1} lamps per pixel", facts.lights_per_pixel));
    }
    plot(ui, history);
    for name in history.names() {
        ui.colored_label(color(name), format!("{name}: {:.2} ms", history.mean_ms(name)));
    }
    ui.small(facts.card);
}

/// A pass keeps its colour, whichever others there are.
fn color(name: &str) -> Color32 {
    const COLORS: [(&str, Color32); 16] = [
        ("raster", Color32::from_rgb(86, 180, 233)),
        ("resolve", Color32::from_rgb(0, 114, 178)),
        ("sun shadows", Color32::from_rgb(240, 228, 66)),
        ("shadow maps", Color32::from_rgb(230, 159, 0)),
        ("fog", Color32::from_rgb(180, 200, 220)),
        ("shading", Color32::from_rgb(213, 94, 0)),
        ("tile boxes", Color32::from_rgb(140, 140, 140)),
        ("light lists", Color32::from_rgb(204, 121, 167)),
        ("lamps", Color32::from_rgb(0, 200, 140)),
        ("bins", Color32::from_rgb(120, 94, 240)),
        ("source cells", Color32::from_rgb(150, 150, 220)),
        ("marks", Color32::from_rgb(100, 143, 255)),
        ("survivors", Color32::from_rgb(70, 110, 220)),
        ("lamp maps", Color32::from_rgb(255, 176, 0)),
        ("mapped lamps", Color32::from_rgb(0, 230, 170)),
        ("tone mapping", Color32::from_rgb(200, 200, 200)),
    ];
    COLORS.iter().find(|(known, _)| *known == name).map_or(Color32::WHITE, |(_, color)| *color)
}

/// One line for each pass, over the last frames.
fn plot(ui: &mut Ui, history: &History) {
    let (area, painter) = ui.allocate_painter(Vec2::new(ui.available_width(), 90.0), Sense::hover());
    let rect = area.rect;
    painter.rect_filled(rect, 2.0, Color32::from_black_alpha(90));
    let names = history.names();
    let most = history.frames.iter().flatten().map(|time| time.ms).fold(1e-3, f64::max);
    for name in names {
        let at = |(x, frame): (usize, &Vec<PassTime>)| {
            let share = (x as f32 / (KEPT - 1) as f32, (History::ms(frame, name) / most) as f32);
            Pos2::new(rect.left() + rect.width() * share.0, rect.bottom() - rect.height() * share.1)
        };
        let points: Vec<Pos2> = history.frames.iter().enumerate().map(at).collect();
        painter.line(points, Stroke::new(1.5, color(name)));
    }
    painter.text(
        rect.left_top() + Vec2::new(4.0, 2.0),
        egui::Align2::LEFT_TOP,
        format!("{most:.1} ms"),
        egui::FontId::proportional(10.0),
        Color32::GRAY,
    );
}
