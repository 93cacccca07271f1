//! What follows from what was found: curves from the folds of branches, and branches from where curves cross levels.
//!
//! Which tasks there are does not depend on the order in which results come: the folds of a level are taken when it and those
//! before it are done, crossings when everything is.

use super::state::Ledger;
use super::task::TaskEntry;
use protocol::ids::TaskId;
use results::journal::{AddedTask, Change};
use solver::response::task::{CrossingPlace, FoldPlace, Task};

impl Ledger {
    /// Adds the tasks that follow from what is known by now.
    pub(super) fn extend(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        loop {
            let mut added = self.folds();
            if added.is_empty() {
                added = self.crossings();
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

    /// Tasks for the folds of levels that are done.
    fn folds(&mut self) -> Vec<(usize, TaskEntry)> {
        let c = self.curves();
        let mut added: Vec<(usize, TaskEntry)> = Vec::new();
        for &l in self.order.iter().filter(|&&l| l != c) {
            let (chain, known) = (&self.chains[l], self.chains[c].entries.len());
            let Some(level) = chain.level().filter(|_| chain.is_finished()) else { break };
            for branch in &level.branches {
                if !self.unfolded.insert((l, branch.known.branch)) {
                    continue;
                }
                for fold in 0..branch.folds {
                    if known + added.len() >= self.rules.most_folds {
                        break;
                    }
                    let task = Task::Fold(FoldPlace { branch: branch.known.branch, fold });
                    added.push((c, TaskEntry::new(TaskId::of_fold(known + added.len()), l, task)));
                }
            }
        }
        added
    }

    /// Tasks for the crossings of curves with levels, once everything else is done.
    fn crossings(&mut self) -> Vec<(usize, TaskEntry)> {
        if !self.is_finished() {
            return Vec::new();
        }
        let curves = self.chains[self.curves()].curves();
        let mut added = Vec::new();
        for (l, (chain, level)) in self.levels().enumerate() {
            let places = curves[self.crossed..].iter().flat_map(|curve| {
                let segments = curve.crossings(level.amplitude.value);
                segments.map(|segment| CrossingPlace { curve: curve.known.number, segment })
            });
            for (i, place) in places.enumerate() {
                let id = TaskId::of_level(&level.amplitude.text, chain.entries.len() + i);
                let id = id.expect("amplitudes are numbers");
                added.push((l, TaskEntry::new(id, l, Task::Crossing(place))));
            }
        }
        self.crossed = curves.len();
        added
    }
}
