//! A coordinator that answers as it is told to.

use crate::study::Study;
use clap::Parser;
use protocol::codec::{Message, decode, encode, encoding};
use protocol::credentials::Credentials;
use protocol::from_worker::{FailRequest, LeaseRequest, ReleaseRequest, RenewRequest, SubmitRequest};
use protocol::ids::TaskId;
use protocol::keys::{Keys, NAMESPACE, last_chunk};
use protocol::pieces::{Piece, PieceReply};
use protocol::session::{answer, answer_encoded, encoding_of, listen, question, refuse};
use protocol::to_everyone::{Manifest, StoredResult};
use protocol::to_worker::{Acknowledgement, LeaseReply, RenewReply, SubmitReply};
use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use worker::shutdown::Shutdown;
use worker::{Options, Summary, WorkerError};
use zenoh::Session;
use zenoh::key_expr::KeyExpr;
use zenoh::query::Query;

/// What a worker asks.
#[derive(Debug, Clone, PartialEq)]
pub enum Asked {
    Lease(LeaseRequest),
    Renew(RenewRequest),
    Submit(Box<SubmitRequest>),
    Fail(FailRequest),
    Release(ReleaseRequest),
}

impl Asked {
    pub fn is_lease(&self) -> bool {
        matches!(self, Asked::Lease(_))
    }

    pub fn is_renew(&self) -> bool {
        matches!(self, Asked::Renew(_))
    }

    pub fn is_submit(&self) -> bool {
        matches!(self, Asked::Submit(_))
    }

    pub fn is_fail(&self) -> bool {
        matches!(self, Asked::Fail(_))
    }

    pub fn is_release(&self) -> bool {
        matches!(self, Asked::Release(_))
    }
}

/// What it is answered.
pub enum Answer {
    Lease(Box<LeaseReply>),
    Renew(RenewReply),
    Submit(SubmitReply),
    Refuse(&'static str),
    Silence,
}

pub fn grant(grant: protocol::to_worker::Grant) -> Answer {
    Answer::Lease(Box::new(LeaseReply::Grant(grant)))
}

pub fn drained() -> Answer {
    Answer::Lease(Box::new(LeaseReply::Drained))
}

pub fn wait() -> Answer {
    Answer::Lease(Box::new(LeaseReply::Wait { retry_ms: 20 }))
}

/// What a friendly coordinator answers to anything but a request for work.
pub fn fine(asked: &Asked) -> Answer {
    match asked {
        Asked::Renew(_) => Answer::Renew(RenewReply::Ok),
        Asked::Submit(_) => Answer::Submit(SubmitReply::Accepted),
        // Failures and releases are noted in any case.
        _ => Answer::Silence,
    }
}

/// Hands out these grants, then says that all is done.
pub fn hand_out(grants: Vec<protocol::to_worker::Grant>) -> impl FnMut(&Asked) -> Answer + Send + 'static {
    let mut grants = grants.into_iter();
    move |asked| match asked {
        Asked::Lease(_) => grants.next().map_or_else(drained, grant),
        _ => fine(asked),
    }
}

/// What everyone may see of a [`Fake`].
#[derive(Default)]
pub struct Seen {
    pub log: Mutex<Vec<Asked>>,
    pub results: Mutex<HashMap<TaskId, StoredResult>>,
    pub manifest: Mutex<Option<Manifest>>,
    pub model: Mutex<Vec<u8>>,
}

impl Seen {
    pub fn count(&self, of: fn(&Asked) -> bool) -> usize {
        self.log.lock().unwrap().iter().filter(|asked| of(asked)).count()
    }

    /// Waits until one more request of a kind has come.
    pub async fn wait_for_another(&self, of: fn(&Asked) -> bool) {
        self.wait_for(of, self.count(of) + 1).await;
    }

    /// Waits until so many requests of a kind have come.
    pub async fn wait_for(&self, of: fn(&Asked) -> bool, count: usize) {
        let started = Instant::now();
        while self.count(of) < count {
            assert!(started.elapsed() < PATIENCE, "asked: {:?}", self.log.lock().unwrap());
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
    }

    pub fn submitted(&self) -> Vec<SubmitRequest> {
        let log = self.log.lock().unwrap();
        let submit = |asked: &Asked| if let Asked::Submit(request) = asked { Some((**request).clone()) } else { None };
        log.iter().filter_map(submit).collect()
    }

    pub fn reasons(&self) -> Vec<String> {
        let log = self.log.lock().unwrap();
        let fail = |asked: &Asked| if let Asked::Fail(request) = asked { Some(request.reason.clone()) } else { None };
        log.iter().filter_map(fail).collect()
    }
}

/// A coordinator that answers as it is told to; gone when it is dropped.
pub struct Fake {
    pub session: Session,
    pub endpoint: String,
    pub keys: Keys,
    pub seen: Arc<Seen>,
}

/// How long anything is waited for before a test fails: minutes, since the machine may be busy with other things.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// An endpoint that no other test, of this process or another one, listens on or connects from: on a loopback address that
/// belongs to this process, with a port below those that the system gives to connections.
pub fn own_endpoint() -> String {
    static COUNT: AtomicU16 = AtomicU16::new(0);
    let [_, a, b, c] = std::process::id().to_be_bytes();
    format!("tcp/127.{}.{b}.{c}:{}", 64 + a % 64, 20_000 + COUNT.fetch_add(1, Ordering::Relaxed))
}

impl Fake {
    pub async fn start(study: &Study, answer: impl FnMut(&Asked) -> Answer + Send + 'static) -> Self {
        Self::start_at(&own_endpoint(), Arc::default(), study, answer).await
    }

    /// At an endpoint of one's choice, with something to see already.
    pub async fn start_at(
        endpoint: &str,
        seen: Arc<Seen>,
        study: &Study,
        answer: impl FnMut(&Asked) -> Answer + Send + 'static,
    ) -> Self {
        let session = listen(endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
        let manifest = study.manifest();
        let keys = Keys::new("isola", &manifest.run);
        *seen.manifest.lock().unwrap() = Some(manifest);
        *seen.model.lock().unwrap() = study.model_message();
        serve(&session, &keys, seen.clone(), answer).await;
        Self { session, endpoint: endpoint.to_string(), keys, seen }
    }

    /// Makes another run visible on the same bus.
    pub async fn announce(&self, manifest: Manifest) {
        let key = Keys::new("isola", &manifest.run).run();
        let reply = key.clone();
        let queryable = self.session.declare_queryable(key).callback(move |query| answer(&query, &reply, &manifest));
        queryable.background().await.unwrap();
    }

    /// Options of a worker of this coordinator.
    pub fn options(&self, more: &[&str]) -> Options {
        options(&self.endpoint, more)
    }

    /// Runs a worker to its end.
    pub async fn work(&self, more: &[&str]) -> Result<Summary, WorkerError> {
        worker::work(&self.options(more), &Shutdown::default()).await
    }

    /// Changes the manifest from now on.
    pub fn change(&self, change: impl FnOnce(&mut Manifest)) {
        change(self.seen.manifest.lock().unwrap().as_mut().unwrap());
    }

    /// Tells workers to ask for orders.
    pub async fn hint(&self) {
        self.session.put(self.keys.hint(), "").await.unwrap();
    }
}

/// Later options win.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Line {
    #[command(flatten)]
    options: Options,
}

pub fn options(endpoint: &str, more: &[&str]) -> Options {
    let line = ["worker", "--connect", endpoint, "--slots", "1", "--wait", "100"];
    Line::parse_from(line.iter().chain(more)).options
}

async fn serve(
    session: &Session,
    keys: &Keys,
    seen: Arc<Seen>,
    mut decide: impl FnMut(&Asked) -> Answer + Send + 'static,
) {
    let (inbox, queries) = std::sync::mpsc::channel::<Query>();
    let all = keys.run().replace("/run", "/**");
    let queryable = session.declare_queryable(all).complete(true);
    queryable.callback(move |query| drop(inbox.send(query))).background().await.unwrap();
    let keys = keys.clone();
    std::thread::spawn(move || {
        let mut pieces = Pieces::default();
        for query in queries {
            let key = query.key_expr().as_str().to_string();
            // Of a query for all runs this is one.
            if query.key_expr().intersects(&KeyExpr::try_from(keys.run()).unwrap()) {
                answer(&query, &keys.run(), seen.manifest.lock().unwrap().as_ref().unwrap());
            } else if key == keys.model() {
                let model = seen.model.lock().unwrap().clone();
                answer_encoded(&query, &key, model, &encoding::<protocol::model::ModelMessage>());
            } else if key.contains("/result/") {
                let task = TaskId::new(last_chunk(&key)).unwrap();
                if let Some(stored) = seen.results.lock().unwrap().get(&task) {
                    answer_encoded(&query, &key, encode(stored), &encoding::<StoredResult>());
                }
            } else if let Some(asked) = read(&query, &key, &keys, &mut pieces) {
                seen.log.lock().unwrap().push(asked.clone());
                reply(&query, &key, &asked, decide(&asked));
            }
        }
    });
}

fn read(query: &Query, key: &str, keys: &Keys, pieces: &mut Pieces) -> Option<Asked> {
    fn of<Q: Message>(query: &Query) -> Q {
        question(query).unwrap()
    }
    let asked = match key {
        key if key == keys.lease() => Asked::Lease(of(query)),
        key if key == keys.renew() => Asked::Renew(of(query)),
        key if key == keys.fail() => Asked::Fail(of(query)),
        key if key == keys.release() => Asked::Release(of(query)),
        key if key.contains("/rpc/submit/") => {
            let payload = pieces.whole(query)?;
            Asked::Submit(Box::new(decode(&payload, &encoding_of(query)).unwrap()))
        }
        _ => return None,
    };
    Some(asked)
}

/// What has come of messages in pieces, by their names.
#[derive(Default)]
struct Pieces(HashMap<String, BTreeMap<usize, Vec<u8>>>);

impl Pieces {
    /// The message that a query brings, or completes; a piece after which others are to come is answered.
    fn whole(&mut self, query: &Query) -> Option<Vec<u8>> {
        let payload = query.payload().unwrap().to_bytes().into_owned();
        let Some(attached) = query.attachment() else { return Some(payload) };
        let piece = Piece::read(attached).unwrap();
        let parts = self.0.entry(piece.message.clone()).or_default();
        parts.insert(piece.number, payload);
        if parts.len() < piece.count() {
            answer(query, query.key_expr(), &PieceReply::Taken);
            return None;
        }
        Some(self.0.remove(&piece.message)?.into_values().flatten().collect())
    }
}

fn reply(query: &Query, key: &str, asked: &Asked, with: Answer) {
    match (with, asked) {
        (Answer::Lease(reply), _) => answer(query, key, &*reply),
        (Answer::Renew(reply), _) => answer(query, key, &reply),
        (Answer::Submit(reply), _) => answer(query, key, &reply),
        (Answer::Refuse(why), _) => refuse(query, why),
        (Answer::Silence, Asked::Fail(_) | Asked::Release(_)) => answer(query, key, &Acknowledgement::Ok),
        (Answer::Silence, _) => {}
    }
}
