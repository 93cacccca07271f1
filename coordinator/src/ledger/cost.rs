//! What tasks cost.

/// What tasks of a kind have cost so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cost {
    /// How many tasks.
    pub count: usize,
    /// Computing time of all of them, s.
    pub seconds: f64,
}

/// So many tasks of a kind that may be unlike the others are taken to have cost what tasks of all kinds cost: the first fold is
/// followed for long, and most of the others are found to lie on its curve.
const UNKNOWN: f64 = 4.0;

impl Cost {
    /// Of a task; nothing as long as none is done.
    pub fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.seconds / self.count as f64)
    }

    /// Of a task to come, where tasks of all kinds cost so much.
    pub fn expected(self, all: f64) -> f64 {
        (self.seconds + UNKNOWN * all) / (self.count as f64 + UNKNOWN)
    }

    /// Of the tasks of both.
    pub fn and(self, other: Self) -> Self {
        Self { count: self.count + other.count, seconds: self.seconds + other.seconds }
    }
}
