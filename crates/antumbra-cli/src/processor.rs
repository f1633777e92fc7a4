//! Processor time that the process has taken; unknown where the system is no Unix.

/// Seconds of all threads so far, those in the system included.
#[cfg(unix)]
#[must_use]
pub fn seconds() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

/// Unknown here.
#[cfg(not(unix))]
#[must_use]
pub fn seconds() -> Option<f64> {
    None
}
