//! Following a run from anywhere: how it is doing, and every announcement of a result exactly once.
//!
//! Announcements are puts: one may be dropped on the way, and a subscriber declared a moment ago may not be known yet. The
//! status says how many there are, and whoever has fewer asks for them, again and again, until all are there.

use crate::codec::{Message, decode, sha256};
use crate::ids::TaskId;
use crate::keys::Keys;
use crate::session::{RequestError, fetch, fetch_answer, fetch_every};
use crate::to_everyone::{Done, Status, StoredResult};
use std::collections::{HashMap, VecDeque};
use std::time::Duration;
use thiserror::Error;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::{Instant, sleep, sleep_until};
use zenoh::Session;
use zenoh::pubsub::Subscriber;

/// How long an answer may take.
const ANSWER: Duration = Duration::from_secs(10);
/// A coordinator that has said nothing for so long is asked; it sends its status every second.
const SILENCE: Duration = Duration::from_secs(3);
/// Time that an announcement is given to come by itself, and the first pause between two questions.
const GRACE: Duration = Duration::from_millis(300);
/// The slowest connection that results are fetched over at the first attempt, bytes/s; each further one has twice the time.
const SLOWEST: u64 = 1_000_000;

/// What a follower hears.
#[derive(Debug, Clone, PartialEq)]
pub enum Update {
    /// How the run is doing.
    Status(Status),
    /// A result is stored.
    Done(Done),
}

/// Why a run cannot be followed any further.
#[derive(Debug, Error)]
pub enum FollowError {
    /// The coordinator is gone, frozen or cut off.
    #[error("the coordinator has not answered for {} s", .0.as_secs())]
    Gone(Duration),
    /// A result that is not the one announced.
    #[error("the result of task {0} is not the one that was announced: its SHA-256 differs")]
    Altered(TaskId),
    /// It answers, but not with what was asked for.
    #[error(transparent)]
    Request(#[from] RequestError),
}

/// What was announced, with its SHA-256, and how much there is. A result that was withdrawn since it was wrong is followed by another
/// one of its task, which is announced as well.
#[derive(Debug, Default)]
struct Tally {
    announced: HashMap<TaskId, String>,
    /// Number of announcements by the coordinator's account.
    expected: Option<u64>,
    is_over: bool,
}

impl Tally {
    /// Takes down what was heard; gives it back if it is new.
    fn take(&mut self, update: Update) -> Option<Update> {
        match &update {
            Update::Status(status) => (self.expected, self.is_over) = (Some(status.sequence), status.stage.is_over()),
            Update::Done(done) => {
                self.expected = self.expected.max(Some(done.sequence));
                if self.announced.insert(done.task.clone(), done.sha256.clone()).as_ref() == Some(&done.sha256) {
                    return None;
                }
            }
        }
        Some(update)
    }

    fn is_complete(&self) -> bool {
        self.expected.is_some_and(|expected| self.announced.len() as u64 >= expected)
    }
}

/// Follows a run to its end.
pub struct Follower {
    session: Session,
    keys: Keys,
    patience: Duration,
    news: UnboundedReceiver<Result<Update, RequestError>>,
    _subscribers: [Subscriber<()>; 2],
    tally: Tally,
    ready: VecDeque<Update>,
    ask_at: Instant,
    pause: Duration,
    /// Since when questions have had no answer.
    unanswered: Option<Instant>,
}

impl Follower {
    /// Begins to follow a run; whoever does not answer for as long as `patience` is gone.
    ///
    /// # Errors
    /// If the session is closed.
    pub async fn start(session: &Session, keys: &Keys, patience: Duration) -> Result<Self, RequestError> {
        // Subscribe first, ask afterwards: what comes in between comes twice, not never.
        let (sender, news) = unbounded_channel();
        let subscribers = [
            subscribe(session, keys.all_done(), Update::Done, sender.clone()).await?,
            subscribe(session, keys.status(), Update::Status, sender).await?,
        ];
        Ok(Self {
            session: session.clone(),
            keys: keys.clone(),
            patience,
            news,
            _subscribers: subscribers,
            tally: Tally::default(),
            ready: VecDeque::new(),
            ask_at: Instant::now(),
            pause: GRACE,
            unanswered: None,
        })
    }

    /// What is new; nothing more once the run is finished or cancelled and every result was told of.
    ///
    /// # Errors
    /// If the coordinator is gone, or says what cannot be read. It may be called again: a coordinator may come back.
    pub async fn next(&mut self) -> Result<Option<Update>, FollowError> {
        loop {
            if let Some(update) = self.ready.pop_front() {
                return Ok(Some(update));
            }
            if self.tally.is_over && self.tally.is_complete() {
                return Ok(None);
            }
            tokio::select! {
                biased;
                Some(update) = self.news.recv() => self.hear(update?),
                () = sleep_until(self.ask_at) => self.ask().await?,
            }
        }
    }

    /// Number of results that were announced by the coordinator's account, and not told of.
    pub fn missing(&self) -> u64 {
        self.tally.expected.map_or(0, |expected| expected.saturating_sub(self.tally.announced.len() as u64))
    }

    fn hear(&mut self, update: Update) {
        self.unanswered = None;
        let was_complete = self.tally.is_complete();
        self.ready.extend(self.tally.take(update));
        if self.tally.is_complete() {
            (self.ask_at, self.pause) = (Instant::now() + SILENCE, GRACE);
        } else if was_complete {
            // The announcement that is missing may just have been overtaken.
            self.ask_at = Instant::now() + GRACE;
        }
    }

    /// Asks how the run is doing, and for all announcements if any is missing.
    async fn ask(&mut self) -> Result<(), FollowError> {
        match fetch(&self.session, &self.keys.status(), ANSWER).await {
            Ok(status) => {
                self.hear(Update::Status(status));
                if !self.tally.is_complete() {
                    let announced: Vec<Done> = fetch_every(&self.session, &self.keys.all_done(), ANSWER).await?;
                    announced.into_iter().for_each(|done| self.hear(Update::Done(done)));
                }
            }
            // It is there, just starting.
            Err(RequestError::Refused(_)) => self.unanswered = None,
            Err(RequestError::NoReply) => {
                let since = *self.unanswered.get_or_insert_with(Instant::now);
                if since.elapsed() > self.patience {
                    self.unanswered = None;
                    return Err(FollowError::Gone(self.patience));
                }
            }
            Err(error) => return Err(error.into()),
        }
        if !self.tally.is_complete() || self.unanswered.is_some() {
            self.ask_at = Instant::now() + self.pause;
            self.pause = (2 * self.pause).min(SILENCE);
        }
        Ok(())
    }

    /// The message at a key of the run, asked for until the coordinator answers.
    ///
    /// # Errors
    /// If it refuses, is gone, or says what cannot be read.
    pub async fn fetch<R: Message>(&self, key: &str) -> Result<R, FollowError> {
        let (payload, encoding) = self.insist(key, ANSWER).await?;
        Ok(decode(&payload, &encoding).map_err(RequestError::from)?)
    }

    /// The result that was announced.
    ///
    /// # Errors
    /// If it cannot be had, or is another one.
    pub async fn result(&self, done: &Done) -> Result<StoredResult, FollowError> {
        let timeout = ANSWER + Duration::from_secs(done.size / SLOWEST);
        let (payload, encoding) = self.insist(&self.keys.result(&done.task), timeout).await?;
        if sha256(&payload) != done.sha256 {
            return Err(FollowError::Altered(done.task.clone()));
        }
        Ok(decode(&payload, &encoding).map_err(RequestError::from)?)
    }

    /// Payload and encoding of an answer.
    async fn insist(&self, key: &str, mut timeout: Duration) -> Result<(Vec<u8>, String), FollowError> {
        let (mut unanswered, mut pause) = (None, GRACE);
        loop {
            match fetch_answer(&self.session, key, timeout).await {
                Ok(answer) => return Ok(answer),
                Err(RequestError::NoReply) => {
                    // Not from the first question on: whoever was stopped meanwhile could not hear the answer.
                    if unanswered.get_or_insert_with(Instant::now).elapsed() > self.patience {
                        return Err(FollowError::Gone(self.patience));
                    }
                    sleep(pause).await;
                }
                Err(error) => return Err(error.into()),
            }
            (timeout, pause) = (2 * timeout, (2 * pause).min(SILENCE));
        }
    }
}

/// Hands on whatever is put at a key. Nothing is lost or held up while the follower is busy.
async fn subscribe<M: Message>(
    session: &Session,
    key: String,
    update: impl Fn(M) -> Update + Send + Sync + 'static,
    news: UnboundedSender<Result<Update, RequestError>>,
) -> Result<Subscriber<()>, RequestError> {
    let hear = move |sample: zenoh::sample::Sample| {
        let message = decode(&sample.payload().to_bytes(), &sample.encoding().to_string());
        // Nobody listens any more when the follower ends.
        let _ = news.send(message.map(&update).map_err(RequestError::from));
    };
    let declared = session.declare_subscriber(key).callback(hear).await;
    declared.map_err(|error| RequestError::Closed(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::RunId;
    use crate::to_everyone::{Amplitude, Counts, Stage};
    use solver::response::task::SeedOutcome;

    fn status(stage: Stage, sequence: u64) -> Update {
        Update::Status(Status {
            run: RunId::new("one").unwrap(),
            name: "one".into(),
            stage,
            backbone: None,
            tasks: Counts::default(),
            levels: 1,
            levels_done: 0,
            active: Vec::new(),
            workers: Vec::new(),
            stalled: Vec::new(),
            sequence,
            elapsed: 0.0,
            eta: None,
        })
    }

    fn done(sequence: u64) -> Update {
        Update::Done(announced(sequence))
    }

    fn announced(sequence: u64) -> Done {
        Done {
            sequence,
            task: TaskId::new(&format!("20-{sequence}")).unwrap(),
            amplitude: Amplitude { text: "20".into(), value: 20.0 },
            outcome: SeedOutcome::OutOfBounds,
            branch: None,
            size: 0,
            sha256: String::new(),
        }
    }

    #[test]
    fn announcements_count_once() {
        let mut tally = Tally::default();
        assert!(!tally.is_complete(), "nobody has said how many there are");
        assert!(tally.take(status(Stage::Sweep, 0)).is_some() && tally.is_complete());
        assert!(tally.take(done(1)).is_some() && tally.is_complete());
        assert!(tally.take(done(1)).is_none());
        assert!(tally.take(done(3)).is_some() && !tally.is_complete(), "the second one is missing");
        assert!(tally.take(done(2)).is_some() && tally.is_complete());
        // One was wrong.
        let again = || Update::Done(Done { sha256: "00".into(), ..announced(2) });
        assert!(tally.take(again()).is_some() && tally.take(again()).is_none() && tally.is_complete());
        assert!(tally.take(status(Stage::Finished, 4)).is_some());
        assert!(tally.is_over && !tally.is_complete());
        assert!(tally.take(done(4)).is_some() && tally.is_complete());
    }
}
