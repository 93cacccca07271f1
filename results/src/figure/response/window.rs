//! What part of the plane is shown.

use super::Outline;
use crate::curves::Curve;
use crate::figure::axis::largest;
use crate::figure::data::Axis;
use solver::curve::extrema::further_peaks;
use solver::response::branch::{BranchKind, SpecialKind};

/// A main branch is shown at least where it is higher than this share of its peak.
const HIGH: f64 = 0.8;
/// Folds of main branches are shown that are higher than this share of the peak.
const TURNS: f64 = 0.1;
/// Room beside what is shown at least, as a share of its width.
const ROOM: f64 = 0.25;
/// Room beside ends of branches, as a share of the same width.
const EDGE: f64 = 0.03;
/// The page begins with the whole sweep if it is no more than so many times as wide as what files show.
const WIDE: f64 = 3.0;
/// Branches that leave through the widest bounds are beyond what is shown where they are higher all along than so many times the
/// highest of the others: parts that are pressed against each other for ever, say.
const BEYOND: f64 = 2.0;

impl<'r> Outline<'r> {
    pub(super) fn amplitudes(&self) -> Vec<Axis> {
        let of = |m: usize| {
            let all = |branch: &&'r Curve| {
                let beyond = branch.beyond.iter().filter(|beyond| beyond.is_shown());
                let beyond = beyond.filter_map(move |beyond| Some(beyond.amplitudes.get(m)?[1]));
                largest(branch.amplitude[m].values.iter().copied().chain(beyond))
            };
            let found = self.branches.iter().filter(|branch| !self.is_beyond(branch)).map(all).fold(0.0, f64::max);
            let backbone = self.subject.backbone.filter(|_| self.branches.is_empty());
            backbone.map_or(vec![found], |backbone| backbone.amplitude[m].values.clone())
        };
        self.subject.amplitudes(of)
    }

    /// Whether a branch is too high to be shown with the others.
    pub(super) fn is_beyond(&self, branch: &Curve) -> bool {
        let is_open = |branch: &Curve| branch.kind == BranchKind::Open.name();
        let near = self.branches.iter().filter(|branch| !is_open(branch));
        let highest = near.map(|branch| branch.amplitude_at_peak).fold(0.0, f64::max);
        let lowest = branch.amplitude[0].values.iter().copied().fold(f64::INFINITY, f64::min);
        is_open(branch) && highest > 0.0 && lowest > BEYOND * highest
    }

    /// In files, where something happens: all isolas and the upper parts of all main branches, with room beside them. On the
    /// page at first, the whole sweep, and isolas that go farther, unless that is so much more that nothing could be told apart.
    pub(super) fn frequencies(&self) -> Axis {
        let all = self.branches.iter().flat_map(|branch| branch.omega.values.iter().copied());
        let backbone = self.subject.backbone.filter(|_| self.branches.is_empty());
        let ends = crate::figure::axis::bounds(all.chain(backbone.iter().flat_map(|b| b.omega.values.iter().copied())));
        let whole = self.subject.sweep.unwrap_or(ends);
        let near = || self.branches.iter().filter(|branch| !self.is_beyond(branch));
        let top = |branch: &Curve| largest(branch.amplitude[0].values.iter().copied());
        let high = near().flat_map(|branch| {
            let floor = if branch.kind == "main" { HIGH * top(branch) } else { 0.0 };
            branch.omega.values.iter().zip(&branch.amplitude[0].values).filter(move |(_, x)| **x >= floor)
        });
        let (low, high) = crate::figure::axis::bounds(high.map(|(omega, _)| *omega));
        // Between its folds a main branch goes back: without them it looks like two. A resonance far from all isolas is left out.
        let far = if near().all(|branch| branch.kind == "main") { f64::INFINITY } else { high - low };
        let folds = near().flat_map(|branch| {
            let folds = branch.special.iter().filter(|special| special.kind == SpecialKind::Fold);
            let is_high =
                move |i: &usize| branch.amplitude[0].values.get(*i).is_some_and(|x| *x >= TURNS * top(branch));
            folds.map(|special| special.index).filter(is_high).map(|i| branch.omega.values[i])
        });
        let folds = folds.filter(|omega| (low - far..=high + far).contains(omega));
        let (low, high) = crate::figure::axis::bounds([low, high].into_iter().chain(folds));
        let room = ROOM * (high - low);
        // What ends somewhere does so a little inside of the figure.
        let edge = EDGE * (high - low);
        let part = ((low - room).max(ends.0 - edge), (high + room).min(ends.1 + edge));
        let range = if part.1 > part.0 { part } else { ends };
        let farther =
            if self.branches.is_empty() { whole } else { (whole.0.min(low - edge), whole.1.max(high + edge)) };
        let is_near = farther.1 - farther.0 <= WIDE * (range.1 - range.0);
        let whole = is_near.then(|| crate::figure::axis::bounds([farther.0, farther.1]));
        Axis { whole, ..Axis::of_frequencies(range, self.subject.harmonic) }
    }

    /// Whether main branches have peaks at other resonances where nothing is shown.
    pub(super) fn has_peaks_beyond(&self, frequencies: &Axis) -> bool {
        let (low, high) = frequencies.whole.unwrap_or(frequencies.range);
        let is_beyond = |branch: &&Curve| {
            let mut omegas = further_peaks(&branch.amplitude[0].values).into_iter().map(|i| branch.omega.values[i]);
            omegas.any(|omega| !(low..=high).contains(&omega))
        };
        self.branches.iter().copied().filter(|branch| branch.kind == "main").any(|branch| is_beyond(&branch))
    }
}
