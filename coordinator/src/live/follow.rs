//! Takes everything that a page shows from the bus: what is there already and what comes.

use super::feed::Feed;
use super::{Run, Start};
use crate::display::summary;
use crate::error::Error;
use crate::report::{BackboneCurve, Curve, Level, monitors};
use crate::target::Live;
use protocol::backbone::BackboneMessage;
use protocol::codec::{Message, decode};
use protocol::curve::Size;
use protocol::ids::TaskId;
use protocol::model::ModelMessage;
use protocol::session::{RequestError, fetch, fetch_all};
use protocol::to_everyone::{Done, Manifest, Stage, Status, StoredResult};
use serde::Serialize;
use solver::model::Model;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use zenoh::pubsub::Subscriber;
use zenoh::sample::Sample;

/// How long an answer is waited for.
const TIMEOUT: Duration = Duration::from_secs(10);
/// A run without a status for so long has no coordinator any more.
const SILENCE: Duration = Duration::from_secs(10);

/// Samples as they come. Nothing is lost or held up while something else is waited for.
struct Updates {
    samples: mpsc::UnboundedReceiver<Sample>,
    _subscriber: Subscriber<()>,
}

/// How the run is doing, as the page shows it.
#[derive(Serialize)]
struct Line {
    stage: Stage,
    text: String,
}

/// A branch with the forcing amplitude of its level.
#[derive(Serialize)]
struct BranchOfLevel<'c> {
    #[serde(flatten)]
    curve: &'c Curve,
    value: f64,
}

/// Follows a run from its beginning to its end.
pub(super) struct Follower<'l> {
    live: &'l Live,
    feed: Arc<Feed>,
    announcements: Updates,
    statuses: Updates,
    /// Levels by amplitude as typed.
    levels: HashMap<String, usize>,
    told: HashSet<TaskId>,
    /// As long as the backbone is not known.
    awaits_backbone: Option<Model>,
}

fn unanswered(what: &str) -> impl FnOnce(RequestError) -> Error {
    let what = what.to_string();
    |source| Error::Request { what, source }
}

async fn subscribe(live: &Live, key: String) -> Result<Updates, Error> {
    let (sender, samples) = mpsc::unbounded_channel();
    // Nobody listens any more when the page ends.
    let declared = live.session.declare_subscriber(key).callback(move |sample| drop(sender.send(sample))).await;
    let subscriber = declared.map_err(|error| Error::Other(format!("the run cannot be followed: {error}")))?;
    Ok(Updates { samples, _subscriber: subscriber })
}

fn read<M: Message>(sample: &Sample) -> Result<M, Error> {
    let bytes = sample.payload().to_bytes();
    decode(&bytes, &sample.encoding().to_string()).map_err(|error| Error::Other(error.to_string()))
}

impl<'l> Follower<'l> {
    /// Begins to follow a run; nothing that is announced from now on is missed.
    pub async fn start(live: &'l Live, feed: Arc<Feed>) -> Result<(Self, Start), Error> {
        let announcements = subscribe(live, live.keys.all_done()).await?;
        let statuses = subscribe(live, live.keys.status()).await?;
        let manifest: Manifest =
            fetch(&live.session, &live.keys.run(), TIMEOUT).await.map_err(unanswered("the run"))?;
        let (start, model) = beginning(live, &manifest).await?;
        let levels = start.levels.iter().enumerate().map(|(i, level)| (level.amplitude.clone(), i)).collect();
        let (told, awaits_backbone) = (HashSet::new(), start.backbone.is_none().then_some(model));
        Ok((Self { live, feed, announcements, statuses, levels, told, awaits_backbone }, start))
    }

    /// Tells the feed everything until the run has ended.
    pub async fn follow(mut self) -> Result<(), Error> {
        self.catch_up().await?;
        loop {
            tokio::select! {
                Some(sample) = self.announcements.samples.recv() => self.tell(&read(&sample)?).await,
                status = tokio::time::timeout(SILENCE, self.statuses.samples.recv()) => {
                    let status = match status {
                        Ok(Some(sample)) => read(&sample)?,
                        // Missed updates are no reason to give up; a coordinator that does not answer is.
                        _ => match self.live.status().await {
                            Ok(status) => status,
                            Err(_) => {
                                self.feed.tell("end", &"The coordinator does not answer any more.");
                                return Ok(());
                            }
                        },
                    };
                    if self.status(&status).await? {
                        return Ok(());
                    }
                }
            }
        }
    }

    /// Whether the run has ended.
    async fn status(&mut self, status: &Status) -> Result<bool, Error> {
        if let Some(model) = self.awaits_backbone.as_ref().filter(|_| status.stage != Stage::Backbone)
            && let Some(curve) = backbone(self.live, model).await?
        {
            self.feed.tell("backbone", &curve);
            self.awaits_backbone = None;
        }
        self.feed.tell_status(&Line { stage: status.stage, text: summary(status) });
        let has_ended = matches!(status.stage, Stage::Finished | Stage::Cancelled);
        let is_behind = (self.told.len() as u64) < status.sequence;
        if is_behind && (has_ended || self.announcements.samples.is_empty()) {
            self.catch_up().await?;
        }
        if has_ended {
            let missing = status.sequence.saturating_sub(self.told.len() as u64);
            let what = if missing > 0 { format!(" {missing} results did not arrive.") } else { String::new() };
            self.feed.tell("end", &format!("The run is {}.{what}", status.stage.name()));
        }
        Ok(has_ended)
    }

    /// Everything announced so far.
    async fn catch_up(&mut self) -> Result<(), Error> {
        let key = self.live.keys.all_done();
        let all: Vec<Done> =
            fetch_all(&self.live.session, &key, TIMEOUT).await.map_err(unanswered("the results so far"))?;
        for done in &all {
            self.tell(done).await;
        }
        Ok(())
    }

    /// Hands on what was announced. What cannot be fetched now is tried again at the next status.
    async fn tell(&mut self, done: &Done) {
        if self.told.contains(&done.task) {
            return;
        }
        if done.branch.is_some() {
            let key = self.live.keys.result(&done.task);
            let fetched: Result<StoredResult, _> = fetch(&self.live.session, &key, TIMEOUT).await;
            let Ok(result) = fetched else { return };
            if let Some(&level) = self.levels.get(&result.amplitude.text)
                && let Ok(Some(curve)) = Curve::of(&result, level)
            {
                self.feed.tell("branch", &BranchOfLevel { curve: &curve, value: result.amplitude.value });
            }
        }
        self.told.insert(done.task.clone());
    }
}

/// What there is before the first branch, and the model.
async fn beginning(live: &Live, manifest: &Manifest) -> Result<(Start, Model), Error> {
    let message: ModelMessage =
        fetch(&live.session, &live.keys.model(), TIMEOUT).await.map_err(unanswered("the model"))?;
    let model = message.model().map_err(|error| Error::Other(error.to_string()))?;
    let mut amplitudes = manifest.amplitudes.clone();
    amplitudes.sort_by(|a, b| a.value.total_cmp(&b.value));
    let start = Start {
        run: Run {
            id: manifest.run.to_string(),
            name: manifest.name.clone(),
            model: model.name.clone(),
            stage: manifest.stage,
        },
        monitors: monitors(&model),
        levels: amplitudes.into_iter().map(|amplitude| Level::bare(amplitude.text, amplitude.value)).collect(),
        branches: [],
        backbone: backbone(live, &model).await?,
    };
    Ok((start, model))
}

/// The backbone, if it is known already.
async fn backbone(live: &Live, model: &Model) -> Result<Option<BackboneCurve>, Error> {
    let key = live.keys.backbone();
    let found: Vec<BackboneMessage> =
        fetch_all(&live.session, &key, TIMEOUT).await.map_err(unanswered("the backbone"))?;
    let Some(message) = found.first() else { return Ok(None) };
    let backbone = message.backbone(&Size::of(model)).map_err(|error| Error::Other(error.to_string()))?;
    Ok(Some(BackboneCurve::new(&backbone, model)))
}
