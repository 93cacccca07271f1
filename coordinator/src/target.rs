//! A run that somebody else conducts: found by its folder or on the bus.

use crate::cli::{TargetArgs, WatchArgs};
use crate::display::{Display, summary};
use crate::error::Error;
use crate::rundir::read_address;
use crate::store::{Change, Reader, Store};
use protocol::control::{ControlReply, ControlRequest};
use protocol::ids::RunId;
use protocol::keys::{Keys, all_runs};
use protocol::session::{connect, fetch, fetch_all, request};
use protocol::to_everyone::{Manifest, Stage, Status};
use std::path::Path;
use std::time::Duration;
use zenoh::Session;

/// How long an answer is waited for.
const TIMEOUT: Duration = Duration::from_secs(5);
/// A run without a status for so long has no coordinator any more.
const SILENCE: Duration = Duration::from_secs(5);

/// A run on the bus.
pub struct Live {
    pub(crate) session: Session,
    pub(crate) keys: Keys,
}

impl Live {
    /// The run that `args` name; `None` if they name a folder that nobody serves.
    async fn find(args: &TargetArgs) -> Result<Option<Self>, Error> {
        match (&args.directory, &args.connect) {
            (Some(directory), _) => Self::of_directory(directory).await,
            (None, Some(endpoint)) => {
                let wanted = args.run.as_deref().map(RunId::new).transpose();
                let wanted = wanted.map_err(|error| Error::Other(format!("--run {error}")))?;
                Self::at(endpoint, &args.namespace, wanted.as_ref()).await.map(Some)
            }
            (None, None) => Err(Error::Other("name a run by its folder or by --connect".into())),
        }
    }

    async fn of_directory(directory: &Path) -> Result<Option<Self>, Error> {
        let header = Reader::open(directory)?.header()?;
        let Some(endpoint) = read_address(directory) else { return Ok(None) };
        // An address that was left behind by a crash leads nowhere, or to another run.
        Ok(Self::at(&endpoint, &header.namespace, Some(&header.run)).await.ok())
    }

    /// The only run at an endpoint, or the one wanted.
    async fn at(endpoint: &str, namespace: &str, wanted: Option<&RunId>) -> Result<Self, Error> {
        let session = connect(endpoint).await?;
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
        Ok(Self { keys: Keys::new(namespace, &manifest.run), session })
    }

    async fn control(&self, order: ControlRequest) -> Result<String, Error> {
        let reply: ControlReply = request(&self.session, &self.keys.control(), &order, TIMEOUT)
            .await
            .map_err(|source| Error::Request { what: "the order".into(), source })?;
        Ok(reply.message)
    }

    /// How the run is doing.
    pub(crate) async fn status(&self) -> Result<Status, Error> {
        fetch(&self.session, &self.keys.status(), TIMEOUT)
            .await
            .map_err(|source| Error::Request { what: "the status".into(), source })
    }
}

/// How a run is doing, in words.
pub async fn status(args: &TargetArgs) -> Result<String, Error> {
    if let Some(live) = Live::find(args).await? {
        let status = live.status().await?;
        let mut text = format!("run {} ({}), {}\n", status.run, status.name, summary(&status));
        for worker in &status.workers {
            let tasks: Vec<String> = worker.tasks.iter().map(ToString::to_string).collect();
            let doing = if tasks.is_empty() { "waiting".into() } else { format!("task {}", tasks.join(", ")) };
            text += &format!("  {}: {} tasks done, {doing}\n", worker.worker, worker.done);
        }
        return Ok(text);
    }
    let directory = args.directory.as_deref().expect("what is not on the bus was named by its folder");
    let reader = Reader::open(directory)?;
    let header = reader.header()?;
    let stage = match reader.stage()? {
        stage @ (Stage::Finished | Stage::Cancelled) => stage.name().to_string(),
        Stage::Backbone | Stage::Sweep => format!("interrupted; to go on: isola resume {}", directory.display()),
    };
    Ok(format!("run {} ({}), {stage}\n{}", header.run, header.name, crate::closing::table(&reader)?))
}

/// Follows a run until it ends; with a page, until the process is ended.
pub async fn watch(args: &WatchArgs) -> Result<(), Error> {
    let target = &args.target;
    let live = match (Live::find(target).await?, &args.page) {
        (Some(live), Some(address)) => return crate::live::serve(&live, address).await,
        (Some(live), None) => live,
        (None, Some(_)) => {
            let directory = target.directory.as_deref().unwrap_or(Path::new("RUN")).display();
            let remedy = format!("`isola report {directory}` draws what there is, `isola resume {directory}` goes on");
            return Err(Error::Other(format!("nobody conducts this run: there is nothing to watch; {remedy}")));
        }
        (None, None) => return status(target).await.map(|text| print!("{text}")),
    };
    let declared = live.session.declare_subscriber(live.keys.status()).await;
    let updates = declared.map_err(|error| Error::Other(format!("the run cannot be followed: {error}")))?;
    let mut display = Display::new();
    let mut latest = live.status().await?;
    loop {
        display.update(&latest);
        if matches!(latest.stage, Stage::Finished | Stage::Cancelled) {
            display.clear();
            println!("{}", summary(&latest));
            return Ok(());
        }
        match tokio::time::timeout(SILENCE, updates.recv_async()).await {
            Ok(Ok(sample)) => {
                let bytes = sample.payload().to_bytes();
                match protocol::codec::decode(&bytes, &sample.encoding().to_string()) {
                    Ok(status) => latest = status,
                    Err(error) => return Err(Error::Other(error.to_string())),
                }
            }
            // Missed updates are no reason to give up; a coordinator that does not answer is.
            _ => {
                latest = live.status().await.map_err(|_| {
                    display.clear();
                    Error::Other(format!("the coordinator of run {} is gone; it can be resumed", latest.run))
                })?;
            }
        }
    }
}

/// Stops a run.
pub async fn cancel(args: &TargetArgs) -> Result<String, Error> {
    match Live::find(args).await? {
        Some(live) => live.control(ControlRequest::Cancel).await,
        None => Err(Error::Other("nobody conducts this run: there is nothing to cancel".into())),
    }
}

/// Puts dead tasks back: by its coordinator, or in the store of a run that nobody conducts.
pub async fn retry_dead(args: &TargetArgs) -> Result<String, Error> {
    if let Some(live) = Live::find(args).await? {
        return live.control(ControlRequest::RetryDead).await;
    }
    let directory = args.directory.as_deref().expect("what is not on the bus was named by its folder");
    let mut store = Store::open(directory)?;
    let dead = store.tasks()?.into_iter().filter(|task| task.state == crate::ledger::State::Dead);
    let revived: Vec<_> = dead.map(|task| crate::ledger::Record::Revived { task: task.id }).collect();
    let changes: Vec<Change<'_>> = revived.iter().map(Change::Record).collect();
    store.commit(&changes)?;
    Ok(format!("{} dead tasks are tried again by: isola resume {}", revived.len(), directory.display()))
}
