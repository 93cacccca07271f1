//! Backbone: the nonlinear normal mode of one mode, or its resonances in quadrature with the forcing, with energies and
//! modal contributions (paper [20–26]).

mod assemble;
mod compute;
mod crossing;
mod ends;
mod error;
mod known;
mod resumed;
mod shorter;
mod way;

use crate::curve::extrema::turning_points;
use crate::response::branch::{BranchPoint, Outcome, Stop};
use crate::response::columns::{self, Row};
use crate::response::melnikov::Energies;
pub use crossing::MOST as MOST_CROSSING;
pub use error::BackboneError;
use serde::{Deserialize, Serialize};
use std::iter;

/// Share of a mode in a motion above which it leads there.
const LEADS: f64 = 0.5;

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
    /// Points along the arc, piece after piece: the first piece grows out of the linear mode, further ones are where it goes on beyond
    /// tongues, cross it or each other at branch points, or are motions of shorter periods ([`BackbonePoint::piece`]).
    pub points: Vec<BackbonePoint>,
    /// How its first piece begins and ends.
    pub outcome: Outcome,
    /// How further pieces begin and end.
    pub crossing: Vec<Outcome>,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
}

/// Up to where the energy balance of a mode is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackboneEnd {
    /// Threshold A* where its backbone ends, or before the tongue in which it does.
    pub threshold: f64,
    /// Frequency of the branch point at which it ends, rad/s, if it does so.
    pub branch_point: Option<f64>,
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
        self.crossing.len() >= MOST_CROSSING
    }

    /// The points of every piece.
    pub fn pieces(&self) -> impl Iterator<Item = &[BackbonePoint]> {
        self.points.chunk_by(|a, b| a.piece() == b.piece())
    }

    /// Where the first piece ends, or if it does so at a branch point, the piece that goes to the largest motions.
    pub fn end(&self) -> Option<BackboneEnd> {
        let pieces = || iter::once(&self.outcome).chain(&self.crossing).zip(self.pieces());
        let is_branching = |outcome: &Outcome| matches!(outcome, Outcome::Open(_, Stop::Branching));
        let amplitude = |piece: &[BackbonePoint]| piece.iter().map(|p| p.point.amplitude()).fold(0.0, f64::max);
        let (outcome, piece) = match pieces().next()? {
            (outcome, _) if is_branching(outcome) => {
                pieces().max_by(|(_, a), (_, b)| amplitude(a).total_cmp(&amplitude(b)))?
            }
            first => first,
        };
        let last = piece.last()?;
        if !is_branching(outcome) {
            return Some(BackboneEnd { threshold: last.threshold(), branch_point: None });
        }
        let leads = |point: &&BackbonePoint| point.contributions()[self.mode] > LEADS;
        let threshold = piece.iter().filter(leads).map(BackbonePoint::threshold).fold(0.0, f64::max);
        Some(BackboneEnd { threshold, branch_point: Some(last.point.omega()) })
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
