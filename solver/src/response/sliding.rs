//! Whether the tips of a branch slide on all the time that they press, as the law of permanent sliding takes for granted.

use crate::formulation::aft::Aft;
use crate::formulation::arcs::Coverage;
use crate::formulation::harmonics::{differentiate, evaluate, width};
use crate::response::branch::BranchPoint;
use crate::settings::HarmonicSettings;
use crate::structure::Model;
use crate::structure::laws::Law;
use std::f64::consts::TAU;

/// Instants of an arc of contact at which the speed is looked at, per number of a series.
const LOOKED_AT: usize = 4;

/// A contact with friction.
struct Tip {
    /// First of its arguments: predicted pressure, then the displacements along and across the rotation.
    channel: usize,
    /// σ / (m ρ): what of the velocity along the rotation is relative to that of the rotor, of a displacement by the phase.
    share: f64,
}

/// Slowest sliding along the rotation of all tips while they press, over the speed of the rotor there: 1 for one that does not vibrate along
/// it, zero or below where the sliding stops or turns round. `None` where no contact has friction, or none presses.
pub(super) fn slowest_sliding(model: &Model, truncation: HarmonicSettings, points: &[BranchPoint]) -> Option<f64> {
    let harmonic = model.forcing().harmonic as f64;
    let tips = model.numbered().filter_map(|(channel, element)| {
        let friction = element.law.rigid()?.friction?;
        Some(Tip { channel, share: friction.sense / (harmonic * friction.radius) })
    });
    let tips: Vec<Tip> = tips.collect();
    let nc = width(truncation.count);
    let (mut aft, mut slope) = (Aft::new(truncation), vec![0.0; nc]);
    let mut slowest: Option<f64> = None;
    for (point, tip) in points.iter().flat_map(|point| tips.iter().map(move |tip| (point, tip))) {
        let series = |channel: usize| &point.state.arguments[channel * nc..(channel + 1) * nc];
        differentiate(series(tip.channel + 1), &mut slope);
        let arcs = match aft.coverage(series(tip.channel), 0.0) {
            Coverage::Never => Vec::new(),
            Coverage::Always => vec![(0.0, TAU)],
            Coverage::Arcs(arcs) => arcs,
        };
        let speeds = arcs.into_iter().flat_map(|(begin, end)| {
            // With both ends of the arc: where a tip begins to press, or ceases, it moves fastest.
            let count = LOOKED_AT * nc;
            (0..=count).map(move |i| begin + (end - begin) * i as f64 / count as f64)
        });
        let speeds = speeds.map(|tau| 1.0 + tip.share * evaluate(&slope, tau)[0]);
        slowest = speeds.chain(slowest).reduce(f64::min);
    }
    slowest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::state::State;
    use crate::response::columns::Row;
    use crate::structure::laws::{Contact, Friction};

    #[test]
    fn the_slowest_sliding_is_that_of_a_tip_that_presses() {
        let (radius, gap) = (0.5, 0.1);
        let friction = |sense: f64| Some(Friction { coefficient: 0.2, radius, sense });
        let told = |sense: f64, pressure: [f64; 3], along: [f64; 3]| {
            let model = Model::builder("tip")
                .mass([[1.0, 0.0], [0.0, 1.0]])
                .stiffness([[1.0, 0.0], [0.0, 1.0]])
                .force("x1", 1.0)
                .harmonic(2)
                .element("tip", Contact { gap, epsilon: 1.0, friction: friction(sense) }, ["x1", "x2", "x2"])
                .build()
                .unwrap();
            let arguments = [pressure, along, [0.0; 3]].concat();
            let state = State { harmonics: 1, omega: 3.0, decay: 0.0, forcing: 1.0, arguments, modal: vec![0.0; 6] };
            let truncation = HarmonicSettings { count: 1, samples: 64, ..HarmonicSettings::default() };
            slowest_sliding(&model, truncation, &[BranchPoint { state, values: Row::new(Vec::new()) }])
        };
        // The rotor turns at 2 ω: the tip at ρ 2 ω = 1 · ω; it moves by 0.6 sin τ along, while it presses all the time.
        let close = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-12;
        assert!(close(told(1.0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.6]), 0.4));
        assert!(close(told(-1.0, [1.0, 0.0, 0.0], [0.0, 0.0, 1.6]), -0.6));
        // While cos τ > 0 alone: the velocity 0.6 cos τ is along the rotation then, or against it.
        assert!(close(told(1.0, [0.0, 1.0, 0.0], [0.0, 0.0, 0.6]), 1.0));
        // While cos τ > 1/2: −0.6 sin τ is least at its end, τ = π/3.
        assert!(close(told(1.0, [-0.5, 1.0, 0.0], [0.0, 0.6, 0.0]), 1.0 - 0.6 * 0.75f64.sqrt()));
        assert!(close(told(-1.0, [0.0, 1.0, 0.0], [0.0, 0.0, 0.6]), 0.4));
        assert_eq!(told(1.0, [-1.0, 0.0, 0.0], [0.0, 0.0, 0.6]), None);
    }
}
