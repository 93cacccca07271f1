//! A run that is finished: what every task took and brought.

use protocol::branch::TaskResultMessage;
use protocol::ids::TaskId;
use protocol::to_everyone::StoredResult;
use results::journal::TaskState;
use results::store::{Reader, RunHeader};
use solver::response::seeds::LandingFailure;
use solver::response::task::{SeedOutcome, Task};
use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

/// What becomes of a landing that was not recorded.
const NOT_LANDED: SeedOutcome = SeedOutcome::NotLanded(LandingFailure::Far(1.0));

/// A task that was done.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Task.
    pub id: TaskId,
    /// Name of its level.
    pub level: String,
    /// What was to be done.
    pub work: Task,
    /// What became of it.
    pub outcome: SeedOutcome,
    /// Computing time, s.
    pub seconds: f64,
    /// What it brought.
    pub finding: TaskResultMessage,
}

/// A run that is finished.
#[derive(Debug)]
pub struct Recording {
    /// What does not change in the course of a run.
    pub header: RunHeader,
    /// Tasks that were done, in the order of their announcements.
    pub tasks: Vec<Recorded>,
    index: HashMap<TaskId, usize>,
    /// What a landing that was not carried out is taken to last, s.
    landing: f64,
}

impl Recording {
    /// The run in a folder; every computing time multiplied by `scale`.
    ///
    /// # Errors
    /// If it cannot be read, or tasks of it are left.
    pub fn read(folder: &Path, scale: f64) -> Result<Self, Box<dyn Error>> {
        let reader = Reader::open(folder)?;
        let header = reader.header()?;
        let mut tasks = Vec::new();
        for stored in reader.tasks()? {
            match stored.state {
                TaskState::Done(_) => {}
                TaskState::Skipped => continue,
                state => return Err(format!("{}: task {} is {state:?}", folder.display(), stored.id).into()),
            }
            let result = reader.result(&stored.id)?.ok_or_else(|| format!("task {} has no result", stored.id))?;
            tasks.push(recorded(result, scale)?);
        }
        let index = tasks.iter().enumerate().map(|(place, task)| (task.id.clone(), place)).collect();
        let landings: Vec<f64> =
            tasks.iter().filter(|task| matches!(task.work, Task::Land(_))).map(|task| task.seconds).collect();
        let landing = landings.iter().sum::<f64>() / landings.len().max(1) as f64;
        Ok(Self { header, tasks, index, landing })
    }

    /// What a task of the run took and brought.
    pub fn task(&self, id: &TaskId) -> Option<&Recorded> {
        self.index.get(id).map(|&place| &self.tasks[place])
    }

    /// Time, s, and finding for a task that was handed out; `None` if it is not of this run.
    ///
    /// Many workers land seeds that fewer would not have come to before it was known that they are not needed. Nothing follows
    /// from what those land on: one takes as long as others do on average, and lands on nothing.
    pub fn answer(&self, id: &TaskId, work: &Task) -> Option<(f64, TaskResultMessage)> {
        match (self.task(id), work) {
            (Some(task), _) => Some((task.seconds, task.finding.clone())),
            (None, Task::Land(_)) => Some((self.landing, TaskResultMessage::Nothing(NOT_LANDED))),
            (None, _) => None,
        }
    }

    /// Computing time of all tasks, s.
    pub fn work(&self) -> f64 {
        self.tasks.iter().map(|task| task.seconds).sum()
    }
}

fn recorded(result: StoredResult, scale: f64) -> Result<Recorded, String> {
    let StoredResult { task: id, amplitude, work, outcome, name, seconds, .. } = result;
    let found = [
        result.branch.filter(|_| name.is_some()).map(TaskResultMessage::Branch),
        result.curve.map(TaskResultMessage::Curve),
        result.landings.map(TaskResultMessage::Landings),
        result.verification.map(TaskResultMessage::Verification),
        result.disturbance.map(TaskResultMessage::Disturbance),
        result.settling.map(TaskResultMessage::Settling),
    ];
    let finding = found.into_iter().flatten().next().unwrap_or(TaskResultMessage::Nothing(outcome));
    Ok(Recorded { id, level: amplitude.text, work, outcome, seconds: seconds * scale, finding })
}
