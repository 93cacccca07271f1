//! The backbone as a message.

use crate::array::{Array, ArrayError};
use crate::codec::messages;
use crate::curve::{Points, Size};
use serde::{Deserialize, Serialize};
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::response::branch::Outcome;
use solver::response::melnikov::Energies;

/// Backbone of p points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackboneMessage {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// How it begins and ends.
    pub outcome: Outcome,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
    /// The points.
    pub points: Points,
    /// R_lin, J a period: p.
    pub r_lin: Array,
    /// R_nl, J a period: p.
    pub r_nl: Array,
    /// W/A, J a period: p.
    pub work_per_amplitude: Array,
    /// Energy certificate: p.
    pub certificate: Array,
    /// Threshold A*: p.
    pub threshold: Array,
    /// Scaled arc length: p.
    pub arc: Array,
    /// Modal contributions, summing to 1: p × modes.
    pub contributions: Array,
}

messages! { BackboneMessage => "backbone" }

impl From<&Backbone> for BackboneMessage {
    fn from(backbone: &Backbone) -> Self {
        let points = &backbone.points;
        let count = points.len();
        let column = |of: fn(&BackbonePoint) -> f64| Array::new([count], points.iter().map(of));
        let modes = points.first().map_or(0, |point| point.contributions.len());
        Self {
            mode: backbone.mode,
            outcome: backbone.outcome,
            rejections: backbone.rejections,
            points: Points::new(points.iter().map(|point| &point.point)),
            r_lin: column(|p| p.energies.linear),
            r_nl: column(|p| p.energies.nonlinear),
            work_per_amplitude: column(|p| p.energies.work_per_amplitude),
            certificate: column(|p| p.energies.certificate),
            threshold: column(|p| p.threshold),
            arc: column(|p| p.arc),
            contributions: Array::new([count, modes], points.iter().flat_map(|p| p.contributions.iter().copied())),
        }
    }
}

impl BackboneMessage {
    /// The backbone, for a model of this size.
    pub fn backbone(&self, size: &Size) -> Result<Backbone, ArrayError> {
        let points = self.points.points(size)?;
        let count = [points.len()];
        let linear = self.r_lin.values("r_lin", &count)?;
        let nonlinear = self.r_nl.values("r_nl", &count)?;
        let work = self.work_per_amplitude.values("work_per_amplitude", &count)?;
        let certificate = self.certificate.values("certificate", &count)?;
        let threshold = self.threshold.values("threshold", &count)?;
        let arc = self.arc.values("arc", &count)?;
        let contributions = self.contributions.values("contributions", &[points.len(), size.modes])?;
        let mut contributions = contributions.chunks(size.modes.max(1));
        let points = points.into_iter().enumerate().map(|(i, point)| BackbonePoint {
            point,
            energies: Energies {
                linear: linear[i],
                nonlinear: nonlinear[i],
                work_per_amplitude: work[i],
                certificate: certificate[i],
            },
            threshold: threshold[i],
            contributions: contributions.next().unwrap_or_default().to_vec(),
            arc: arc[i],
        });
        let (mode, outcome, rejections) = (self.mode, self.outcome, self.rejections);
        Ok(Backbone { mode, points: points.collect(), outcome, rejections })
    }
}
