//! Time, results and messages, as the workers see them.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What is counted while a recording is replayed.
#[derive(Debug, Default)]
pub struct Meter {
    /// Results that were stored.
    pub stored: AtomicUsize,
    /// Landings that were not recorded.
    pub speculative: AtomicUsize,
    /// The largest status that was told, bytes.
    pub status: AtomicUsize,
    span: Mutex<Option<(Instant, Instant)>>,
}

impl Meter {
    /// A task was handed out.
    pub fn granted(&self) {
        let mut span = self.span.lock().expect("no holder of this lock panics");
        let now = Instant::now();
        span.get_or_insert((now, now));
    }

    /// A result was stored.
    pub fn accepted(&self) {
        self.stored.fetch_add(1, Ordering::Relaxed);
        let mut span = self.span.lock().expect("no holder of this lock panics");
        if let Some((_, last)) = span.as_mut() {
            *last = Instant::now();
        }
    }

    /// From the first task that was handed out to the last result that was acknowledged, s.
    pub fn seconds(&self) -> f64 {
        let span = *self.span.lock().expect("no holder of this lock panics");
        span.map_or(0.0, |(first, last)| (last - first).as_secs_f64())
    }

    /// Whether a task was handed out.
    pub fn has_begun(&self) -> bool {
        self.span.lock().expect("no holder of this lock panics").is_some()
    }
}
