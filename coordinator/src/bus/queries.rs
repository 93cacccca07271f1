//! Queries of anyone: answered from what the run is now and from the store.

use super::recent::Recent;
use super::state::{PublishedSweep, RunState};
use protocol::backbone::BackboneMessage;
use protocol::codec::encoding;
use protocol::ids::TaskId;
use protocol::keys::{Keys, last_chunk};
use protocol::model::ModelMessage;
use protocol::session::{answer, answer_encoded, refuse};
use protocol::steps::PORTION;
use protocol::to_everyone::{StoredResult, WindowsMessage};
use results::store::{Reader, StoreError};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use tokio::sync::watch;
use zenoh::bytes::ZBytes;
use zenoh::key_expr::keyexpr;
use zenoh::query::Query;

/// Everything that anyone may ask for.
pub(super) struct Queries {
    directory: PathBuf,
    keys: Keys,
    /// The `model` message.
    model_bytes: Vec<u8>,
    recent: Arc<Recent>,
    state: watch::Receiver<RunState>,
    /// Open and not in use.
    readers: Mutex<Vec<Reader>>,
}

impl Queries {
    /// Of the run in a folder.
    pub fn new(
        directory: PathBuf,
        keys: Keys,
        model_bytes: Vec<u8>,
        recent: Arc<Recent>,
        state: watch::Receiver<RunState>,
    ) -> Self {
        Self { directory, keys, model_bytes, recent, state, readers: Mutex::new(Vec::new()) }
    }

    /// Answers a query. May wait for the disk, and for room on the way to whoever asked.
    pub fn answer(&self, query: &Query) {
        let asks = |own: &str| keyexpr::new(own).is_ok_and(|own| own.intersects(query.key_expr()));
        let keys = &self.keys;
        if asks(&keys.run()) {
            let manifest = self.state.borrow().manifest.clone();
            answer(query, &keys.run(), &manifest);
        } else if asks(&keys.model()) {
            answer_encoded(query, &keys.model(), self.model_bytes.clone(), &encoding::<ModelMessage>());
        } else if asks(&keys.status()) {
            let status = self.state.borrow().status.clone();
            match status {
                Some(status) => answer(query, &keys.status(), &status),
                None => refuse(query, "the run is just starting"),
            }
        } else if [keys.backbone(), keys.backbones(), keys.windows(), keys.seeds()].iter().any(|key| asks(key)) {
            let sweep = self.state.borrow().sweep.clone();
            match sweep {
                Some(sweep) => self.answer_of_sweep(query, &sweep),
                None => refuse(query, "the backbone is still being computed"),
            }
        } else if let Some((task, bytes)) = self.recent_result(query) {
            answer_encoded(query, &keys.result(&task), bytes, &encoding::<StoredResult>());
        } else if let Err(error) = self.answer_from_store(query) {
            tracing::error!(%error, "a stored result cannot be read");
            refuse(query, &error.to_string());
        }
    }

    fn answer_of_sweep(&self, query: &Query, sweep: &PublishedSweep) {
        let keys = &self.keys;
        let asked = query.key_expr().as_str();
        let of_mode = |(mode, _): &&(usize, Vec<u8>)| asked == keys.backbone_of(mode + 1);
        let primary = sweep.backbone_bytes.first().filter(|_| asked == keys.backbone());
        if let Some((_, bytes)) = primary.or_else(|| sweep.backbone_bytes.iter().find(of_mode)) {
            answer_encoded(query, asked, bytes.clone(), &encoding::<BackboneMessage>());
        } else if asked.starts_with(&format!("{}/", keys.backbone())) {
            refuse(query, "no backbone of this mode was followed: the manifest says of which modes there are some");
        } else if asked == keys.windows() {
            answer_encoded(query, asked, sweep.windows_bytes.clone(), &encoding::<WindowsMessage>());
        } else {
            match TaskId::new(last_chunk(asked)).ok().and_then(|task| sweep.seed(&task)) {
                Some(seed) => answer(query, &keys.seed(&seed.task), &seed),
                None => refuse(query, "ask for the seed of one task: seed/<task>"),
            }
        }
    }

    /// The result that is asked for, if it is at hand.
    fn recent_result(&self, query: &Query) -> Option<(TaskId, ZBytes)> {
        let asked = query.key_expr().as_str();
        let task = TaskId::new(last_chunk(asked)).ok().filter(|task| asked == self.keys.result(task))?;
        let bytes = self.recent.get(&task)?;
        Some((task, bytes))
    }

    fn answer_from_store(&self, query: &Query) -> Result<(), StoreError> {
        let reader = self.readers.lock().expect("no holder of this lock panics").pop();
        let reader = reader.map_or_else(|| Reader::open(&self.directory), Ok)?;
        let answered = self.answer_from(&reader, query);
        self.readers.lock().expect("no holder of this lock panics").push(reader);
        answered
    }

    fn answer_from(&self, reader: &Reader, query: &Query) -> Result<(), StoreError> {
        let (keys, asked) = (&self.keys, query.key_expr());
        let one = TaskId::new(last_chunk(asked.as_str())).ok();
        if let Some(task) = one.as_ref().filter(|task| asked.as_str() == keys.result(task)) {
            if !self.answer_result(reader, query, task)? {
                refuse(query, &format!("task {task} has no result yet"));
            }
            return Ok(());
        }
        // Workers ask whether a result is stored that is not answered for long: where there is little time as it is.
        if let Some(task) = one.as_ref().filter(|task| asked.as_str() == keys.done(task)) {
            match reader.done_of(task)? {
                Some(done) => answer(query, &keys.done(task), &done),
                None => refuse(query, &format!("task {task} has no result yet")),
            }
            return Ok(());
        }
        if let Some(task) = one.as_ref().filter(|task| asked.as_str() == keys.checkpoint(task)) {
            let first = query.parameters().get("first").map_or(Ok(0), str::parse);
            let Ok(first) = first else {
                refuse(query, "ask for the steps from a number on: checkpoint/<task>?first=<number>");
                return Ok(());
            };
            match reader.checkpoint(task, first, PORTION)? {
                Some(checkpoint) => answer(query, asked.as_str(), &checkpoint),
                None => refuse(query, &format!("nothing is kept of task {task} from step {first} on")),
            }
            return Ok(());
        }
        if asked.as_str() == keys.checkpoints() {
            refuse(query, "ask for the steps of one task: checkpoint/<task>");
            return Ok(());
        }
        let all_results = keyexpr::new(&keys.results()).is_ok_and(|own| own.intersects(asked));
        for done in reader.done()? {
            if all_results {
                self.answer_result(reader, query, &done.task)?;
            } else if one.as_ref().is_none_or(|task| *task == done.task) {
                answer(query, &keys.done(&done.task), &done);
            }
        }
        Ok(())
    }

    /// Answers with the result of a task, to the byte what was announced; false if there is none.
    fn answer_result(&self, reader: &Reader, query: &Query, task: &TaskId) -> Result<bool, StoreError> {
        let Some(bytes) = reader.encoded_result(task)? else { return Ok(false) };
        answer_encoded(query, &self.keys.result(task), bytes, &encoding::<StoredResult>());
        Ok(true)
    }
}
