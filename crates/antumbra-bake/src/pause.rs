//! Rests: how a bake is spread over time, and ended early.

/// Called by threads at work every small part of a millisecond, wherever they may rest: may block for as long as it likes.
/// False ends the work early, whose result is then of no use.
pub type Pause<'a> = &'a (dyn Fn() -> bool + Sync);

/// Works on without a rest.
#[must_use]
pub fn never_pause() -> bool {
    true
}
