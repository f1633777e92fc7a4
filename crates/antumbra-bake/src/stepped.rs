//! Bakes a little at a time: a rebuild that an engine spreads over frames, for a sun that moves slowly.
//!
//! The bake is the ordinary one, on a thread of its own that works only while a step is under way: it rests at the many
//! places where a bake may ([`crate::Progress::pause`]), until the next step. So the bytes are those of any other bake,
//! and between steps nothing runs.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use antumbra_scene::{Light, Scene};

use crate::bake::{BakeError, BakeOptions, Baked, Progress, Stopwatch, bake_lights, check, judge_casters, pool};

/// A budget that is as good as endless.
const LONGEST: Duration = Duration::from_secs(1 << 30);

/// How a step has left a bake.
#[derive(Debug)]
pub enum Step {
    /// There is nothing to do: no bake has been started, or the last one has been handed over or cancelled.
    Idle,
    /// There is more to do.
    Working {
        /// What is being done.
        stage: String,
        /// Share of it that is done, 0 to 1.
        share: f64,
    },
    /// The bake is finished; this is handed over once.
    Done(Result<Box<Baked>, BakeError>),
}

/// Bakes lights of one scene, one bake after the other, in steps.
///
/// ```no_run
/// # use std::{sync::Arc, time::Duration};
/// # use antumbra_bake::{BakeOptions, Step, SteppedBaker};
/// # let scene = Arc::new(antumbra_scene::Scene::default());
/// # let sun = scene.lights[0].clone();
/// let mut baker = SteppedBaker::new(scene, BakeOptions::default())?;
/// baker.start(vec![sun]);
/// let shadows = loop {
///     // Once per frame:
///     match baker.step(Duration::from_millis(2)) {
///         Step::Done(baked) => break baked?.bytes,
///         Step::Working { stage, share } => println!("{stage}: {:.0} %", 100.0 * share),
///         Step::Idle => unreachable!("a bake was started"),
///     }
/// };
/// # Ok::<(), antumbra_bake::BakeError>(())
/// ```
pub struct SteppedBaker {
    gate: Arc<Gate>,
    jobs: Option<Sender<Job>>,
    thread: Option<JoinHandle<()>>,
    /// The bake that was started last, if it has not been handed over.
    current: Option<u64>,
    next: u64,
}

struct Job {
    number: u64,
    lights: Vec<Light>,
}

/// Where the bake's thread waits.
struct Gate {
    state: Mutex<State>,
    /// The thread may go on, or has stopped to work.
    changed: Condvar,
    options: BakeOptions,
}

struct State {
    /// The thread works until then.
    until: Instant,
    /// It has not begun yet, and goes on to its next rest in any case: steps of no length make progress, too.
    has_turn: bool,
    /// The thread rests, or is about to.
    resting: bool,
    /// Bakes with lesser numbers are cancelled.
    first_wanted: u64,
    stage: String,
    share: f64,
    result: Option<(u64, Result<Box<Baked>, BakeError>)>,
}

impl SteppedBaker {
    /// Judges the scene's casters, on all threads and at once: that is done once for all bakes of the scene. The options'
    /// threads count for this; steps are made by one.
    ///
    /// # Errors
    /// [`BakeError`]: there are no casters, or the options make no sense.
    pub fn new(scene: Arc<Scene>, options: BakeOptions) -> Result<Self, BakeError> {
        let state = State {
            until: Instant::now(),
            has_turn: false,
            resting: true,
            first_wanted: 0,
            stage: String::new(),
            share: 0.0,
            result: None,
        };
        let gate = Arc::new(Gate { state: Mutex::new(state), changed: Condvar::new(), options });
        let judging = pool(options.threads)?;
        let one = pool(1)?;
        let (jobs, waiting) = channel();
        let (ready, is_ready) = channel();
        let of_thread = Arc::clone(&gate);
        let body = move || match judging.install(|| judge_casters(&scene, &of_thread.options)) {
            Err(error) => _ = ready.send(Err(error)),
            Ok(casters) => {
                drop(judging);
                _ = ready.send(Ok(()));
                let (gate, casters) = (&*of_thread, &casters);
                one.install(move || work(gate, casters, &waiting));
            }
        };
        let thread = std::thread::Builder::new().name("antumbra stepped bake".to_owned()).spawn(body);
        let thread = thread.map_err(|e| BakeError::Threads { threads: 1, reason: e.to_string() })?;
        // The thread answers, or has panicked: then its message has been shown.
        is_ready.recv().unwrap_or(Err(BakeError::Cancelled))?;
        Ok(Self { gate, jobs: Some(jobs), thread: Some(thread), current: None, next: 0 })
    }

    /// Begins a bake; one that is under way is cancelled. Work is done in steps only.
    pub fn start(&mut self, lights: Vec<Light>) {
        self.cancel();
        let number = self.next;
        self.next += 1;
        self.current = Some(number);
        if let Some(jobs) = &self.jobs {
            // A thread that is gone shows in the next step.
            _ = jobs.send(Job { number, lights });
        }
    }

    /// Works for about so long: until the next rest after it. The calling thread waits.
    pub fn step(&mut self, budget: Duration) -> Step {
        let Some(current) = self.current else { return Step::Idle };
        let mut state = self.gate.lock();
        // A time that no clock shows is never.
        let now = Instant::now();
        state.until = now.checked_add(budget).unwrap_or(now + LONGEST);
        state.has_turn = true;
        state.resting = false;
        self.gate.changed.notify_all();
        loop {
            if let Some((number, result)) = state.result.take()
                && number == current
            {
                drop(state);
                self.current = None;
                return Step::Done(result);
            }
            if state.resting {
                return Step::Working { stage: state.stage.clone(), share: state.share };
            }
            if self.thread.as_ref().is_none_or(JoinHandle::is_finished) {
                self.current = None;
                return Step::Done(Err(BakeError::Cancelled));
            }
            state = self.gate.wait(state);
        }
    }

    /// Gives up the bake that is under way. Its thread needs a moment to leave it.
    pub fn cancel(&mut self) {
        self.current = None;
        let mut state = self.gate.lock();
        state.first_wanted = self.next;
        state.result = None;
        self.gate.changed.notify_all();
    }
}

impl Drop for SteppedBaker {
    fn drop(&mut self) {
        self.cancel();
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // It has panicked, or not: there is nobody to tell.
            _ = thread.join();
        }
    }
}

/// Bakes what is asked for, until nobody can ask any more.
fn work(gate: &Gate, casters: &crate::casters::Casters<'_>, waiting: &Receiver<Job>) {
    while let Ok(Job { number, lights }) = waiting.recv() {
        let paced = Paced { gate, number };
        if !paced.pause() {
            continue;
        }
        let options = &gate.options;
        let bake = || {
            check(&lights, options)?;
            bake_lights(casters, &lights, options, &paced, Stopwatch::start())
        };
        let result = bake().map(Box::new);
        let mut state = gate.lock();
        if number >= state.first_wanted {
            state.result = Some((number, result));
        }
        gate.changed.notify_all();
    }
}

impl Gate {
    /// A panic elsewhere leaves the state whole.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        // A thread that panics notifies nobody: look again now and then.
        let (state, _) =
            self.changed.wait_timeout(state, Duration::from_secs(1)).unwrap_or_else(PoisonError::into_inner);
        state
    }
}

/// One bake's progress.
struct Paced<'a> {
    gate: &'a Gate,
    number: u64,
}

impl Progress for Paced<'_> {
    fn stage(&self, name: &str) {
        let mut state = self.gate.lock();
        state.stage = name.to_owned();
        state.share = 0.0;
    }

    fn advance(&self, share: f64) {
        self.gate.lock().share = share;
    }

    fn pause(&self) -> bool {
        let mut state = self.gate.lock();
        while self.number >= state.first_wanted && !state.has_turn && Instant::now() >= state.until {
            state.resting = true;
            self.gate.changed.notify_all();
            state = self.gate.wait(state);
        }
        state.has_turn = false;
        self.number >= state.first_wanted
    }
}
