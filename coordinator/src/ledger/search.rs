//! What follows from what was found: branches from branch points of others, curves from the folds of branches and from what is open,
//! and branches from where curves cross levels.
//!
//! Which tasks there are does not depend on the order in which results come: the folds of a level are taken when it and those
//! before it are done, crossings when everything is. Where everything is verified, unstable motions are followed.

use super::chain::Branch;
use super::state::Ledger;
use super::task::TaskEntry;
use protocol::ids::TaskId;
use results::journal::{AddedTask, Change, TaskState};
use solver::response::task::{CarryPlace, CrossingPlace, FoldPlace, Origin, SeedOutcome, Task, VerifyPlace};
use solver::settings::{Stretch, VerifyEffort};

impl Ledger {
    /// Adds the tasks that follow from what is known by now.
    pub(super) fn extend(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        loop {
            let mut added = self.rounds();
            if added.is_empty() {
                added = self.switches();
            }
            if added.is_empty() {
                added = self.curves_over_forcing();
            }
            if added.is_empty() {
                added = self.crossings();
            }
            if added.is_empty() {
                added = self.verify();
            }
            if added.is_empty() {
                added = self.march();
            }
            if added.is_empty() {
                return changes;
            }
            changes.extend(self.add(added));
        }
    }

    fn add(&mut self, added: Vec<(usize, TaskEntry)>) -> Vec<Change> {
        let mut list = Vec::with_capacity(added.len());
        let mut chains = Vec::new();
        for (c, entry) in added {
            let level = self.chains[entry.level].level().expect("tasks are of levels");
            list.push(AddedTask { id: entry.id.clone(), amplitude: level.amplitude.text.clone(), task: entry.task });
            self.index.insert(entry.id.clone(), (c, self.chains[c].entries.len()));
            self.chains[c].entries.push(entry);
            chains.push(c);
        }
        chains.dedup();
        let mut changes = vec![Change::Added(list)];
        changes.extend(chains.into_iter().flat_map(|c| self.chains[c].settle()));
        changes
    }

    /// Tasks for starts whose batch may lead to one more branch.
    fn rounds(&mut self) -> Vec<(usize, TaskEntry)> {
        let mut added = Vec::new();
        for (l, chain) in self.chains.iter_mut().enumerate() {
            for (i, place) in std::mem::take(&mut chain.rounds).into_iter().enumerate() {
                let level = chain.level().expect("starts are of levels");
                let id = TaskId::of_level(&level.amplitude.text, chain.entries.len() + i);
                added.push((l, TaskEntry::new(id.expect("amplitudes are numbers"), l, Task::Begin(place))));
            }
        }
        added
    }

    /// Tasks for the branch points of branches.
    fn switches(&mut self) -> Vec<(usize, TaskEntry)> {
        if self.rules.most_folds == 0 {
            return Vec::new();
        }
        let mut added = Vec::new();
        for (l, chain) in self.chains.iter_mut().enumerate() {
            let new = std::mem::take(&mut chain.crossed).into_iter().filter(|place| self.switched.insert((l, *place)));
            for (i, place) in new.enumerate() {
                let level = chain.level().expect("branches are of levels");
                let id = TaskId::of_level(&level.amplitude.text, chain.entries.len() + i);
                added.push((l, TaskEntry::new(id.expect("amplitudes are numbers"), l, Task::Switch(place))));
            }
        }
        added
    }

    /// Tasks for what is open and the folds of levels whose branches are known, and when everything is done at all levels for the
    /// folds that scouts met; as many as are allowed that lie on no curve known by then.
    fn curves_over_forcing(&mut self) -> Vec<(usize, TaskEntry)> {
        if self.rules.most_folds == 0 {
            return Vec::new();
        }
        let c = self.curves();
        let mut levels = self.order.iter().copied().filter(|&l| l != c);
        let are_done = levels.all(|l| {
            let chain = &self.chains[l];
            let Some(level) = chain.level().filter(|_| chain.has_branches()) else { return chain.level().is_none() };
            for Branch { known, folds } in &level.branches[self.unfolded[l]..] {
                let branch = known.branch;
                let folds = FoldPlace::of(branch, *folds).map(Origin::Fold);
                let places = CarryPlace::of(branch).map(Origin::Carry).chain(folds).map(|origin| (l, origin));
                self.queue.extend(places.filter(|place| !self.followed.contains(place)));
            }
            self.unfolded[l] = level.branches.len();
            true
        });
        if are_done && self.levels().all(|(chain, _)| chain.is_finished()) {
            for (l, chain) in self.chains.iter_mut().enumerate() {
                // Scouts end in any order.
                chain.scouted.sort_by_key(|scouted| (scouted.0.number, scouted.1));
                let place = |(scout, fold)| (l, Origin::Fold(FoldPlace::Scout { scout, fold }));
                let places = chain.scouted.drain(..).map(place);
                self.queue.extend(places.filter(|place| !self.followed.contains(place)));
            }
        }
        let entries = &self.chains[c].entries;
        let is_on_curve = |entry: &&TaskEntry| matches!(entry.state, TaskState::Done(SeedOutcome::OnCurve(_)));
        let known = entries.len();
        // Of those on a curve one is its first.
        let costly = known - entries.iter().filter(is_on_curve).count() + self.chains[c].curves().len();
        let room = self.rules.most_folds.saturating_sub(costly);
        let next = self.queue.drain(..room.min(self.queue.len()));
        let mut added = Vec::new();
        for (i, (l, origin)) in next.enumerate() {
            self.followed.insert((l, origin));
            added.push((c, TaskEntry::new(TaskId::of_curve(known + i, origin), l, origin.into())));
        }
        added
    }

    /// Tasks for the crossings of curves with levels, once everything else is done.
    fn crossings(&mut self) -> Vec<(usize, TaskEntry)> {
        if !self.has_searched() {
            return Vec::new();
        }
        let curves = self.chains[self.curves()].curves();
        let mut added = Vec::new();
        for (l, (chain, level)) in self.levels().enumerate() {
            let order = level.amplitude.order();
            let curves = curves[self.crossed..].iter().filter(|curve| self.order_of(&curve.known.task) == order);
            let places = curves.flat_map(|curve| {
                let segments = curve.crossings(level.amplitude.value);
                segments.map(|segment| CrossingPlace { curve: curve.known.number, segment })
            });
            let new = places.filter(|place| !self.crossings.contains(&(l, place.curve, place.segment)));
            for (i, place) in new.enumerate() {
                let id = TaskId::of_level(&level.amplitude.text, chain.entries.len() + i);
                let id = id.expect("amplitudes are numbers");
                added.push((l, TaskEntry::new(id, l, Task::Crossing(place))));
            }
        }
        self.crossed = curves.len();
        added
    }

    /// Tasks that march on from unstable motions found since.
    fn march(&mut self) -> Vec<(usize, TaskEntry)> {
        // Where a motion ends is told by the branches of its level: all of them have to be known.
        if self.rules.verify != VerifyEffort::All || !self.has_searched() {
            return Vec::new();
        }
        let c = self.verifications();
        let mut unsettled = std::mem::take(&mut self.chains[c].unsettled);
        unsettled.sort_by_key(|(l, place)| (*l, place.branch, place.index));
        let mut added = Vec::new();
        for (l, place) in unsettled {
            if self.marched.insert((l, place.branch, place.index)) {
                let level = self.chains[l].level().expect("branches are of levels");
                let id = TaskId::of_march(&level.amplitude.text, &place).expect("amplitudes are numbers");
                added.push((c, TaskEntry::new(id, l, Task::March(place))));
            }
        }
        added
    }

    /// Tasks that verify branches found since.
    fn verify(&mut self) -> Vec<(usize, TaskEntry)> {
        let (c, effort) = (self.verifications(), self.rules.verify);
        let mut added = Vec::new();
        for (l, chain) in self.chains.iter_mut().enumerate() {
            for branch in std::mem::take(&mut chain.unverified) {
                let Some(place) = VerifyPlace::of(effort, branch) else { continue };
                let whole = VerifyPlace { stretch: Stretch::Whole, branch };
                if !self.verified.contains(&(l, whole)) && self.verified.insert((l, place)) {
                    let level = chain.level().expect("branches are of levels");
                    let id = TaskId::of_verification(&level.amplitude.text, &place).expect("amplitudes are numbers");
                    added.push((c, TaskEntry::new(id, l, Task::Verify(place))));
                }
            }
        }
        added
    }
}
