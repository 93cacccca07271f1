//! What is counted while a run goes on, for whoever watches over the system.

use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use results::journal::{AttemptEnd, Change};
use std::time::Duration;

/// Counters since the start of this process's part in the run. Clones count together.
#[derive(Debug, Clone)]
pub struct Meters {
    /// Tasks handed out.
    pub granted: Counter,
    /// Attempts that ended without a sign of life in time.
    pub expired: Counter,
    /// Attempts that were given back, as by a worker that was told to end.
    pub released: Counter,
    /// Attempts that failed.
    pub failed: Counter,
    /// Results that cannot be true.
    pub refused: Counter,
    /// Results stored.
    pub stored: Counter,
    /// Bytes of results that have come, whatever became of them.
    pub received: Counter,
    /// Time that transactions took, s.
    pub commits: Histogram,
}

impl Default for Meters {
    fn default() -> Self {
        let [granted, expired, released, failed, refused, stored, received] = Default::default();
        // From 0.25 ms to 8 s: a transaction is a write to disk, or the wait for one.
        let commits = Histogram::new(exponential_buckets(0.25e-3, 2.0, 16));
        Self { granted, expired, released, failed, refused, stored, received, commits }
    }
}

impl Meters {
    /// Counts what one transaction has put on disk, and what it took.
    pub(super) fn committed(&self, changes: &[Change], took: Duration) {
        self.commits.observe(took.as_secs_f64());
        for change in changes {
            let counter = match change {
                Change::Granted { .. } | Change::Repeated { .. } => &self.granted,
                Change::Result(_) => &self.stored,
                Change::Ended { end: AttemptEnd::Expired, .. } => &self.expired,
                Change::Ended { end: AttemptEnd::Released, .. } => &self.released,
                Change::Ended { end: AttemptEnd::Failed(_), .. } => &self.failed,
                Change::Ended { end: AttemptEnd::Refused(_), .. } => &self.refused,
                _ => continue,
            };
            counter.inc();
        }
    }
}
