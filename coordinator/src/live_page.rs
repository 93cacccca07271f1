//! Takes everything that a page shows from the bus: what is there already and what comes.

use crate::display::summary;
use crate::error::Error;
use crate::remote::RemoteRun;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use protocol::follow::{FollowError, Follower, Update};
use protocol::model::ModelMessage;
use protocol::session::RequestError;
use protocol::to_everyone::{Done, Stage, Status};
use results::live::{self, Feed, Run, Start};
use results::report::{BackboneCurve, Curve, monitors};
use solver::structure::Model;
use std::collections::HashMap;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use worker::terminal;

/// A run without an answer for so long has no coordinator any more.
const PATIENCE: Duration = Duration::from_secs(20);

/// Serves the page of a run at `address` until the process is ended.
///
/// # Errors
/// If nothing can be served there, or the run cannot be followed.
pub async fn serve(run: &RemoteRun, address: &str) -> Result<(), Error> {
    let refused = |source: io::Error| {
        Error::Other(format!("--page {address}: {source}; give HOST:PORT of this machine, as in 127.0.0.1:8080"))
    };
    let listener = TcpListener::bind(address).await.map_err(refused)?;
    let served_at = listener.local_addr().map_err(refused)?;
    let feed = Arc::new(Feed::new());
    let (teller, start) = Teller::start(run, feed.clone()).await?;
    terminal::print(format_args!("http://{served_at} shows the run as it goes on; Ctrl-C ends this\n"))
        .map_err(Error::io("standard output"))?;
    let served = async { live::serve(listener, start, feed).await.map_err(refused) };
    tokio::try_join!(served, teller.tell()).map(|_| ())
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
    /// Results that could not be had.
    missing: u64,
    stage: Stage,
}

impl Teller {
    /// Begins to follow a run; nothing that is announced from now on is missed.
    async fn start(run: &RemoteRun, feed: Arc<Feed>) -> Result<(Self, Start), Error> {
        let follower = Follower::start(&run.session, &run.keys, PATIENCE).await.map_err(FollowError::from)?;
        let (manifest, backbone_key) = (&run.manifest, run.keys.backbone());
        let message: ModelMessage = follower.fetch(&run.keys.model()).await?;
        let model = message.model().map_err(|error| Error::Other(error.to_string()))?;
        let mut amplitudes = manifest.amplitudes.clone();
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
        let start = Start::new(shown, monitors(&model), levels.clone(), backbone);
        let teller = Self {
            follower,
            backbone_key,
            feed,
            levels: levels.into_iter().enumerate().map(|(i, (text, _))| (text, i)).collect(),
            awaits_backbone: (!is_known).then_some(model),
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

    /// Hands on what was announced.
    async fn result(&mut self, done: &Done) -> Result<(), Error> {
        if done.branch.is_none() {
            return Ok(());
        }
        let result = match self.follower.result(done).await {
            Ok(result) => result,
            Err(error) => {
                self.missing += 1;
                return match error {
                    FollowError::Gone(_) => Err(error.into()),
                    // The others may be in order.
                    _ => Ok(()),
                };
            }
        };
        if let Some(&level) = self.levels.get(&result.amplitude.text)
            && let Ok(Some(curve)) = Curve::of(&result, level)
        {
            self.feed.branch(&curve, result.amplitude.value);
        }
        Ok(())
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
