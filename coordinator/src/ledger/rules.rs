//! Times and limits by which tasks are handed out.

use solver::settings::VerifyEffort;
use std::time::Duration;

/// Times and limits.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// A task without a sign of life for so long is handed out again.
    pub lease: Duration,
    /// What a lease is shortened to when its worker vanishes from the bus.
    pub grace: Duration,
    /// Attempts that may fail, or workers whose results are refused, before a task is given up.
    pub max_failures: u32,
    /// Attempts without a sign of life before a task is given up: that is the network's fault, or the task kills its workers.
    pub max_lapses: u32,
    /// Results of a worker that may be refused before it is given no work any more.
    pub max_refusals: u32,
    /// Pause after a task's first failure; doubled after each further one.
    pub backoff: Duration,
    /// Most folds that are not found to lie on a curve that is known; none: no such search.
    pub most_folds: usize,
    /// What of the branches is verified.
    pub verify: VerifyEffort,
    /// Share of the computing time for which results that cannot be checked are repeated.
    pub repeated: f64,
    /// What decides which: nobody else should know it.
    pub draw: u64,
}

/// Time that a worker takes at most to notice that its connection is gone and to connect again.
const RECONNECTION: Duration = Duration::from_secs(7);

impl Rules {
    /// Time that workers have to be heard of again when it was this side that could not be reached.
    pub fn reconnection(&self) -> Duration {
        self.grace.max(self.lease / 3 + RECONNECTION)
    }
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            lease: Duration::from_secs(15),
            grace: Duration::from_secs(5),
            max_failures: 3,
            max_lapses: 10,
            max_refusals: 3,
            backoff: Duration::from_secs(1),
            most_folds: 0,
            verify: VerifyEffort::None,
            repeated: 0.01,
            draw: 0,
        }
    }
}
