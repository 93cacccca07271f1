//! The one thread that decides: ledger and store, requests in, answers and announcements out.
//!
//! Requests that wait together share one commit; an answer is given only after it.

mod answer;
mod job;

pub use job::{Job, News, Ready, Responder};

use crate::ledger::{Ledger, Record, Rules};
use crate::store::{Change, Store, StoreError};
use protocol::backbone::BackboneMessage;
use protocol::control::{ControlReply, ControlRequest};
use protocol::curve::Size;
use protocol::from_worker::{FailRequest, Progress, ReleaseRequest};
use protocol::to_everyone::{Manifest, Stage, Status, StoredResult};
use solver::backbone::Backbone;
use solver::forced::{Forced, Reach};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use tracing::{info, warn};

/// Time between two reports of the status.
const STATUS_PERIOD: Duration = Duration::from_millis(500);
/// Most requests that share a commit.
const BATCH: usize = 64;

/// Ledger, store and what answers need.
pub struct Engine<'m> {
    store: Store,
    manifest: Manifest,
    rules: Rules,
    size: Size,
    model: &'m solver::model::Model,
    sweep: Option<Sweep<'m>>,
    backbone: Option<Progress>,
    news: Box<dyn FnMut(News) + Send + 'm>,
    origin: Instant,
    first_grant: Option<(Instant, usize)>,
    stopping: bool,
}

struct Sweep<'m> {
    forced: Forced<'m>,
    backbone: Backbone,
    reach: Reach,
    ledger: Ledger,
}

/// An answer that waits for the commit.
type Answer = Box<dyn FnOnce()>;

/// What a job changes.
enum Effect {
    Record(Record),
    Result { result: Box<StoredResult>, sequence: u64, size: u64, sha256: String },
}

impl<'m> Engine<'m> {
    /// Engine of the run that `manifest` describes.
    pub fn new(
        store: Store,
        manifest: Manifest,
        rules: Rules,
        model: &'m solver::model::Model,
        news: impl FnMut(News) + Send + 'm,
    ) -> Self {
        Self {
            store,
            rules,
            size: Size::of(model),
            model,
            sweep: None,
            backbone: None,
            news: Box::new(news),
            origin: Instant::now(),
            first_grant: None,
            stopping: false,
            manifest,
        }
    }

    /// Decides until the senders of jobs are gone.
    ///
    /// # Errors
    /// If the store cannot be written: nothing that was answered is lost.
    pub fn run(mut self, jobs: &Receiver<Job>) -> Result<(), StoreError> {
        let mut reported = Instant::now();
        self.report();
        loop {
            let mut batch = Vec::new();
            match jobs.recv_timeout(STATUS_PERIOD.saturating_sub(reported.elapsed())) {
                Ok(job) => batch.push(job),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            batch.extend(jobs.try_iter().take(BATCH - 1));
            self.carry_out(batch)?;
            if reported.elapsed() >= STATUS_PERIOD {
                self.report();
                reported = Instant::now();
            }
        }
    }

    fn carry_out(&mut self, batch: Vec<Job>) -> Result<(), StoreError> {
        let now = self.origin.elapsed();
        let mut effects: Vec<Effect> = Vec::new();
        let mut answers: Vec<Answer> = Vec::new();
        let mut news: Vec<News> = Vec::new();
        // While the process ends nobody is asked to go on, and nothing is held against anybody.
        if let Some(sweep) = self.sweep.as_mut().filter(|_| !self.stopping) {
            effects.extend(sweep.ledger.tick(now).into_iter().map(Effect::Record));
        }
        for job in batch {
            self.decide(job, now, &mut effects, &mut answers, &mut news)?;
        }
        for effect in &effects {
            log(effect);
        }
        let changes: Vec<Change<'_>> = effects.iter().map(Effect::change).collect();
        if !changes.is_empty() {
            self.store.commit(&changes)?;
        }
        answers.into_iter().for_each(|answer| answer());
        news.into_iter().for_each(|news| (self.news)(news));
        let finished = self.sweep.as_ref().is_some_and(|sweep| sweep.ledger.is_finished());
        if finished && self.manifest.stage == Stage::Sweep {
            self.enter(Stage::Finished)?;
        }
        Ok(())
    }

    fn decide(
        &mut self,
        job: Job,
        now: Duration,
        effects: &mut Vec<Effect>,
        answers: &mut Vec<Answer>,
        news: &mut Vec<News>,
    ) -> Result<(), StoreError> {
        let mut records = Vec::new();
        match job {
            Job::Lease(request, respond) => {
                let reply = self.lease(&request, now, &mut records, news);
                answers.push(Box::new(move || respond(reply)));
            }
            Job::Renew(request, respond) => {
                // Without an answer it is asked again: the sweep is about to begin.
                if let Some(sweep) = &mut self.sweep {
                    let reply = sweep.ledger.renew(&request.lease, request.progress, now);
                    answers.push(Box::new(move || respond(reply)));
                }
            }
            Job::Submit(..) | Job::Fail(..) | Job::Release(..) if self.sweep.is_none() => {}
            Job::Submit(request, respond) => {
                let reply = self.submit(*request, effects, news)?;
                answers.push(Box::new(move || respond(reply)));
            }
            Job::Fail(FailRequest { lease, reason }, respond) => {
                let reply = self.end(|ledger| ledger.fail(&lease, &reason, now), &mut records);
                answers.push(Box::new(move || respond(reply)));
            }
            Job::Release(ReleaseRequest { lease }, respond) => {
                let reply = self.end(|ledger| ledger.release(&lease, now), &mut records);
                answers.push(Box::new(move || respond(reply)));
            }
            Job::Control(request, respond) => {
                let message = self.control(request, &mut records, news)?;
                answers.push(Box::new(move || respond(ControlReply { message })));
            }
            Job::WorkerGone(worker) => {
                if let Some(sweep) = &mut self.sweep {
                    sweep.ledger.worker_gone(&worker, now);
                }
            }
            Job::Progress(task, progress) => {
                if let Some(sweep) = &mut self.sweep {
                    sweep.ledger.note(&task, progress);
                }
            }
            Job::Backbone(progress) => self.backbone = Some(progress),
            Job::Ready(ready) if self.manifest.stage == Stage::Backbone || !ready.fresh => self.begin(*ready)?,
            // Cancelled in between.
            Job::Ready(_) => {}
            Job::Stop => self.stopping = true,
        }
        effects.extend(records.into_iter().map(Effect::Record));
        Ok(())
    }

    fn begin(&mut self, ready: Ready) -> Result<(), StoreError> {
        let Ready { backbone, reach, plans, tasks, fresh } = ready;
        if fresh {
            self.store.set_backbone(&BackboneMessage::from(&backbone), &reach, &plans)?;
        }
        let (ledger, records) = Ledger::restore(self.rules, plans, tasks, self.origin.elapsed());
        let changes: Vec<Change<'_>> = records.iter().map(Change::Record).collect();
        self.store.commit(&changes)?;
        // The amplitude does not matter: only its frequency–time tables are used, to make seeds.
        let forced = Forced::new(self.model, &self.manifest.settings, reach, 1.0);
        self.manifest.reach = Some(reach);
        self.sweep = Some(Sweep { forced, backbone, reach, ledger });
        self.enter(Stage::Sweep)
    }

    fn enter(&mut self, stage: Stage) -> Result<(), StoreError> {
        self.manifest.stage = stage;
        self.store.set_stage(stage)?;
        (self.news)(News::Manifest(self.manifest.clone()));
        self.report();
        Ok(())
    }

    fn control(
        &mut self,
        request: ControlRequest,
        records: &mut Vec<Record>,
        news: &mut Vec<News>,
    ) -> Result<String, StoreError> {
        let run = self.manifest.run.clone();
        match (request, &mut self.sweep, self.manifest.stage) {
            (_, _, Stage::Finished) if request == ControlRequest::Cancel => {
                Ok(format!("run {run} has finished already"))
            }
            (ControlRequest::Cancel, sweep, _) => {
                if let Some(sweep) = sweep {
                    sweep.ledger.cancel();
                }
                self.enter(Stage::Cancelled)?;
                news.push(News::Hint);
                Ok(format!("run {run} is cancelled; what is stored stays"))
            }
            (ControlRequest::RetryDead, _, Stage::Cancelled) => {
                Ok(format!("run {run} was cancelled: go on with `isola resume` first"))
            }
            (ControlRequest::RetryDead, Some(sweep), stage) => {
                let revived = sweep.ledger.retry_dead();
                let count = revived.iter().filter(|record| matches!(record, Record::Revived { .. })).count();
                records.extend(revived);
                if count > 0 && stage == Stage::Finished {
                    self.enter(Stage::Sweep)?;
                }
                Ok(format!("{count} dead tasks of run {run} are tried again"))
            }
            (ControlRequest::RetryDead, None, _) => Ok(format!("run {run} has not begun: there are no dead tasks")),
        }
    }

    fn report(&mut self) {
        let status = self.status();
        (self.news)(News::Status(status));
    }

    fn status(&self) -> Status {
        let ledger = self.sweep.as_ref().map(|sweep| &sweep.ledger);
        let tasks = ledger.map(Ledger::counts).unwrap_or_default();
        let (levels, levels_done) = ledger.map_or((self.manifest.amplitudes.len(), 0), Ledger::levels);
        let settled = tasks.done + tasks.skipped + tasks.dead;
        let eta = self.first_grant.and_then(|(since, before)| {
            let rate = (settled - before.min(settled)) as f64 / since.elapsed().as_secs_f64();
            (rate > 0.0).then(|| (tasks.waiting + tasks.running) as f64 / rate)
        });
        Status {
            run: self.manifest.run.clone(),
            name: self.manifest.name.clone(),
            stage: self.manifest.stage,
            backbone: self.backbone,
            tasks,
            levels,
            levels_done,
            active: ledger.map(Ledger::active).unwrap_or_default(),
            workers: ledger.map(Ledger::workers).unwrap_or_default(),
            sequence: ledger.map_or(0, Ledger::sequence),
            elapsed: self.origin.elapsed().as_secs_f64(),
            eta,
        }
    }
}

impl Effect {
    fn change(&self) -> Change<'_> {
        match self {
            Effect::Record(record) => Change::Record(record),
            Effect::Result { result, sequence, size, sha256 } => {
                Change::Result { result, sequence: *sequence, size: *size, sha256 }
            }
        }
    }
}

fn log(effect: &Effect) {
    match effect {
        Effect::Record(Record::Granted { task, attempt, worker, .. }) => info!(%task, %attempt, %worker, "granted"),
        Effect::Record(Record::Ended { task, attempt, end }) => {
            warn!(%task, %attempt, end = end.name(), reason = end.reason().unwrap_or(""), "attempt ended without a result");
        }
        Effect::Record(Record::Dead { task }) => warn!(%task, "given up"),
        Effect::Record(_) => {}
        Effect::Result { result, size, .. } => {
            info!(task = %result.task, worker = %result.worker, seconds = result.seconds, size, "{}", result.outcome);
        }
    }
}
