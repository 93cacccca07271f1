//! Backbone: the nonlinear normal mode of one mode, or its resonances in quadrature with the forcing, with energies and
//! modal contributions (paper [20–26]).

mod assemble;
mod compute;
mod crossing;
mod error;
mod known;

use crate::curve::extrema::turning_points;
use crate::response::branch::{BranchPoint, Outcome};
use crate::response::columns::{self, Row};
use crate::response::melnikov::Energies;
pub use crossing::MOST as MOST_CROSSING;
pub use error::BackboneError;
use serde::{Deserialize, Serialize};

/// A point of the backbone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackbonePoint {
    /// Motion, and what points of any curve have.
    pub point: BranchPoint,
    /// What a backbone has besides: [`columns::of_backbone`].
    pub values: Row,
}

impl BackbonePoint {
    /// Energy balance.
    pub fn energies(&self) -> Energies {
        Energies {
            linear: self.values.first(columns::R_LIN),
            nonlinear: self.values.first(columns::R_NL),
            work_per_amplitude: self.values.first(columns::WORK),
            certificate: self.values.first(columns::CERTIFICATE),
        }
    }

    /// Threshold amplitude A*: forced responses are predicted here for A > A*.
    pub fn threshold(&self) -> f64 {
        self.values.first(columns::THRESHOLD)
    }

    /// Share of each mode, summing to 1.
    pub fn contributions(&self) -> &[f64] {
        self.values.all(columns::CONTRIBUTIONS)
    }

    /// Scaled arc length from the first point; that of a piece goes on from the end of the one before.
    pub fn arc(&self) -> f64 {
        self.values.first(columns::ARC)
    }

    /// Number of the piece it belongs to, from 0.
    pub fn piece(&self) -> usize {
        self.values.get(columns::PIECE).map_or(0, |values| values[0] as usize)
    }
}

/// A nonlinear normal mode, or a curve of phase-resonant responses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Backbone {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// Points along the arc, piece after piece: the first piece grows out of the linear mode, further ones cross it or each other at
    /// branch points ([`BackbonePoint::piece`]).
    pub points: Vec<BackbonePoint>,
    /// How its first piece begins and ends.
    pub outcome: Outcome,
    /// How further pieces begin and end.
    pub crossing: Vec<Outcome>,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
}

/// One backbone where several may be.
impl AsRef<[Backbone]> for Backbone {
    fn as_ref(&self) -> &[Backbone] {
        std::slice::from_ref(self)
    }
}

impl Backbone {
    /// Whether as many curves cross it as are followed: there may be more.
    pub fn is_crowded(&self) -> bool {
        self.crossing.len() == MOST_CROSSING
    }

    /// The points of every piece.
    pub fn pieces(&self) -> impl Iterator<Item = &[BackbonePoint]> {
        self.points.chunk_by(|a, b| a.piece() == b.piece())
    }

    /// The threshold A* where the first piece ends.
    pub fn last_threshold(&self) -> Option<f64> {
        Some(self.pieces().next()?.last()?.threshold())
    }

    /// Turning points of what has a value at every point (see [`turning_points`]), within pieces.
    pub fn turning_points(&self, values: &[f64], prominence: f64) -> Vec<(usize, bool)> {
        let mut first = 0;
        let turns = self.pieces().flat_map(|piece| {
            let begin = first;
            first += piece.len();
            let turns = turning_points(&values[begin..first], prominence).into_iter();
            let last = piece.len() - 1;
            turns
                .filter(move |(index, _)| (1..last).contains(index))
                .map(move |(index, is_max)| (begin + index, is_max))
        });
        turns.collect()
    }

    /// Lowest and highest frequency, rad/s.
    pub fn frequency_range(&self) -> (f64, f64) {
        self.points
            .iter()
            .map(|p| p.point.omega())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), omega| (low.min(omega), high.max(omega)))
    }

    /// Largest amplitude of the first monitored dof, m.
    pub fn max_amplitude(&self) -> f64 {
        self.points.iter().map(|p| p.point.amplitude()).fold(0.0, f64::max)
    }
}
