//! Reading a run, finished or in progress.

use super::arrays::{array_at, fill, of_points_mut};
use super::branch_id::branch_id;
use super::error::At;
use super::extent::Extent;
use super::header::{corrupt, get, read_header, read_model, read_stage, unpack};
use super::number::number;
use super::plan::{read_added, read_backbone, read_further, read_left_out, read_modes, read_plans, read_reach};
use super::points_table::POINTS;
use super::{FILE, Result, RunHeader, StoreError, database};
use crate::journal::{AddedTask, AttemptEnd, Holder, LevelPlan, StoredTask, TaskState, Troubles};
use protocol::array::Array;
use protocol::backbone::BackboneMessage;
use protocol::codec::{decode_stored, encode, sha256};
use protocol::digest::announced;
use protocol::ids::{TaskId, WorkerId};
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, Counts, Done, Stage, StoredResult};
use rusqlite::{Connection, OptionalExtension, Params, Row, Transaction};
use solver::response::branch::{BranchKind, SpecialKind, SpecialPoint};
use solver::response::forced::Reach;
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::response::task::Brought;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Reads a run, also one in progress.
#[derive(Debug)]
pub struct Reader {
    db: Connection,
    dir: PathBuf,
    file: PathBuf,
}

impl Reader {
    /// Opens the run in folder `dir` for reading. No lock is needed, nor, for a run that was closed in order,
    /// permission to write there.
    ///
    /// # Errors
    /// If there is no run, or something that is none.
    pub fn open(dir: &Path) -> Result<Self> {
        Ok(Self::new(database::open_to_read(dir)?, dir))
    }

    pub(super) fn new(db: Connection, dir: &Path) -> Self {
        Self { db, dir: dir.into(), file: dir.join(FILE) }
    }

    pub(super) fn parts_mut(&mut self) -> (&mut Connection, &Path) {
        (&mut self.db, &self.file)
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Folder of the run.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// What does not change.
    pub fn header(&self) -> Result<RunHeader> {
        read_header(&self.db, &self.file)
    }

    /// The model.
    pub fn model(&self) -> Result<ModelMessage> {
        read_model(&self.db, &self.file)
    }

    /// The model, if it is the one that the run began with.
    pub(crate) fn verified_model(&self) -> Result<ModelMessage> {
        let model = self.model()?;
        let expected: Option<String> = get(&self.db, &self.file, "model_sha256")?;
        if expected != Some(sha256(&encode(&model))) {
            return Err(corrupt(&self.file, "the model is not the one that the run began with"));
        }
        Ok(model)
    }

    /// Whether the tables and indices of the file hang together.
    ///
    /// # Errors
    /// With the first thing that does not.
    pub(crate) fn check(&self) -> Result<()> {
        let check: String = self.db.query_row("PRAGMA quick_check(1)", [], |row| row.get(0)).at(&self.file)?;
        if check == "ok" { Ok(()) } else { Err(corrupt(&self.file, check)) }
    }

    /// Where the run is.
    pub fn stage(&self) -> Result<Stage> {
        read_stage(&self.db, &self.file)
    }

    /// Tasks by state.
    pub fn counts(&self) -> Result<Counts> {
        let mut counts = Counts::default();
        let sql = "SELECT state, count(*) FROM tasks GROUP BY state UNION ALL SELECT 'branch', count(*) FROM branches";
        for (state, count) in self.all(sql, [], |row| Ok((row.get::<_, String>(0)?, row.get(1)?)))? {
            match state.as_str() {
                "done" => counts.done = count,
                "skipped" => counts.skipped = count,
                "leased" => counts.running = count,
                "waiting" => counts.waiting = count,
                "dead" => counts.dead = count,
                _ => counts.branches = count,
            }
        }
        Ok(counts)
    }

    /// The backbone of the primary mode, once it is known.
    pub fn backbone(&self) -> Result<Option<BackboneMessage>> {
        read_backbone(&self.db, &self.file)
    }

    /// The backbones of further modes, once they are known; none of runs of earlier programs, which followed one mode.
    pub fn further_backbones(&self) -> Result<Vec<BackboneMessage>> {
        read_further(&self.db, &self.file)
    }

    /// Which modes have a backbone and which not; `None` as long as that is not known. Runs of earlier programs followed the
    /// mode that they were told to.
    pub fn modes(&self) -> Result<Option<ModesFollowed>> {
        read_modes(&self.db, &self.file)
    }

    /// Modes without a backbone, and why; `None` as long as that is not known, and of runs of earlier programs.
    pub fn modes_left_out(&self) -> Result<Option<Vec<(usize, LeftOut)>>> {
        read_left_out(&self.db, &self.file)
    }

    /// Within which frequencies and amplitudes branches are followed; known when the backbone is.
    pub fn reach(&self) -> Result<Option<Reach>> {
        read_reach(&self.db, &self.file)
    }

    /// Windows and tasks of every level; empty as long as there is no backbone.
    pub fn plans(&self) -> Result<Vec<LevelPlan>> {
        read_plans(&self.db, &self.file)
    }

    /// The tasks that were added over all levels, to follow folds or to verify branches, those of a kind in their order.
    pub fn added(&self) -> Result<Vec<AddedTask>> {
        read_added(&self.db, &self.file)
    }

    /// Tasks with what became of them: those done in the order of their announcements, then the others.
    pub fn tasks(&self) -> Result<Vec<StoredTask>> {
        let (mut troubles, mut forcings, mut holders) = (self.troubles()?, self.forcings()?, self.holders()?);
        let sql = "SELECT tasks.id, state, tasks.record, branches.kind, special FROM tasks LEFT JOIN results ON results.task = tasks.id \
                   LEFT JOIN branches ON branches.task = tasks.id \
                   ORDER BY sequence IS NULL, sequence, tasks.level, position";
        let rows = self.all(sql, [], TaskRow::read)?;
        let task = |row: TaskRow| {
            let troubles = troubles.remove(&row.id).unwrap_or_default();
            let curve = forcings.remove(&row.id).map(Brought::Curve);
            let holders = holders.remove(&row.id).unwrap_or_default();
            Ok(StoredTask {
                id: self.task_id(&row.id)?,
                brought: self.branch_brought(&row)?.or(curve),
                troubles,
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
        let folds = special.iter().filter(|special| special.kind == SpecialKind::Fold).count();
        Ok(Some(Brought::Branch { kind, folds }))
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
            ("done", Some(record), _) => TaskState::Done(unpack(&self.file, &record)?),
            ("leased", _, Some(holder)) => TaskState::Leased { holder: holder.clone(), deadline: Duration::ZERO },
            ("skipped", ..) => TaskState::Skipped,
            ("dead", ..) => TaskState::Dead,
            ("waiting", ..) => TaskState::Waiting,
            (state, ..) => return Err(corrupt(&self.file, format!("task {}: state `{state}`", row.id))),
        })
    }

    fn worker_id(&self, id: String) -> Result<WorkerId> {
        WorkerId::new(&id).map_err(|error| corrupt(&self.file, error))
    }

    fn task_id(&self, id: &str) -> Result<TaskId> {
        TaskId::new(id).map_err(|error| corrupt(&self.file, error))
    }

    /// The result of a task: its encoding has the SHA-256 that was announced.
    pub fn result(&self, task: &TaskId) -> Result<Option<StoredResult>> {
        Ok(self.verified(task)?.map(|(result, _)| result))
    }

    /// The encoding of the result of a task, to the byte what was announced.
    pub fn encoded_result(&self, task: &TaskId) -> Result<Option<Vec<u8>>> {
        Ok(self.verified(task)?.map(|(_, bytes)| bytes))
    }

    fn verified(&self, task: &TaskId) -> Result<Option<(StoredResult, Vec<u8>)>> {
        let sql = "SELECT record, sha256, branches.id FROM results LEFT JOIN branches USING (task) WHERE task = ?1";
        let row =
            |row: &Row<'_>| Ok((row.get::<_, Vec<u8>>(0)?, row.get::<_, String>(1)?, row.get::<_, Option<i64>>(2)?));
        let Some((record, expected, branch)) = self.one(sql, [task.as_str()], row)? else { return Ok(None) };
        let mut result: StoredResult = decode_stored(&record).map_err(|error| corrupt(&self.file, error))?;
        if let (Some(message), Some(id)) = (&mut result.branch, branch) {
            let (db, file) = (&self.db, &self.file);
            fill(db, file, (task.as_str(), &POINTS), id, of_points_mut(&mut message.points))?;
        }
        let bytes = announced(&result, &expected);
        let bytes = bytes.ok_or_else(|| self.corrupt(format!("the result of task {task} is not what was stored")))?;
        Ok(Some((result, bytes)))
    }

    /// All announcements, in order.
    pub fn done(&self) -> Result<Vec<Done>> {
        self.done_since(0)
    }

    /// The announcements after number `sequence`, in order.
    pub fn done_since(&self, sequence: u64) -> Result<Vec<Done>> {
        let sql = "SELECT sequence, results.task, levels.amplitude, levels.value, tasks.record, branches.kind, \
                   branches.number, size, sha256 FROM results JOIN tasks ON tasks.id = results.task \
                   JOIN levels USING (level) LEFT JOIN branches ON branches.task = results.task \
                   WHERE sequence > ?1 ORDER BY sequence";
        self.all(sql, [sequence as i64], DoneRow::read)?.into_iter().map(|row| row.done(&self.file)).collect()
    }

    /// The branches found so far in numbers, by the tasks that found them.
    pub fn extents(&self) -> Result<HashMap<TaskId, Extent>> {
        let sql = "SELECT task, omega_min, omega_max, amplitude_max, omega_at_max, points FROM branches";
        let row = |row: &Row<'_>| {
            let extent = Extent::from([number(row, 1)?, number(row, 2)?, number(row, 3)?, number(row, 4)?]);
            Ok((row.get::<_, String>(0)?, Extent { points: row.get(5)?, ..extent }))
        };
        self.all(sql, [], row)?.into_iter().map(|(task, extent)| Ok((self.task_id(&task)?, extent))).collect()
    }

    /// What is stored makes no sense.
    pub(crate) fn corrupt(&self, detail: impl std::fmt::Display) -> StoreError {
        corrupt(&self.file, detail)
    }

    /// Version of the schema.
    pub(super) fn version(&self) -> Result<i64> {
        database::version(&self.db, &self.file)
    }

    /// An array that is stored as such.
    pub(crate) fn array(&self, owner: &str, name: &str) -> Result<Option<Array>> {
        let sql = "SELECT dtype, shape, data FROM arrays WHERE owner = ?1 AND name = ?2";
        self.one(sql, [owner, name], |row| array_at(row, 0))
    }

    /// Everything read until the guard is dropped is of one moment.
    pub fn snapshot(&self) -> Result<Transaction<'_>> {
        self.db.unchecked_transaction().at(&self.file)
    }

    /// Hands the rows that `sql` selects to `sink`, one after the other.
    pub(super) fn each<T, E: From<StoreError>>(
        &self,
        sql: &str,
        params: impl Params,
        map: impl Fn(&Row<'_>) -> rusqlite::Result<T>,
        mut sink: impl FnMut(T) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        let mut statement = self.db.prepare_cached(sql).at(&self.file)?;
        let mut rows = statement.query(params).at(&self.file)?;
        while let Some(row) = rows.next().at(&self.file)? {
            sink(map(row).at(&self.file)?)?;
        }
        Ok(())
    }

    /// The rows that `sql` selects.
    pub(super) fn all<T>(
        &self,
        sql: &str,
        params: impl Params,
        map: impl Fn(&Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<Vec<T>> {
        let mut list = Vec::new();
        self.each(sql, params, map, |item| -> Result<()> {
            list.push(item);
            Ok(())
        })?;
        Ok(list)
    }

    /// The row that `sql` selects, if any.
    pub(super) fn one<T>(
        &self,
        sql: &str,
        params: impl Params,
        map: impl Fn(&Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<Option<T>> {
        let mut statement = self.db.prepare_cached(sql).at(&self.file)?;
        statement.query_row(params, |row| map(row)).optional().at(&self.file)
    }
}

struct TaskRow {
    id: String,
    state: String,
    record: Option<Vec<u8>>,
    /// Kind and special points.
    branch: Option<(String, String)>,
}

impl TaskRow {
    fn read(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            id: row.get(0)?,
            state: row.get(1)?,
            record: row.get(2)?,
            branch: row.get::<_, Option<String>>(3)?.zip(row.get(4)?),
        })
    }
}

struct DoneRow {
    sequence: u64,
    task: String,
    amplitude: Amplitude,
    record: Vec<u8>,
    branch: Option<(String, usize)>,
    size: u64,
    sha256: String,
}

impl DoneRow {
    fn read(row: &Row<'_>) -> rusqlite::Result<Self> {
        let kind: Option<String> = row.get(5)?;
        Ok(Self {
            sequence: row.get(0)?,
            task: row.get(1)?,
            amplitude: Amplitude { text: row.get(2)?, value: row.get(3)? },
            record: row.get(4)?,
            branch: kind.zip(row.get(6)?),
            size: row.get(7)?,
            sha256: row.get(8)?,
        })
    }

    fn done(self, file: &Path) -> Result<Done> {
        let name = |(kind, number): (String, usize)| {
            branch_id(&kind, number).ok_or_else(|| corrupt(file, format!("branch `{kind} {number}`")))
        };
        Ok(Done {
            sequence: self.sequence,
            task: TaskId::new(&self.task).map_err(|error| corrupt(file, error))?,
            amplitude: self.amplitude,
            outcome: unpack(file, &self.record)?,
            branch: self.branch.map(name).transpose()?,
            size: self.size,
            sha256: self.sha256,
        })
    }
}
