//! Reading a run, finished or in progress.

use super::arrays::{array_at, fill, of_points_mut};
use super::branch_id::branch_id;
use super::error::At;
use super::extent::Extent;
use super::header::{corrupt, get, read_header, read_model, read_stage, unpack};
use super::number::number;
use super::plan::{
    read_added, read_backbone, read_further, read_left_out, read_modes, read_orders, read_plans, read_reach,
};
use super::points_table::POINTS;
use super::{FILE, Result, RunHeader, StoreError, database};
use crate::journal::{AddedTask, LevelPlan, OrderPlan};
use protocol::array::Array;
use protocol::backbone::BackboneMessage;
use protocol::codec::{decode_stored, encode, sha256};
use protocol::digest::announced;
use protocol::ids::{TaskId, WorkerId};
use protocol::model::ModelMessage;
use protocol::to_everyone::{Amplitude, Counts, Done, Stage, StoredResult};
use rusqlite::{Connection, OptionalExtension, Params, Row, Transaction};
use solver::response::forced::SearchRange;
use solver::response::modes::{LeftOut, ModesFollowed};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Reads a run, also one in progress.
#[derive(Debug)]
pub struct Reader {
    db: Connection,
    dir: PathBuf,
    file: PathBuf,
    /// Order of motions that is told of, if it is not the first.
    pub(super) order: Option<usize>,
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
        Self { db, dir: dir.into(), file: dir.join(FILE), order: None }
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
        let header = read_header(&self.db, &self.file)?;
        if self.order.is_some() { self.settled(header) } else { Ok(header) }
    }

    /// The model, with its force on the harmonic of the order that is told of.
    pub fn model(&self) -> Result<ModelMessage> {
        Ok(self.forced(read_model(&self.db, &self.file)?))
    }

    /// The model, if it is the one that the run began with.
    pub(crate) fn verified_model(&self) -> Result<ModelMessage> {
        let model = read_model(&self.db, &self.file)?;
        let expected: Option<String> = get(&self.db, &self.file, "model_sha256")?;
        if expected != Some(sha256(&encode(&model))) {
            return Err(corrupt(&self.file, "the model is not the one that the run began with"));
        }
        Ok(self.forced(model))
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
        match self.order {
            None => read_backbone(&self.db, &self.file),
            Some(_) => Ok(self.order_plan()?.and_then(|plan| plan.backbones.into_iter().next())),
        }
    }

    /// The backbones of further modes, once they are known; none of runs of earlier programs, which followed one mode.
    pub fn further_backbones(&self) -> Result<Vec<BackboneMessage>> {
        match self.order {
            None => read_further(&self.db, &self.file),
            Some(_) => {
                Ok(self.order_plan()?.map_or_else(Vec::new, |plan| plan.backbones.into_iter().skip(1).collect()))
            }
        }
    }

    /// Which modes have a backbone and which not; `None` as long as that is not known. Runs of earlier programs followed the
    /// mode that they were told to.
    pub fn modes(&self) -> Result<Option<ModesFollowed>> {
        match self.order {
            None => read_modes(&self.db, &self.file),
            Some(_) => Ok(self.order_plan()?.map(|plan| plan.modes())),
        }
    }

    /// Modes without a backbone, and why; `None` as long as that is not known, and of runs of earlier programs.
    pub fn modes_left_out(&self) -> Result<Option<Vec<(usize, LeftOut)>>> {
        match self.order {
            None => read_left_out(&self.db, &self.file),
            Some(_) => Ok(self.order_plan()?.map(|plan| plan.left_out)),
        }
    }

    /// Within which frequencies and amplitudes branches are followed; known when the backbone is.
    pub fn reach(&self) -> Result<Option<SearchRange>> {
        match self.order {
            None => read_reach(&self.db, &self.file),
            Some(_) => Ok(self.order_plan()?.map(|plan| plan.reach)),
        }
    }

    /// What orders of motions beyond the first one are looked for with; none as long as there is no backbone.
    pub fn orders(&self) -> Result<Vec<OrderPlan>> {
        read_orders(&self.db, &self.file)
    }

    /// Windows and tasks of every level; empty as long as there is no backbone.
    pub fn plans(&self) -> Result<Vec<LevelPlan>> {
        read_plans(&self.db, &self.file)
    }

    /// The tasks that were added over all levels, to follow folds or to verify branches, those of a kind in their order.
    pub fn added(&self) -> Result<Vec<AddedTask>> {
        read_added(&self.db, &self.file)
    }

    pub(super) fn worker_id(&self, id: String) -> Result<WorkerId> {
        WorkerId::new(&id).map_err(|error| corrupt(&self.file, error))
    }

    pub(super) fn task_id(&self, id: &str) -> Result<TaskId> {
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
        let sql = format!("{DONE} WHERE sequence > ?1 ORDER BY sequence");
        self.all(&sql, [sequence as i64], DoneRow::read)?.into_iter().map(|row| row.done(&self.file)).collect()
    }

    /// The announcement of the result of a task, if it has one.
    pub fn done_of(&self, task: &TaskId) -> Result<Option<Done>> {
        let sql = format!("{DONE} WHERE results.task = ?1");
        self.one(&sql, [task.as_str()], DoneRow::read)?.map(|row| row.done(&self.file)).transpose()
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

    /// Name of a branch by what the store says of it.
    pub(super) fn branch_name(&self, kind: &str, number: usize) -> Result<String> {
        let id = branch_id(kind, number).ok_or_else(|| self.corrupt(format!("branch `{kind} {number}`")))?;
        Ok(id.to_string())
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

/// What announcements say.
const DONE: &str = "SELECT sequence, results.task, levels.amplitude, levels.value, tasks.record, branches.kind, \
                    branches.number, size, sha256 FROM results JOIN tasks ON tasks.id = results.task \
                    JOIN levels USING (level) LEFT JOIN branches ON branches.task = results.task";

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
