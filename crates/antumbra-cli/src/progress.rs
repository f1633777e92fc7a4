//! Progress on a terminal's stderr: the stage, its percentage or rate, and the time left. Silent anywhere else.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of a bar that shows a share.
const SHARE_STEPS: u64 = 10_000;

/// A line of progress; it vanishes when dropped.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Shows itself only on a terminal, and never when asked to be quiet.
    #[must_use]
    pub fn new(quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::new(SHARE_STEPS);
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar }
    }

    /// A stage of unknown length begins.
    pub fn stage(&self, name: &str) {
        self.begin(name, SHARE_STEPS, "{spinner} {msg} ({elapsed})");
    }

    /// A stage of so many things begins; `unit` is their plural.
    pub fn count(&self, name: &str, things: u64, unit: &str) {
        let shape = format!("{{spinner}} {{msg}} {{wide_bar}} {{percent}} % {{per_sec}} {unit}, {{eta}} left");
        self.begin(name, things, &shape);
    }

    /// So many more of the stage's things are done.
    pub fn add(&self, things: u64) {
        self.bar.inc(things);
    }

    /// So many of the stage's things are done, of so many.
    pub fn set(&self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
    }

    fn begin(&self, name: &str, length: u64, shape: &str) {
        if self.bar.is_hidden() {
            return;
        }
        if let Ok(style) = ProgressStyle::with_template(shape) {
            self.bar.set_style(style.progress_chars("=> "));
        }
        self.bar.set_length(length);
        self.bar.set_message(name.to_owned());
        self.bar.reset();
    }
}

impl antumbra_bake::Progress for Progress {
    fn stage(&self, name: &str) {
        self.begin(name, SHARE_STEPS, "{spinner} {msg} {wide_bar} {percent} % {eta} left");
    }

    fn advance(&self, share: f64) {
        self.bar.set_position((share * SHARE_STEPS as f64) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
