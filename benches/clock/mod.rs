//! The time that work on one thread takes.

use std::time::{Duration, Instant};

/// What `make` takes, and what it makes: the time that this thread has a processor, where the system says; else the time of
/// day. Other work on the machine counts in the second only.
pub fn timed<T>(make: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let before = now(start);
    let made = make();
    (now(start) - before, made)
}

fn now(start: Instant) -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanos = text.split_whitespace().next().and_then(|n| n.parse().ok());
    nanos.map_or_else(|| start.elapsed(), Duration::from_nanos)
}
