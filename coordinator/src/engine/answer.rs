//! Answers to workers.

use super::{Effect, Engine, News};
use crate::ledger::{Accepted, Leased, Ledger, Record, Submitted};
use crate::store::{StoreError, Summary};
use protocol::branch::{BranchMessage, FindingMessage};
use protocol::codec::{encode, sha256};
use protocol::curve::Seeds;
use protocol::from_worker::{Lease, LeaseRequest, SubmitRequest};
use protocol::to_everyone::{Done, SeedMessage, Stage, StoredResult};
use protocol::to_worker::{Acknowledgement, Grant, LeaseReply, SubmitReply};
use solver::task::SeedOutcome;
use std::time::{Duration, Instant};
use tracing::warn;

/// Relative difference of range and peak up to which two results of a task agree: vector instructions differ between
/// processors.
const AGREEMENT: f64 = 1e-6;
/// What a cancelled run answers.
const CANCELLED: &str = "the run was cancelled";

impl Engine<'_> {
    pub(super) fn lease(
        &mut self,
        request: &LeaseRequest,
        now: Duration,
        records: &mut Vec<Record>,
        news: &mut Vec<News>,
    ) -> LeaseReply {
        if request.protocol != protocol::VERSION {
            let reason = format!(
                "worker {} speaks version {} of the messages (Isola {}), this run version {} (Isola {}): install the same \
                 Isola on both sides",
                request.worker,
                request.protocol,
                request.program,
                protocol::VERSION,
                protocol::PROGRAM
            );
            return LeaseReply::Stop { reason };
        }
        let Some(sweep) = &mut self.sweep else {
            return match self.manifest.stage {
                Stage::Cancelled => LeaseReply::Stop { reason: CANCELLED.into() },
                _ => LeaseReply::Wait { retry_ms: 200 },
            };
        };
        if self.stopping {
            return LeaseReply::Wait { retry_ms: 1000 };
        }
        let (leased, changes) = sweep.ledger.lease(&request.worker, request.slot, now);
        records.extend(changes);
        let granted = match leased {
            Leased::Grant(granted) => granted,
            Leased::Wait(pause) => return LeaseReply::Wait { retry_ms: pause.as_millis() as u64 },
            Leased::Drained => return LeaseReply::Drained,
            Leased::Stop => return LeaseReply::Stop { reason: CANCELLED.into() },
        };
        if self.first_grant.is_none() {
            self.first_grant = Some((Instant::now(), sweep.ledger.settled()));
        }
        let amplitude = granted.amplitude.value;
        let seeds = Seeds::new(&granted.work.seeds(&sweep.forced.problem, &sweep.backbone, amplitude));
        news.push(News::Seed(SeedMessage {
            task: granted.task.clone(),
            amplitude: granted.amplitude,
            work: granted.work,
            seeds: seeds.clone(),
        }));
        LeaseReply::Grant(Grant {
            task: granted.task,
            attempt: granted.attempt,
            ttl_ms: self.manifest.lease_ms,
            amplitude,
            reach: sweep.reach,
            work: granted.work,
            seeds,
            known: granted.known,
        })
    }

    pub(super) fn submit(
        &mut self,
        request: SubmitRequest,
        effects: &mut Vec<Effect>,
        news: &mut Vec<News>,
    ) -> Result<SubmitReply, StoreError> {
        let Some(sweep) = &mut self.sweep else {
            return Ok(SubmitReply::Rejected { why: "this run has not begun".into() });
        };
        let (branch, outcome) = match request.finding {
            FindingMessage::Branch(branch) => (Some(branch), None),
            FindingMessage::Nothing(outcome) => (None, Some(outcome)),
        };
        if let Some(error) = branch.as_ref().and_then(|branch| branch.branch(&self.size).err()) {
            return Ok(SubmitReply::Rejected { why: error.to_string() });
        }
        let (submitted, records) = sweep.ledger.submit(&request.lease, outcome);
        let accepted = match submitted {
            Submitted::Accepted(accepted) => accepted,
            Submitted::Duplicate => return self.compare(&request.lease, branch.as_ref(), effects),
            Submitted::Late => {
                let why = format!("task {} was given up, and its level went on without it", request.lease.task);
                return Ok(SubmitReply::Rejected { why });
            }
            Submitted::Unknown => {
                let why = format!("run {} has no task {}", self.manifest.run, request.lease.task);
                return Ok(SubmitReply::Rejected { why });
            }
        };
        let Lease { task, attempt, worker, .. } = request.lease;
        let Accepted { outcome, sequence, amplitude, work } = accepted;
        let name = match (&branch, outcome) {
            (Some(_), SeedOutcome::Found(id)) => Some(id),
            _ => None,
        };
        let (program, seconds) = (request.program, request.seconds);
        let result =
            Box::new(StoredResult { task, attempt, amplitude, work, outcome, name, branch, worker, program, seconds });
        let bytes = encode(&*result);
        let (size, sha256) = (bytes.len() as u64, sha256(&bytes));
        news.push(News::Done(Done {
            sequence,
            task: result.task.clone(),
            amplitude: result.amplitude.clone(),
            outcome,
            branch: name,
            size,
            sha256: sha256.clone(),
        }));
        effects.push(Effect::Result { result, sequence, size, sha256 });
        effects.extend(records.into_iter().map(Effect::Record));
        Ok(SubmitReply::Accepted)
    }

    /// A second result of a task should be the first one again.
    fn compare(
        &self,
        lease: &Lease,
        branch: Option<&BranchMessage>,
        effects: &[Effect],
    ) -> Result<SubmitReply, StoreError> {
        // The first one may be about to be stored.
        let waiting = effects.iter().find_map(|effect| match effect {
            Effect::Result { result, .. } if result.task == lease.task => Some(result.branch.as_ref().map(Summary::of)),
            _ => None,
        });
        let stored = waiting.map_or_else(|| self.store.summary(&lease.task), Ok)?;
        let agrees = match (stored, branch) {
            (Some(stored), Some(branch)) => stored.agrees(&Summary::of(branch), AGREEMENT),
            (None, None) => true,
            _ => false,
        };
        if !agrees {
            warn!(task = %lease.task, worker = %lease.worker, "a second result disagrees with the stored one by more than 1e-6");
        }
        Ok(SubmitReply::Duplicate { agrees })
    }

    pub(super) fn end(
        &mut self,
        event: impl FnOnce(&mut Ledger) -> (bool, Vec<Record>),
        records: &mut Vec<Record>,
    ) -> Acknowledgement {
        let Some(sweep) = &mut self.sweep else { return Acknowledgement::Lost };
        let (valid, changes) = event(&mut sweep.ledger);
        records.extend(changes);
        if valid { Acknowledgement::Ok } else { Acknowledgement::Lost }
    }
}
