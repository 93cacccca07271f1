//! A run that another process conducts, found by its folder or on the bus: how it is doing, and orders to it.

use crate::access::known;
use crate::cli::RemoteArgs;
use crate::display::{layout, summary};
use crate::error::Error;
use crate::run::directory::read_address;
use protocol::control::{ControlReply, ControlRequest};
use protocol::ids::RunId;
use protocol::keys::{Keys, all_runs};
use protocol::secret::Secret;
use protocol::session::{connect, fetch, fetch_all, request};
use protocol::to_everyone::{Manifest, Status};
use results::journal::{Change, TaskState};
use results::store::{Holder, Reader, Store, holder};
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
}

impl RemoteRun {
    /// The run that `args` name; `None` if they name a folder that nobody serves.
    pub async fn find(args: &RemoteArgs) -> Result<Option<Self>, Error> {
        match (&args.directory, &args.connect) {
            (Some(directory), _) => Self::of_directory(directory, args.secret_file.as_deref()).await,
            (None, Some(endpoint)) => {
                let secret = known(None, args.secret_file.as_deref())?;
                Self::at(endpoint, secret.as_ref(), &args.namespace, args.run.as_ref()).await.map(Some)
            }
            (None, None) => Err(Error::Usage("name a run by its folder or by --connect".into())),
        }
    }

    async fn of_directory(directory: &Path, secret_file: Option<&Path>) -> Result<Option<Self>, Error> {
        let header = Reader::open(directory)?.header()?;
        let Some(endpoint) = read_address(directory) else { return Ok(None) };
        // An address that was left behind by a crash leads nowhere, or to another run.
        let secret = known(Some(directory), secret_file)?;
        Ok(Self::at(&endpoint, secret.as_ref(), &header.namespace, Some(&header.run)).await.ok())
    }

    /// The only run at an endpoint, or the one wanted.
    async fn at(
        endpoint: &str,
        secret: Option<&Secret>,
        namespace: &str,
        wanted: Option<&RunId>,
    ) -> Result<Self, Error> {
        let session = connect(endpoint, secret).await?;
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
        Ok(Self { keys: Keys::new(namespace, &manifest.run), session, manifest: manifest.clone() })
    }

    async fn control(&self, order: ControlRequest) -> Result<String, Error> {
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
fn folder(args: &RemoteArgs) -> &Path {
    args.directory.as_deref().expect("what is not on the bus was named by its folder")
}

/// How a run is doing, in lines.
pub async fn status(args: &RemoteArgs) -> Result<String, Error> {
    let Some(run) = RemoteRun::find(args).await? else { return stored_status(folder(args)) };
    let status = run.status().await?;
    let mut text = format!("run {} ({}), {}\n", status.run, status.name, summary(&status));
    for worker in &status.workers {
        let tasks: Vec<String> = worker.tasks.iter().map(ToString::to_string).collect();
        let doing = if tasks.is_empty() { "waiting".into() } else { format!("task {}", tasks.join(", ")) };
        text += &format!("  {}: {} tasks done, {doing}\n", worker.worker, worker.done);
    }
    Ok(text)
}

/// How a run that nobody conducts is doing, in lines.
pub fn stored_status(directory: &Path) -> Result<String, Error> {
    let reader = Reader::open(directory)?;
    let header = reader.header()?;
    let stage = match (reader.stage()?, holder(directory)) {
        (stage, _) if stage.is_over() => stage.name().to_string(),
        (_, Some(Holder { pid, host, .. })) => {
            format!("conducted by process {pid} on {host}, which does not answer here: ask there, or by --connect")
        }
        _ => format!("interrupted; to go on: isola resume {}", directory.display()),
    };
    let table = results::summary_table::table(&reader, layout(None))?;
    Ok(format!("run {} ({}), {stage}\n{table}\n", header.run, header.name))
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
    Ok(format!("{} dead tasks are tried again by: isola resume {}", revived.len(), folder(args).display()))
}
