//! The backbone as its figures show it: energies, births and merges of windows, modes.

use super::column::{Column, Quantity};
use crate::overview::Unforced;
use solver::formulation::harmonics::complex;
use solver::response::backbone::{Backbone, BackboneEnd, BackbonePoint};
use solver::response::branch::Outcome;
use solver::response::columns;
use solver::response::windows::{Event, EventKind, events};
use solver::structure::Model;
use std::ops::Range;

/// Modes drawn at most.
const MODES: usize = 6;
/// Share below which a mode is not worth drawing.
const FAINT: f64 = 1e-4;
/// Share below which the peak of a mode is not worth a label.
const LABELLED: f64 = 5e-3;
/// A peak stands out by this factor.
const PROMINENCE: f64 = 1.5;
/// Peaks labelled at most.
const PEAKS: usize = 12;
/// Relative distance of frequencies within which a mode is in resonance.
const RESONANT: f64 = 0.1;

/// The backbone: p points, in rad/s, 1/s, m and J a period.
#[derive(Debug, Clone, PartialEq)]
pub struct BackboneCurve {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// The curve that grows out of the linear mode, and those that cross it or each other.
    pub pieces: Vec<Piece>,
    /// Whether as many of these are known as are followed: there may be more.
    pub is_crowded: bool,
    /// Up to where its energy balance is known; `None` without a point.
    pub end: Option<BackboneEnd>,
    /// Whether it ends there since the run began with smaller levels.
    pub falls_short: bool,
    /// What it tells of motions without forcing; `None` without a point.
    pub unforced: Option<Unforced>,
    /// Frequency. It, amplitudes and arc are NaN at the first point of every piece but one, where lines break.
    pub omega: Column,
    /// Decay rate.
    pub decay: Column,
    /// Largest |x| over the period of every monitored dof.
    pub amplitude: Vec<Column>,
    /// Share of the period in contact, the largest over the contact elements; NaN without any.
    pub contact: Column,
    /// Work of the linear damping R_lin.
    pub r_lin: Column,
    /// Work of the nonlinear elements R_nl.
    pub r_nl: Column,
    /// Work of the forcing per unit of A.
    pub work: Column,
    /// Work that the forcing has to do by the criterion of the run: A* times the work per unit of A.
    pub needed: Column,
    /// Threshold A*.
    pub threshold: Column,
    /// Relative error of the energy balance.
    pub certificate: Column,
    /// Scaled arc length.
    pub arc: Column,
    /// Columns that were added later, as far as the page says them.
    pub later: Vec<Quantity>,
    /// Births and merges of windows.
    pub events: Vec<Event>,
    /// The modes that contribute most, the one followed first.
    pub modes: Vec<ModeShare>,
    /// Where the share of a mode peaks.
    pub peaks: Vec<Peak>,
}

/// A piece of the backbone.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Its points, by index.
    pub points: Range<usize>,
    /// How it begins and ends, in words.
    pub status: String,
    /// Whether it goes on where it ends.
    pub is_unfinished: bool,
}

/// A mode along the backbone.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShare {
    /// Mode, from 0.
    pub mode: usize,
    /// Its frequency, rad/s.
    pub frequency: f64,
    /// Its contribution, all modes summing to 1.
    pub share: Column,
}

/// A peak of a mode's contribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Peak {
    /// Mode j, from 0.
    pub mode: usize,
    /// Index of the point.
    pub index: usize,
    /// Frequency ω, rad/s.
    pub omega: f64,
    /// Its contribution.
    pub share: f64,
    /// The harmonic h that is largest in the motion of the mode.
    pub harmonic: usize,
    /// ω_j/(h ω): 1 in resonance.
    pub ratio: f64,
    /// Whether that is a resonance.
    pub resonant: bool,
}

impl BackboneCurve {
    /// Of a backbone of this model.
    pub fn new(backbone: &Backbone, model: &Model) -> Self {
        let points = &backbone.points;
        let column = |of: &dyn Fn(&BackbonePoint) -> f64| points.iter().map(of).collect::<Vec<f64>>();
        let short = |of: &dyn Fn(&BackbonePoint) -> f64| Column::short(column(of));
        let pieces = pieces(backbone);
        // Lines break where a piece begins.
        let drawn = |of: &dyn Fn(&BackbonePoint) -> f64| {
            let mut values = column(of);
            pieces.iter().skip(1).for_each(|piece| values[piece.points.start] = f64::NAN);
            values
        };
        let modes = modes(backbone, model);
        let mut peaks: Vec<Peak> = modes.iter().skip(1).flat_map(|mode| peaks(backbone, mode)).collect();
        peaks.sort_by(|a, b| b.share.total_cmp(&a.share));
        peaks.truncate(PEAKS);
        Self {
            mode: backbone.mode,
            omega: Column::exact(drawn(&|p| p.point.omega())),
            decay: short(&|p| p.point.state.decay),
            amplitude: (0..model.monitors().len())
                .map(|m| Column::short(drawn(&|p| p.point.amplitudes()[m])))
                .collect(),
            contact: short(&|p| p.point.contact().iter().copied().fold(f64::NAN, f64::max)),
            r_lin: short(&|p| p.energies().linear),
            r_nl: short(&|p| p.energies().nonlinear),
            work: short(&|p| p.energies().work_per_amplitude),
            needed: short(&|p| p.threshold() * p.energies().work_per_amplitude),
            threshold: short(&|p| p.threshold()),
            certificate: short(&|p| p.energies().certificate),
            arc: Column::short(drawn(&|p| p.arc())),
            later: later(points),
            events: events(backbone),
            modes,
            peaks,
            pieces,
            is_crowded: backbone.is_crowded(),
            end: backbone.end(),
            falls_short: false,
            unforced: Unforced::of(backbone),
        }
    }

    /// Whether other curves cross the one that grows out of the linear mode.
    pub fn is_crossed(&self) -> bool {
        self.pieces.len() > 1
    }
}

impl BackboneCurve {
    /// Whether dissipation and what is fed in cancel near a point: R_lin + R_nl changes its sign beside it.
    pub fn feeds_itself(&self, index: usize) -> bool {
        let balance = |i: usize| self.r_lin.values[i] + self.r_nl.values[i];
        let neighbours = index.saturating_sub(1)..=(index + 1).min(self.r_lin.values.len() - 1);
        neighbours.clone().any(|i| balance(i) < 0.0) && neighbours.clone().any(|i| balance(i) >= 0.0)
    }
}

/// Thresholds below this are round-off, whatever the levels are.
const NOTHING: f64 = 1e-9;
/// Events whose thresholds lie further from the levels than this factor are not theirs.
const FAR: f64 = 1e3;
/// A balance of energies this much smaller than the dissipation is round-off.
const ROUND_OFF: f64 = 1e-6;

impl BackboneCurve {
    /// Keeps the births and merges that mean something for levels from the lowest to the highest of these amplitudes.
    ///
    /// Where nothing is dissipated, A* is the quotient of two roundings, and has extrema at 1e-18 or 1e14. A birth far
    /// below the levels is real if what is fed in and what the damping takes cancel there: A* goes to zero then, and what
    /// a point near it has is chance.
    pub fn keep_events_near(&mut self, amplitudes: impl Iterator<Item = f64>) {
        let (low, high) =
            amplitudes.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let range = NOTHING.max(low / FAR)..=high * FAR;
        let events = std::mem::take(&mut self.events);
        let is_kept = |event: &Event| range.contains(&event.threshold) || self.cancels(event);
        self.events = events.into_iter().filter(is_kept).collect();
    }

    /// Whether a threshold is so small since energies that are more than round-off cancel.
    fn cancels(&self, event: &Event) -> bool {
        let linear = self.r_lin.values[event.index];
        let before = event.index.saturating_sub(1);
        let beside = [before, (event.index + 1).min(self.r_lin.values.len() - 1)];
        let is_real = |i: usize| (self.r_lin.values[i] + self.r_nl.values[i]).abs() > ROUND_OFF * linear;
        event.kind == EventKind::Birth
            && linear > 0.0
            && self.feeds_itself(event.index)
            && beside.into_iter().all(is_real)
    }
}

fn pieces(backbone: &Backbone) -> Vec<Piece> {
    let mut first = 0;
    let outcomes = std::iter::once(&backbone.outcome).chain(&backbone.crossing);
    let of = |(outcome, points): (&Outcome, &[BackbonePoint])| {
        let begin = first;
        first += points.len();
        Piece { points: begin..first, status: outcome.to_string(), is_unfinished: outcome.is_unfinished() }
    };
    outcomes.zip(backbone.pieces()).map(of).collect()
}

/// What every point has of the columns that were added later and are shown.
fn later(points: &[BackbonePoint]) -> Vec<Quantity> {
    let is_shown = |(_, column): &(usize, &columns::Column)| column.is_later && column.hover.is_some();
    let of_points = columns::of_points().enumerate().filter(is_shown).filter_map(|(place, column)| {
        let rows = points.iter().map(|p| p.point.values.get(place)).collect::<Option<Vec<&[f64]>>>()?;
        Quantity::new(column, &rows)
    });
    let of_backbone = columns::of_backbone().enumerate().filter(is_shown).filter_map(|(place, column)| {
        let rows = points.iter().map(|p| p.values.get(place)).collect::<Option<Vec<&[f64]>>>()?;
        Quantity::new(column, &rows)
    });
    of_points.chain(of_backbone).collect()
}

fn modes(backbone: &Backbone, model: &Model) -> Vec<ModeShare> {
    let share = |mode: usize| backbone.points.iter().map(move |point| point.contributions()[mode]);
    let largest = |mode: usize| share(mode).fold(0.0, f64::max);
    let mut others: Vec<usize> = (0..model.size()).filter(|&j| j != backbone.mode && largest(j) > FAINT).collect();
    others.sort_by(|&a, &b| largest(b).total_cmp(&largest(a)));
    others.truncate(MODES - 1);
    let drawn = std::iter::once(backbone.mode).chain(others);
    let mode = |j: usize| ModeShare {
        mode: j,
        frequency: model.modes().frequencies[j],
        share: Column::short(share(j).collect()),
    };
    drawn.map(mode).collect()
}

fn peaks<'b>(backbone: &'b Backbone, mode: &'b ModeShare) -> impl Iterator<Item = Peak> + 'b {
    let logs: Vec<f64> = mode.share.values.iter().map(|share| share.max(1e-12).ln()).collect();
    let maxima = backbone.turning_points(&logs, PROMINENCE.ln()).into_iter().filter(|&(_, is_maximum)| is_maximum);
    maxima.filter(|&(index, _)| mode.share.values[index] > LABELLED).map(move |(index, _)| {
        let state = &backbone.points[index].point.state;
        let series = state.mode(mode.mode);
        let size = |k: usize| complex(series, k).norm();
        let harmonic = (1..=state.harmonics).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(1);
        let ratio = mode.frequency / (harmonic as f64 * state.omega);
        Peak {
            mode: mode.mode,
            index,
            omega: state.omega,
            share: mode.share.values[index],
            harmonic,
            ratio,
            resonant: (ratio - 1.0).abs() < RESONANT,
        }
    })
}
