//! Turns on a computing thread: its lanes take one each, so that one computes while the result of the other is on its way. Where tasks
//! are brief, two lanes both wait for acknowledgements most of the time: others join them then.

use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Mutex, OwnedMutexGuard, watch};

/// Lanes that take turns however long tasks take.
pub const STEADY: u32 = 2;

/// Tasks that take less are brief: about what an acknowledgement takes.
const BRIEF: Duration = Duration::from_millis(2);

/// So many brief tasks in a row let others expect to be brief as well.
const ENOUGH: u32 = 8;

/// A computing thread is taken until this is dropped.
pub type Turn = OwnedMutexGuard<()>;

/// Turns on a computing thread, in the order in which they were asked for.
#[derive(Debug, Default)]
pub struct Turns {
    turn: Arc<Mutex<()>>,
    /// Lanes that have a task and wait for their turn.
    waiting: watch::Sender<usize>,
    pace: watch::Sender<Pace>,
}

/// How the tasks of a thread follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pace {
    /// So many of the last ones were brief.
    Brief(u32),
    /// There are no more.
    Over,
}

impl Default for Pace {
    fn default() -> Self {
        Self::Brief(0)
    }
}

impl Pace {
    fn is_brief(self) -> bool {
        matches!(self, Self::Brief(count) if count >= ENOUGH)
    }
}

impl Turns {
    /// A task has taken so long.
    pub fn note(&self, time: Duration) {
        self.pace.send_if_modified(|pace| {
            let Pace::Brief(count) = *pace else { return false };
            let before = *pace;
            *pace = Pace::Brief(if time < BRIEF { (count + 1).min(ENOUGH) } else { 0 });
            *pace != before
        });
    }

    /// There are no more tasks.
    pub fn end(&self) {
        self.pace.send_replace(Pace::Over);
    }

    /// Whether tasks are brief.
    pub fn are_brief(&self) -> bool {
        self.pace.borrow().is_brief()
    }

    /// Waits until tasks are brief; `false` if there are no more.
    pub async fn become_brief(&self) -> bool {
        let mut pace = self.pace.subscribe();
        // It ends with `self`.
        pace.wait_for(|pace| pace.is_brief() || *pace == Pace::Over).await.is_ok_and(|pace| pace.is_brief())
    }

    /// Waits for the turn of a lane that has no task yet.
    pub async fn take(&self) -> Turn {
        self.turn.clone().lock_owned().await
    }

    /// Waits for the turn of a lane that has a task. Who has the turn and no task hears of it: see [`Turns::is_wanted`].
    pub async fn take_with_task(&self) -> Turn {
        self.waiting.send_modify(|waiting| *waiting += 1);
        let _waiting = Waiting(&self.waiting);
        self.take().await
    }

    /// Waits until a lane waits that has a task.
    pub async fn is_wanted(&self) {
        let mut waiting = self.waiting.subscribe();
        // It ends with `self`.
        let _ = waiting.wait_for(|&waiting| waiting > 0).await;
    }
}

/// A lane that waits, until it is dropped.
struct Waiting<'w>(&'w watch::Sender<usize>);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.send_modify(|waiting| *waiting -= 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::Future;
    use std::pin::pin;
    use std::task::{Context, Waker};

    fn is_ready(future: std::pin::Pin<&mut impl Future>) -> bool {
        future.poll(&mut Context::from_waker(Waker::noop())).is_ready()
    }

    #[test]
    fn who_has_no_task_hears_of_one_that_waits() {
        let turns = Turns::default();
        assert!(is_ready(pin!(turns.take())));
        let turn = turns.turn.clone().try_lock_owned().unwrap();
        let mut wanted = pin!(turns.is_wanted());
        assert!(!is_ready(wanted.as_mut()));
        let mut second = Box::pin(turns.take_with_task());
        assert!(!is_ready(second.as_mut()));
        assert!(is_ready(wanted.as_mut()));
        drop(turn);
        assert!(is_ready(second.as_mut()));
        // What was waited for is not wanted any more.
        assert!(!is_ready(pin!(turns.is_wanted())));
    }

    #[test]
    fn tasks_are_brief_after_several_in_a_row_until_one_is_not() {
        let turns = Turns::default();
        let mut brief = pin!(turns.become_brief());
        for _ in 0..ENOUGH {
            assert!(!turns.are_brief() && !is_ready(brief.as_mut()));
            turns.note(BRIEF / 2);
        }
        assert!(turns.are_brief() && is_ready(brief.as_mut()));
        turns.note(BRIEF);
        assert!(!turns.are_brief());
        turns.end();
        turns.note(BRIEF / 2);
        assert!(is_ready(pin!(turns.become_brief())) && !turns.are_brief());
    }

    #[test]
    fn who_gives_up_waiting_is_not_waited_for() {
        let turns = Turns::default();
        let _turn = turns.turn.clone().try_lock_owned().unwrap();
        let mut second = Box::pin(turns.take_with_task());
        assert!(!is_ready(second.as_mut()));
        drop(second);
        assert!(!is_ready(pin!(turns.is_wanted())));
    }
}
