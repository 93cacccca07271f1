//! How fast so many workers can be at best: no faster than all of the work divided among them, nor than the longest chain of
//! tasks of which each has to know what the one before it found.

use crate::recording::{Recorded, Recording};
use protocol::ids::TaskId;
use solver::response::seeds::LandingMethod;
use solver::response::starts::StartWay;
use solver::response::task::{CarryPlace, FoldPlace, SeedOutcome, SeedPlace, Task};
use std::collections::HashMap;

/// What a recording consists of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Computing time of all tasks, s.
    pub work: f64,
    /// The longest chain of tasks that depend on each other, s.
    pub chain: f64,
}

impl Bound {
    /// Of a recording.
    pub fn of(recording: &Recording) -> Self {
        Self { work: recording.work(), chain: longest_chain(&recording.tasks) }
    }

    /// The shortest time in which so many workers can do it, s.
    pub fn time(&self, workers: usize) -> f64 {
        self.chain.max(self.work / workers as f64)
    }
}

/// When tasks end that begin as soon as those are done that they depend on, the latest of them, s.
fn longest_chain(tasks: &[Recorded]) -> f64 {
    let mut order: Vec<&Recorded> = tasks.iter().collect();
    order.sort_by_key(|task| (stage(&task.work), position(&task.id)));
    let mut ends = Ends::default();
    for task in order {
        let begin = ends.before(task);
        ends.add(task, begin + task.seconds);
    }
    ends.last
}

/// Tasks of a later stage never come before those of an earlier one that they depend on.
fn stage(work: &Task) -> usize {
    match work {
        Task::Main(_) | Task::Land(_) | Task::Seed(_) | Task::Start(_) | Task::Begin(_) | Task::Switch(_) => 0,
        Task::Scout(_) => 0,
        Task::Fold(_) | Task::Carry(_) => 1,
        Task::Crossing(_) => 2,
        Task::Verify(_) | Task::Disturb(_) => 3,
        Task::March(_) => 4,
    }
}

/// Its turn among the tasks of its level or of its kind, with which its name ends.
fn position(id: &TaskId) -> usize {
    id.as_str().rsplit('-').next().and_then(|text| text.parse().ok()).unwrap_or(0)
}

/// When tasks end, s.
#[derive(Default)]
struct Ends {
    /// Of a level, by name: the last of the tasks that follow each other.
    levels: HashMap<String, f64>,
    /// Landings and starts, with their levels.
    landings: Vec<(String, Task, f64)>,
    /// Where a branch was found, as its level and name.
    branches: Vec<(String, SeedOutcome, f64)>,
    /// Number of a curve over the forcing.
    curves: HashMap<usize, f64>,
    /// Everything but what follows from curves and what is marched.
    search: f64,
    /// The last of what is followed over the forcing, one after the other.
    folds: f64,
    last: f64,
}

impl Ends {
    /// When a task can begin, s.
    fn before(&self, task: &Recorded) -> f64 {
        let level = &task.level;
        let own = self.levels.get(level).copied().unwrap_or(0.0);
        let landed = |wanted: Task| {
            let same = self.landings.iter().find(|(of, work, _)| of == level && *work == wanted);
            same.map_or(0.0, |(.., end)| *end)
        };
        match task.work {
            Task::Main(_) => own,
            Task::Land(place) if place.method == LandingMethod::SteppedForcing => {
                landed(Task::Seed(SeedPlace { method: LandingMethod::FullForcing, ..place }))
            }
            Task::Start(place) if place.way == StartWay::Homotopy => own,
            Task::Land(_) | Task::Start(_) | Task::Scout(_) => 0.0,
            Task::Seed(place) => own.max(landed(Task::Land(place))),
            Task::Begin(place) => own.max(landed(Task::Start(place.landing()))),
            Task::Switch(place) => own.max(self.found(level, SeedOutcome::Found(place.branch))),
            Task::Fold(FoldPlace::Branch { branch, .. }) | Task::Carry(CarryPlace { branch, .. }) => {
                self.folds.max(self.found(level, SeedOutcome::Found(branch)))
            }
            Task::Fold(FoldPlace::Scout { scout, .. }) => self.folds.max(self.search).max(landed(Task::Scout(scout))),
            Task::Crossing(place) => own.max(self.search).max(self.curves.get(&place.curve).copied().unwrap_or(0.0)),
            Task::Verify(place) => self.found(level, SeedOutcome::Found(place.branch)),
            Task::Disturb(place) => self.found(level, SeedOutcome::Found(place.branch)),
            Task::March(_) => self.search,
        }
    }

    fn found(&self, level: &str, branch: SeedOutcome) -> f64 {
        let same = self.branches.iter().find(|(of, outcome, _)| of == level && *outcome == branch);
        same.map_or(0.0, |(.., end)| *end)
    }

    fn add(&mut self, task: &Recorded, end: f64) {
        let level = &task.level;
        self.last = self.last.max(end);
        if stage(&task.work) == 0 {
            self.search = self.search.max(end);
        }
        match task.work {
            Task::Fold(_) | Task::Carry(_) => self.folds = end,
            // Forcing in steps waits for what became of a seed, which others follow on as well.
            Task::Land(_) | Task::Start(_) | Task::Scout(_) | Task::Seed(_) => {
                self.landings.push((level.clone(), task.work, end))
            }
            _ => {}
        }
        if task.work.is_ordered() && task.work.origin().is_none() {
            self.levels.insert(level.clone(), end);
        }
        match task.outcome {
            SeedOutcome::OnCurve(number) => drop(self.curves.entry(number).or_insert(end)),
            found @ SeedOutcome::Found(_) if matches!(task.work, Task::Main(_) | Task::Seed(_) | Task::Begin(_)) => {
                self.branches.push((level.clone(), found, end));
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::branch::TaskResultMessage;
    use solver::response::branch::Side;
    use solver::response::seeds::{LandingFailure, Phase};
    use solver::response::windows::Window;

    fn task(name: &str, work: Task, seconds: f64) -> Recorded {
        let outcome = SeedOutcome::NotLanded(LandingFailure::Far(1.0));
        let finding = TaskResultMessage::Nothing(outcome);
        Recorded { id: TaskId::new(name).unwrap(), level: "1".into(), work, outcome, seconds, finding }
    }

    fn place(method: LandingMethod) -> SeedPlace {
        let well = Window { mode: 0, first: 0, last: 0, best: 0, threshold: 0.0, omega: (1.0, 1.0) };
        SeedPlace { window: 0, well, phase: Phase::First, method }
    }

    #[test]
    fn a_chain_waits_for_landings_and_landings_in_steps_for_the_chain() {
        let (full, steps) = (place(LandingMethod::FullForcing), place(LandingMethod::SteppedForcing));
        // As they came: not in the order in which they depend on each other.
        let tasks = [
            task("1-2", Task::Land(full), 5.0),
            task("1-0", Task::Main(Side::Below), 2.0),
            task("1-1", Task::Main(Side::Above), 1.0),
            task("1-4", Task::Land(steps), 4.0),
            task("1-3", Task::Seed(full), 1.0),
            task("1-5", Task::Seed(steps), 1.0),
        ];
        // The landing is longer than both main branches; 5 + 1, then 4 + 1.
        assert_eq!(longest_chain(&tasks), 11.0);
        let bound = Bound { work: 14.0, chain: longest_chain(&tasks) };
        assert_eq!((bound.time(1), bound.time(2)), (14.0, 11.0));
    }

    #[test]
    fn levels_do_not_wait_for_each_other() {
        let other = Recorded { level: "2".into(), ..task("2-0", Task::Main(Side::Below), 3.0) };
        assert_eq!(longest_chain(&[task("1-0", Task::Main(Side::Below), 2.0), other]), 3.0);
    }
}
