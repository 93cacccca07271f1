//! The coordinator on the bus: queries become jobs of the engine or reads of the store, news become puts.
//!
//! Callbacks of Zenoh only hand over: whatever may wait (decoding a result, reading the store, an answer to somebody
//! slow) runs on the blocking pool, a bounded number of them at a time.

use crate::engine::{Job, News};
use crate::store::{Reader, StoreError};
use protocol::codec::{Message, decode, encode, encoding};
use protocol::curve::Seeds;
use protocol::ids::{TaskId, WorkerId};
use protocol::keys::{Keys, last_chunk};
use protocol::session::{answer, answer_encoded, question, refuse};
use protocol::to_everyone::{LevelWindows, Manifest, SeedMessage, Status, WindowsMessage};
use solver::backbone::Backbone;
use solver::forced::{Forced, Reach};
use solver::model::Model;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender};
use std::sync::{Arc, Mutex};
use tokio::runtime::Handle;
use tokio::sync::{Semaphore, watch};
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::qos::CongestionControl;
use zenoh::query::{Query, Queryable};
use zenoh::sample::SampleKind;
use zenoh::{Session, Wait};

/// Results decoded at a time: bounds the memory that many submits at once take.
const SUBMITS: usize = 4;
/// Stored results read and sent at a time.
const READS: usize = 32;

/// What everybody may ask for and the store does not have.
#[derive(Clone)]
pub struct Shared {
    /// Latest manifest.
    pub manifest: watch::Receiver<Manifest>,
    /// Latest status.
    pub status: watch::Receiver<Option<Status>>,
    /// The `model` message.
    pub model_bytes: Arc<Vec<u8>>,
    /// The model.
    pub model: Arc<Model>,
    /// The sweep, once it has begun.
    pub sweep: Arc<Mutex<Option<Arc<Published>>>>,
}

/// What is known when the sweep begins.
pub struct Published {
    /// Backbone.
    pub backbone: Backbone,
    /// Bounds of branches.
    pub reach: Reach,
    /// The `windows` message.
    pub windows: WindowsMessage,
    /// The `backbone` message.
    pub backbone_bytes: Vec<u8>,
}

impl Published {
    /// From what was computed.
    pub fn new(backbone: Backbone, reach: Reach, levels: Vec<LevelWindows>) -> Self {
        let backbone_bytes = encode(&protocol::backbone::BackboneMessage::from(&backbone));
        Self { backbone, reach, windows: WindowsMessage { levels }, backbone_bytes }
    }
}

/// Everything declared on the bus; gone when dropped.
pub struct Presence {
    _queryables: Vec<Queryable<()>>,
    _token: LivelinessToken,
    _workers: zenoh::pubsub::Subscriber<()>,
    _progress: zenoh::pubsub::Subscriber<()>,
}

/// Answers queries from here on.
pub async fn serve(
    session: &Session,
    keys: &Keys,
    directory: PathBuf,
    shared: Shared,
    jobs: Sender<Job>,
) -> Result<Presence, zenoh::Error> {
    let runtime = Handle::current();
    let requests = Requests {
        jobs: jobs.clone(),
        keys: keys.clone(),
        runtime: runtime.clone(),
        permits: Arc::new(Semaphore::new(SUBMITS)),
    };
    let rpc = session.declare_queryable(keys.requests()).complete(true).callback(move |query| requests.hear(query));
    let mut queryables = vec![rpc.await?];
    let library = Arc::new(Library { directory, keys: keys.clone(), shared, readers: Mutex::new(Vec::new()) });
    let permits = Arc::new(Semaphore::new(READS));
    let small = Arc::new(Semaphore::new(READS));
    for (key, permits) in [
        (keys.run(), &small),
        (keys.model(), &small),
        (keys.backbone(), &small),
        (keys.windows(), &small),
        (keys.status(), &small),
        (keys.seeds(), &small),
        (keys.all_done(), &small),
        // Whoever asks for many results and does not read them keeps nobody from the rest.
        (keys.results(), &permits),
    ] {
        let (library, permits, runtime) = (library.clone(), permits.clone(), runtime.clone());
        let lend = move |query: Query| {
            let (library, permits) = (library.clone(), permits.clone());
            runtime.spawn(async move {
                let Ok(permit) = permits.acquire_owned().await else { return };
                tokio::task::spawn_blocking(move || {
                    library.lend(&query);
                    drop(permit);
                });
            });
        };
        queryables.push(session.declare_queryable(key).complete(true).callback(lend).await?);
    }
    let told = jobs.clone();
    let advanced = move |sample: zenoh::sample::Sample| {
        if let Ok(task) = TaskId::new(last_chunk(sample.key_expr().as_str()))
            && let Ok(progress) = decode(&sample.payload().to_bytes(), &sample.encoding().to_string())
        {
            let _ = told.send(Job::Progress(task, progress));
        }
    };
    let progress = session.declare_subscriber(keys.all_progress()).callback(advanced).await?;
    let vanished = move |sample: zenoh::sample::Sample| {
        if sample.kind() == SampleKind::Delete
            && let Ok(worker) = WorkerId::new(last_chunk(sample.key_expr().as_str()))
        {
            // The engine is gone only when the process ends.
            let _ = jobs.send(Job::WorkerGone(worker));
        }
    };
    let workers = session.liveliness().declare_subscriber(keys.alive_workers()).callback(vanished).await?;
    let token = session.liveliness().declare_token(keys.alive_coordinator()).await?;
    Ok(Presence { _queryables: queryables, _token: token, _workers: workers, _progress: progress })
}

/// Turns queries into jobs.
struct Requests {
    jobs: Sender<Job>,
    keys: Keys,
    runtime: Handle,
    permits: Arc<Semaphore>,
}

impl Requests {
    fn hear(&self, query: Query) {
        let key = query.key_expr().as_str().to_string();
        let keys = &self.keys;
        if key == keys.lease() {
            self.forward(query, Job::Lease);
        } else if key == keys.renew() {
            self.forward(query, Job::Renew);
        } else if key == keys.fail() {
            self.forward(query, Job::Fail);
        } else if key == keys.release() {
            self.forward(query, Job::Release);
        } else if key == keys.control() {
            self.forward(query, Job::Control);
        } else if TaskId::new(last_chunk(&key)).is_ok_and(|task| key == keys.submit(&task)) {
            self.submit(query);
        } else {
            self.runtime.spawn_blocking(move || refuse(&query, &format!("there is no request `{key}`")));
        }
    }

    fn forward<Q: Message, R: Message + Send + 'static>(
        &self,
        query: Query,
        job: impl FnOnce(Q, Box<dyn FnOnce(R) + Send>) -> Job,
    ) {
        match question::<Q>(&query) {
            Ok(request) => {
                let _ = self.jobs.send(job(request, respond(self.runtime.clone(), query, ())));
            }
            Err(error) => {
                self.runtime.spawn_blocking(move || refuse(&query, &error.to_string()));
            }
        }
    }

    fn submit(&self, query: Query) {
        let (jobs, runtime, permits) = (self.jobs.clone(), self.runtime.clone(), self.permits.clone());
        self.runtime.spawn(async move {
            let Ok(permit) = permits.acquire_owned().await else { return };
            let pool = runtime.clone();
            pool.spawn_blocking(move || match question(&query) {
                Ok(request) => {
                    let _ = jobs.send(Job::Submit(Box::new(request), respond(runtime, query, permit)));
                }
                Err(error) => refuse(&query, &error.to_string()),
            });
        });
    }
}

/// Answers a query from the blocking pool: whoever asked may be frozen. `held` is let go once the answer is decided.
fn respond<R: Message + Send + 'static>(
    runtime: Handle,
    query: Query,
    held: impl Send + 'static,
) -> Box<dyn FnOnce(R) + Send> {
    Box::new(move |reply| {
        drop(held);
        runtime.spawn_blocking(move || {
            let key = query.key_expr().as_str().to_string();
            answer(&query, &key, &reply);
        });
    })
}

/// Lends what is stored.
struct Library {
    directory: PathBuf,
    keys: Keys,
    shared: Shared,
    readers: Mutex<Vec<Reader>>,
}

impl Library {
    fn lend(&self, query: &Query) {
        let key = query.key_expr();
        let asks = |own: &str| zenoh::key_expr::keyexpr::new(own).is_ok_and(|own| own.intersects(key));
        let keys = &self.keys;
        if asks(&keys.run()) {
            answer(query, &keys.run(), &self.shared.manifest.borrow().clone());
        } else if asks(&keys.model()) {
            let bytes = self.shared.model_bytes.to_vec();
            answer_encoded(query, &keys.model(), bytes, &encoding::<protocol::model::ModelMessage>());
        } else if asks(&keys.status()) {
            let status = self.shared.status.borrow().clone();
            match status {
                Some(status) => answer(query, &keys.status(), &status),
                None => refuse(query, "the run is just starting"),
            }
        } else if asks(&keys.backbone()) || asks(&keys.windows()) || asks(&keys.seeds()) {
            let published = self.shared.sweep.lock().expect("no holder of this lock panics").clone();
            match published {
                Some(published) => self.lend_published(query, &published),
                None => refuse(query, "the backbone is still being computed"),
            }
        } else if let Err(error) = self.lend_stored(query) {
            tracing::error!(%error, "a stored result cannot be read");
            refuse(query, &error.to_string());
        }
    }

    fn lend_published(&self, query: &Query, published: &Published) {
        let keys = &self.keys;
        let asked = query.key_expr().as_str();
        if asked == keys.backbone() {
            let bytes = published.backbone_bytes.clone();
            answer_encoded(query, asked, bytes, &encoding::<protocol::backbone::BackboneMessage>());
        } else if asked == keys.windows() {
            answer(query, asked, &published.windows);
        } else {
            match self.seed(asked, published) {
                Some(seed) => answer(query, &keys.seed(&seed.task), &seed),
                None => refuse(query, "ask for the seed of one task: seed/<task>"),
            }
        }
    }

    /// The seed of the task that a key ends with.
    fn seed(&self, key: &str, published: &Published) -> Option<SeedMessage> {
        let task = TaskId::new(last_chunk(key)).ok()?;
        let manifest = self.shared.manifest.borrow().clone();
        let level = published.windows.levels.iter().find(|level| task.is_of_level(&level.amplitude.text))?;
        let (_, tasks) = solver::task::plan(&published.backbone, level.amplitude.value);
        let index =
            (0..tasks.len()).find(|&i| TaskId::of_level(&level.amplitude.text, i).is_ok_and(|id| id == task))?;
        let value = level.amplitude.value;
        let forced = Forced::new(&self.shared.model, &manifest.settings, published.reach, value);
        let seeds = Seeds::new(&tasks[index].seeds(&forced.problem, &published.backbone, value));
        Some(SeedMessage { task, amplitude: level.amplitude.clone(), work: tasks[index], seeds })
    }

    fn lend_stored(&self, query: &Query) -> Result<(), StoreError> {
        let reader = self.readers.lock().expect("no holder of this lock panics").pop();
        let reader = reader.map_or_else(|| Reader::open(&self.directory), Ok)?;
        let lent = self.lend_from(&reader, query);
        self.readers.lock().expect("no holder of this lock panics").push(reader);
        lent
    }

    fn lend_from(&self, reader: &Reader, query: &Query) -> Result<(), StoreError> {
        let (keys, asked) = (&self.keys, query.key_expr());
        let one = TaskId::new(last_chunk(asked.as_str())).ok();
        if let Some(task) = one.as_ref().filter(|task| asked.as_str() == keys.result(task)) {
            match reader.result(task)? {
                Some(result) => answer(query, &keys.result(task), &result),
                None => refuse(query, &format!("task {task} has no result yet")),
            }
            return Ok(());
        }
        let all_results = zenoh::key_expr::keyexpr::new(&keys.results()).is_ok_and(|own| own.intersects(asked));
        for done in reader.done()? {
            if all_results {
                if let Some(result) = reader.result(&done.task)? {
                    answer(query, &keys.result(&done.task), &result);
                }
            } else if one.as_ref().is_none_or(|task| *task == done.task) {
                answer(query, &keys.done(&done.task), &done);
            }
        }
        Ok(())
    }
}

/// Puts news on the bus until there are none any more. Whatever a slow reader misses it can ask for.
pub fn announce(session: &Session, keys: &Keys, news: &Receiver<News>) {
    for news in news {
        match news {
            News::Manifest(manifest) => put(session, &keys.run(), &manifest),
            News::Seed(seed) => put(session, &keys.seed(&seed.task), &seed),
            News::Done(done) => put(session, &keys.done(&done.task), &done),
            News::Status(status) => put(session, &keys.status(), &status),
            News::Hint => {
                let hint = session.put(keys.hint(), "").congestion_control(CongestionControl::Drop).wait();
                let _ = hint.inspect_err(|error| tracing::debug!(%error, "no hint"));
            }
        }
    }
}

fn put<M: Message>(session: &Session, key: &str, message: &M) {
    let put = session
        .put(key, encode(message))
        .encoding(Encoding::from(encoding::<M>()))
        .congestion_control(CongestionControl::Drop);
    if let Err(error) = put.wait() {
        tracing::debug!(key, %error, "not announced");
    }
}
