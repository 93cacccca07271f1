//! Turns on a computing thread: its lanes take one each, so that one computes while the result of the other is on its way.

use std::sync::Arc;
use tokio::sync::{Mutex, OwnedMutexGuard, watch};

/// A computing thread is taken until this is dropped.
pub type Turn = OwnedMutexGuard<()>;

/// Turns on a computing thread, in the order in which they were asked for.
#[derive(Debug, Default)]
pub struct Turns {
    turn: Arc<Mutex<()>>,
    /// Lanes that have a task and wait for their turn.
    waiting: watch::Sender<usize>,
}

impl Turns {
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
    fn who_gives_up_waiting_is_not_waited_for() {
        let turns = Turns::default();
        let _turn = turns.turn.clone().try_lock_owned().unwrap();
        let mut second = Box::pin(turns.take_with_task());
        assert!(!is_ready(second.as_mut()));
        drop(second);
        assert!(!is_ready(pin!(turns.is_wanted())));
    }
}
