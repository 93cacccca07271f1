//! Results that bring no curve, computed again by somebody else.
//!
//! What was found is checked against the equations. That nothing is there, or nothing that was not known, cannot be: it is what the
//! whole computation comes to. Of such results some are drawn, and handed out once more as they were handed out first, for a share of
//! the computing time. Where two disagree a third one decides, or a fourth or fifth: what is wrong is taken back (`withdraw.rs`), and
//! what else was said by who said it is repeated whatever it takes, until several in a row hold.

use super::answers::Granted;
use super::repeats::{Claim, Held, Repeated, Vote};
use super::state::Ledger;
use super::worker::Worker;
use protocol::from_worker::Lease;
use protocol::ids::{Attempt, TaskId, WorkerId};
use results::journal::{AttemptEnd, Change, Holder, Said};
use solver::response::task::Brought;
use std::time::Duration;

/// So many confirmed results after one that was wrong, and a worker is believed again: bad memory errs now and then, and what is
/// at the edge of two answers may depend on the processor.
const CLEARED: usize = 32;

impl Ledger {
    /// Takes down what an accepted result says, if it can only be repeated.
    pub(super) fn claim(&mut self, place: (usize, usize), lease: &Lease, brought: &Brought) {
        let Some(said) = Said::by(brought) else { return };
        let vote = Vote { attempt: lease.attempt, worker: lease.worker.clone(), said };
        let claim = Claim { place, votes: vec![vote], seconds: 0.0, tries: 0 };
        self.repeats.claims.entry(lease.worker.clone()).or_default().push(claim);
    }

    /// What computing the result just accepted took, no more than there was time for since it was handed out.
    pub fn note_claim(&mut self, lease: &Lease, seconds: f64, now: Duration) {
        let Some(&(c, e)) = self.index.get(&lease.task) else { return };
        let seconds = seconds.min(now.saturating_sub(self.chains[c].entries[e].granted_at).as_secs_f64());
        self.repeats.total += seconds;
        let last = self.repeats.claims.get_mut(&lease.worker).and_then(|claims| claims.last_mut());
        if let Some(claim) = last.filter(|claim| claim.place == (c, e)) {
            claim.seconds = seconds;
        }
    }

    /// What repeating a result took.
    pub fn note_repeat(&mut self, granted_at: Duration, seconds: f64, now: Duration) {
        self.repeats.spent += seconds.min(now.saturating_sub(granted_at).as_secs_f64());
    }

    /// A result for a thread without a task to repeat, as a task like others.
    pub(super) fn repeat_for(&mut self, holder: &Holder, now: Duration) -> Option<(Granted, Vec<Change>)> {
        if let Some(held) = self.repeats.held.iter_mut().find(|held| held.holder == *holder) {
            held.deadline = now + self.rules.lease;
            let ((c, e), attempt) = (held.claim.place, held.attempt);
            return Some((Granted { attempt, ..self.granted(c, e) }, Vec::new()));
        }
        let mut claim = self.choose_claim(&holder.worker)?;
        claim.tries += 1;
        let (c, e) = claim.place;
        let entry = &mut self.chains[c].entries[e];
        entry.holders.push(holder.clone());
        let (task, attempt, deadline) = (entry.id.clone(), Attempt(entry.attempts()), now + self.rules.lease);
        let (holder, granted_at) = (holder.clone(), now);
        self.repeats.held.push(Held { claim, holder: holder.clone(), attempt, granted_at, deadline });
        Some((self.granted(c, e), vec![Change::Repeated { task, attempt, holder }]))
    }

    /// What this worker is to repeat: what others disagree on; what somebody said who is not believed any more; or, if it is not too dear, one
    /// of what the one said of whom the least was repeated so far. The worker's own, if there is nobody else.
    fn choose_claim(&mut self, worker: &WorkerId) -> Option<Claim> {
        if !self.is_believed(worker) {
            return None;
        }
        if let Some(i) = self.repeats.disputes.iter().position(|claim| !claim.is_of(worker)) {
            return self.repeats.disputes.remove(i);
        }
        // When nothing else is left to do only what is doubtful is waited for.
        let is_over = self.has_nothing_left();
        let room = if is_over { 0.0 } else { self.rules.repeated * self.repeats.total - self.repeats.taken() };
        if room <= 0.0 && self.workers.keys().all(|id| self.is_believed(id)) {
            return None;
        }
        let is_alone = !self.workers.iter().any(|(id, other)| id != worker && !other.gone && self.is_believed(id));
        let authors: Vec<&WorkerId> =
            self.repeats.claims.keys().filter(|author| is_alone || *author != worker).collect();
        let suspect = authors.iter().find(|author| !self.is_believed(author));
        let is_suspect = suspect.is_some();
        let author = match suspect {
            Some(author) => (*author).clone(),
            None => {
                let repeated = |id: &WorkerId| self.workers.get(id).map_or(0, |worker| worker.repeated);
                let least = authors.iter().map(|id| repeated(id)).min()?;
                let least: Vec<WorkerId> = authors.into_iter().filter(|id| repeated(id) == least).cloned().collect();
                let drawn = self.repeats.draw(self.rules.draw, least.len());
                least[drawn].clone()
            }
        };
        let count = self.repeats.claims.get(&author)?.len();
        let drawn = self.repeats.draw(self.rules.draw, count);
        let claims = self.repeats.claims.get_mut(&author)?;
        if !is_suspect && claims[drawn].seconds >= room {
            return None;
        }
        let claim = claims.swap_remove(drawn);
        if claims.is_empty() {
            self.repeats.claims.remove(&author);
        }
        self.workers.entry(author).or_default().repeated += 1;
        Some(claim)
    }

    /// Whether what a worker says was never found wrong, or not for long, nor refused too often.
    fn is_believed(&self, worker: &WorkerId) -> bool {
        let is_cleared = |worker: &Worker| worker.refuted == 0 || worker.confirmed >= CLEARED;
        self.workers.get(worker).is_none_or(is_cleared) && self.refusals(worker).is_none()
    }

    /// Whether a result under this lease repeats another one.
    pub fn is_repeat(&self, lease: &Lease) -> bool {
        self.index.get(&lease.task).is_some_and(|&place| self.repeats.find(place, lease).is_some())
    }

    /// Number of results that are doubtful and that somebody present can decide: what two disagree on, and what was said by who was
    /// wrong before.
    pub(super) fn doubts(&self) -> usize {
        let can = |claim: &Claim, (id, worker): (&WorkerId, &Worker)| {
            !worker.gone && !claim.is_of(id) && self.is_believed(id)
        };
        let is_open = |claim: &&Claim| self.workers.iter().any(|worker| can(claim, worker));
        let disputes = self.repeats.disputes.iter().filter(is_open).count();
        let claims = self.repeats.claims.values().flatten();
        let suspects = claims.filter(|claim| !self.is_believed(&claim.votes[0].worker)).filter(is_open).count();
        disputes + suspects
    }

    /// Whether something is doubtful that somebody present can decide, or somebody who is about to come.
    pub(super) fn has_doubts(&self) -> bool {
        let is_suspect = |author| !self.is_believed(author);
        let are_some = !self.repeats.disputes.is_empty() || self.repeats.claims.keys().any(is_suspect);
        (self.repeats.awaited.is_some() && are_some) || self.doubts() > 0
    }

    /// A repetition has come to this; `None` if it is none.
    pub(super) fn repeated(&mut self, lease: &Lease, brought: &Brought) -> Option<Repeated> {
        let place = *self.index.get(&lease.task)?;
        let held = self.repeats.held.swap_remove(self.repeats.find(place, lease)?);
        let Held { mut claim, granted_at, attempt, .. } = held;
        let said = Said::by(brought).unwrap_or(Said::New);
        self.chains[place.0].entries[place.1].compared.push(attempt);
        claim.votes.push(Vote { attempt, worker: lease.worker.clone(), said });
        let agrees = claim.votes[0].said == said;
        let changes = self.judge(claim);
        Some(Repeated { agrees, granted_at, changes })
    }

    /// Decides what several say of a task: what two of them say is so.
    fn judge(&mut self, claim: Claim) -> Vec<Change> {
        let id = self.chains[claim.place.0].entries[claim.place.1].id.clone();
        let ended = |vote: &Vote, end| Change::Ended { task: id.clone(), attempt: vote.attempt, end };
        let [others @ .., before, last] = &claim.votes[..] else { return Vec::new() };
        let Some(right) = others.iter().chain([before]).find(|vote| vote.said == last.said) else {
            let why = format!("{}: {}; {}: {}", before.worker, before.said, last.worker, last.said);
            let said = Change::Said { task: id.clone(), attempt: last.attempt, said: last.said };
            let changes = vec![ended(last, AttemptEnd::Disputed(why)), said];
            if !claim.is_exhausted() {
                self.repeats.disputes.push_back(claim);
            }
            return changes;
        };
        if claim.votes.len() == 2 {
            self.workers.entry(right.worker.clone()).or_default().confirmed += 1;
            return vec![ended(last, AttemptEnd::Confirmed)];
        }
        let (wrong, agreeing): (Vec<&Vote>, Vec<&Vote>) = claim.votes.iter().partition(|vote| vote.said != last.said);
        let mut changes = Vec::new();
        for wrong in wrong {
            let why = format!("{}, where {} and {} come to {}", wrong.said, right.worker, last.worker, right.said);
            self.contradict(&id, &wrong.worker, &why);
            changes.push(ended(wrong, AttemptEnd::Refuted(format!("{}: {why}", wrong.worker))));
            let entry = &mut self.chains[claim.place.0].entries[claim.place.1];
            entry.refuted.push(wrong.worker.clone());
            entry.compared.push(wrong.attempt);
        }
        // The result that counts has no end but its own.
        let first = &claim.votes[0];
        let compared = agreeing.into_iter().filter(|vote| vote.attempt != first.attempt);
        changes.extend(compared.map(|vote| ended(vote, AttemptEnd::Confirmed)));
        if first.said != last.said {
            changes.extend(self.withdraw(claim.place));
        }
        changes
    }

    /// Takes down that a result of a worker is not what others come to.
    pub(super) fn contradict(&mut self, task: &TaskId, worker: &WorkerId, why: &str) {
        let worker = self.workers.entry(worker.clone()).or_default();
        worker.refuted += 1;
        worker.confirmed = 0;
        worker.refusals.push(format!("{task}: {why}"));
    }

    /// A sign of life of somebody who repeats a result.
    pub(super) fn renew_repeat(&mut self, lease: &Lease, now: Duration) -> bool {
        let place = self.index.get(&lease.task);
        let Some(i) = place.and_then(|&place| self.repeats.find(place, lease)) else { return false };
        self.repeats.held[i].deadline = now + self.rules.lease;
        true
    }

    /// A repetition ended without a result.
    pub(super) fn end_repeat(&mut self, lease: &Lease, end: AttemptEnd) -> Option<Vec<Change>> {
        let place = *self.index.get(&lease.task)?;
        let held = self.repeats.find(place, lease)?;
        self.drop_repeat(held);
        Some(vec![Change::Ended { task: lease.task.clone(), attempt: lease.attempt, end }])
    }

    /// Repetitions of which there was no sign of life in time.
    pub(super) fn expire_repeats(&mut self, now: Duration) -> Vec<Change> {
        let mut changes = Vec::new();
        while let Some(i) = self.repeats.held.iter().position(|held| held.deadline <= now) {
            let held = self.drop_repeat(i);
            let task = self.chains[held.claim.place.0].entries[held.claim.place.1].id.clone();
            changes.push(Change::Ended { task, attempt: held.attempt, end: AttemptEnd::Expired });
        }
        changes
    }

    fn drop_repeat(&mut self, i: usize) -> Held {
        let is_suspect = !self.is_believed(&self.repeats.held[i].claim.votes[0].worker);
        self.repeats.drop_held(i, is_suspect)
    }

    /// Moves the times until which those who repeat results are waited for.
    pub(super) fn move_repeats(&mut self, moved: impl Fn(&Holder, Duration) -> Duration) {
        for held in &mut self.repeats.held {
            held.deadline = moved(&held.holder, held.deadline);
        }
    }
}
