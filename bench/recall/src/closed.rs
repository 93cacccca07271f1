//! What is said of a closed branch: where it lies, what resonates, and whether it is one of the structure and not of ten harmonics alone.

use crate::balance::Balance;
use crate::images::is_attached;
use crate::known::Extent;
use crate::quadrature::norm;
use crate::record::{Isola, Resonance, Standing};
use crate::shooting;
use crate::starts::{converged, with_harmonics};
use crate::walk::{Bounds, Curve, SIZE, branch};

/// Largest relative change with twice the harmonics.
const TRUNCATION: f64 = 0.08;

/// Narrowest range of an isola, of its frequency.
const NARROWEST: f64 = 1e-6;

/// Points of an isola that are confirmed by time integration.
const MARCHED: usize = 4;

/// A closed branch with what twice the harmonics and time integration say of it; `hits`: starts that met it.
pub fn isola(balance: &Balance, curve: &Curve, extent: &Extent, hits: usize) -> Isola {
    let points = &curve.points;
    let deviations: Vec<Option<f64>> = (0..MARCHED)
        .map(|i| shooting::deviation(balance, &points[(extent.at + i * points.len() / MARCHED) % points.len()]))
        .collect();
    let confirmed: Vec<f64> = deviations.into_iter().flatten().filter(|deviation| *deviation <= TRUNCATION).collect();
    let (low, high) = extent.omega;
    let is_resolved = 2 * confirmed.len() >= MARCHED && high - low > NARROWEST * high;
    let change = if is_resolved { change_with_twice(balance, curve, extent) } else { None };
    let holds = change.is_some_and(|change| change <= TRUNCATION);
    let standing = match (is_attached(balance, points), holds) {
        (true, _) => Standing::Attached,
        (false, true) => Standing::Isola,
        (false, false) => Standing::Unresolved,
    };
    Isola {
        resonance: resonance(balance, &points[extent.at]),
        omega: [digits(extent.omega.0), digits(extent.omega.1)],
        peak: [digits(extent.peak.0), digits(extent.peak.1)],
        standing,
        change: change.map(|change| (1e4 * change).round() / 1e4),
        marched: [confirmed.len(), MARCHED],
        deviation: (1e4 * confirmed.iter().copied().fold(0.0, f64::max)).round() / 1e4,
        hits,
    }
}

/// Nine digits: more than branches are compared by.
pub fn digits(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// Largest relative change of frequencies, width and peak with twice the harmonics; none where there is no isola then.
fn change_with_twice(balance: &Balance, curve: &Curve, extent: &Extent) -> Option<f64> {
    let twice = Balance::new(balance.structure, 2 * balance.harmonics(), balance.forcing);
    let points = &curve.points;
    let (y, tangent) = [0, points.len() / 2].iter().find_map(|shift| {
        converged(&twice, &with_harmonics(&points[(extent.at + shift) % points.len()], balance, &twice))
    })?;
    let (low, high) = extent.omega;
    let bounds = Bounds { omega: (0.8 * low, 1.25 * high), size: SIZE, points: 1500 };
    let again = branch(&twice, &y, &tangent, &bounds);
    if !again.is_closed() {
        return None;
    }
    let Extent { omega, peak, .. } = Extent::of(&twice, &again.points);
    let relative = |a: f64, b: f64| (a - b).abs() / b;
    let width = relative(omega.1 - omega.0, high - low);
    Some(
        [relative(omega.0, low), relative(omega.1, high), width, relative(peak.1, extent.peak.1)]
            .into_iter()
            .fold(0.0, f64::max),
    )
}

/// Which mode moves fastest at a point, and with which harmonic.
fn resonance(balance: &Balance, y: &[f64]) -> Resonance {
    let structure = balance.structure;
    if structure.harmonic > 1 {
        return Resonance::SubHarmonic;
    }
    let n = structure.size();
    let speed = |j: usize, k: usize| {
        let direction: Vec<f64> = (0..n).map(|i| structure.mass[i] * structure.shapes[(i, j)]).collect();
        let q = balance.series(y, &direction);
        k as f64 * norm(&q[2 * k - 1..=2 * k])
    };
    let all = (0..n).flat_map(|j| (1..=balance.harmonics()).map(move |k| (j, k)));
    match all.max_by(|a, b| speed(a.0, a.1).total_cmp(&speed(b.0, b.1))) {
        Some((0, 1)) => Resonance::FirstMode,
        Some((_, 1)) => Resonance::OtherMode,
        _ => Resonance::SuperHarmonic,
    }
}
