//! Room for what waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes that wait; given back when dropped.
pub(super) struct Held {
    all: Arc<AtomicUsize>,
    bytes: usize,
}

impl Held {
    /// So many more, if there is room or nothing else waits.
    pub fn of(all: &Arc<AtomicUsize>, bytes: usize, most: usize) -> Option<Self> {
        let more = |held: usize| (held == 0 || held + bytes <= most).then_some(held + bytes);
        all.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Self { all: all.clone(), bytes })
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.all.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
