//! A curve over the forcing amplitude, of folds, peaks or responses at one frequency, as a message.

use crate::array::ArrayError;
use crate::curve::{Points, Size};
use serde::{Deserialize, Serialize};
use solver::response::branch::{BranchPoint, Outcome};
use solver::response::critical::{Corner, CriticalCurve, CriticalEvent, Quantity};

/// Curve of p points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CriticalMessage {
    /// What has an extremum at its points, along the branch at each point's own forcing amplitude; nothing at fixed frequency.
    pub quantity: Option<Quantity>,
    /// How it begins and ends.
    pub outcome: Outcome,
    /// For both ends, if it stalled there: the element, by its number in the model, that is about to act or to cease.
    pub grazing: [Option<usize>; 2],
    /// Steps refused and repeated shorter.
    pub rejections: usize,
    /// Births, merges and cusps, by index of the point.
    pub events: Vec<CriticalEvent>,
    /// Corners at which a contact begins or ends and beyond which the curve was taken up again, by index of the point.
    #[serde(default)]
    pub corners: Vec<Corner>,
    /// The points: a forced response each, at its own forcing amplitude.
    pub points: Points,
}

impl From<&CriticalCurve> for CriticalMessage {
    fn from(curve: &CriticalCurve) -> Self {
        Self {
            quantity: curve.quantity,
            outcome: curve.outcome,
            grazing: curve.grazing,
            rejections: curve.rejections,
            events: curve.events.clone(),
            corners: curve.corners.clone(),
            points: Points::new(curve.points.iter()),
        }
    }
}

impl CriticalMessage {
    /// Forcing amplitudes of its points, of a closed curve the first one again; none if they are no numbers.
    pub fn forcing(&self) -> Vec<f64> {
        let count = self.points.len();
        let mut forcing = self.points.motions.forcing.values("forcing", &[count]).unwrap_or_default();
        forcing.extend(forcing.first().copied().filter(|_| self.outcome == Outcome::Closed));
        forcing
    }

    /// The curve, for a model of this size.
    ///
    /// # Errors
    /// If an array has another shape, an event or a corner is at no point, or a forcing amplitude is none.
    pub fn curve(&self, size: &Size) -> Result<CriticalCurve, ArrayError> {
        let points = self.points.points(size)?;
        let indices = self.events.iter().map(|event| event.index).chain(self.corners.iter().map(|corner| corner.index));
        let last = indices.max().unwrap_or(0).max(self.events.len()).max(self.corners.len());
        if last >= points.len() {
            return Err(ArrayError::Special { index: last, points: points.len() });
        }
        let is_number =
            |(forcing, omega): (f64, f64)| forcing > 0.0 && omega > 0.0 && forcing.is_finite() && omega.is_finite();
        if let Some(event) = self.events.iter().find(|event| !event.doubled.is_none_or(is_number)) {
            return Err(ArrayError::Forcing { index: event.index });
        }
        // What crosses a level is told by the forcing.
        let is_none = |point: &BranchPoint| !(point.state.forcing > 0.0 && point.state.forcing.is_finite());
        if let Some(index) = points.iter().position(is_none) {
            return Err(ArrayError::Forcing { index });
        }
        Ok(CriticalCurve {
            quantity: self.quantity,
            points,
            events: self.events.clone(),
            corners: self.corners.clone(),
            outcome: self.outcome,
            grazing: self.grazing,
            rejections: self.rejections,
        })
    }
}
