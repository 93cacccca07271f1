//! Signs of life, and how long they are waited for.

use super::state::Ledger;
use protocol::from_worker::{Lease, Progress};
use protocol::ids::WorkerId;
use protocol::to_worker::RenewReply;
use results::journal::{AttemptEnd, Change, Holder};
use std::time::Duration;

impl Ledger {
    /// A sign of life. A lease that ran out goes on if nobody else has the task.
    pub fn renew(&mut self, lease: &Lease, progress: Option<Progress>, now: Duration) -> (RenewReply, Vec<Change>) {
        let worker = self.workers.entry(lease.worker.clone()).or_default();
        worker.gone = false;
        if self.renew_repeat(lease, now) {
            return (if self.cancelled { RenewReply::Cancel } else { RenewReply::Ok }, Vec::new());
        }
        let (place, changes) = match self.valid(lease) {
            Some(place) => (Some(place), Vec::new()),
            None => self.adopt(lease, now),
        };
        let Some((c, e)) = place else { return (RenewReply::Lost, changes) };
        if self.cancelled {
            return (RenewReply::Cancel, changes);
        }
        self.chains[c].entries[e].renew(now + self.rules.lease);
        if let Some(progress) = progress {
            self.note(&lease.task, progress, now);
        }
        (RenewReply::Ok, changes)
    }

    /// Takes up a lease that ran out, of a thread that holds nothing else.
    fn adopt(&mut self, lease: &Lease, now: Duration) -> (Option<(usize, usize)>, Vec<Change>) {
        let Some(&(c, e)) = self.index.get(&lease.task) else { return (None, Vec::new()) };
        let holder = Holder { worker: lease.worker.clone(), slot: lease.slot };
        let chain = &self.chains[c];
        let is_last = chain.entries[e].was_granted(lease) && chain.entries[e].attempts() == lease.attempt.0;
        let is_busy = self.held_by(&holder).is_some() || self.repeats.holders().any(|(other, _)| *other == holder);
        if !is_last || !chain.ready.contains(&e) || is_busy {
            return (None, Vec::new());
        }
        let chain = &mut self.chains[c];
        let Some(adopted) = chain.entries[e].adopt(now + self.rules.lease) else { return (None, Vec::new()) };
        let mut changes = vec![adopted];
        changes.extend(chain.settle());
        self.workers.entry(holder.worker).or_default().chains.insert(holder.slot, c);
        (Some((c, e)), changes)
    }

    /// A worker vanished from the bus: its leases are shortened, until it gives a sign of life.
    pub fn worker_gone(&mut self, worker: &WorkerId, now: Duration) {
        let Some(known) = self.workers.get_mut(worker) else { return };
        known.gone = true;
        let grace = (now + self.rules.grace).max(self.forbearance);
        self.move_repeats(|holder, deadline| if holder.worker == *worker { deadline.min(grace) } else { deadline });
        for chain in &mut self.chains {
            for &e in &chain.held {
                chain.entries[e].shorten(worker, grace);
            }
        }
    }

    /// This side could not be reached, or did not run: everybody has the time from now to be heard of again.
    pub fn forbear(&mut self, now: Duration) {
        self.forbearance = now + self.rules.reconnection();
        let until = self.forbearance;
        self.move_repeats(|_, deadline| deadline.max(until));
        for chain in &mut self.chains {
            for &e in &chain.held {
                chain.entries[e].extend(self.forbearance);
            }
        }
    }

    /// Leases that ran out.
    pub fn tick(&mut self, now: Duration) -> Vec<Change> {
        let held = self.chains.iter().enumerate().flat_map(|(c, chain)| chain.held.iter().map(move |&e| (c, e)));
        let places: Vec<(usize, usize)> = held.filter(|&(c, e)| self.chains[c].entries[e].is_expired(now)).collect();
        let end = |orphaned| if orphaned { AttemptEnd::Released } else { AttemptEnd::Expired };
        let ended = places.into_iter().flat_map(|(c, e)| {
            let end = end(self.chains[c].entries[e].orphaned);
            self.end_at(c, e, end, now)
        });
        let mut changes: Vec<Change> = ended.collect();
        changes.extend(self.expire_repeats(now));
        self.repeats.awaited.take_if(|until| *until <= now);
        changes
    }
}
