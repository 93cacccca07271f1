//! Tasks of a run, with what became of them and what they brought: what a ledger begins with.

use super::header::{corrupt, unpack};
use super::{Reader, Result, StoreError};
use crate::journal::{AttemptEnd, Holder, StoredTask, TaskState, Troubles};
use rusqlite::Row;
use solver::response::branch::{BranchKind, SpecialKind, SpecialPoint};
use solver::response::task::Brought;
use std::collections::HashMap;
use std::time::Duration;

impl Reader {
    /// Tasks with what became of them: those done in the order of their announcements, then the others.
    pub fn tasks(&self) -> Result<Vec<StoredTask>> {
        let (mut troubles, mut forcings, mut holders) = (self.troubles()?, self.forcings()?, self.holders()?);
        let mut evidence = self.evidence()?;
        let sql = "SELECT tasks.id, state, tasks.record, branches.kind, special, \
                   tasks.kind = 'verify' AND state = 'done' FROM tasks LEFT JOIN results ON results.task = tasks.id \
                   LEFT JOIN branches ON branches.task = tasks.id \
                   ORDER BY sequence IS NULL, sequence, tasks.level, position";
        let rows = self.all(sql, [], TaskRow::read)?;
        let task = |row: TaskRow| {
            let troubles = troubles.remove(&row.id).unwrap_or_default();
            let curve = forcings.remove(&row.id).map(Brought::Curve);
            let holders = holders.remove(&row.id).unwrap_or_default();
            let evidence = evidence.remove(&row.id).unwrap_or_default();
            Ok(StoredTask {
                id: self.task_id(&row.id)?,
                brought: self.branch_brought(&row)?.or(curve).or(self.marched(&row)?),
                troubles,
                evidence,
                state: self.state(row, holders.last())?,
                holders,
            })
        };
        rows.into_iter().map(task).collect()
    }

    /// The new branch that a task brought.
    fn branch_brought(&self, row: &TaskRow) -> Result<Option<Brought>> {
        let Some((kind, special)) = &row.branch else { return Ok(None) };
        let kind = BranchKind::named(kind).ok_or_else(|| self.corrupt(format!("a branch of kind `{kind}`")))?;
        let special: Vec<SpecialPoint> = serde_json::from_str(special).map_err(|error| self.corrupt(error))?;
        let count = |kind| special.iter().filter(|special| special.kind == kind).count();
        let (folds, branch_points) = (count(SpecialKind::Fold), count(SpecialKind::BranchPoint));
        Ok(Some(Brought::Branch { kind, folds, branch_points }))
    }

    /// What follows from what marching says of a branch.
    fn marched(&self, row: &TaskRow) -> Result<Option<Brought>> {
        if !row.is_verification {
            return Ok(None);
        }
        // Of a damaged one nothing follows; that it is damaged is said where it is read for itself.
        let found = match self.result(&self.task_id(&row.id)?) {
            Err(StoreError::Corrupt { .. }) => None,
            found => found?.and_then(|result| result.verification),
        };
        Ok(found.map(|found| Brought::Verification(found.points.len(), found.unsettled().into())))
    }

    /// What has gone wrong with tasks, as far as it counts.
    fn troubles(&self) -> Result<HashMap<String, Troubles>> {
        let sql = "SELECT task, worker, \"end\", reason FROM attempts JOIN tasks ON tasks.id = task \
                   WHERE \"end\" IN ('failed', 'refused', 'expired') AND attempt > forgiven ORDER BY task, attempt";
        let mut troubles: HashMap<String, Troubles> = HashMap::new();
        let read = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get(1)?, row.get::<_, String>(2)?, row.get(3)?));
        for (task, worker, end, reason) in self.all(sql, [], read)? {
            let end = AttemptEnd::named(&end, reason).ok_or_else(|| self.corrupt(format!("an attempt `{end}`")))?;
            troubles.entry(task).or_default().note(&self.worker_id(worker)?, &end);
        }
        Ok(troubles)
    }

    /// To whom tasks were handed out, one an attempt, in their order.
    fn holders(&self) -> Result<HashMap<String, Vec<Holder>>> {
        let sql = "SELECT task, worker, slot FROM attempts ORDER BY task, attempt";
        let mut holders: HashMap<String, Vec<Holder>> = HashMap::new();
        let read = |row: &Row<'_>| Ok((row.get::<_, String>(0)?, row.get(1)?, row.get(2)?));
        for (task, worker, slot) in self.all(sql, [], read)? {
            let worker = self.worker_id(worker)?;
            holders.entry(task).or_default().push(Holder { worker, slot });
        }
        Ok(holders)
    }

    fn state(&self, row: TaskRow, holder: Option<&Holder>) -> Result<TaskState> {
        Ok(match (row.state.as_str(), row.record, holder) {
            ("done", Some(record), _) => TaskState::Done(unpack(self.file(), &record)?),
            ("leased", _, Some(holder)) => TaskState::Leased { holder: holder.clone(), deadline: Duration::ZERO },
            ("skipped", ..) => TaskState::Skipped,
            ("dead", ..) => TaskState::Dead,
            ("waiting", ..) => TaskState::Waiting,
            (state, ..) => return Err(corrupt(self.file(), format!("task {}: state `{state}`", row.id))),
        })
    }
}

struct TaskRow {
    id: String,
    state: String,
    record: Option<Vec<u8>>,
    /// Kind and special points.
    branch: Option<(String, String)>,
    is_verification: bool,
}

impl TaskRow {
    fn read(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            id: row.get(0)?,
            state: row.get(1)?,
            record: row.get(2)?,
            branch: row.get::<_, Option<String>>(3)?.zip(row.get(4)?),
            is_verification: row.get(5)?,
        })
    }
}
