//! What changes in the course of a run: tasks, attempts, results.

use super::Result;
use super::arrays::{empty_points, insert, insert_rest, of_points};
use super::checkpoints::{forget, insert_part};
use super::curves::insert_curve;
use super::displacement::Displacements;
use super::error::At;
use super::evidence::insert_said;
use super::extent::{Extent, contact_range};
use super::header::{pack, set_stage};
use super::motions::insert_motion;
use super::plan::{insert_added, insert_plan};
use super::points_table::POINTS;
use super::pushes::insert_push;
use super::scalars::Scalars;
use super::verifications::insert_verification;
use crate::journal::{AcceptedResult, AttemptEnd, Change, Holder};
use protocol::branch::BranchMessage;
use protocol::codec::encode;
use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::{Stage, StoredResult};
use rusqlite::{Connection, OptionalExtension, Params, params};
use solver::response::branch::{Outcome, Standing};
use solver::response::task::{BranchId, SeedOutcome, Task};
use std::path::Path;

/// Writes changes, all at one time.
pub(super) struct Changes<'a> {
    /// The transaction.
    pub db: &'a Connection,
    /// Its file.
    pub file: &'a Path,
    /// Displacements of the model.
    pub displacements: &'a Displacements,
    /// When.
    pub now: String,
}

impl Changes<'_> {
    /// Writes one change.
    pub fn write(&self, change: &Change) -> Result<()> {
        if let Some(task) = change.ends_checkpoint() {
            forget(self.db, self.file, task)?;
        }
        match change {
            Change::Stage(stage) => {
                if *stage == Stage::Sweep {
                    self.end_repetitions()?;
                }
                set_stage(self.db, self.file, *stage)
            }
            Change::Planned(plan) => insert_plan(self.db, self.file, plan, self.displacements),
            Change::Added(tasks) => insert_added(self.db, self.file, tasks),
            Change::Granted { task, attempt, holder } => self.granted(task, *attempt, holder),
            Change::Repeated { task, attempt, holder } => self.attempted(task, *attempt, holder),
            Change::Ended { task, attempt, end } => self.ended(task, *attempt, end),
            Change::Said { task, attempt, said } => insert_said(self.db, self.file, task, *attempt, *said),
            Change::Withdrawn { task } => self.withdrawn(task),
            Change::Adopted { task, attempt } => self.adopted(task, *attempt),
            Change::HandedOn { task, attempt, steps } => self.handed_on(task, *attempt, *steps),
            Change::Checkpoint(part) => insert_part(self.db, self.file, part),
            Change::Done { task, attempt, outcome, .. } => self.done(task, *attempt, outcome),
            Change::Result(accepted) => self.result(accepted),
            Change::Skipped { task } => self.state(task, "skipped"),
            Change::Dead { task } => self.state(task, "dead"),
            Change::Revived { task } => {
                self.execute("UPDATE tasks SET state = 'waiting', forgiven = attempts WHERE id = ?1", [task.as_str()])
            }
        }
    }

    fn execute(&self, sql: &str, params: impl Params) -> Result<()> {
        self.db.prepare_cached(sql).at(self.file)?.execute(params).at(self.file)?;
        Ok(())
    }

    fn state(&self, task: &TaskId, state: &str) -> Result<()> {
        self.execute("UPDATE tasks SET state = ?2 WHERE id = ?1", [task.as_str(), state])
    }

    fn granted(&self, task: &TaskId, attempt: Attempt, holder: &Holder) -> Result<()> {
        self.execute(
            "UPDATE tasks SET state = 'leased', attempts = ?2 WHERE id = ?1",
            params![task.as_str(), attempt.0],
        )?;
        self.attempted(task, attempt, holder)
    }

    fn attempted(&self, task: &TaskId, attempt: Attempt, holder: &Holder) -> Result<()> {
        let sql = "INSERT INTO attempts (task, attempt, worker, slot, granted_at) VALUES (?1, ?2, ?3, ?4, ?5)";
        self.execute(sql, params![task.as_str(), attempt.0, holder.worker.as_str(), holder.slot, self.now])
    }

    /// When a sweep begins, or goes on with another coordinator, nothing that is done is being repeated.
    fn end_repetitions(&self) -> Result<()> {
        let sql = "UPDATE attempts SET ended_at = ?1, \"end\" = 'released' \
                   WHERE ended_at IS NULL AND task IN (SELECT id FROM tasks WHERE state = 'done')";
        self.execute(sql, [&self.now])
    }

    fn ended(&self, task: &TaskId, attempt: Attempt, end: &AttemptEnd) -> Result<()> {
        let sql = "UPDATE attempts SET ended_at = ?3, \"end\" = ?4, \
                   reason = CASE ?4 WHEN 'expired' THEN worker || ': no sign of life' ELSE ?5 END \
                   WHERE task = ?1 AND attempt = ?2";
        self.execute(sql, params![task.as_str(), attempt.0, self.now, end.name(), end.reason()])?;
        self.execute("UPDATE tasks SET state = 'waiting' WHERE id = ?1 AND state = 'leased'", [task.as_str()])
    }

    /// Takes back a result; announcements are counted as if it never had been one.
    fn withdrawn(&self, task: &TaskId) -> Result<()> {
        let sql = "UPDATE tasks SET state = 'waiting', outcome = NULL, found = NULL, branch = NULL, record = NULL WHERE id = ?1";
        self.execute(sql, [task.as_str()])?;
        let sql = "DELETE FROM results WHERE task = ?1 RETURNING sequence";
        let mut statement = self.db.prepare_cached(sql).at(self.file)?;
        let deleted = statement.query_row([task.as_str()], |row| row.get::<_, i64>(0)).optional().at(self.file)?;
        let Some(sequence) = deleted else { return Ok(()) };
        // By way of negative numbers: at no time two are the same.
        self.execute("UPDATE results SET sequence = 1 - sequence WHERE sequence > ?1", [sequence])?;
        self.execute("UPDATE results SET sequence = -sequence WHERE sequence < 0", [])
    }

    fn handed_on(&self, task: &TaskId, attempt: Attempt, steps: usize) -> Result<()> {
        let sql = "UPDATE attempts SET checkpoint = ?3 WHERE task = ?1 AND attempt = ?2";
        self.execute(sql, params![task.as_str(), attempt.0, steps as i64])
    }

    fn adopted(&self, task: &TaskId, attempt: Attempt) -> Result<()> {
        let sql = "UPDATE attempts SET ended_at = NULL, \"end\" = NULL, reason = NULL, lapses = lapses + 1 \
                   WHERE task = ?1 AND attempt = ?2";
        self.execute(sql, params![task.as_str(), attempt.0])?;
        self.state(task, "leased")
    }

    fn done(&self, task: &TaskId, attempt: Attempt, outcome: &SeedOutcome) -> Result<()> {
        let branch = outcome.branch().map(|id| id.to_string());
        let found = branch.is_some()
            || matches!(
                outcome,
                SeedOutcome::OnCurve(_)
                    | SeedOutcome::Landed(_)
                    | SeedOutcome::Verified(_)
                    | SeedOutcome::Disturbed(_)
                    | SeedOutcome::Marched(_)
            );
        let sql = "UPDATE tasks SET state = 'done', outcome = ?2, found = ?3, branch = ?4, record = ?5 WHERE id = ?1";
        self.execute(sql, params![task.as_str(), outcome.to_string(), found, branch, pack(outcome)])?;
        let sql = "UPDATE attempts SET ended_at = ?3, \"end\" = 'done' \
                   WHERE task = ?1 AND attempt = ?2 AND ended_at IS NULL";
        self.execute(sql, params![task.as_str(), attempt.0, self.now])
    }

    fn result(&self, accepted: &AcceptedResult) -> Result<()> {
        let AcceptedResult { result, sequence, digest } = accepted;
        let named = result.branch.as_ref().zip(result.name);
        let record = if named.is_some() { encode(&without_numbers(result)) } else { encode(&**result) };
        let row = params![
            *sequence as i64,
            result.task.as_str(),
            result.attempt.0,
            result.worker.as_str(),
            result.program,
            result.seconds,
            digest.size as i64,
            digest.sha256,
            record,
        ];
        let sql = "INSERT INTO results (sequence, task, attempt, worker, program, seconds, size, sha256, record) \
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
        self.execute(sql, row)?;
        match (named, &result.curve, result.outcome) {
            (Some((branch, name)), ..) => self.branch(&result.task, branch, name),
            (None, Some(curve), SeedOutcome::OnCurve(number)) => {
                insert_curve(self.db, self.file, &result.task, number, curve)
            }
            _ => self.marched(result),
        }
    }

    /// What time marching says.
    fn marched(&self, result: &StoredResult) -> Result<()> {
        let (task, amplitude) = (&result.task, result.amplitude.text.as_str());
        match (&result.work, &result.verification, &result.disturbance, &result.settling) {
            (Task::Verify(place), Some(verification), ..) => {
                insert_verification(self.db, self.file, (task, amplitude, place), verification)
            }
            (Task::Disturb(place), _, Some(disturbance), _) => {
                insert_push(self.db, self.file, (task, amplitude, place), disturbance)
            }
            (Task::March(place), .., Some(settling)) => {
                insert_motion(self.db, self.file, (task, amplitude, place), settling)
            }
            _ => Ok(()),
        }
    }

    fn branch(&self, task: &TaskId, branch: &BranchMessage, name: BranchId) -> Result<()> {
        let points = Scalars::new(&branch.points).at(self.file)?;
        let certificate = branch.certificate.unwrap_or_default();
        let range = certificate.doubled.and_then(|doubled| doubled.range);
        // Beginnings and ends of contact that could not be located are those of points.
        let contact = certificate.contact_omega.or_else(|| contact_range(&points));
        let summary = Extent::of_scalars(&points);
        let row = params![
            task.as_str(),
            name.kind.name(),
            name.number + 1,
            branch.outcome.to_string(),
            branch.outcome == Outcome::Closed,
            points.omega.len(),
            branch.rejections,
            serde_json::to_string(&branch.special).expect("a list of indices"),
            summary.omega_min,
            summary.omega_max,
            summary.amplitude_max,
            summary.omega_at_max,
            contact.map(|(low, _)| low),
            contact.map(|(_, high)| high),
            branch.peak_standing.map(Standing::name),
            certificate.penetration,
            certificate.pressure_beyond,
            certificate.doubled.map(|doubled| doubled.amplitude),
            certificate.doubled.map(|doubled| doubled.shift),
            range.map(|(low, _)| low),
            range.map(|(_, high)| high),
            certificate.elsewhere.and_then(|change| change.share),
            certificate.elsewhere.map(|change| change.omega),
            certificate.slowest_sliding,
        ];
        let sql = "INSERT INTO branches (task, level, amplitude, kind, number, status, closed, points, rejections, \
                   special, omega_min, omega_max, amplitude_max, omega_at_max, contact_omega_min, contact_omega_max, \
                   peak_standing, penetration, pressure_beyond, amplitude_2h, shift_2h, omega_min_2h, omega_max_2h, \
                   change_2h, change_omega_2h, slowest_sliding) \
                   SELECT ?1, level, amplitude, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, \
                   ?18, ?19, ?20, ?21, ?22, ?23, ?24 \
                   FROM tasks JOIN levels USING (level) WHERE tasks.id = ?1";
        self.execute(sql, row)?;
        let id = self.db.last_insert_rowid();
        let held = POINTS.insert(self.db, self.file, id, &[&points.omega], &points.columns)?;
        insert_rest(self.db, self.file, task.as_str(), &of_points(&branch.points), &held)?;
        let displacement = self.displacements.array(&branch.points.motions).at(self.file)?;
        insert(self.db, self.file, task.as_str(), "displacement", &displacement)
    }
}

fn without_numbers(result: &StoredResult) -> StoredResult {
    let without_arrays = |branch: &BranchMessage| BranchMessage {
        kind: branch.kind,
        amplitude: branch.amplitude,
        outcome: branch.outcome,
        special: branch.special.clone(),
        rejections: branch.rejections,
        peak_standing: branch.peak_standing,
        certificate: branch.certificate,
        points: empty_points(&branch.points),
    };
    StoredResult {
        task: result.task.clone(),
        attempt: result.attempt,
        amplitude: result.amplitude.clone(),
        work: result.work,
        outcome: result.outcome,
        name: result.name,
        branch: result.branch.as_ref().map(without_arrays),
        curve: None,
        landings: None,
        verification: None,
        disturbance: None,
        settling: None,
        worker: result.worker.clone(),
        program: result.program.clone(),
        seconds: result.seconds,
    }
}
