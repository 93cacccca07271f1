//! Steps of walks as arrays: what a checkpoint of a task under way consists of.

use crate::array::{Array, ArrayError};
use crate::codec::messages;
use serde::{Deserialize, Serialize};
use solver::curve::continuation::CurvePoint;
use solver::curve::record::{Ahead, Step};

/// Bytes of the steps in one answer: no more, unless the first part alone has more.
pub const PORTION: usize = 32 << 20;

/// p steps of one length of state n, one after the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// What the task was given, see [`crate::to_worker::Grant::fingerprint`]: with anything else other steps are taken.
    pub given: String,
    /// Number of the first of them among all steps of the task, from 0.
    pub first: usize,
    /// Number of the walk that each is of: p.
    pub walk: Vec<usize>,
    /// Scaled states: p × n.
    pub state: Array,
    /// Unit tangents: p × n.
    pub tangent: Array,
    /// What the problem remembers: p × any.
    pub memory: Array,
    /// Newton iterations: p.
    pub iterations: Vec<usize>,
    /// Factorisations they needed: p.
    pub factorisations: Vec<usize>,
    /// Largest scaled residual: p.
    pub residual: Array,
    /// Sign of the determinant: p.
    pub orientation: Array,
    /// Arc length of the step: p.
    pub step: Array,
    /// Of the next one: p.
    pub next_step: Array,
    /// Longest that the problem allows then: p.
    pub longest_step: Array,
    /// Whether it limits steps: p.
    pub is_narrow: Vec<bool>,
    /// Steps refused so far: p.
    pub rejections: Vec<usize>,
    /// Whether the tangent is that of the point's own Jacobian: p.
    pub is_refreshed: Vec<bool>,
}

impl Steps {
    /// Of the first of these steps, as many as are of one length; `first` is the number of the first one.
    pub fn new(given: String, first: usize, steps: &[Step]) -> Self {
        let shape = |step: &Step| (step.point.y.len(), step.memory.len());
        let steps = steps.chunk_by(|a, b| shape(a) == shape(b)).next().unwrap_or_default();
        let (p, (n, memory)) = (steps.len(), steps.first().map_or((0, 0), shape));
        let number = |of: fn(&Step) -> f64| Array::new([p], steps.iter().map(of));
        let count = |of: fn(&Step) -> usize| steps.iter().map(of).collect();
        let flag = |of: fn(&Step) -> bool| steps.iter().map(of).collect();
        Self {
            given,
            first,
            walk: count(|step| step.walk),
            state: Array::new([p, n], steps.iter().flat_map(|step| step.point.y.iter().copied())),
            tangent: Array::new([p, n], steps.iter().flat_map(|step| step.point.tangent.iter().copied())),
            memory: Array::new([p, memory], steps.iter().flat_map(|step| step.memory.iter().copied())),
            iterations: count(|step| step.point.iterations),
            factorisations: count(|step| step.point.factorisations),
            residual: number(|step| step.point.residual),
            orientation: number(|step| step.point.orientation),
            step: number(|step| step.point.step),
            next_step: number(|step| step.ahead.step),
            longest_step: number(|step| step.ahead.longest),
            is_narrow: flag(|step| step.ahead.is_narrow),
            rejections: count(|step| step.ahead.rejections),
            is_refreshed: flag(|step| step.ahead.is_refreshed),
        }
    }

    /// Number of steps p.
    pub fn len(&self) -> usize {
        self.walk.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.walk.is_empty()
    }

    /// The steps.
    ///
    /// # Errors
    /// Arrays that do not fit each other, and states that are not finite.
    pub fn steps(&self) -> Result<Vec<Step>, ArrayError> {
        let p = self.len();
        let width = |array: &Array| array.shape.get(1).copied().unwrap_or(0);
        let (n, remembered) = (width(&self.state), width(&self.memory));
        let states = self.state.finite("state", &[p, n])?;
        let tangents = self.tangent.finite("tangent", &[p, n])?;
        let memories = self.memory.finite("memory", &[p, remembered])?;
        let numbers = [&self.residual, &self.orientation, &self.step, &self.next_step, &self.longest_step];
        let [residual, orientation, step, next, longest] = numbers.map(|array| array.values("numbers of steps", &[p]));
        let (residual, orientation, step, next, longest) = (residual?, orientation?, step?, next?, longest?);
        for length in [self.iterations.len(), self.factorisations.len(), self.rejections.len()] {
            fits("counts of steps", length, p)?;
        }
        for length in [self.is_narrow.len(), self.is_refreshed.len()] {
            fits("flags of steps", length, p)?;
        }
        let part = |values: &[f64], i: usize, width: usize| values[i * width..(i + 1) * width].to_vec();
        let one = |i: usize| Step {
            walk: self.walk[i],
            point: CurvePoint {
                y: part(&states, i, n),
                tangent: part(&tangents, i, n),
                iterations: self.iterations[i],
                factorisations: self.factorisations[i],
                residual: residual[i],
                orientation: orientation[i],
                step: step[i],
            },
            ahead: Ahead {
                step: next[i],
                longest: longest[i],
                is_narrow: self.is_narrow[i],
                rejections: self.rejections[i],
                is_refreshed: self.is_refreshed[i],
            },
            memory: part(&memories, i, remembered),
        };
        Ok((0..p).map(one).collect())
    }
}

messages! {
    Steps => "steps",
}

fn fits(name: &'static str, length: usize, expected: usize) -> Result<(), ArrayError> {
    if length == expected {
        return Ok(());
    }
    Err(ArrayError::Shape { name, shape: vec![length], bytes: length, expected: vec![expected] })
}
