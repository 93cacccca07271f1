//! Computing threads for which there was no work: they wait to be woken, one for every task that can be handed out, and ask now and
//! then in case that is lost on the way.

use protocol::from_worker::thread_of;
use protocol::ids::WorkerId;
use results::journal::Holder;
use std::collections::{HashSet, VecDeque};
use std::time::Duration;

/// Between two requests of all threads that wait, together: so few cost next to nothing, however many threads there are.
const BETWEEN: Duration = Duration::from_millis(20);
/// A thread asks no more often.
const SHORTEST: Duration = Duration::from_secs(1);
/// It asks no less often, so that one whose coordinator forgot about it is not forgotten for long.
const LONGEST: Duration = Duration::from_secs(10);

/// Computing threads that wait for work.
#[derive(Debug, Default)]
pub(super) struct Parking {
    /// In the order in which they came.
    waiting: VecDeque<Holder>,
    /// Woken, and not heard of since: tasks are there for them.
    woken: HashSet<Holder>,
}

impl Parking {
    /// There is nothing for a thread; after how long it asks again if it is not woken.
    pub fn park(&mut self, holder: Holder) -> Duration {
        self.waiting.push_back(holder);
        (BETWEEN * self.waiting.len() as u32).clamp(SHORTEST, LONGEST)
    }

    /// A thread asks by itself.
    pub fn leave(&mut self, holder: &Holder) {
        if !self.woken.remove(holder) {
            self.waiting.retain(|waiting| waiting != holder);
        }
    }

    /// Who waits of the computing thread of a slot.
    pub fn waiting_of(&self, holder: &Holder) -> Option<&Holder> {
        let thread = thread_of(holder.slot);
        self.waiting.iter().find(|waiting| waiting.worker == holder.worker && thread_of(waiting.slot) == thread)
    }

    /// A worker vanished.
    pub fn forget(&mut self, worker: &WorkerId) {
        self.waiting.retain(|waiting| waiting.worker != *worker);
        self.woken.retain(|woken| woken.worker != *worker);
    }

    /// Those that were woken had the time to ask: tasks that are still there are for others.
    pub fn give_up_on_woken(&mut self) {
        self.woken.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Whom to wake for so many tasks that can be handed out, those first that have waited longest.
    pub fn wake(&mut self, tasks: usize) -> Vec<WorkerId> {
        let count = tasks.saturating_sub(self.woken.len()).min(self.waiting.len());
        let chosen: Vec<Holder> = self.waiting.drain(..count).collect();
        let workers = chosen.iter().map(|holder| holder.worker.clone()).collect();
        self.woken.extend(chosen);
        workers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thread(name: &str) -> Holder {
        Holder { worker: WorkerId::new(name).unwrap(), slot: 0 }
    }

    fn woken(parking: &mut Parking, tasks: usize) -> Vec<String> {
        parking.wake(tasks).iter().map(|worker| worker.as_str().to_string()).collect()
    }

    #[test]
    fn one_thread_is_woken_for_every_task_and_another_one_if_it_is_not_heard_of() {
        let mut parking = Parking::default();
        for name in ["a", "b", "c", "d"] {
            parking.park(thread(name));
        }
        assert_eq!(woken(&mut parking, 1), ["a"]);
        // It is on its way to ask for that task.
        assert!(woken(&mut parking, 1).is_empty());
        assert_eq!(woken(&mut parking, 2), ["b"]);
        parking.leave(&thread("b"));
        parking.forget(&thread("c").worker);
        parking.give_up_on_woken();
        assert_eq!(woken(&mut parking, 5), ["d"]);
        assert!(parking.is_empty());
    }

    #[test]
    fn all_together_ask_no_more_often_however_many_they_are() {
        let mut parking = Parking::default();
        assert_eq!(parking.park(thread("a")), SHORTEST);
        let pauses: Vec<Duration> = (0..10_000).map(|n| parking.park(thread(&format!("w{n}")))).collect();
        assert_eq!(pauses[254], BETWEEN * 256);
        assert_eq!(pauses[9_999], LONGEST);
    }
}
