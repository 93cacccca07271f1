//! Tasks under way that do not get on, though there are signs of life: a thread that turns in circles renews for ever.

use super::state::Ledger;
use protocol::to_everyone::StalledTask;
use results::journal::place_of_kind;
use std::time::Duration;

/// Nothing is said of less.
const SHORTEST: Duration = Duration::from_secs(600);
/// Nor of less than so many times as long as tasks of its kind took so far.
const TIMES: f64 = 20.0;

impl Ledger {
    /// Tasks of workers that are heard of which have not got on for long, the longest first: of those that follow a curve, no new
    /// point has come.
    pub fn stalled(&self, now: Duration) -> Vec<StalledTask> {
        let mut stalled: Vec<StalledTask> = self
            .entries()
            .filter_map(|entry| {
                let worker = &entry.holder()?.worker;
                let usual = self.costs[place_of_kind(&entry.task)].mean().unwrap_or(0.0);
                let seconds = now.saturating_sub(entry.moved_at).as_secs_f64();
                let is_heard_of = self.workers.get(worker).is_some_and(|worker| !worker.gone);
                let is_long = seconds >= SHORTEST.as_secs_f64().max(TIMES * usual);
                (is_heard_of && is_long).then(|| StalledTask {
                    task: entry.id.clone(),
                    worker: worker.clone(),
                    seconds,
                })
            })
            .collect();
        stalled.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        stalled
    }
}
