//! The thread that commits: decisions that wait together share one transaction.

use super::decision::News;
use super::meters::Meters;
use results::journal::{AcceptedResult, AttemptEnd, Change, CheckpointPart};
use results::store::{Store, StoreError};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use tracing::{debug, info, warn};
use worker::terminal;

/// Most decisions that share a transaction.
const BATCH: usize = 64;

/// How long another program may hold the file before people are told.
const OTHERS: Duration = Duration::from_secs(2);

/// Time between two messages that the file is locked.
const REMINDER: Duration = Duration::from_secs(60);

/// A decision on its way.
pub struct Decided {
    /// What is to be put on disk.
    pub changes: Vec<Change>,
    /// Gives the answer, then.
    pub answer: Option<Box<dyn FnOnce() + Send>>,
    /// What is to be told, then.
    pub news: Vec<News>,
}

/// Commits decisions, in their order, and then lets answers go and tells the news; until nobody decides any more.
///
/// # Errors
/// If the store cannot be written. Everything that was answered is stored.
pub fn commit(
    mut store: Store,
    decided: &Receiver<Decided>,
    meters: &Meters,
    mut tell: impl FnMut(News),
) -> Result<(), StoreError> {
    store.wait_for_others(OTHERS)?;
    while let Ok(first) = decided.recv() {
        let (mut changes, mut answers, mut news) = (Vec::new(), Vec::new(), Vec::new());
        for decision in std::iter::once(first).chain(decided.try_iter().take(BATCH - 1)) {
            changes.extend(decision.changes);
            answers.extend(decision.answer);
            news.extend(decision.news);
        }
        store.beat();
        if !changes.is_empty() {
            changes.iter().for_each(log);
            let began = Instant::now();
            commit_patiently(&mut store, &changes)?;
            meters.committed(&changes, began.elapsed());
        }
        answers.into_iter().for_each(|answer| answer());
        news.into_iter().for_each(&mut tell);
    }
    Ok(())
}

/// Stores changes, however long another program holds the file: what is decided meanwhile waits.
fn commit_patiently(store: &mut Store, changes: &[Change]) -> Result<(), StoreError> {
    let began = Instant::now();
    let mut told = None;
    loop {
        match store.commit(changes) {
            Err(error) if error.is_busy() => {
                store.beat();
                if told.is_none_or(|told: Instant| told.elapsed() > REMINDER) {
                    let (file, seconds) = (store.file().display(), began.elapsed().as_secs());
                    terminal::note(format_args!(
                        "{file} has been locked by another program for {seconds} s: results wait until it lets go"
                    ));
                    told = Some(Instant::now());
                }
            }
            result => {
                if told.is_some() {
                    let seconds = began.elapsed().as_secs();
                    terminal::note(format_args!("{} was let go after {seconds} s", store.file().display()));
                }
                return result;
            }
        }
    }
}

fn log(change: &Change) {
    match change {
        Change::Granted { task, attempt, holder } => info!(%task, %attempt, worker = %holder.worker, "granted"),
        Change::Ended { task, attempt, end: AttemptEnd::Released } => info!(%task, %attempt, "given back"),
        Change::Repeated { task, attempt, holder } => info!(%task, %attempt, worker = %holder.worker, "repeated"),
        Change::Ended { task, attempt, end: AttemptEnd::Confirmed } => info!(%task, %attempt, "came to the same"),
        Change::Ended { task, attempt, end: AttemptEnd::Disputed(why) } => {
            warn!(%task, %attempt, why, "two results disagree: a third worker decides, if there is one");
        }
        Change::Ended { task, attempt, end: AttemptEnd::Refuted(why) } => {
            warn!(%task, %attempt, why, "a result is wrong");
            terminal::note(format_args!(
                "the result of task {task} is wrong ({why}): what that worker says is computed again"
            ));
        }
        Change::Said { task, attempt, said } => info!(%task, %attempt, "says: {said}"),
        Change::Withdrawn { task } => info!(%task, "to be done as if it never had been"),
        Change::Ended { task, attempt, end } => {
            warn!(%task, %attempt, end = end.name(), reason = end.reason().unwrap_or(""), "attempt ended without a result");
        }
        Change::Adopted { task, attempt } => info!(%task, %attempt, "heard of again"),
        Change::Dead { task } => warn!(%task, "given up"),
        Change::Result(AcceptedResult { result, digest, .. }) => {
            let (task, worker, seconds) = (&result.task, &result.worker, result.seconds);
            info!(%task, %worker, seconds, size = digest.size, "{}", result.outcome);
        }
        Change::HandedOn { task, attempt, steps } => info!(%task, %attempt, steps, "goes on from a checkpoint"),
        Change::Checkpoint(CheckpointPart { task, attempt, first, steps, payload }) => {
            debug!(%task, %attempt, first, steps, size = payload.len(), "checkpoint");
        }
        Change::Stage(stage) => info!("{}", stage.name()),
        Change::Added(tasks) => info!(count = tasks.len(), "tasks added"),
        Change::Planned(_) | Change::Done { .. } | Change::Skipped { .. } | Change::Revived { .. } => {}
    }
}
