//! What the user does, and what follows from it.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use antumbra::ShadowFile;
use antumbra_render::{RenderError, default_camera, look_at};
use antumbra_scene::{Camera, Scene};
use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

use crate::fly::Fly;
use crate::panel::{self, Facts, History, Wishes};
use crate::screen::{Painted, Screen};
use crate::script::{self, Step};
use crate::settings::Settings;
use crate::stage::Stage;
use crate::video;
use crate::{Closed, ViewError, ViewOptions};

/// Opens the window and runs until it is closed.
pub(crate) fn run(options: ViewOptions) -> Result<Closed, ViewError> {
    let events = EventLoop::new().map_err(|_| ViewError::NoDisplay)?;
    events.set_control_flow(ControlFlow::Poll);
    let mut app = App::new(options)?;
    events.run_app(&mut app).map_err(|error| ViewError::Window(error.to_string()))?;
    match app.failed {
        Some(error) => Err(error),
        None => Ok(Closed { passes: app.history.means(), ..app.clock.closed() }),
    }
}

struct App {
    size: [u32; 2],
    resolution: u32,
    /// What the stage is made of, until there is a window, and again when the card was lost.
    scene: Scene,
    bake: Option<ShadowFile>,
    settings: Settings,
    fly: Fly,
    shown: Option<(Screen, Stage)>,
    /// Steps that are left, the next one last.
    steps: Option<Vec<Step>>,
    is_dragging: bool,
    /// What is dragged is the area light.
    moves_light: bool,
    pointer: Option<[f64; 2]>,
    history: History,
    /// What to tell the user, and whether it is something that went wrong.
    message: Option<(String, bool)>,
    lights_per_pixel: f64,
    clock: Clock,
    wants_screenshot: bool,
    failed: Option<ViewError>,
}

/// Frames and their times.
struct Clock {
    last: Instant,
    frame_ms: f64,
    frames: usize,
    sum_ms: f64,
    metered: Instant,
}

impl Clock {
    fn new() -> Self {
        let now = Instant::now();
        Self { last: now, frame_ms: 0.0, frames: 0, sum_ms: 0.0, metered: now }
    }

    /// Seconds since the last frame.
    fn tick(&mut self) -> f64 {
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        self.frame_ms += (1e3 * seconds - self.frame_ms) * if self.frames == 0 { 1.0 } else { 0.1 };
        (self.frames, self.sum_ms) = (self.frames + 1, self.sum_ms + 1e3 * seconds);
        seconds
    }

    fn closed(&self) -> Closed {
        Closed { frames: self.frames, mean_ms: self.sum_ms / self.frames.max(1) as f64, passes: Vec::new() }
    }
}

/// Seconds between looks at the exposure, which wait for the card.
const METER_SECONDS: f64 = 0.5;

impl App {
    fn new(options: ViewOptions) -> Result<Self, ViewError> {
        let ViewOptions { scene, bake, resolution, size, script } = options;
        Ok(Self {
            size,
            resolution,
            settings: Settings::new(&scene),
            fly: Fly::new(first_camera(&scene)?, scene.bounds(|_| true).diagonal()),
            scene,
            bake,
            shown: None,
            steps: script.map(|script| script.steps.into_iter().rev().collect()),
            is_dragging: false,
            moves_light: false,
            pointer: None,
            history: History::default(),
            message: None,
            lights_per_pixel: 0.0,
            clock: Clock::new(),
            wants_screenshot: false,
            failed: None,
        })
    }

    /// Makes the window, unless it is there, and brings the scene to the card.
    fn open(&mut self, events: &ActiveEventLoop, window: Option<Arc<Window>>) -> Result<(), ViewError> {
        let window = match window {
            Some(window) => window,
            None => {
                let [width, height] = self.size;
                let attributes = Window::default_attributes()
                    .with_title(format!("Antumbra: {}", self.scene.name))
                    .with_inner_size(PhysicalSize::new(width, height));
                let made = events.create_window(attributes);
                Arc::new(made.map_err(|error| ViewError::Window(error.to_string()))?)
            }
        };
        let screen = Screen::new(window)?;
        let stage = Stage::new(&screen.gpu, self.scene.clone(), self.bake.clone(), self.resolution, &self.settings)?;
        self.shown = Some((screen, stage));
        Ok(())
    }

    /// Draws one frame, and does what the script says.
    fn frame(&mut self, events: &ActiveEventLoop) -> Result<(), ViewError> {
        let Some((mut screen, mut stage)) = self.shown.take() else { return Ok(()) };
        if screen.gpu.is_lost() {
            // Everything on the card is gone: opened again, from what is here.
            self.bake = stage.bake.as_ref().map(|(file, _)| ShadowFile::clone(file));
            return self.open(events, Some(screen.window));
        }
        let seconds = self.clock.tick();
        if let Err(reason) = stage.swap_in() {
            self.fail(ViewError::Bake(reason))?;
        }
        let mut shot = self.play(events, &stage)?;
        if self.steps.is_none() {
            self.settings.video_s += seconds;
            self.fly.advance(seconds.min(0.2));
        }
        match stage.frame(&self.fly.camera, screen.size(), &self.settings) {
            Ok(()) => {}
            // A bake of another scene.
            Err(error @ RenderError::LightNotInFile { .. }) => {
                stage.bake = None;
                self.fail(error.into())?;
            }
            Err(error) => return Err(error.into()),
        }
        self.measure(&mut stage, shot.is_some())?;
        if shot.is_some() {
            // As bright as suits what the picture shows.
            stage.frame(&self.fly.camera, screen.size(), &self.settings)?;
        }
        let (painted, wishes) = self.paint(&mut screen, &stage);
        if wishes.screenshot || std::mem::take(&mut self.wants_screenshot) {
            shot = Some(free_name());
        }
        if let Some(camera) = wishes.camera.and_then(|i| self.scene.cameras.get(i)) {
            self.fly.camera = camera.clone();
        }
        if let Some(path) = shot {
            screen.screenshot(&mut stage.renderer, painted, &path)?;
            self.message = Some((format!("saved {}", path.display()), false));
        } else {
            screen.present(&mut stage.renderer, painted);
        }
        self.shown = Some((screen, stage));
        Ok(())
    }

    /// In a script what fails ends it; a user is told.
    fn fail(&mut self, error: ViewError) -> Result<(), ViewError> {
        if self.steps.is_some() {
            return Err(error);
        }
        self.message = Some((error.to_string(), true));
        Ok(())
    }

    /// Takes the script's steps up to the next frame or screenshot, whose path it gives.
    fn play(&mut self, events: &ActiveEventLoop, stage: &Stage) -> Result<Option<PathBuf>, ViewError> {
        let Some(steps) = &mut self.steps else { return Ok(None) };
        loop {
            match steps.pop() {
                None => {
                    events.exit();
                    return Ok(None);
                }
                Some(Step::WaitBake) if stage.rebuild.state().is_some() => {
                    steps.push(Step::WaitBake);
                    return Ok(None);
                }
                Some(Step::WaitBake) => {}
                Some(Step::Set(key, value)) => {
                    // It was tried out when the script was read.
                    script::set(&mut self.settings, &key, &value)
                        .map_err(|reason| ViewError::Script { line: 0, reason })?;
                }
                Some(Step::Frame { eye, target }) => {
                    self.fly.camera = look_at(eye, target, self.fly.camera.fov_y)?;
                    return Ok(None);
                }
                Some(Step::Screenshot(path)) => return Ok(Some(path)),
            }
        }
    }

    /// Reads the card's clocks, and now and then what exposure suits the picture.
    fn measure(&mut self, stage: &mut Stage, at_once: bool) -> Result<(), ViewError> {
        let times = stage.renderer.times()?;
        let has_lamps = times.iter().any(|time| time.name == "lamps");
        self.history.add(times);
        let first = self.clock.frames <= 2;
        if at_once || first || self.clock.metered.elapsed().as_secs_f64() > METER_SECONDS {
            stage.expose(if at_once || first { 1.0 } else { 0.4 })?;
            let counts = if has_lamps { stage.renderer.lamps_per_pixel()? } else { Vec::new() };
            let sum: f64 = counts.iter().map(|count| f64::from(*count)).sum();
            self.lights_per_pixel = sum / counts.len().max(1) as f64;
            self.clock.metered = Instant::now();
        }
        Ok(())
    }

    fn paint(&mut self, screen: &mut Screen, stage: &Stage) -> (Painted, Wishes) {
        let state = stage.rebuild.state();
        let card = screen.gpu.name();
        let bake = stage.bake.as_ref().map(|(file, _)| file);
        let facts = Facts {
            scene: &self.scene.name,
            triangles: self.scene.triangle_count(),
            lights: self.scene.lights.len(),
            bake_bytes: bake.map(|_| stage.renderer.baked_bytes()),
            has_levels: bake.is_some_and(|file| file.has_levels()),
            has_enters: bake.is_some_and(|file| file.has_enter_depths()),
            card: &card,
            state: state.as_deref(),
            message: self.message.as_ref().map(|(words, is_bad)| (&words[..], *is_bad)),
            cameras: &self.scene.cameras,
            lights_per_pixel: self.lights_per_pixel,
            frame_ms: self.clock.frame_ms,
            speed: self.fly.speed,
        };
        let input = screen.input.take_egui_input(&screen.window);
        let mut wishes = Wishes::default();
        let (settings, history) = (&mut self.settings, &self.history);
        let output = screen.context.run_ui(input, |ui| wishes = panel::show(ui, settings, &facts, history));
        screen.input.handle_platform_output(&screen.window, output.platform_output.clone());
        (Painted { output }, wishes)
    }

    /// Opens a file that was dropped on the window.
    fn drop_file(&mut self, path: &Path) -> Result<(), String> {
        let Some((screen, stage)) = &mut self.shown else { return Ok(()) };
        if path.extension().is_some_and(|extension| extension == "antumbra") {
            let bytes = std::fs::read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
            stage.take_bake(ShadowFile::from_bytes(&bytes).map_err(|error| format!("{}: {error}", path.display()))?);
            return Ok(());
        }
        let is_picture = |extension: &OsStr| ["png", "jpg", "jpeg", "webp"].iter().any(|known| extension == *known);
        if path.is_dir() || path.extension().is_some_and(is_picture) {
            self.settings.area.lights[0].frames = video::frames(path)?;
            self.settings.area.is_on = true;
            return Ok(());
        }
        let scene = antumbra_scene::load(path).map_err(|error| error.to_string())?;
        let camera = first_camera(&scene).map_err(|error| error.to_string())?;
        let Settings { sun_deg, area, .. } = Settings::new(&scene);
        let settings = Settings { sun_deg, area, ..self.settings.clone() };
        let opened = Stage::new(&screen.gpu, scene.clone(), None, self.resolution, &settings);
        *stage = opened.map_err(|error| error.to_string())?;
        screen.window.set_title(&format!("Antumbra: {}", scene.name));
        self.fly = Fly::new(camera, scene.bounds(|_| true).diagonal());
        (self.settings, self.scene, self.bake) = (settings, scene, None);
        Ok(())
    }

    /// What the mouse and the keys do outside the panel.
    fn act(&mut self, event: &WindowEvent, over_panel: bool) {
        match event {
            WindowEvent::KeyboardInput { event, .. } => {
                let PhysicalKey::Code(key) = event.physical_key else { return };
                let is_down = event.state == ElementState::Pressed;
                self.wants_screenshot |= key == KeyCode::F12 && is_down && !event.repeat;
                self.fly.key(key, is_down);
            }
            WindowEvent::MouseInput { state, button: button @ (MouseButton::Left | MouseButton::Right), .. } => {
                let is_down = *state == ElementState::Pressed && !over_panel;
                let moves_light = *button == MouseButton::Right && self.settings.area.is_on;
                (self.is_dragging, self.moves_light) = (is_down, is_down && moves_light);
            }
            WindowEvent::CursorMoved { position, .. } => {
                let here = [position.x, position.y];
                if let Some(before) = self.pointer.replace(here).filter(|_| self.is_dragging) {
                    let [right, down] = [here[0] - before[0], here[1] - before[1]];
                    if self.moves_light {
                        self.move_light(DVec2::new(right, down), 0.0);
                    } else {
                        self.fly.drag(right, down);
                    }
                }
            }
            WindowEvent::MouseWheel { delta, .. } if !over_panel => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / 40.0,
                };
                if self.moves_light {
                    self.move_light(DVec2::ZERO, steps);
                } else {
                    self.fly.scroll(steps);
                }
            }
            WindowEvent::Focused(false) => self.fly.let_go(),
            _ => {}
        }
    }

    fn move_light(&mut self, pixels: DVec2, steps: f64) {
        let height = self.shown.as_ref().map_or(1, |(screen, _)| screen.size()[1]);
        self.settings.area.drag(&self.fly.camera, height, pixels, steps);
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.shown.is_none()
            && let Err(error) = self.open(events, None)
        {
            self.failed = Some(error);
            events.exit();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some((screen, _)) = &mut self.shown else { return };
        let taken = screen.input.on_window_event(&screen.window, &event).consumed;
        let over_panel = taken || screen.context.egui_wants_pointer_input();
        match &event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => screen.resize(size.width, size.height),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.frame(events) {
                    self.failed = Some(error);
                    events.exit();
                }
            }
            WindowEvent::DroppedFile(path) => self.message = self.drop_file(path).err().map(|words| (words, true)),
            _ => self.act(&event, over_panel),
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some((screen, _)) = &self.shown {
            screen.window.request_redraw();
        }
    }
}

/// Where a scene is seen first.
fn first_camera(scene: &Scene) -> Result<Camera, RenderError> {
    scene.cameras.first().map_or_else(|| default_camera(scene), |camera| Ok(camera.clone()))
}

/// The first of `antumbra-0001.png`, `antumbra-0002.png`, ... that is not there.
fn free_name() -> PathBuf {
    let name = |i: u32| PathBuf::from(format!("antumbra-{i:04}.png"));
    (1..).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(0))
}
