//! What is believed of workers: results of what they were given, as long as those hold when they are checked.

use super::answers::Offered;
use super::state::Ledger;
use protocol::from_worker::Lease;
use protocol::ids::WorkerId;
use results::journal::{AttemptEnd, Change};
use solver::response::task::{Task, VerifyPlace};
use std::time::Duration;

impl Ledger {
    /// What a result under this lease has to be of: asked before it is looked at.
    pub fn offered(&self, lease: &Lease) -> Offered {
        let Some(&(c, e)) = self.index.get(&lease.task) else { return Offered::Unknown };
        let entry = &self.chains[c].entries[e];
        if !entry.was_granted(lease) {
            return Offered::NeverGranted;
        }
        let level = self.chains[entry.level].level().expect("tasks are of levels");
        let branch = match entry.task {
            Task::Verify(VerifyPlace { branch, .. }) => {
                level.branches.iter().find(|found| found.known.branch == branch).map(|found| found.known.task.clone())
            }
            _ => None,
        };
        let (amplitude, order) = (level.amplitude.value, level.amplitude.order());
        Offered::Expected { amplitude, order, work: entry.task, branch }
    }

    /// A result was refused, as something that cannot be true. That is held against whoever was given the task, and ends the
    /// attempt if it is under way.
    pub fn refuse(&mut self, lease: &Lease, why: &str, now: Duration) -> Vec<Change> {
        if !matches!(self.offered(lease), Offered::Expected { .. }) {
            return Vec::new();
        }
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.refusals.push(format!("{}: {why}", lease.task));
        let reason = format!("{}: the result was refused: {why}", lease.worker);
        self.end(lease, AttemptEnd::Refused(reason), now).1
    }

    /// Why results of a worker were refused, if they were so often that it is given no work any more.
    pub(super) fn refusals(&self, worker: &WorkerId) -> Option<&[String]> {
        let refusals = &self.workers.get(worker)?.refusals;
        (refusals.len() >= self.rules.max_refusals as usize).then_some(refusals)
    }
}
