//! Results stored lately, as they are sent: those that workers ask for are mostly of tasks that were done a moment ago.

use protocol::ids::TaskId;
use std::collections::{HashMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use zenoh::bytes::ZBytes;

/// Bytes that are kept at most.
const MOST: usize = 64 << 20;

/// The encodings of results that are on disk, as many of the last ones as there is room for.
#[derive(Default)]
pub struct Recent(Mutex<Kept>);

#[derive(Default)]
struct Kept {
    results: HashMap<TaskId, ZBytes>,
    /// In the order in which they came.
    order: VecDeque<TaskId>,
    bytes: usize,
}

impl Recent {
    /// Keeps the result of a task, which is on disk.
    pub fn keep(&self, task: TaskId, bytes: Vec<u8>) {
        let mut kept = self.kept();
        kept.bytes += bytes.len();
        kept.order.push_back(task.clone());
        kept.results.insert(task, bytes.into());
        while kept.bytes > MOST {
            let Some(oldest) = kept.order.pop_front().and_then(|task| kept.results.remove(&task)) else { return };
            kept.bytes -= oldest.len();
        }
    }

    /// The result of a task is none any more.
    pub fn forget(&self, task: &TaskId) {
        let mut kept = self.kept();
        if let Some(bytes) = kept.results.remove(task) {
            kept.bytes -= bytes.len();
            kept.order.retain(|other| other != task);
        }
    }

    /// The result of a task, if it is kept.
    pub fn get(&self, task: &TaskId) -> Option<ZBytes> {
        self.kept().results.get(task).cloned()
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_make_room() {
        let recent = Recent::default();
        let task = |n: usize| TaskId::new(&format!("1-{n}")).unwrap();
        for n in 0..4 {
            recent.keep(task(n), vec![n as u8; MOST / 3]);
        }
        assert!(recent.get(&task(0)).is_none());
        assert_eq!(recent.get(&task(3)).unwrap().to_bytes()[0], 3);
        recent.forget(&task(3));
        assert!(recent.get(&task(3)).is_none());
        recent.keep(task(3), vec![7; MOST / 3]);
        assert_eq!(recent.get(&task(3)).unwrap().to_bytes()[0], 7);
        assert!(recent.get(&task(1)).is_some());
        recent.keep(task(4), vec![0; MOST + 1]);
        assert!((0..5).all(|n| recent.get(&task(n)).is_none()));
    }
}
