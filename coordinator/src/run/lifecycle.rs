//! The steps of a run: prepare, sweep with local workers, write files, stay if asked to, close.

use super::directory::{LOGS, remove_address, write_address};
use super::endpoint::{Connection, refuse_second_coordinator};
use super::local_workers::{Launch, LocalWorkers};
use super::over_http;
use super::preparation::{self, Prepared};
use super::services::{Services, Start};
use crate::access;
use crate::cli::ServeArgs;
use crate::display::{self, Display, all_of_it, closing_table};
use crate::engine::Event;
use crate::error::Error;
use crate::ledger::Rules;
use protocol::keys::Keys;
use protocol::to_everyone::Stage;
use results::export;
use results::overview::{doubts, most_folds};
use results::store::{Reader, RunHeader, Store};
use results::words::count;
use solver::structure::Model;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::task::{JoinError, spawn_blocking};
use worker::terminal;

/// Time between two looks at how things are.
const TICK: Duration = Duration::from_millis(200);
/// Time for local workers to give back what they have.
const WORKER_PATIENCE: Duration = Duration::from_secs(5);

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Every task is done.
    Complete,
    /// Every task is done, but a curve that everything else hangs on stopped before its end, or another worker came to something else.
    Doubtful,
    /// Tasks were given up, the run was cancelled, or it has results that are wrong.
    Incomplete,
    /// Somebody wanted this process to end.
    Interrupted,
}

/// A run under way.
struct Run {
    directory: PathBuf,
    header: RunHeader,
    options: ServeArgs,
    /// Whether the command goes on after it, and says at its end what was found.
    is_followed: bool,
    /// Most folds that are followed.
    most_folds: usize,
    connection: Connection,
    interrupts: Interrupts,
    services: Services,
}

/// Signals that ask this process to end.
struct Interrupts {
    interrupt: Signal,
    terminate: Signal,
}

impl Interrupts {
    fn new() -> Result<Self, Error> {
        Ok(Self {
            interrupt: signal(SignalKind::interrupt()).map_err(Error::io("SIGINT"))?,
            terminate: signal(SignalKind::terminate()).map_err(Error::io("SIGTERM"))?,
        })
    }

    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
    }
}

/// Carries out a run from where its store stands; `is_followed`: the command does more with it, and says at its end what was found.
///
/// # Errors
/// If the store cannot be written, or there is no backbone. What was accepted is stored; the run can be resumed.
pub async fn drive(
    directory: &Path,
    store: Store,
    model: Model,
    mut connection: Connection,
    options: ServeArgs,
    is_followed: bool,
) -> Result<Ending, Error> {
    let header = store.header()?;
    refuse_second_coordinator(&connection.session, &Keys::new(&header.namespace, &header.run)).await?;
    let model = Arc::new(model);
    let prepared = preparation::stored(&store, &model)?;
    let is_prepared = prepared.is_some();
    let most_folds = most_folds(&model, &header.settings);
    let start = Start {
        directory: directory.to_path_buf(),
        header: &header,
        connection: &connection,
        store,
        model: model.clone(),
        rules: Rules {
            lease: Duration::from_secs_f64(options.lease),
            most_folds,
            verify: header.settings.verify.effort,
            repeated: options.repeat,
            draw: uuid::Uuid::new_v4().as_u64_pair().0,
            ..Rules::default()
        },
        prepared,
    };
    let services = Services::start(start).await?;
    access::keep(directory, &connection.credentials)?;
    let server = match connection.http.take() {
        Some(listener) => Some(over_http::serve(listener, directory, &header, &connection, services.shown())?),
        None => None,
    };
    write_address(directory, &connection.endpoint).map_err(Error::io(directory))?;
    let interrupts = Interrupts::new()?;
    let folder = directory.to_path_buf();
    let run = Run { directory: folder, header, options, is_followed, most_folds, connection, interrupts, services };
    let ending = run.all_steps((!is_prepared).then_some(model)).await;
    drop(server);
    remove_address(directory);
    ending
}

impl Run {
    /// All steps that are left; the model is given if its backbone is still to be computed.
    async fn all_steps(mut self, to_prepare: Option<Arc<Model>>) -> Result<Ending, Error> {
        let mut display = Display::new();
        if let Some(model) = to_prepare {
            match self.prepare(model, &mut display).await? {
                Some(prepared) => {
                    display.clear();
                    terminal::note(display::plan(
                        &prepared.beginning.plan,
                        self.most_folds,
                        self.header.settings.verify.effort,
                    ));
                    self.services.begin(prepared);
                }
                None => {
                    display.clear();
                    if self.services.stage() != Stage::Cancelled {
                        return self.close(Ending::Interrupted, None).await;
                    }
                    self.dismiss_workers().await;
                    return self.close(Ending::Incomplete, None).await;
                }
            }
        }
        self.services.reach(|stage| stage != Stage::Backbone).await?;
        loop {
            let mut workers = self.start_workers()?;
            let is_interrupted = self.follow(&mut display, &mut workers).await?;
            display.clear();
            if is_interrupted {
                return self.close(Ending::Interrupted, workers).await;
            }
            let found = self.finish(workers).await?;
            // Somebody may have put dead tasks back meanwhile.
            if self.services.stage() == Stage::Sweep {
                continue;
            }
            if self.options.stay {
                terminal::note(format_args!(
                    "the run stays on the bus at {}; Ctrl-C ends it",
                    self.connection.endpoint
                ));
                if self.wait_for_work().await? {
                    continue;
                }
            }
            let ending = self.ending(found);
            return self.close(ending, None).await;
        }
    }

    /// Backbone and tasks; `None` if interrupted or cancelled.
    async fn prepare(&mut self, model: Arc<Model>, display: &mut Display) -> Result<Option<Prepared>, Error> {
        let stop = Arc::new(AtomicBool::new(false));
        let (header, engine, stopped) = (self.header.clone(), self.services.engine(), stop.clone());
        let mut computing = spawn_blocking(move || preparation::compute(&header, &model, &engine, &stopped));
        let mut tick = tokio::time::interval(TICK);
        loop {
            tokio::select! {
                prepared = &mut computing => return prepared.map_err(abnormal)?,
                () = self.interrupts.next() => stop.store(true, Ordering::Relaxed),
                changed = self.services.changed() => changed?,
                _ = tick.tick() => self.show(display),
            }
            if self.services.stage() == Stage::Cancelled {
                stop.store(true, Ordering::Relaxed);
            }
        }
    }

    fn show(&self, display: &mut Display) {
        self.services.status().iter().for_each(|status| display.update(status));
    }

    fn start_workers(&self) -> Result<Option<LocalWorkers>, Error> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let count = self.options.workers.unwrap_or(cores);
        if count == 0 {
            let credentials = &self.connection.credentials;
            let secret = match &credentials.secret {
                Some(_) => format!(" --secret-file {}", self.directory.join(protocol::secret::FILE).display()),
                None => String::new(),
            };
            let tls = if credentials.certificate.is_some() { " --tls CERTIFICATES-OF-A-WORKER" } else { "" };
            terminal::note(format_args!(
                "waiting for workers: isola worker --connect {}{secret}{tls}",
                self.connection.elsewhere
            ));
            return Ok(None);
        }
        let launch = Launch {
            endpoint: self.connection.endpoint.clone(),
            credentials: self.connection.credentials.clone(),
            namespace: self.header.namespace.clone(),
            run: self.header.run.clone(),
            logs: self.directory.join(LOGS),
            log_format: self.options.log_format,
        };
        LocalWorkers::start(launch, count).map(Some).map_err(Error::io("local workers"))
    }

    /// Until the sweep ends (false) or somebody wants this process to end (true).
    async fn follow(&mut self, display: &mut Display, workers: &mut Option<LocalWorkers>) -> Result<bool, Error> {
        let mut tick = tokio::time::interval(TICK);
        loop {
            tokio::select! {
                () = self.interrupts.next() => return Ok(true),
                changed = self.services.changed() => changed?,
                _ = tick.tick() => {}
            }
            self.show(display);
            if self.services.stage() != Stage::Sweep {
                return Ok(false);
            }
            if let Some(workers) = workers {
                let done = self.services.status().map_or(0, |status| status.tasks.done);
                workers.tend(done).map_err(Error::Other)?;
            }
        }
    }

    /// Waits for workers to notice that the sweep has ended; writes files and the closing table. Tells how far what was found is to be
    /// believed: something that others contradict is missing, what one other contradicts is doubtful.
    async fn finish(&self, workers: Option<LocalWorkers>) -> Result<Ending, Error> {
        if let Some(mut workers) = workers {
            // Their next request for work tells them.
            spawn_blocking(move || workers.wait(WORKER_PATIENCE)).await.map_err(abnormal)?;
        }
        self.dismiss_workers().await;
        let reader = Reader::open(&self.directory)?;
        let (refuted, disputed) = reader.contradictions()?;
        let is_finished = self.services.stage() == Stage::Finished;
        let doubts = doubts_of_all(&reader)?;
        // A command that goes on says all of it at its end.
        let is_last = !(self.is_followed && is_finished && refuted == 0);
        if is_last {
            tell_doubts(&doubts, is_finished);
        }
        for sentence in export::csv(&reader, &self.directory)?.damaged {
            terminal::note(sentence);
        }
        if is_last {
            let table = closing_table(&reader, &self.directory, self.options.units)?;
            let closing = format!("{table}\nresults: {}\n{}\n", self.directory.display(), all_of_it(&self.directory));
            terminal::print(closing).map_err(Error::io("standard output"))?;
        }
        Ok(match (refuted, !doubts.is_empty() || disputed > 0) {
            (0, false) => Ending::Complete,
            (0, true) => Ending::Doubtful,
            _ => Ending::Incomplete,
        })
    }

    /// Gives workers elsewhere the time to hear that there is no more work.
    async fn dismiss_workers(&self) {
        let (session, keys) = (&self.connection.session, Keys::new(&self.header.namespace, &self.header.run));
        for _ in 0..30 {
            let query = session.liveliness().get(keys.alive_workers()).timeout(Duration::from_millis(500));
            let Ok(replies) = query.await else { return };
            if replies.recv_async().await.is_err() {
                return;
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    }

    /// Until dead tasks are tried again (true) or somebody wants this process to end (false).
    async fn wait_for_work(&mut self) -> Result<bool, Error> {
        tokio::select! {
            () = self.interrupts.next() => Ok(false),
            reached = self.services.reach(|stage| stage == Stage::Sweep) => reached.map(|()| true),
        }
    }

    fn dead(&self) -> usize {
        self.services.status().map_or(0, |status| status.tasks.dead)
    }

    /// How the run ends that has found this.
    fn ending(&self, found: Ending) -> Ending {
        let is_complete = self.services.stage() == Stage::Finished && self.dead() == 0;
        if is_complete { found } else { Ending::Incomplete }
    }

    async fn close(mut self, ending: Ending, workers: Option<LocalWorkers>) -> Result<Ending, Error> {
        self.services.send(Event::Stop);
        if let Some(workers) = workers {
            let stopping = spawn_blocking(move || workers.stop(WORKER_PATIENCE));
            tokio::select! {
                stopped = stopping => stopped.map_err(abnormal)?,
                // A second signal: at once. The workers end with this process.
                () = self.interrupts.next() => {}
            }
        }
        let (dead, is_over) = (self.dead(), self.services.stage() == Stage::Finished);
        self.services.stop().await?;
        let directory = self.directory.display();
        if ending == Ending::Incomplete && dead > 0 {
            terminal::note(format_args!(
                "given up: {}; isola retry-dead {directory}, then isola resume {directory}",
                count(dead, "task")
            ));
        } else if ending == Ending::Incomplete && is_over {
            terminal::note("results that others contradict are in the run: the table says at which levels");
        } else if matches!(ending, Ending::Incomplete | Ending::Interrupted) {
            terminal::note(format_args!("to go on: isola resume {directory}"));
        }
        // Closing may hang (eclipse-zenoh/zenoh 2675); nothing depends on it.
        let _ = tokio::time::timeout(Duration::from_secs(1), self.connection.session.close()).await;
        Ok(ending)
    }
}

/// What is not known to its end, order by order.
fn doubts_of_all(reader: &Reader) -> Result<Vec<String>, Error> {
    let mut all: Vec<String> = doubts(reader)?.into_iter().collect();
    for order in reader.further_orders()? {
        let of_order = doubts(&reader.of_order(order)?)?;
        all.extend(of_order.map(|doubts| format!("motions that last {order} periods of the force: {doubts}")));
    }
    Ok(all)
}

/// Says so. Of a finished run it stands with the table as well: whoever sees both has it once.
fn tell_doubts(doubts: &[String], is_finished: bool) {
    let is_seen_below = is_finished && std::io::stdout().is_terminal() && std::io::stderr().is_terminal();
    for doubts in doubts.iter().filter(|_| !is_seen_below) {
        terminal::note(doubts);
    }
}

fn abnormal(error: JoinError) -> Error {
    Error::Other(format!("ended abnormally: {error}"))
}
