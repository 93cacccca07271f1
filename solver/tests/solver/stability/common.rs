//! Branches of small models.

use solver::response::branch::Side;
use solver::{Backbone, Branch, Forced, Model, SearchRange, Settings};
use std::ops::ControlFlow;

/// The main branch, entered from below.
pub fn main_branch(model: &Model, settings: &Settings, forcing: f64) -> Branch {
    let backbone = Backbone::compute(model, settings).unwrap();
    let reach = SearchRange::new(settings, &backbone).unwrap();
    let mut forced = Forced::new(model, settings, reach, forcing);
    forced.main_branch(Side::Below, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// |value/expected − 1| < relative.
#[track_caller]
pub fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < relative, "{what}: {value} is not {expected} to {relative}");
}

/// Fundamental matrix over a period, by columns, of δ'' + c δ' + k(t) δ = 0, by the classical Runge–Kutta method.
pub fn fundamental(damping: f64, stiffness: impl Fn(f64) -> f64, period: f64, count: u32) -> [[f64; 2]; 2] {
    let h = period / f64::from(count);
    [[1.0, 0.0], [0.0, 1.0]].map(|start: [f64; 2]| {
        let mut z = start;
        for i in 0..count {
            let t = f64::from(i) * h;
            let rate = |z: [f64; 2], k: f64| [z[1], -damping * z[1] - k * z[0]];
            let moved = |by: f64, r: [f64; 2]| [z[0] + by * r[0], z[1] + by * r[1]];
            let ks = [stiffness(t), stiffness(t + 0.5 * h), stiffness(t + h)];
            let r1 = rate(z, ks[0]);
            let r2 = rate(moved(0.5 * h, r1), ks[1]);
            let r3 = rate(moved(0.5 * h, r2), ks[1]);
            let r4 = rate(moved(h, r3), ks[2]);
            z = std::array::from_fn(|j| z[j] + h / 6.0 * (r1[j] + 2.0 * (r2[j] + r3[j]) + r4[j]));
        }
        z
    })
}
