//! A run that another process conducts, found by its folder or on the bus: how it is doing, and orders to it.

use crate::access::known;
use crate::cli::{RemoteArgs, StatusArgs};
use crate::display::{all_of_it, closing_table, stall, summary};
use crate::error::Error;
use crate::ledger::{Ledger, Rules};
use crate::run::directory::read_address;
use protocol::control::{ControlReply, ControlRequest};
use protocol::credentials::{Credentials, CredentialsError};
use protocol::ids::RunId;
use protocol::keys::{Keys, all_runs};
use protocol::role::Role;
use protocol::session::{connect, fetch, fetch_all, request};
use protocol::to_everyone::{Manifest, Status};
use results::journal::{Change, TaskState};
use results::overview::most_folds;
use results::store::{FILE, Holder, Reader, Store, holder};
use results::summary_table::UnitChoice;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;
use zenoh::Session;

/// How long an answer is waited for.
const TIMEOUT: Duration = Duration::from_secs(5);

/// A run on the bus that another process conducts.
pub struct RemoteRun {
    /// Session.
    pub session: Session,
    /// Keys of the run.
    pub keys: Keys,
    /// What it is.
    pub manifest: Manifest,
    credentials: Credentials,
}

impl RemoteRun {
    /// The run that `args` name; `None` if they name a folder that nobody serves.
    pub async fn find(args: &RemoteArgs) -> Result<Option<Self>, Error> {
        let (secret, tls) = (args.secret_file.as_deref(), args.tls.as_deref());
        match (&args.directory, &args.connect) {
            (Some(directory), _) => {
                let header = Reader::open(directory)?.header()?;
                let Some(endpoint) = read_address(directory) else { return Ok(None) };
                let credentials = known(Some(directory), secret, tls)?.for_endpoint(&endpoint);
                // An address that was left behind by a crash leads nowhere, or to another run.
                Ok(Self::at(&endpoint, credentials, &header.namespace, Some(&header.run)).await.ok())
            }
            (None, Some(endpoint)) => {
                let credentials = known(None, secret, tls)?;
                Self::at(endpoint, credentials, &args.namespace, args.run.as_ref()).await.map(Some)
            }
            (None, None) => Err(Error::Usage("name a run by its folder or by --connect".into())),
        }
    }

    /// The only run at an endpoint, or the one wanted.
    async fn at(
        endpoint: &str,
        credentials: Credentials,
        namespace: &str,
        wanted: Option<&RunId>,
    ) -> Result<Self, Error> {
        let session = connect(endpoint, &credentials).await?;
        let found: Vec<Manifest> = fetch_all(&session, &all_runs(namespace), TIMEOUT)
            .await
            .map_err(|source| Error::Request { what: format!("the runs at {endpoint}"), source })?;
        let list =
            || found.iter().map(|m| format!("\n  {}  {} ({})", m.run, m.name, m.stage.name())).collect::<String>();
        let chosen = match (wanted, found.as_slice()) {
            (Some(run), _) => found.iter().find(|manifest| manifest.run == *run),
            (None, [only]) => Some(only),
            (None, []) => None,
            (None, _) => {
                return Err(Error::Other(format!("several runs at {endpoint}: choose one by --run{}", list())));
            }
        };
        let Some(manifest) = chosen else {
            let wanted = wanted.map_or("run".to_string(), |run| format!("run {run}"));
            return Err(Error::Other(format!("no {wanted} at {endpoint} in namespace {namespace}{}", list())));
        };
        Ok(Self { keys: Keys::new(namespace, &manifest.run), session, manifest: manifest.clone(), credentials })
    }

    async fn control(&self, order: ControlRequest) -> Result<String, Error> {
        if let Some(certificate) = &self.credentials.certificate {
            certificate.require(Role::Operator, "give orders to a run").map_err(CredentialsError::from)?;
        }
        let reply: ControlReply = request(&self.session, &self.keys.control(), &order, TIMEOUT)
            .await
            .map_err(|source| Error::Request { what: "the order".into(), source })?;
        Ok(reply.message)
    }

    async fn status(&self) -> Result<Status, Error> {
        fetch(&self.session, &self.keys.status(), TIMEOUT)
            .await
            .map_err(|source| Error::Request { what: "the status".into(), source })
    }
}

/// The folder of what is not on the bus.
/// What is said of a folder that is no run itself, but holds some.
fn runs_inside(folder: &Path) -> Option<String> {
    let is_run = |folder: &Path| folder.join(FILE).is_file();
    if is_run(folder) {
        return None;
    }
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut inside: Vec<String> = entries.filter(|path| is_run(path)).map(|path| path.display().to_string()).collect();
    inside.sort();
    (!inside.is_empty()).then(|| format!("{} is no run, but holds some: {}", folder.display(), inside.join(", ")))
}

fn folder(args: &RemoteArgs) -> &Path {
    args.directory.as_deref().expect("what is not on the bus was named by its folder")
}

/// How a run is doing, for programs.
#[derive(Serialize)]
struct Told {
    /// Whether somebody conducts it.
    conducted: bool,
    #[serde(flatten)]
    status: Status,
}

fn json(told: &Told) -> String {
    serde_json::to_string_pretty(told).expect("numbers and texts have JSON forms") + "\n"
}

/// One line of a run that is carried on.
///
/// # Errors
/// If nobody does, or nobody can be asked.
pub async fn health(args: &RemoteArgs) -> Result<String, Error> {
    let Some(run) = RemoteRun::find(args).await? else {
        let folder = folder(args).display();
        return Err(Error::Other(format!("no coordinator answers for the run in {folder}")));
    };
    let status = run.status().await?;
    Ok(format!("run {}, {}", status.run, summary(&status)))
}

/// How a run is doing, in lines or as JSON.
pub async fn status(args: &StatusArgs) -> Result<String, Error> {
    let StatusArgs { run: args, json: is_json, units } = args;
    if let Some(several) = args.directory.as_deref().and_then(runs_inside) {
        return Err(Error::Usage(several));
    }
    let Some(run) = RemoteRun::find(args).await? else {
        return if *is_json { stored_json(folder(args)) } else { stored_status(folder(args), *units) };
    };
    let status = run.status().await?;
    if *is_json {
        return Ok(json(&Told { conducted: true, status }));
    }
    let mut text = format!("run {} ({}), {}\n", status.run, status.name, summary(&status));
    for worker in &status.workers {
        let tasks: Vec<String> = worker.tasks.iter().map(ToString::to_string).collect();
        let doing = if tasks.is_empty() { "waiting".into() } else { format!("task {}", tasks.join(", ")) };
        text += &format!("  {}: {} tasks done, {doing}\n", worker.worker, worker.done);
    }
    text.extend(status.stalled.iter().map(|stalled| format!("  {}\n", stall(stalled))));
    Ok(text)
}

/// How a run that nobody conducts is doing, in lines.
pub fn stored_status(directory: &Path, units: Option<UnitChoice>) -> Result<String, Error> {
    let reader = Reader::open(directory)?;
    let header = reader.header()?;
    let stage = match (reader.stage()?, holder(directory)) {
        (stage, _) if stage.is_over() => stage.name().to_string(),
        (_, Some(Holder { pid, host, .. })) => {
            format!("conducted by process {pid} on {host}, which does not answer here: ask there, or by --connect")
        }
        _ => format!("interrupted; to go on: isola resume {}", directory.display()),
    };
    let table = closing_table(&reader, directory, units)?;
    Ok(format!("run {} ({}), {stage}\n{table}\n{}\n", header.run, header.name, all_of_it(directory)))
}

/// The same, for programs.
fn stored_json(directory: &Path) -> Result<String, Error> {
    let reader = Reader::open(directory)?;
    let (header, stage) = (reader.header()?, reader.stage()?);
    let model = reader.model()?.model().map_err(|error| Error::Other(format!("the stored model: {error}")))?;
    // As a coordinator that goes on would count.
    let most_folds = most_folds(&model, &header.settings);
    let rules = Rules { most_folds, verify: header.settings.verify.effort, ..Rules::default() };
    let (ledger, _) = Ledger::restore(rules, reader.plans()?, &reader.added()?, reader.tasks()?, Duration::ZERO);
    let (levels, levels_done) = ledger.progress_of_levels();
    let status = Status {
        run: header.run,
        name: header.name,
        stage,
        backbone: None,
        tasks: ledger.counts(),
        levels: levels.max(header.amplitudes.len()),
        levels_done,
        active: ledger.active(),
        workers: Vec::new(),
        stalled: Vec::new(),
        sequence: ledger.sequence(),
        elapsed: 0.0,
        eta: None,
    };
    Ok(json(&Told { conducted: false, status }))
}

/// Stops a run; says what became of it.
pub async fn cancel(args: &RemoteArgs) -> Result<String, Error> {
    match RemoteRun::find(args).await? {
        Some(run) => run.control(ControlRequest::Cancel).await,
        None => Err(Error::Other("nobody conducts this run: there is nothing to cancel".into())),
    }
}

/// Puts dead tasks back: by its coordinator, or in the store of a run that nobody conducts. Says how many.
pub async fn retry_dead(args: &RemoteArgs) -> Result<String, Error> {
    if let Some(run) = RemoteRun::find(args).await? {
        return run.control(ControlRequest::RetryDead).await;
    }
    let mut store = Store::open(folder(args))?;
    let dead = store.tasks()?.into_iter().filter(|task| task.state == TaskState::Dead);
    let revived: Vec<Change> = dead.map(|task| Change::Revived { task: task.id }).collect();
    store.commit(&revived)?;
    let folder = folder(args).display();
    Ok(match revived.len() {
        0 => format!("no task of {folder} was given up: there is nothing to try again"),
        1 => format!("1 dead task is tried again by: isola resume {folder}"),
        number => format!("{number} dead tasks are tried again by: isola resume {folder}"),
    })
}
