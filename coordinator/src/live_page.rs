//! Takes everything that a page shows from the bus: what is there already and what comes.

use crate::display::summary;
use crate::error::Error;
use crate::http::{self, own_names_only};
use axum::Router;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::middleware::from_fn;
use axum::response::IntoResponse;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use protocol::follow::{FollowError, Follower, Update};
use protocol::keys::Keys;
use protocol::model::ModelMessage;
use protocol::session::RequestError;
use protocol::to_everyone::{Done, Manifest, Stage, Status, StoredResult};
use results::live::{self, Feed, Run, Start};
use results::report::{BackboneCurve, Curve, monitors};
use solver::response::task::{BranchId, SeedOutcome, Task};
use solver::settings::Stretch;
use solver::stability::verification::Verification;
use solver::structure::Model;
use std::collections::HashMap;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Mutex;
use tokio::task::JoinHandle;
use tower_service::Service;
use worker::terminal;
use zenoh::Session;

/// A run without an answer for so long has no coordinator any more.
const PATIENCE: Duration = Duration::from_secs(20);

/// A run that is shown.
#[derive(Clone, Copy)]
pub struct Shown<'r> {
    /// Session on the bus.
    pub session: &'r Session,
    /// Keys of the run.
    pub keys: &'r Keys,
    /// What it is.
    pub manifest: &'r Manifest,
}

/// Serves the page of a run at `address` until the process is ended.
///
/// # Errors
/// If nothing can be served there, or the run cannot be followed.
pub async fn serve(run: Shown<'_>, address: &str) -> Result<(), Error> {
    let refused = |source: io::Error| {
        Error::Other(format!("--page {address}: {source}; give HOST:PORT of this machine, as in 127.0.0.1:8080"))
    };
    let listener = TcpListener::bind(address).await.map_err(refused)?;
    let served_at = listener.local_addr().map_err(refused)?;
    let feed = Arc::new(Feed::new());
    let (teller, start) = Teller::start(run, feed.clone()).await?;
    terminal::print(format_args!("http://{served_at} shows the run as it goes on; Ctrl-C ends this\n"))
        .map_err(Error::io("standard output"))?;
    let routes = live::routes(start, feed).layer(from_fn(own_names_only));
    tokio::select! {
        never = http::serve(listener, routes, None) => match never {},
        // What has been told stays there to be looked at.
        Err(error) = teller.tell() => Err(error),
    }
}

/// The page of a run for a server of one's own. It is made when somebody first asks for it, and follows the run from then on: what
/// has been found is kept for browsers, and a large run that nobody looks at need not keep it. Who asks for it after the run had
/// ended and goes on has it made anew.
pub fn when_asked_for(
    session: Session,
    keys: Keys,
    manifest: impl Fn() -> Manifest + Clone + Send + Sync + 'static,
) -> Router {
    let page: Arc<Mutex<Option<Page>>> = Arc::default();
    Router::new().fallback(move |request: Request| async move {
        let is_opened = request.uri().path() == "/";
        let routes = async {
            let mut page = page.lock().await;
            // Who has it open asks for more of the one that was made.
            let is_behind = |page: &Page| page.telling.is_finished() && !manifest().stage.is_over();
            if page.as_ref().is_none_or(|page| is_opened && is_behind(page)) {
                *page = Some(Page::of(&session, &keys, manifest()).await?);
            }
            Ok::<_, Error>(page.as_ref().map(|page| page.routes.clone()).unwrap_or_default())
        };
        match routes.await {
            Ok(mut routes) => routes.call(request).await.into_response(),
            Err(error) => (StatusCode::SERVICE_UNAVAILABLE, format!("{error}\n")).into_response(),
        }
    })
}

/// A page that follows its run until it is dropped.
struct Page {
    routes: Router,
    telling: JoinHandle<()>,
}

impl Page {
    async fn of(session: &Session, keys: &Keys, manifest: Manifest) -> Result<Self, Error> {
        let feed = Arc::new(Feed::new());
        let (teller, start) = Teller::start(Shown { session, keys, manifest: &manifest }, feed.clone()).await?;
        let telling = tokio::spawn(async move {
            if let Err(error) = teller.tell().await {
                tracing::error!(%error, "the page shows nothing new any more");
            }
        });
        Ok(Self { routes: live::routes(start, feed), telling })
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.telling.abort();
    }
}

/// What was announced of a branch.
#[derive(Default)]
struct Announced {
    branch: Option<Done>,
    /// What marching says of it, and whether of all of it.
    verification: Option<(Done, bool)>,
}

/// Tells a feed of a run, from its beginning to its end.
struct Teller {
    follower: Follower,
    backbone_key: String,
    feed: Arc<Feed>,
    /// Levels by amplitude as typed.
    levels: HashMap<String, usize>,
    /// As long as the backbone is not known.
    awaits_backbone: Option<Model>,
    /// What was announced of branches, by amplitude as typed and name, in whatever order.
    announced: HashMap<(String, BranchId), Announced>,
    /// Results that could not be had.
    missing: u64,
    stage: Stage,
}

impl Teller {
    /// Begins to follow a run; nothing that is announced from now on is missed.
    async fn start(run: Shown<'_>, feed: Arc<Feed>) -> Result<(Self, Start), Error> {
        let follower = Follower::start(run.session, run.keys, PATIENCE).await.map_err(FollowError::from)?;
        let (manifest, backbone_key) = (run.manifest, run.keys.backbone());
        let message: ModelMessage = follower.fetch(&run.keys.model()).await?;
        let model = message.model().map_err(|error| Error::Other(error.to_string()))?;
        let mut amplitudes = manifest.amplitudes.clone();
        amplitudes.retain(|amplitude| amplitude.order().is_none());
        amplitudes.sort_by(|a, b| a.value.total_cmp(&b.value));
        let levels: Vec<(String, f64)> =
            amplitudes.into_iter().map(|amplitude| (amplitude.text, amplitude.value)).collect();
        let shown = Run {
            id: manifest.run.to_string(),
            name: manifest.name.clone(),
            model: model.name().to_string(),
            stage: manifest.stage,
        };
        let backbone = backbone(&follower, &backbone_key, &model).await?;
        let is_known = backbone.is_some();
        let units = manifest.units.as_deref().and_then(|units| units.parse().ok()).unwrap_or_default();
        let start = Start::new(shown, monitors(&model), levels.clone(), model.forcing().harmonic, backbone);
        let start = start.with_units(units);
        let teller = Self {
            follower,
            backbone_key,
            feed,
            levels: levels.into_iter().enumerate().map(|(i, (text, _))| (text, i)).collect(),
            awaits_backbone: (!is_known).then_some(model),
            announced: HashMap::new(),
            missing: 0,
            stage: manifest.stage,
        };
        Ok((teller, start))
    }

    /// Tells the feed everything until the run has ended.
    async fn tell(mut self) -> Result<(), Error> {
        let gone = loop {
            let told = match self.follower.next().await {
                Ok(Some(Update::Status(status))) => self.status(&status).await,
                Ok(Some(Update::Done(done))) => self.result(&done).await,
                Ok(None) => break false,
                Err(error) => Err(error.into()),
            };
            match told {
                Ok(()) => {}
                Err(Error::Follow(FollowError::Gone(_))) => break true,
                Err(error) => return Err(error),
            }
        };
        let missing = match self.missing + self.follower.missing() {
            0 => String::new(),
            missing => format!(" {missing} results did not arrive."),
        };
        let end = match self.stage {
            stage if gone && !stage.is_over() => "The coordinator does not answer any more.".into(),
            stage => format!("The run is {}.", stage.name()),
        };
        self.feed.end(&format!("{end}{missing}"));
        Ok(())
    }

    async fn status(&mut self, status: &Status) -> Result<(), Error> {
        self.stage = status.stage;
        if let Some(model) = self.awaits_backbone.as_ref().filter(|_| status.stage != Stage::Backbone)
            && let Some(curve) = backbone(&self.follower, &self.backbone_key, model).await?
        {
            self.feed.backbone(&curve);
            self.awaits_backbone = None;
        }
        self.feed.status(status.stage, &summary(status));
        Ok(())
    }

    /// Hands on what was announced: a branch, or the same again with what marching says of it.
    async fn result(&mut self, done: &Done) -> Result<(), Error> {
        let is_verification = matches!(done.outcome, SeedOutcome::Verified(_));
        if done.branch.is_none() && !is_verification {
            return Ok(());
        }
        let Some(result) = self.fetch(done).await? else { return Ok(()) };
        let amplitude = done.amplitude.text.clone();
        if let Some(id) = done.branch {
            let announced = self.announced.entry((amplitude, id)).or_default();
            announced.branch = Some(done.clone());
            let verification = match announced.verification.clone() {
                Some((done, _)) => self.fetch(&done).await?.and_then(|result| result.verification),
                None => None,
            };
            self.show(&result, verification.as_ref());
        } else if let (Task::Verify(place), Some(verification)) = (result.work, &result.verification) {
            let is_whole = place.stretch == Stretch::Whole;
            let announced = self.announced.entry((amplitude, place.branch)).or_default();
            if announced.verification.as_ref().is_some_and(|(_, knows_all)| *knows_all && !is_whole) {
                return Ok(());
            }
            announced.verification = Some((done.clone(), is_whole));
            let Some(branch) = announced.branch.clone() else { return Ok(()) };
            let Some(branch) = self.fetch(&branch).await? else { return Ok(()) };
            self.show(&branch, Some(verification));
        }
        Ok(())
    }

    /// What was announced; nothing if it does not arrive.
    async fn fetch(&mut self, done: &Done) -> Result<Option<StoredResult>, Error> {
        match self.follower.result(done).await {
            Ok(result) => Ok(Some(result)),
            Err(error @ FollowError::Gone(_)) => {
                self.missing += 1;
                Err(error.into())
            }
            // The others may be in order.
            Err(_) => {
                self.missing += 1;
                Ok(None)
            }
        }
    }

    fn show(&self, result: &StoredResult, verification: Option<&Verification>) {
        if let Some(&level) = self.levels.get(&result.amplitude.text)
            && let Ok(Some(curve)) = Curve::of(result, level)
        {
            let curve = match verification {
                Some(verification) => curve.verified(verification),
                None => curve,
            };
            self.feed.branch(&curve);
        }
    }
}

/// The backbone, if it is known already.
async fn backbone(follower: &Follower, key: &str, model: &Model) -> Result<Option<BackboneCurve>, Error> {
    let message: BackboneMessage = match follower.fetch(key).await {
        Ok(message) => message,
        // It is still being computed.
        Err(FollowError::Request(RequestError::Refused(_))) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let backbone = message.backbone(&Size::of(model)).map_err(|error| Error::Other(error.to_string()))?;
    Ok(Some(BackboneCurve::new(&backbone, model)))
}
