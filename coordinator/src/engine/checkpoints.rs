//! What is kept of tasks under way.

use protocol::ids::TaskId;
use protocol::to_worker::CheckpointReply;
use results::journal::{Change, CheckpointPart, Kept};
use std::collections::HashMap;

/// Steps kept of tasks under way, in numbers: the steps themselves are in the store.
#[derive(Debug, Default)]
pub(super) struct Checkpoints {
    kept: HashMap<TaskId, Kept>,
}

impl Checkpoints {
    /// What the store has.
    pub fn new(kept: HashMap<TaskId, Kept>) -> Self {
        Self { kept }
    }

    /// Steps kept of a task.
    pub fn steps(&self, task: &TaskId) -> usize {
        self.kept.get(task).map_or(0, |kept| kept.steps)
    }

    /// Further steps from the holder of a task, of which no more than `most` bytes are kept.
    pub fn add(&mut self, part: CheckpointPart, most: usize) -> (CheckpointReply, Vec<Change>) {
        let CheckpointPart { attempt, first, steps, ref payload, .. } = part;
        let kept = self.kept.get(&part.task).copied().unwrap_or(Kept { steps: 0, bytes: 0, attempt });
        // Sent again, since the answer was lost.
        if kept.attempt == attempt && steps > 0 && first + steps <= kept.steps {
            return (CheckpointReply::Kept, Vec::new());
        }
        let before = if first == 0 { 0 } else { kept.bytes };
        let bytes = before.saturating_add(payload.len());
        let follows = first == 0 || first == kept.steps;
        if !follows || steps == 0 || bytes > most {
            return (CheckpointReply::Enough, Vec::new());
        }
        self.kept.insert(part.task.clone(), Kept { steps: first + steps, bytes, attempt });
        (CheckpointReply::Kept, vec![Change::Checkpoint(part)])
    }

    /// Forgets tasks whose steps are of no use any more.
    pub fn follow(&mut self, changes: &[Change]) {
        for task in changes.iter().filter_map(Change::ends_checkpoint) {
            self.kept.remove(task);
        }
    }
}
