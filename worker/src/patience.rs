//! How often and how long a request is repeated.

use std::time::Duration;
use tokio::time::Instant;

const FIRST: Duration = Duration::from_millis(200);
const LONGEST: Duration = Duration::from_secs(2);

/// Patience is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutOfPatience;

/// Patience with a coordinator that does not answer.
#[derive(Debug)]
pub struct Patience {
    limit: Duration,
    since: Instant,
    pause: Duration,
}

impl Patience {
    /// Patience for so long, from now.
    pub fn new(limit: Duration) -> Self {
        Self { limit, since: Instant::now(), pause: FIRST }
    }

    /// How much of it is left.
    pub fn left(&self) -> Duration {
        self.limit.saturating_sub(self.since.elapsed())
    }

    /// There was an answer.
    pub fn restore(&mut self) {
        *self = Self::new(self.limit);
    }

    /// The next pause, each twice as long as the one before up to 2 s.
    pub fn next_pause(&mut self) -> Result<Duration, OutOfPatience> {
        let left = self.left();
        if left.is_zero() {
            return Err(OutOfPatience);
        }
        let pause = self.pause.min(left);
        self.pause = (2 * self.pause).min(LONGEST);
        Ok(pause)
    }

    /// Waits for the next pause.
    pub async fn pause(&mut self) -> Result<(), OutOfPatience> {
        tokio::time::sleep(self.next_pause()?).await;
        Ok(())
    }
}
