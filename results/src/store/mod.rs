//! The run on disk: one SQLite file, `run.sqlite`, that is the truth of a run.
//!
//! What a coordinator has committed survives its end, however abrupt; results survive a power cut as well. One
//! coordinator writes ([`Store`]); anyone may read at any time ([`Reader`]). `schema.sql` documents every table for users
//! of pandas, MATLAB or DuckDB.

#[cfg(any(feature = "figures", feature = "page"))]
mod account;
mod arrays;
mod branch_id;
mod changes;
mod checkpoints;
mod comparisons;
mod cross_spectrum;
mod curves;
mod database;
mod displacement;
mod error;
mod evidence;
mod extent;
mod file_system;
mod header;
mod holder;
mod levels;
mod lock;
mod monitor_peaks;
mod motions;
mod number;
mod orders;
mod plan;
mod points_table;
mod pushes;
mod reader;
mod scalars;
mod search_counts;
mod strayed;
mod tasks;
#[cfg(test)]
mod tests;
mod verifications;
mod windows;

pub(crate) use cross_spectrum::CrossSpectrum;
pub(crate) use curves::GRAZING;
pub use curves::{Crossing, CurvePoint, CurveRow};
pub use error::StoreError;
pub use extent::Extent;
pub use file_system::network_file_system;
pub use holder::Holder;
pub use motions::{MotionRow, motion_name};
pub use pushes::{PushRow, least_energy};
pub use reader::Reader;
pub use search_counts::SearchCounts;
pub use verifications::{BifurcationRow, PeakOrbit, Stability, verdict_name};
pub use windows::{WindowOutcome, WindowRow};

#[cfg(any(feature = "figures", feature = "page"))]
pub use account::{TaskRow, WorkerCost};
pub use levels::{BranchRow, Origin};

pub(crate) use branch_id::branch_id;
pub(crate) use displacement::Displacements;
pub(crate) use plan::further_owner;
pub(crate) use scalars::{Scalar, Scalars, scalars};

use crate::clock::now;
use crate::journal::{Change, Extension};
use changes::Changes;
use error::At;
use lock::{LOCK, RunLock};
use protocol::ids::RunId;
use protocol::model::ModelMessage;
use protocol::to_everyone::Amplitude;
use rusqlite::{Connection, TransactionBehavior};
use solver::settings::{Settings, VerifyEffort};
use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The file of a run, in its folder.
pub const FILE: &str = "run.sqlite";

/// Result of an access to the store.
pub type Result<T> = std::result::Result<T, StoreError>;

/// What does not change in the course of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunHeader {
    /// Run.
    pub run: RunId,
    /// Name of the study.
    pub name: String,
    /// Where the study was read from.
    pub study_file: PathBuf,
    /// Keys and values that the command line changed in the study.
    pub overrides: Vec<(String, String)>,
    /// The study with every setting spelled out, TOML.
    pub study: String,
    /// Model.
    pub model: ModelMessage,
    /// SHA-256 of the `model` message.
    pub model_sha256: String,
    /// Numerics.
    pub settings: Settings,
    /// Forcing levels, as in the study.
    pub amplitudes: Vec<Amplitude>,
    /// Version of the program.
    pub program: String,
    /// When the run was created, RFC 3339, UTC.
    pub created: String,
    /// Prefix of the keys on the bus.
    pub namespace: String,
}

/// A run that this process alone carries on. Reads as well.
#[derive(Debug)]
pub struct Store {
    reader: Reader,
    displacements: Displacements,
    /// Whether a commit waits for the disk.
    synchronous: Option<bool>,
    /// Dropped last: the file is closed before the lock is released.
    lock: RunLock,
}

impl Deref for Store {
    type Target = Reader;

    fn deref(&self) -> &Reader {
        &self.reader
    }
}

impl Store {
    /// The file that tells who has a run, beside [`FILE`].
    pub const LOCK: &str = LOCK;

    /// Creates a run in folder `dir`, at the stage where its backbone is computed.
    ///
    /// # Errors
    /// If there is a run already, another coordinator is about to create one, a file is where a folder is to be, or the folder cannot be
    /// written; nothing of the run is left then.
    pub fn create(dir: &Path, header: &RunHeader) -> Result<Self> {
        let file = dir.join(FILE);
        if file.exists() {
            return Err(StoreError::Exists { dir: dir.into() });
        }
        if let Some(file) = dir.ancestors().find(|folder| folder.is_file()) {
            return Err(StoreError::NotAFolder { file: file.into() });
        }
        let is_new = !dir.exists();
        fs::create_dir_all(dir).at(dir)?;
        let lock = RunLock::take(dir)?;
        if file.exists() {
            return Err(StoreError::Exists { dir: dir.into() });
        }
        let built = build(&file, header);
        if built.is_err() {
            let _ = fs::remove_file(dir.join(LOCK));
            if is_new {
                let _ = fs::remove_dir(dir);
            }
        }
        built?;
        Self::with_lock(dir, lock)
    }

    /// Removes what [`Store::create`] made in a folder, of a run that holds nothing.
    pub fn discard(dir: &Path) {
        // Missing is as good as removed.
        for file in [FILE.to_string(), format!("{FILE}-wal"), format!("{FILE}-shm"), LOCK.to_string()] {
            let _ = fs::remove_file(dir.join(file));
        }
    }

    /// Opens the run in folder `dir` to go on with it.
    ///
    /// # Errors
    /// If there is no run, or something that is none, or a damaged one; or if another coordinator has it.
    pub fn open(dir: &Path) -> Result<Self> {
        let file = dir.join(FILE);
        if !file.is_file() {
            return Err(StoreError::Missing { file });
        }
        let lock = RunLock::take(dir)?;
        Self::with_lock(dir, lock)
    }

    fn with_lock(dir: &Path, lock: RunLock) -> Result<Self> {
        let db = database::open_to_write(dir)?;
        let file = dir.join(FILE);
        let displacements = Displacements::new(&header::read_model(&db, &file)?).at(&file)?;
        Ok(Self { reader: Reader::new(db, dir), displacements, synchronous: None, lock })
    }

    /// Stores changes: all or nothing. Returns when nothing short of a power cut can undo them, and with a result, a plan or
    /// a stage among them not even that.
    pub fn commit(&mut self, changes: &[Change]) -> Result<()> {
        let outlasts_power =
            |change: &Change| matches!(change, Change::Result(_) | Change::Planned(_) | Change::Stage(_));
        self.write(changes.iter().any(outlasts_power), |db, file, displacements| {
            let writer = Changes { db, file, displacements, now: now() };
            changes.iter().try_for_each(|change| writer.write(change))
        })
    }

    /// Gives other machines a sign of life, now and then.
    pub fn beat(&mut self) {
        self.lock.beat();
    }

    /// How long a commit waits for another program that writes the file, before it fails as one that may be tried again.
    pub fn wait_for_others(&mut self, patience: Duration) -> Result<()> {
        let (db, file) = self.reader.parts_mut();
        db.busy_timeout(patience).at(file)
    }

    /// Changes what of the branches is to be verified.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn set_verify(&mut self, effort: VerifyEffort) -> Result<()> {
        self.write(true, |db, file, _| header::set(db, file, "verify", header::pack(&effort)))
    }

    /// Adds levels.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn extend(&mut self, extension: &Extension) -> Result<()> {
        self.write(true, |db, file, _| {
            header::set_study(db, file, &extension.study, &extension.overrides)?;
            header::insert_amplitudes(db, file, &extension.amplitudes)?;
            extension.plan.as_ref().map_or(Ok(()), |more| plan::insert_more(db, file, more))
        })
    }

    /// One transaction; `synchronous`: it survives a power cut.
    fn write(
        &mut self,
        synchronous: bool,
        change: impl FnOnce(&Connection, &Path, &Displacements) -> Result<()>,
    ) -> Result<()> {
        let (db, file) = self.reader.parts_mut();
        if self.synchronous != Some(synchronous) {
            db.pragma_update(None, "synchronous", if synchronous { "FULL" } else { "NORMAL" }).at(file)?;
            self.synchronous = Some(synchronous);
        }
        let transaction = db.transaction_with_behavior(TransactionBehavior::Immediate).at(file)?;
        change(&transaction, file, &self.displacements)?;
        transaction.commit().at(file)
    }
}

/// Who conducts the run in folder `dir`, here or on another machine; `None` if nobody does.
pub fn holder(dir: &Path) -> Option<Holder> {
    lock::holder_of(dir)
}

/// Builds the file of a run under another name and gives it its own when it is complete.
fn build(file: &Path, header: &RunHeader) -> Result<()> {
    let partial = file.with_extension("partial");
    remove_partial(&partial);
    let built = fill_new(&partial, header).and_then(|()| fs::rename(&partial, file).at(file));
    // The new name survives a power cut as well, where folders can be synchronised.
    let _ = file.parent().map(fs::File::open).transpose().and_then(|dir| dir.map_or(Ok(()), |dir| dir.sync_all()));
    if built.is_err() {
        remove_partial(&partial);
    }
    built
}

/// What is left of a run that was not completed.
fn remove_partial(partial: &Path) {
    let _ = fs::remove_file(partial);
    let _ = fs::remove_file(partial.with_extension("partial-journal"));
}

fn fill_new(partial: &Path, header: &RunHeader) -> Result<()> {
    let mut db = database::create(partial)?;
    let transaction = db.transaction().at(partial)?;
    header::insert_header(&transaction, partial, header)?;
    transaction.commit().at(partial)?;
    db.close().map_err(|(_, source)| StoreError::from_sqlite(partial, source))
}
