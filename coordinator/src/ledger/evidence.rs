//! What another coordinator knew of how far workers are to be believed, taken up again.

use super::repeats::{Claim, Vote};
use super::state::Ledger;
use protocol::ids::Attempt;
use results::journal::{AttemptEnd, Evidence, Said, TaskState};
use solver::response::task::Brought;
use std::time::Duration;

impl Ledger {
    /// What came of comparing what was said of entry `e` of chain `c`.
    pub(super) fn restore_evidence(&mut self, (c, e): (usize, usize), evidence: &Evidence) {
        for (attempt, end) in &evidence.ends {
            let entry = &mut self.chains[c].entries[e];
            let Some(holder) = (attempt.0 as usize).checked_sub(1).and_then(|before| entry.holders.get(before)) else {
                continue;
            };
            let (task, worker) = (entry.id.clone(), holder.worker.clone());
            let reason = end.reason().unwrap_or_default();
            let why = reason.strip_prefix(&format!("{worker}: ")).unwrap_or(reason);
            match end {
                AttemptEnd::Refused(_) => {
                    self.workers.entry(worker).or_default().refusals.push(format!("{task}: {why}"));
                    continue;
                }
                AttemptEnd::Refuted(_) => {
                    entry.refuted.push(worker.clone());
                    entry.compared.push(*attempt);
                    self.contradict(&task, &worker, why);
                }
                _ => entry.compared.push(*attempt),
            }
            self.workers.entry(worker).or_default().gone = true;
        }
    }

    /// What the result of entry `e` of chain `c` says, with what others said of it, if that can only be repeated and was not decided.
    pub(super) fn restore_claim(
        &self,
        (c, e): (usize, usize),
        evidence: &Evidence,
        state: &TaskState,
        brought: Option<&Brought>,
    ) -> Option<Claim> {
        let (TaskState::Done(outcome), None) = (state, brought) else { return None };
        let (result, seconds) = evidence.result?;
        let holders = &self.chains[c].entries[e].holders;
        let vote = |attempt: Attempt, said| {
            let worker = holders.get((attempt.0 as usize).checked_sub(1)?)?.worker.clone();
            Some(Vote { attempt, worker, said })
        };
        let mut votes = vec![vote(result, Said::of(outcome)?)?];
        // Attempts before it are of a result that was withdrawn.
        for (attempt, end) in evidence.ends.iter().filter(|(attempt, _)| *attempt >= result) {
            let said = evidence.said.iter().find(|(other, _)| other == attempt);
            match (end, said) {
                (AttemptEnd::Disputed(_), Some((_, said))) => votes.extend(vote(*attempt, *said)),
                (AttemptEnd::Confirmed | AttemptEnd::Refuted(_), _) => return None,
                _ => {}
            }
        }
        Some(Claim { place: (c, e), votes, seconds, tries: 0 })
    }

    /// What is still to be compared. Somebody may be about to come who decides what is doubtful.
    pub(super) fn restore_claims(&mut self, claims: Vec<Claim>, now: Duration) {
        for claim in claims.into_iter().filter(|claim| !claim.is_exhausted()) {
            if claim.votes.len() > 1 {
                self.repeats.disputes.push_back(claim);
            } else {
                self.repeats.claims.entry(claim.votes[0].worker.clone()).or_default().push(claim);
            }
        }
        self.repeats.awaited = Some(now + self.rules.reconnection());
    }
}
