//! Branches of small models.

use solver::response::branch::Side;
use solver::{Backbone, Branch, Forced, Model, Reach, Settings};
use std::ops::ControlFlow;

/// The main branch, entered from below.
pub fn main_branch(model: &Model, settings: &Settings, forcing: f64) -> Branch {
    let backbone = Backbone::compute(model, settings).unwrap();
    let reach = Reach::new(settings, &backbone).unwrap();
    let mut forced = Forced::new(model, settings, reach, forcing);
    forced.main_branch(Side::Below, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// |value/expected − 1| < relative.
#[track_caller]
pub fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < relative, "{what}: {value} is not {expected} to {relative}");
}
