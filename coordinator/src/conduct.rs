//! A run from its beginning, or from where it was left, to its end.

use crate::bus::{Presence, Published, Shared, announce, serve};
use crate::cli::ServeArgs;
use crate::display::Display;
use crate::engine::{Engine, Job, News, Ready};
use crate::error::Error;
use crate::ledger::{LevelPlan, Rules};
use crate::local::{Launch, LocalWorkers};
use crate::place::{Place, alone};
use crate::rundir::{remove_address, write_address};
use crate::store::{Reader, RunHeader, Store, StoreError};
use crate::{closing, export, prepare};
use protocol::codec::encode;
use protocol::keys::Keys;
use protocol::to_everyone::{LevelWindows, Manifest, Stage, Status};
use solver::model::Model;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::{oneshot, watch};

/// Time between two looks at how things are.
const TICK: Duration = Duration::from_millis(200);
/// Time for local workers to give back what they have.
const WORKER_PATIENCE: Duration = Duration::from_secs(5);

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Every task is done.
    Complete,
    /// Tasks were given up, or the run was cancelled.
    Incomplete,
    /// Somebody wanted this process to end.
    Interrupted,
}

/// What a run needs from beginning to end.
struct Conductor {
    directory: PathBuf,
    header: RunHeader,
    options: ServeArgs,
    place: Place,
    manifest: watch::Receiver<Manifest>,
    status: watch::Receiver<Option<Status>>,
    sweep: Arc<Mutex<Option<Arc<Published>>>>,
    jobs: Sender<Job>,
    engine: oneshot::Receiver<Result<(), StoreError>>,
    interrupts: Interrupts,
    presence: Presence,
}

/// Signals that ask this process to end.
struct Interrupts {
    interrupt: Signal,
    terminate: Signal,
}

impl Interrupts {
    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }
}

/// Carries out a run from where its store stands.
///
/// # Errors
/// If the store cannot be written, or there is no backbone. What was accepted is stored; the run can be resumed.
pub async fn conduct(
    directory: &Path,
    store: Store,
    model: Model,
    place: Place,
    options: ServeArgs,
) -> Result<Ending, Error> {
    let header = store.header()?;
    let keys = Keys::new(&header.namespace, &header.run);
    alone(&place.session, &keys).await?;
    let stored = prepare::stored(&store)?;
    let rules = Rules { lease: Duration::from_secs_f64(options.lease), ..Rules::default() };
    let stage = if stored.is_some() { Stage::Sweep } else { Stage::Backbone };
    let first = prepare::manifest(&header, stage, rules.lease);
    let (manifest_sender, manifest) = watch::channel(first.clone());
    let (status_sender, status) = watch::channel(None);
    let (jobs, job_receiver) = channel();
    let (news_sender, news) = channel();
    let model = Arc::new(model);
    let sweep = Arc::new(Mutex::new(None));
    let shared = Shared {
        manifest: manifest.clone(),
        status: status.clone(),
        model_bytes: Arc::new(encode(&header.model)),
        model: model.clone(),
        sweep: sweep.clone(),
    };
    // A run that goes on is there before anybody asks: workers that survived keep what they have.
    let has_begun = stored.is_some();
    if let Some(ready) = stored {
        begin(ready, &sweep, &jobs);
    }
    let presence = serve(&place.session, &keys, directory.to_path_buf(), shared, jobs.clone())
        .await
        .map_err(|error| Error::Other(format!("the run cannot be served on the bus: {error}")))?;
    let announcer = place.session.clone();
    std::thread::spawn(move || announce(&announcer, &keys, &news));
    let (ended, engine) = oneshot::channel();
    let engine_model = model.clone();
    std::thread::spawn(move || {
        let tell = move |news: News| {
            match &news {
                News::Manifest(manifest) => drop(manifest_sender.send(manifest.clone())),
                News::Status(status) => drop(status_sender.send(Some(status.clone()))),
                _ => {}
            }
            // The announcer lives as long as the process.
            let _ = news_sender.send(news);
        };
        let engine = Engine::new(store, first, rules, &engine_model, tell);
        let _ = ended.send(engine.run(&job_receiver));
    });
    write_address(directory, &place.endpoint).map_err(Error::io(directory))?;
    let interrupts = Interrupts {
        interrupt: signal(SignalKind::interrupt()).map_err(Error::io("SIGINT"))?,
        terminate: signal(SignalKind::terminate()).map_err(Error::io("SIGTERM"))?,
    };
    let conductor = Conductor {
        directory: directory.to_path_buf(),
        header,
        options,
        place,
        manifest,
        status,
        sweep,
        jobs,
        engine,
        interrupts,
        presence,
    };
    let directory = conductor.directory.clone();
    let ending = conductor.run((!has_begun).then_some(model)).await;
    remove_address(&directory);
    ending
}

/// Shows what is known when the sweep begins, and lets it begin.
fn begin(ready: Ready, sweep: &Mutex<Option<Arc<Published>>>, jobs: &Sender<Job>) {
    let level = |plan: &LevelPlan| LevelWindows { amplitude: plan.amplitude.clone(), windows: plan.windows.clone() };
    let levels = ready.plans.iter().map(level).collect();
    let published = Published::new(ready.backbone.clone(), ready.reach, levels);
    *sweep.lock().expect("no holder of this lock panics") = Some(Arc::new(published));
    // If the engine has ended, it says why when it is asked.
    let _ = jobs.send(Job::Ready(Box::new(ready)));
}

impl Conductor {
    /// To the end; the model is given if its backbone is still to be computed.
    async fn run(mut self, without_backbone: Option<Arc<Model>>) -> Result<Ending, Error> {
        let mut display = Display::new();
        if let Some(model) = without_backbone {
            match self.compute_backbone(model, &mut display).await? {
                Some(ready) => begin(ready, &self.sweep, &self.jobs),
                None => {
                    display.clear();
                    if self.stage() != Stage::Cancelled {
                        return self.close(Ending::Interrupted, None).await;
                    }
                    self.dismiss().await;
                    return self.close(Ending::Incomplete, None).await;
                }
            }
        }
        self.wait_for(|stage| stage != Stage::Backbone).await?;
        loop {
            let mut workers = self.start_workers()?;
            let interrupted = self.follow(&mut display, &mut workers).await?;
            display.clear();
            if interrupted {
                return self.close(Ending::Interrupted, workers).await;
            }
            self.finish(workers).await?;
            // Somebody may have put dead tasks back meanwhile.
            if self.stage() == Stage::Sweep {
                continue;
            }
            if !self.options.stay {
                let ending = self.ending();
                return self.close(ending, None).await;
            }
            eprintln!("the run stays on the bus at {}; Ctrl-C ends it", self.place.endpoint);
            if !self.wait_for_work().await? {
                let ending = self.ending();
                return self.close(ending, None).await;
            }
        }
    }

    fn stage(&self) -> Stage {
        self.manifest.borrow().stage
    }

    fn send(&self, job: Job) {
        // If the engine has ended, it says why when it is asked.
        let _ = self.jobs.send(job);
    }

    /// Backbone and tasks; `None` if interrupted or cancelled.
    async fn compute_backbone(&mut self, model: Arc<Model>, display: &mut Display) -> Result<Option<Ready>, Error> {
        let stop = Arc::new(AtomicBool::new(false));
        let (settings, amplitudes) = (self.header.settings, self.header.amplitudes.clone());
        let (jobs, stopped) = (self.jobs.clone(), stop.clone());
        let mut computing =
            tokio::task::spawn_blocking(move || prepare::compute(&model, &settings, amplitudes, &jobs, &stopped));
        let mut tick = tokio::time::interval(TICK);
        loop {
            tokio::select! {
                ready = &mut computing => return ready.map_err(abnormal)?,
                () = self.interrupts.next() => stop.store(true, Ordering::Relaxed),
                ended = &mut self.engine => return Err(engine_error(ended)),
                _ = tick.tick() => {
                    if self.stage() == Stage::Cancelled {
                        stop.store(true, Ordering::Relaxed);
                    }
                    self.show(display);
                }
            }
        }
    }

    fn show(&self, display: &mut Display) {
        let status = self.status.borrow().clone();
        status.iter().for_each(|status| display.update(status));
    }

    fn start_workers(&self) -> Result<Option<LocalWorkers>, Error> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let count = self.options.workers.unwrap_or(cores);
        if count == 0 {
            eprintln!("waiting for workers: isola-worker --connect {}", self.place.endpoint);
            return Ok(None);
        }
        let launch = Launch {
            endpoint: self.place.endpoint.clone(),
            namespace: self.header.namespace.clone(),
            run: self.header.run.clone(),
            logs: self.directory.join("logs"),
        };
        LocalWorkers::start(launch, count).map(Some).map_err(Error::io("local workers"))
    }

    /// Until the sweep ends (false) or somebody wants this process to end (true).
    async fn follow(&mut self, display: &mut Display, workers: &mut Option<LocalWorkers>) -> Result<bool, Error> {
        let mut tick = tokio::time::interval(TICK);
        loop {
            tokio::select! {
                () = self.interrupts.next() => return Ok(true),
                ended = &mut self.engine => return Err(engine_error(ended)),
                _ = self.manifest.changed() => {}
                _ = tick.tick() => {}
            }
            self.show(display);
            if self.stage() != Stage::Sweep {
                return Ok(false);
            }
            if let Some(workers) = workers {
                let done = self.status.borrow().as_ref().map_or(0, |status| status.tasks.done);
                workers.tend(done).map_err(Error::Other)?;
            }
        }
    }

    /// Waits for workers to notice that the sweep has ended; writes files and the closing table.
    async fn finish(&self, workers: Option<LocalWorkers>) -> Result<(), Error> {
        if let Some(mut workers) = workers {
            // Their next request for work tells them.
            tokio::task::spawn_blocking(move || workers.wait(WORKER_PATIENCE)).await.map_err(abnormal)?;
        }
        self.dismiss().await;
        let reader = Reader::open(&self.directory)?;
        for sentence in export::csv(&reader, &self.directory)?.damaged {
            eprintln!("{sentence}");
        }
        println!("{}", closing::table(&reader)?);
        let directory = self.directory.display();
        println!("results: {directory}; a page that shows them: isola report {directory}");
        Ok(())
    }

    /// Gives workers elsewhere the time to hear that there is no more work.
    async fn dismiss(&self) {
        let keys = Keys::new(&self.header.namespace, &self.header.run);
        for _ in 0..30 {
            let query = self.place.session.liveliness().get(keys.alive_workers()).timeout(Duration::from_millis(500));
            let Ok(replies) = query.await else { return };
            if replies.recv_async().await.is_err() {
                return;
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    }

    fn ending(&self) -> Ending {
        if self.stage() == Stage::Finished && dead(&self.status) == 0 { Ending::Complete } else { Ending::Incomplete }
    }

    async fn wait_for(&mut self, reached: impl Fn(Stage) -> bool) -> Result<(), Error> {
        while !reached(self.stage()) {
            tokio::select! {
                ended = &mut self.engine => return Err(engine_error(ended)),
                _ = self.manifest.changed() => {}
            }
        }
        Ok(())
    }

    /// Until dead tasks are tried again (true) or somebody wants this process to end (false).
    async fn wait_for_work(&mut self) -> Result<bool, Error> {
        loop {
            if self.stage() == Stage::Sweep {
                return Ok(true);
            }
            tokio::select! {
                () = self.interrupts.next() => return Ok(false),
                ended = &mut self.engine => return Err(engine_error(ended)),
                _ = self.manifest.changed() => {}
            }
        }
    }

    async fn close(mut self, ending: Ending, workers: Option<LocalWorkers>) -> Result<Ending, Error> {
        self.send(Job::Stop);
        if let Some(workers) = workers {
            let stopping = tokio::task::spawn_blocking(move || workers.stop(WORKER_PATIENCE));
            tokio::select! {
                stopped = stopping => stopped.map_err(abnormal)?,
                // A second signal: at once. The workers end with this process.
                () = self.interrupts.next() => {}
            }
        }
        // Without its presence on the bus and this sender nothing is left to decide: the engine closes the store.
        drop(self.presence);
        drop(self.jobs);
        if let Ok(Ok(Err(error))) = tokio::time::timeout(Duration::from_secs(2), self.engine).await {
            return Err(error.into());
        }
        let (directory, dead) = (self.directory.display(), dead(&self.status));
        if ending == Ending::Incomplete && dead > 0 {
            eprintln!("{dead} tasks were given up: isola retry-dead {directory}, then isola resume {directory}");
        } else if ending != Ending::Complete {
            eprintln!("to go on: isola resume {directory}");
        }
        // Closing may hang (eclipse-zenoh/zenoh 2675); nothing depends on it.
        let _ = tokio::time::timeout(Duration::from_secs(1), self.place.session.close()).await;
        Ok(ending)
    }
}

fn dead(status: &watch::Receiver<Option<Status>>) -> usize {
    status.borrow().as_ref().map_or(0, |status| status.tasks.dead)
}

fn engine_error(ended: Result<Result<(), StoreError>, oneshot::error::RecvError>) -> Error {
    match ended {
        Ok(Err(error)) => error.into(),
        Ok(Ok(())) | Err(_) => {
            Error::Other("the engine of the run ended abnormally: this is a bug; the run can be resumed".into())
        }
    }
}

fn abnormal(error: tokio::task::JoinError) -> Error {
    Error::Other(format!("ended abnormally: {error}"))
}
