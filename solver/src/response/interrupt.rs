//! Asking a task to stop while there are no points that it tells of.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asked between the starts and steps of a landing whether to go on; clones are one.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Asks to stop.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked to stop.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
