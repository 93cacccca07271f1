//! When it will be over, as far as that is known.

use super::chain::Chain;
use super::cost::Cost;
use super::state::Ledger;
use results::journal::{KINDS, TaskState, place_of_kind};
use solver::response::task::Task;

/// Computing threads are taken to be used no less than this share of the time: what is only starting tells nothing.
const LEAST_USE: f64 = 0.05;

impl Ledger {
    /// Time to the end, s: what tasks of each kind took on average, as often as they were needed so far, over the threads that are there
    /// and the share of their time that they have computed so far while there were tasks; but no less than a level takes by itself, whose branches follow one
    /// after the other. Levels that are not done ask for as many further tasks as those that are: nothing is known as long as none is.
    pub fn time_left(&self) -> Option<f64> {
        let all = self.costs.iter().copied().fold(Cost::default(), Cost::and).mean()?;
        let expected = self.expected(all);
        let (mut work, mut under_way, mut longest) = (self.asked_for(&expected), 0.0, 0.0f64);
        for chain in &self.chains {
            let mut row = 0.0;
            for entry in &chain.entries {
                let left = match entry.state {
                    TaskState::Waiting => expected[place_of_kind(&entry.task)],
                    TaskState::Leased { .. } => self.costs[place_of_kind(&entry.task)].expected(all) / 2.0,
                    _ => continue,
                };
                under_way += if matches!(entry.state, TaskState::Waiting) { 0.0 } else { left };
                work += left;
                row += if entry.task.is_ordered() { left } else { 0.0 };
            }
            longest = longest.max(row);
        }
        let threads = self.threads() as f64;
        (threads > 0.0).then(|| longest.max(work / (threads * self.used(under_way))))
    }

    /// What a task of each kind that waits is expected to take, s.
    fn expected(&self, all: f64) -> Vec<f64> {
        let mut needed = [(0, 0); KINDS.len()];
        for entry in self.entries() {
            let (done, skipped) = &mut needed[place_of_kind(&entry.task)];
            *done += usize::from(matches!(entry.state, TaskState::Done(_)));
            *skipped += usize::from(matches!(entry.state, TaskState::Skipped));
        }
        let share = |(done, skipped): (usize, usize)| (done + 1) as f64 / (done + skipped + 1) as f64;
        needed.into_iter().zip(&self.costs).map(|(needed, cost)| share(needed) * cost.expected(all)).collect()
    }

    /// What tasks are going to take that levels under way and to come will ask for, as those that are done did: s.
    fn asked_for(&self, expected: &[f64]) -> f64 {
        // Others follow curves over all levels, or are planned.
        let is_of_level = |task: &Task| matches!(task, Task::Begin(_) | Task::Switch(_) | Task::Verify(_));
        let mut asked = vec![0.0; self.chains.len()];
        for entry in self.entries().filter(|entry| is_of_level(&entry.task)) {
            asked[entry.level] += expected[place_of_kind(&entry.task)];
        }
        let is_done = |chain: &Chain| chain.has_branches();
        let levels = || self.chains.iter().zip(&asked).filter(|(chain, _)| chain.level().is_some());
        let done: Vec<f64> = levels().filter(|(chain, _)| is_done(chain)).map(|(_, asked)| *asked).collect();
        if done.is_empty() {
            return 0.0;
        }
        let mean = done.iter().sum::<f64>() / done.len() as f64;
        levels().filter(|(chain, _)| !is_done(chain)).map(|(_, asked)| (mean - asked).max(0.0)).sum()
    }

    /// The share of their time that threads have computed since the coordinator started, as long as there were tasks; with what is
    /// `under_way`, s.
    fn used(&self, under_way: f64) -> f64 {
        let wanted: f64 = self.workers.values().map(|worker| worker.wanted.as_secs_f64()).sum();
        let computed: f64 = self.costs.iter().map(|cost| cost.seconds).sum::<f64>() + under_way;
        if wanted > 0.0 { (computed / wanted).clamp(LEAST_USE, 1.0) } else { 1.0 }
    }
}
