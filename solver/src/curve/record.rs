//! The steps of walks, recorded: whoever is given them goes on where they end as if nothing had happened.
//!
//! A task may walk several curves, one after the other. Steps are recorded with the number of their walk; when the task is carried
//! out again they are taken as they were, without Newton's method, and everything else that a walk does with its points (bounds,
//! closure, identity) is done again. As what comes before a step is the same, what comes after it is the same to the last bit.

use crate::curve::point::CurvePoint;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// A step of a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Number of the walk within its task, from 1; one that is taken up again beyond where it had stalled counts as another.
    pub walk: usize,
    /// The point that it led to.
    pub point: CurvePoint,
    /// What the next step depends on beside the last two points.
    pub ahead: Ahead,
    /// What the problem remembers there.
    pub memory: Vec<f64>,
}

/// What the next step of a walk depends on beside the last two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead {
    /// Arc length of the next step.
    pub step: f64,
    /// Longest step that the problem allows.
    pub longest: f64,
    /// Whether it limits steps at all.
    pub is_narrow: bool,
    /// Steps refused so far.
    pub rejections: usize,
    /// Whether the tangent of the last point is that of its own Jacobian.
    pub is_refreshed: bool,
}

/// Told of every step that was computed, with its number among all steps of the task, from 0.
pub type Keep = dyn FnMut(usize, Step) + Send;

/// Records the steps of walks, and gives back those recorded before. By default it does neither.
#[derive(Clone, Default)]
pub struct Recorder(Option<Arc<Mutex<Tape>>>);

struct Tape {
    /// Steps still to be taken again.
    before: VecDeque<Step>,
    /// Steps taken.
    count: usize,
    /// Number of the walk under way.
    walk: usize,
    /// Whether the steps recorded before were those of something else.
    is_foreign: bool,
    keep: Box<Keep>,
}

impl Recorder {
    /// Takes these steps again, which were recorded before, and hands those that follow to `keep`.
    pub fn new(before: Vec<Step>, keep: impl FnMut(usize, Step) + Send + 'static) -> Self {
        let tape = Tape { before: before.into(), count: 0, walk: 0, is_foreign: false, keep: Box::new(keep) };
        Self(Some(Arc::new(Mutex::new(tape))))
    }

    fn with<R>(&self, what: impl FnOnce(&mut Tape) -> R) -> Option<R> {
        self.0.as_ref().map(|tape| what(&mut tape.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// A walk begins.
    pub(super) fn begin(&self) {
        self.with(Tape::begin);
    }

    /// Whether the next step of the walk under way was recorded before.
    pub(super) fn goes_on(&self) -> bool {
        self.with(|tape| tape.goes_on()).unwrap_or(false)
    }

    /// The next step of the walk under way, of a state of this length, if it was recorded before.
    pub(super) fn next(&self, length: usize) -> Option<Step> {
        self.with(|tape| tape.next(length)).flatten()
    }

    /// Records a step of the walk under way.
    pub(super) fn add(&self, point: &CurvePoint, ahead: Ahead, memory: impl FnOnce() -> Vec<f64>) {
        self.with(|tape| tape.add(point, ahead, memory()));
    }
}

impl Tape {
    fn begin(&mut self) {
        if self.before.front().is_some_and(|step| step.walk <= self.walk) {
            self.give_up();
        }
        self.walk += 1;
    }

    fn goes_on(&self) -> bool {
        self.before.front().is_some_and(|step| step.walk == self.walk)
    }

    fn next(&mut self, length: usize) -> Option<Step> {
        // A walk whose steps have all been taken again ends as it did, or goes on.
        if !self.goes_on() {
            return None;
        }
        let step = self.before.pop_front().filter(|step| step.point.is_of(length));
        if step.is_some() {
            self.count += 1;
        } else {
            self.give_up();
        }
        step
    }

    fn add(&mut self, point: &CurvePoint, ahead: Ahead, memory: Vec<f64>) {
        if !self.before.is_empty() {
            self.give_up();
        }
        if !self.is_foreign {
            (self.keep)(self.count, Step { walk: self.walk, point: point.clone(), ahead, memory });
            self.count += 1;
        }
    }

    /// What was recorded before is of something else: what is computed now does not follow from it, and is not recorded.
    fn give_up(&mut self) {
        self.before.clear();
        self.is_foreign = true;
    }
}
