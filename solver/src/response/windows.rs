//! Windows of the Melnikov balance: where along the backbone forced responses are predicted, for any forcing amplitude.

use crate::curve::extrema::turning_points;
use crate::response::backbone::{Backbone, BackbonePoint};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// A maximal arc of a piece of the backbone with threshold A* < A.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Mode of its backbone, from 0. Mode 0 is not written: results of before, which knew one backbone, keep their bytes.
    #[serde(default, skip_serializing_if = "is_first")]
    pub mode: usize,
    /// Index of the first backbone point inside.
    pub first: usize,
    /// Index of the last backbone point inside.
    pub last: usize,
    /// Index of the point with the smallest threshold.
    pub best: usize,
    /// Smallest threshold amplitude inside.
    pub threshold: f64,
    /// Lowest and highest frequency, rad/s: of a window up to where A* passes A, between points; of a well of its points.
    pub omega: (f64, f64),
}

fn is_first(mode: &usize) -> bool {
    *mode == 0
}

/// Windows at forcing amplitude `forcing`, in the order of the backbone.
pub fn windows(backbone: &Backbone, forcing: f64) -> Vec<Window> {
    let is_inside = |point: &BackbonePoint| point.threshold() < forcing;
    let is_same = |a: &BackbonePoint, b: &BackbonePoint| a.piece() == b.piece() && is_inside(a) == is_inside(b);
    let mut first = 0;
    let stretches = backbone.points.chunk_by(is_same).filter_map(|stretch| {
        let begin = first;
        first += stretch.len();
        if is_inside(&stretch[0]) { Window::covering(backbone, begin, first - 1) } else { None }
    });
    stretches.map(|window| window.up_to_crossings(backbone, forcing)).collect()
}

/// How far from a point of the backbone with threshold `from` on to the next one, with threshold `to`, the threshold passes a forcing
/// amplitude, as a share of the way: its logarithm taken as straight. Where the force does no work the
/// threshold is infinite, and the crossing is at the other point.
pub fn crossing(from: f64, to: f64, forcing: f64) -> f64 {
    if from.is_infinite() {
        return 1.0;
    }
    let share = (forcing / from).ln() / (to / from).ln();
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
}

/// How far outside of the frequencies of a window a response that it predicts may be, relative.
const ABOUT: f64 = 0.05;

impl Window {
    /// Frequencies at which a response that it predicts may be, rad/s.
    pub fn about(&self) -> RangeInclusive<f64> {
        (1.0 - ABOUT) * self.omega.0..=(1.0 + ABOUT) * self.omega.1
    }

    /// The same; its frequencies up to where the threshold passes the forcing amplitude, between its outermost points and the next ones
    /// of their piece.
    fn up_to_crossings(self, backbone: &Backbone, forcing: f64) -> Self {
        let beyond = |inside: usize, outside: Option<usize>| {
            let (inside, outside) = (&backbone.points[inside], backbone.points.get(outside?)?);
            let share = crossing(inside.threshold(), outside.threshold(), forcing);
            let (from, to) = (inside.point.omega(), outside.point.omega());
            (inside.piece() == outside.piece()).then_some(from + share * (to - from))
        };
        let ends = [beyond(self.first, self.first.checked_sub(1)), beyond(self.last, Some(self.last + 1))];
        let (low, high) = self.omega;
        let omega = ends.into_iter().flatten().fold((low, high), |(low, high), end| (low.min(end), high.max(end)));
        Self { omega, ..self }
    }

    /// The lowest and highest frequency of its points, rad/s.
    pub fn of_points(&self, backbone: &Backbone) -> (f64, f64) {
        let omegas = backbone.points[self.first..=self.last].iter().map(|point| point.point.omega());
        omegas.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), w| (low.min(w), high.max(w)))
    }

    /// The wells of a window: its parts between neighbouring maxima of A*, one for each minimum. A barrier below A is
    /// predicted to have been passed, but forced responses on its two sides may still be separate.
    pub fn wells(&self, backbone: &Backbone) -> Vec<Window> {
        let points = &backbone.points[self.first..=self.last];
        let logs: Vec<f64> = points.iter().map(|p| p.threshold().ln()).collect();
        let barriers = turning_points(&logs, PROMINENCE)
            .into_iter()
            .filter(|&(i, is_maximum)| is_maximum && i > 0 && i + 1 < points.len())
            .map(|(i, _)| self.first + i);
        let mut wells = Vec::new();
        let mut first = self.first;
        for last in barriers.chain([self.last]) {
            wells.extend(Self::covering(backbone, first, last));
            first = last;
        }
        wells
    }

    /// The window over backbone points `first` to `last`.
    fn covering(backbone: &Backbone, first: usize, last: usize) -> Option<Window> {
        let best = (first..=last)
            .min_by(|&a, &b| backbone.points[a].threshold().total_cmp(&backbone.points[b].threshold()))?;
        let (mode, threshold) = (backbone.mode, backbone.points[best].threshold());
        let window = Window { mode, first, last, best, threshold, omega: (0.0, 0.0) };
        Some(Window { omega: window.of_points(backbone), ..window })
    }
}

/// Whether windows appear or join.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// Minimum of the threshold: a window is born.
    Birth,
    /// Maximum of the threshold: two neighbouring windows merge.
    Merge,
}

/// A birth or a merge of windows, for all forcing amplitudes at once.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Birth or merge.
    pub kind: EventKind,
    /// Index of the backbone point.
    pub index: usize,
    /// Forcing amplitude A* at which it happens.
    pub threshold: f64,
    /// Frequency, rad/s.
    pub omega: f64,
    /// Amplitude of the first monitored dof, m.
    pub amplitude: f64,
    /// Mode (from 0) that contributes most beside the one followed; `None` for a single mode.
    pub mode: Option<usize>,
}

/// Relative height below which an extremum of the threshold curve is noise.
const PROMINENCE: f64 = 1e-3;

/// Births and merges along the backbone, alternating, in its order. The start of the backbone is not a birth: the main
/// response is always there. Nor are the ends of its pieces.
pub fn events(backbone: &Backbone) -> Vec<Event> {
    let logs: Vec<f64> = backbone.points.iter().map(|p| p.threshold().ln()).collect();
    backbone
        .turning_points(&logs, PROMINENCE)
        .into_iter()
        .map(|(index, is_maximum)| {
            let point = &backbone.points[index];
            let others = point.contributions().iter().enumerate().filter(|&(j, _)| j != backbone.mode);
            Event {
                kind: if is_maximum { EventKind::Merge } else { EventKind::Birth },
                index,
                threshold: point.threshold(),
                omega: point.point.omega(),
                amplitude: point.point.amplitude(),
                mode: others.max_by(|a, b| a.1.total_cmp(b.1)).map(|(j, _)| j),
            }
        })
        .collect()
}
