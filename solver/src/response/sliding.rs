//! Whether the tips of a branch slide on all the time that they press, as the law of permanent sliding takes for granted.

use crate::formulation::harmonics::{Transform, differentiate, width};
use crate::response::branch::BranchPoint;
use crate::settings::HarmonicSettings;
use crate::structure::Model;
use crate::structure::laws::Law;

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
    let mut transform = Transform::new(truncation.count, truncation.samples);
    let [mut pressure, mut speed] = [(); 2].map(|()| vec![0.0; truncation.samples]);
    let mut slope = vec![0.0; nc];
    let mut slowest: Option<f64> = None;
    for (point, tip) in points.iter().flat_map(|point| tips.iter().map(move |tip| (point, tip))) {
        let series = |channel: usize| &point.state.arguments[channel * nc..(channel + 1) * nc];
        differentiate(series(tip.channel + 1), &mut slope);
        transform.synthesise(series(tip.channel), Some(&slope), &mut pressure, &mut speed);
        let pressed = pressure.iter().zip(&speed).filter(|(pressure, _)| **pressure > 0.0);
        slowest = pressed.map(|(_, speed)| 1.0 + tip.share * speed).chain(slowest).reduce(f64::min);
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
        assert!(told(1.0, [0.0, 1.0, 0.0], [0.0, 0.0, 0.6]).unwrap() > 1.0);
        assert!(close(told(-1.0, [0.0, 1.0, 0.0], [0.0, 0.0, 0.6]), 0.4));
        assert_eq!(told(1.0, [-1.0, 0.0, 0.0], [0.0, 0.0, 0.6]), None);
    }
}
