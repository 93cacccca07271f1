//! The sweep: a ledger, and what is compared with results that come twice.

use super::checked_result::{CheckedResult, Expected};
use super::checkpoints::Checkpoints;
use super::decision::{Answer, Decision, News, Offer};
use super::event::Beginning;
use crate::ledger::{Accepted, Granted, Leased, Ledger, Offered, Rules, Submitted};
use protocol::branch::TaskResultMessage;
use protocol::digest::Encoded;
use protocol::from_worker::{Lease, Progress};
use protocol::ids::{RunId, TaskId, WorkerId};
use protocol::to_everyone::{Done, StoredResult};
use protocol::to_worker::{Acknowledgement, CheckpointReply, SubmitReply};
use results::journal::{AcceptedResult, Change, CheckpointPart};
use results::store::Extent;
use solver::response::task::SeedOutcome;
use solver::stability::verification::Verification;
use std::collections::HashMap;
use std::time::Duration;
use tracing::warn;

/// Relative difference of range and peak up to which two results of a task agree: vector instructions differ between
/// processors.
const AGREEMENT: f64 = 1e-6;

/// A sweep under way.
#[derive(Debug)]
pub(super) struct Sweep {
    pub ledger: Ledger,
    /// What is kept of tasks under way.
    pub checkpoints: Checkpoints,
    /// Accepted branches in numbers.
    extents: HashMap<TaskId, Extent>,
    /// Verifications accepted since this process began.
    verifications: HashMap<TaskId, Verification>,
}

impl Sweep {
    /// A sweep that begins or goes on; the changes put it on disk.
    pub fn begin(rules: Rules, beginning: Beginning, now: Duration) -> (Self, Vec<Change>) {
        let Beginning { plan, stored } = beginning;
        let mut changes = Vec::new();
        if stored.is_none() {
            changes.push(Change::Planned(plan.clone()));
        }
        let stored = stored.unwrap_or_default();
        let (ledger, settled) = Ledger::restore(rules, plan.levels.clone(), &plan.added, stored.tasks, now);
        changes.extend(settled);
        let checkpoints = Checkpoints::new(stored.kept);
        (Self { ledger, checkpoints, extents: stored.extents, verifications: HashMap::new() }, changes)
    }

    /// A task for a computing thread. `cancelled`: what it is told if the run was cancelled.
    pub fn lease(&mut self, worker: &WorkerId, slot: u32, cancelled: &str, now: Duration) -> Decision {
        let (leased, mut changes) = self.ledger.lease(worker, slot, now);
        let answer = match leased {
            Leased::Grant(mut granted) => {
                granted.checkpoint = self.checkpoints.steps(&granted.task);
                changes.extend(handed_on(&granted, &changes));
                Answer::Grant(granted)
            }
            Leased::Wait => Answer::Wait(Duration::ZERO),
            Leased::Drained => Answer::Drained,
            Leased::Stop => Answer::Stop(cancelled.into()),
            Leased::Unwelcome(reasons) => Answer::Stop(format!(
                "{} of its results were refused ({}): this machine or this build computes something else",
                reasons.len(),
                reasons.join("; ")
            )),
        };
        Decision::new(answer, changes)
    }

    /// A sign of life.
    pub fn renew(&mut self, lease: &Lease, progress: Option<Progress>, now: Duration) -> Decision {
        let (reply, changes) = self.ledger.renew(lease, progress, now);
        Decision::new(Answer::Renew(reply), changes)
    }

    /// Steps of a task under way, of which no more than `most` bytes are kept.
    pub fn checkpoint(&mut self, lease: &Lease, part: CheckpointPart, most: usize) -> Decision {
        let (reply, changes) = if self.ledger.is_held(lease) {
            self.checkpoints.add(part, most)
        } else if self.ledger.is_repeat(lease) {
            (CheckpointReply::Enough, Vec::new())
        } else {
            (CheckpointReply::Lost, Vec::new())
        };
        Decision::new(Answer::Checkpoint(reply), changes)
    }

    /// What a result under a lease has to be of.
    pub fn offer(&self, lease: &Lease, run: &RunId) -> Decision {
        let offer = match self.ledger.offered(lease) {
            Offered::Expected { amplitude, order, work, branch } => {
                let points = branch.and_then(|task| self.extents.get(&task)).map(|extent| extent.points);
                Offer::Check(Expected { amplitude, order, work, points })
            }
            Offered::NeverGranted => Offer::Refuse(never_granted(lease)),
            Offered::Unknown => Offer::Refuse(unknown(lease, run)),
        };
        Decision::new(Answer::Offer(offer), Vec::new())
    }

    /// A result that cannot be true.
    pub fn refuse(&mut self, lease: &Lease, why: String, now: Duration) -> Decision {
        let Lease { task, attempt, worker, .. } = lease;
        warn!(%task, %attempt, %worker, why, "a result was refused");
        let changes = self.ledger.refuse(lease, &why, now);
        Decision::new(Answer::Submit(SubmitReply::Rejected { why }), changes)
    }

    /// A result of a task of `run`.
    pub fn submit(&mut self, result: CheckedResult, run: &RunId, now: Duration) -> Decision {
        let rejected = |why: String| Decision::new(Answer::Submit(SubmitReply::Rejected { why }), Vec::new());
        let task = &result.lease.task;
        let (submitted, changes) = self.ledger.submit(&result.lease, &result.brought);
        match submitted {
            Submitted::Accepted(accepted) => self.accept(result, accepted, changes, now),
            Submitted::Repeated { agrees, granted_at } => {
                self.ledger.note_repeat(granted_at, result.seconds, now);
                let withdrawn = |change: &Change| match change {
                    Change::Withdrawn { task } => Some(News::Withdrawn(task.clone())),
                    _ => None,
                };
                let news = changes.iter().filter_map(withdrawn).collect();
                Decision { changes, answer: Some(Answer::Submit(SubmitReply::Duplicate { agrees })), news }
            }
            Submitted::Duplicate => Decision::new(Answer::Submit(self.compare(&result)), changes),
            Submitted::Late => rejected(format!("task {task} was given up, and its level went on without it")),
            Submitted::Foreign => rejected(format!("that is not what task {task} is for")),
            Submitted::NeverGranted => rejected(never_granted(&result.lease)),
            Submitted::Unknown => rejected(unknown(&result.lease, run)),
        }
    }

    /// The first result of a task.
    fn accept(&mut self, result: CheckedResult, accepted: Accepted, follow_up: Vec<Change>, now: Duration) -> Decision {
        let CheckedResult { lease, program, seconds, branch, found, extent, .. } = result;
        let Accepted { outcome, sequence, amplitude, work } = accepted;
        self.ledger.note_cost(&work, seconds);
        self.ledger.note_claim(&lease, seconds, now);
        let Lease { task, attempt, worker, .. } = lease;
        let name = match outcome {
            SeedOutcome::Found(id) if extent.is_some() => Some(id),
            _ => None,
        };
        self.extents.extend(extent.map(|extent| (task.clone(), extent)));
        if let Some(TaskResultMessage::Verification(found)) = &found {
            self.verifications.insert(task.clone(), found.clone());
        }
        let result = StoredResult {
            branch: None,
            curve: None,
            landings: None,
            verification: None,
            disturbance: None,
            settling: None,
            task,
            attempt,
            amplitude,
            work,
            outcome,
            name,
            worker,
            program,
            seconds,
        };
        let Encoded { result, bytes, digest } = branch.complete(match found {
            Some(found) => result.with(found),
            None => result,
        });
        let done = Done {
            sequence,
            task: result.task.clone(),
            amplitude: result.amplitude.clone(),
            outcome,
            branch: name,
            size: digest.size,
            sha256: digest.sha256.clone(),
        };
        let mut changes = vec![Change::Result(AcceptedResult { result: Box::new(result), sequence, digest })];
        changes.extend(follow_up);
        let news = vec![News::Result(done.task.clone(), bytes), News::Done(done)];
        Decision { changes, answer: Some(Answer::Submit(SubmitReply::Accepted)), news }
    }

    /// A second result of a task should be the first one again.
    fn compare(&self, result: &CheckedResult) -> SubmitReply {
        let Lease { task, worker, .. } = &result.lease;
        let agrees = match (self.extents.get(task), &result.extent) {
            (Some(first), Some(second)) => first.agrees(second, AGREEMENT),
            (None, None) => true,
            _ => false,
        };
        if !agrees {
            warn!(%task, %worker, "a second result disagrees with the stored one by more than {AGREEMENT:e}");
        }
        let (Some(first), Some(TaskResultMessage::Verification(second))) =
            (self.verifications.get(task), &result.found)
        else {
            return SubmitReply::Duplicate { agrees };
        };
        let is_alike = first.agrees(second);
        if !is_alike {
            warn!(%task, %worker, "a second verification comes to other verdicts than the stored one");
        }
        SubmitReply::Duplicate { agrees: agrees && is_alike }
    }

    /// A task that could not be carried out.
    pub fn fail(&mut self, lease: &Lease, reason: &str, now: Duration) -> Decision {
        Self::acknowledge(self.ledger.fail(lease, reason, now))
    }

    /// A task given back.
    pub fn release(&mut self, lease: &Lease, now: Duration) -> Decision {
        Self::acknowledge(self.ledger.release(lease, now))
    }

    fn acknowledge((was_held, changes): (bool, Vec<Change>)) -> Decision {
        let answer = if was_held { Acknowledgement::Ok } else { Acknowledgement::Lost };
        Decision::new(Answer::Acknowledge(answer), changes)
    }
}

/// For the record: an attempt that has just been granted begins with steps of those before it.
fn handed_on(granted: &Granted, changes: &[Change]) -> Option<Change> {
    let Granted { task, attempt, checkpoint, .. } = granted;
    let is_new = |change: &Change| matches!(change, Change::Granted { task: new, .. } if new == task);
    let is_handed_on = *checkpoint > 0 && changes.iter().any(is_new);
    is_handed_on.then(|| Change::HandedOn { task: task.clone(), attempt: *attempt, steps: *checkpoint })
}

fn never_granted(lease: &Lease) -> String {
    let Lease { task, attempt, worker, slot } = lease;
    format!("attempt {attempt} at task {task} was not handed out to thread {slot} of worker {worker}")
}

fn unknown(lease: &Lease, run: &RunId) -> String {
    format!("run {run} has no task {}", lease.task)
}
