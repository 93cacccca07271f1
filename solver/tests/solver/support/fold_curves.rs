//! Fold and peak curves of a model, and the branches that they are checked by.

use solver::formulation::state::State;
use solver::response::branch::{BranchPoint, Side, SpecialKind};
use solver::response::folds::{Critical, CriticalCurve, CriticalKind, Extent, Quantity};
use solver::{Backbone, Branch, Forced, Model, SearchRange, Settings};
use std::ops::ControlFlow;
use std::time::Instant;

pub fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A model with what is needed to trace its branches.
pub struct Study {
    pub model: Model,
    pub settings: Settings,
    pub reach: SearchRange,
}

impl Study {
    pub fn new(model: Model, settings: Settings) -> Self {
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let reach = SearchRange::new(&settings, &backbone).unwrap();
        Self { model, settings, reach }
    }

    pub fn main(&self, forcing: f64) -> Branch {
        Forced::new(&self.model, &self.settings, self.reach, forcing).main_branch(Side::Below, &mut quiet).unwrap()
    }

    pub fn through(&self, state: &State) -> Branch {
        let mut forced = Forced::new(&self.model, &self.settings, self.reach, state.forcing);
        forced.branch_through(state, &mut quiet).unwrap()
    }

    pub fn folds(&self, extent: Extent) -> Critical<'_> {
        Critical::new(&self.model, &self.settings, Quantity::Frequency, extent).unwrap()
    }

    pub fn peaks(&self, extent: Extent) -> Critical<'_> {
        Critical::new(&self.model, &self.settings, Quantity::Amplitude, extent).unwrap()
    }
}

pub fn folds(branch: &Branch) -> Vec<State> {
    branch.special(SpecialKind::Fold).map(|point| point.state.clone()).collect()
}

pub fn report(curve: &CriticalCurve, since: Instant) {
    let seconds = since.elapsed().as_secs_f64();
    let (low, high) = curve.forcing_range();
    println!(
        "{:?}: {} points in {seconds:.3} s, A = {low:.6} to {high:.6}, {}, grazing {:?}, {} refused",
        curve.quantity,
        curve.points.len(),
        curve.outcome,
        curve.grazing,
        curve.rejections
    );
    for corner in &curve.corners {
        let point = &curve.points[corner.index];
        println!("  corner by {} at A = {:.10}, {:.8} rad/s", corner.element, point.state.forcing, point.omega());
    }
    for event in &curve.events {
        let point = &curve.points[event.index];
        println!(
            "  {:?} at A = {:.10}, {:.8} rad/s, amplitude {:.6}",
            event.kind,
            point.state.forcing,
            point.omega(),
            point.amplitude()
        );
    }
}

/// Relative distance in frequency of a state from the nearest fold of a branch.
pub fn fold_miss(branch: &Branch, state: &State) -> f64 {
    folds(branch).iter().map(|fold| (fold.omega / state.omega - 1.0).abs()).fold(f64::INFINITY, f64::min)
}

#[track_caller]
pub fn assert_close(value: f64, expected: f64, relative: f64) {
    assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected} to {relative}");
}

pub fn all(curve: &CriticalCurve, kind: CriticalKind) -> Vec<f64> {
    let mut list: Vec<f64> = curve.events(kind).map(|point| point.state.forcing).collect();
    list.sort_by(f64::total_cmp);
    list
}
