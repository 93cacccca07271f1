//! The coordinator on the bus: requests become events of the engine, queries reads of state and store, news puts.
//!
//! Callbacks of Zenoh only hand over: whatever may wait (checking a result, reading the store, an answer to somebody slow)
//! runs on the blocking pool, a bounded number of them at a time.

mod announcements;
mod answers;
mod checkpoints;
mod held;
mod intake;
mod pieces;
mod queries;
mod recent;
mod requests;
mod state;

pub use announcements::announce;
pub use recent::Recent;
pub use state::{PublishedSweep, RunState};

use crate::engine::{Decider, Event, Meters};
use answers::Answers;
use protocol::codec::decode;
use protocol::ids::{TaskId, WorkerId};
use protocol::keys::{Keys, last_chunk};
use queries::Queries;
use requests::Requests;
use solver::response::orders::Orders;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::runtime::Handle;
use tokio::sync::{Semaphore, watch};
use zenoh::Session;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::{Sample, SampleKind};

/// Queries answered at a time: small ones, and as many for results.
const QUERIES: usize = 32;

/// What answers need that does not change.
pub struct Served {
    /// Folder of the run.
    pub directory: PathBuf,
    /// The `model` message.
    pub model_bytes: Vec<u8>,
    /// The model with its numerics, which results are checked against.
    pub orders: Orders,
    /// What is counted.
    pub meters: Meters,
    /// Results stored lately.
    pub recent: Arc<Recent>,
    /// The run as it is.
    pub state: watch::Receiver<RunState>,
}

/// Everything declared on the bus; gone when dropped.
pub struct Presence {
    _queryables: Vec<Queryable<()>>,
    _token: LivelinessToken,
    _subscribers: [Subscriber<()>; 2],
}

/// Answers from here on.
pub async fn serve(
    session: &Session,
    keys: &Keys,
    served: Served,
    engine: Arc<Decider>,
) -> Result<Presence, zenoh::Error> {
    let Served { directory, model_bytes, orders, meters, recent, state } = served;
    let most = state.borrow().manifest.max_result_bytes;
    let answers = Answers { session: session.clone(), keys: keys.clone(), state: state.clone() };
    let requests = Requests::new(engine.clone(), keys.clone(), answers, (orders, meters), most);
    let take = move |query| requests.take(query);
    let mut queryables = vec![session.declare_queryable(keys.requests()).complete(true).callback(take).await?];
    let queries = Arc::new(Queries::new(directory, keys.clone(), model_bytes, recent, state));
    queryables.extend(declare_queries(session, keys, &queries).await?);
    let progress = session.declare_subscriber(keys.all_progress()).callback(progress(engine.clone())).await?;
    let workers = session.liveliness().declare_subscriber(keys.alive_workers()).callback(vanished(engine)).await?;
    let token = session.liveliness().declare_token(keys.alive_coordinator()).await?;
    Ok(Presence { _queryables: queryables, _token: token, _subscribers: [progress, workers] })
}

async fn declare_queries(
    session: &Session,
    keys: &Keys,
    queries: &Arc<Queries>,
) -> Result<Vec<Queryable<()>>, zenoh::Error> {
    let (small, large) = (Arc::new(Semaphore::new(QUERIES)), Arc::new(Semaphore::new(QUERIES)));
    let mut queryables = Vec::new();
    for (key, permits) in [
        (keys.run(), &small),
        (keys.model(), &small),
        (keys.backbone(), &small),
        (keys.backbones(), &small),
        (keys.windows(), &small),
        (keys.status(), &small),
        (keys.seeds(), &small),
        (keys.all_done(), &small),
        // Whoever asks for many results and does not read them keeps nobody from the rest.
        (keys.results(), &large),
        (keys.checkpoints(), &large),
    ] {
        let (queries, permits, runtime) = (queries.clone(), permits.clone(), Handle::current());
        let answer = move |query: Query| {
            let (queries, permits) = (queries.clone(), permits.clone());
            runtime.spawn(async move {
                let Ok(permit) = permits.acquire_owned().await else { return };
                tokio::task::spawn_blocking(move || {
                    queries.answer(&query);
                    drop(permit);
                });
            });
        };
        queryables.push(session.declare_queryable(key).complete(true).callback(answer).await?);
    }
    Ok(queryables)
}

/// Hears where branches under way are.
fn progress(engine: Arc<Decider>) -> impl Fn(Sample) {
    move |sample| {
        if let Ok(task) = TaskId::new(last_chunk(sample.key_expr().as_str()))
            && let Ok(progress) = decode(&sample.payload().to_bytes(), &sample.encoding().to_string())
        {
            // The engine is gone only when the process ends.
            engine.tell(Event::Progress(task, progress));
        }
    }
}

/// Hears of workers that vanish.
fn vanished(engine: Arc<Decider>) -> impl Fn(Sample) {
    move |sample| {
        if sample.kind() == SampleKind::Delete
            && let Ok(worker) = WorkerId::new(last_chunk(sample.key_expr().as_str()))
        {
            engine.tell(Event::WorkerGone(worker));
        }
    }
}
