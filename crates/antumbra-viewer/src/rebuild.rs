//! Bakes in the background, a step at a time, so that frames go on; starts anew when the sun moves on.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use antumbra::ShadowFile;
use antumbra_bake::{BakeOptions, Step, SteppedBaker};
use antumbra_scene::{Light, Scene};

/// A bake that is done, with the lights that it is of.
pub(crate) struct Rebuilt {
    pub lights: Vec<Light>,
    pub file: ShadowFile,
}

/// Bakes of one scene.
pub(crate) struct Rebuild {
    jobs: Sender<Vec<Light>>,
    done: Receiver<Result<Rebuilt, String>>,
    state: Arc<Mutex<Option<String>>>,
}

/// How long the baker works before it looks for a newer sun, and how long it rests then.
const STEP: Duration = Duration::from_millis(8);
const REST: Duration = Duration::from_millis(1);

impl Rebuild {
    pub fn new(scene: Arc<Scene>, options: BakeOptions) -> Self {
        let (jobs, orders) = channel();
        let (results, done) = channel();
        let state = Arc::new(Mutex::new(None));
        let worker = Worker { orders, results, state: Arc::clone(&state) };
        // It ends when the rebuild is dropped.
        thread::spawn(move || worker.run(scene, options));
        Self { jobs, done, state }
    }

    /// Bakes these lights next, and nothing that was asked for before.
    pub fn start(&self, lights: Vec<Light>) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = Some("baking".to_owned());
        // A worker that is gone has said why.
        let _ = self.jobs.send(lights);
    }

    /// What was done since the last call.
    pub fn take(&self) -> Option<Result<Rebuilt, String>> {
        self.done.try_iter().last()
    }

    /// What is being done, for people; `None` when nothing is.
    pub fn state(&self) -> Option<String> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

struct Worker {
    orders: Receiver<Vec<Light>>,
    results: Sender<Result<Rebuilt, String>>,
    state: Arc<Mutex<Option<String>>>,
}

impl Worker {
    fn run(self, scene: Arc<Scene>, options: BakeOptions) {
        let mut baker: Option<SteppedBaker> = None;
        while let Ok(lights) = self.orders.recv() {
            // Judging which parts are closed takes a while, once.
            let result = match &mut baker {
                Some(baker) => self.bake(baker, lights),
                None => match SteppedBaker::new(Arc::clone(&scene), options) {
                    Ok(new) => self.bake(baker.insert(new), lights),
                    Err(error) => Some(Err(error.to_string())),
                },
            };
            let Some(result) = result else { return };
            self.say(None);
            if self.results.send(result).is_err() {
                return;
            }
        }
    }

    /// Bakes the newest lights there are; `None` when nobody waits any more.
    fn bake(&self, baker: &mut SteppedBaker, mut lights: Vec<Light>) -> Option<Result<Rebuilt, String>> {
        baker.start(lights.clone());
        loop {
            match baker.step(STEP) {
                Step::Working { stage, share } => self.say(Some(format!("{stage} {:.0} %", 100.0 * share))),
                Step::Idle => return Some(Err("the bake was given up".to_owned())),
                Step::Done(result) => {
                    let file = result
                        .map_err(|error| error.to_string())
                        .and_then(|baked| ShadowFile::from_bytes(&baked.bytes).map_err(|error| error.to_string()));
                    return Some(file.map(|file| Rebuilt { lights, file }));
                }
            }
            loop {
                match self.orders.try_recv() {
                    Ok(newer) => {
                        lights = newer;
                        baker.start(lights.clone());
                    }
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return None,
                }
            }
            thread::sleep(REST);
        }
    }

    fn say(&self, words: Option<String>) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = words;
    }
}
