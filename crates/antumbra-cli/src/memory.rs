//! Memory that the process takes, from Linux's `/proc`; unknown elsewhere.

/// The most that the process has held so far, bytes.
#[must_use]
pub fn peak_bytes() -> Option<u64> {
    status("VmHWM:")
}

/// What the process holds now, bytes.
#[must_use]
pub fn current_bytes() -> Option<u64> {
    status("VmRSS:")
}

/// A line of `/proc/self/status`, such as `VmHWM:    12345 kB`.
fn status(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
