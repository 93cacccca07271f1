//! Scales of the unknowns: every tolerance and arc length is measured in these units.

use crate::formulation::aft::{Aft, ElementForce, Rate};
use crate::formulation::harmonics::width;
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::Model;
use crate::structure::laws::{Law, with_law};
use serde::{Deserialize, Serialize};

/// Reference length, frequency, modal amplitude and forcing amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Reference length ℓ, m: the smallest positive gap; without one, what the stop that is pressed least at rest is pressed in by;
    /// without either the amplitude (of the first monitored dof) at which the nonlinear modal force has fallen or risen to a tenth of
    /// the linear one, or has changed by that (`nonlinear_amplitude`); that of unit modal amplitude if every motion is like every
    /// other.
    pub length: f64,
    /// Reference frequency ω_ref, rad/s: eigenfrequency of the mode followed.
    pub frequency: f64,
    /// Modal amplitude ℓ/|φ|, kg^½·m, φ the mode's component at the first monitored dof.
    pub modal: f64,
    /// Forcing amplitude A whose linear resonance would have this modal amplitude.
    pub forcing: f64,
}

impl Scales {
    /// Scales of a model for the mode `tracked` (from 0).
    pub fn new(model: &Model, tracked: usize) -> Self {
        let frequency = model.modes().frequencies[tracked];
        let shape = model.modes().shapes.column(tracked);
        // A monitored dof on a node of the mode would make the scale meaningless.
        let largest = shape.iter().fold(0.0f64, |m, s| m.max(s.abs()));
        let phi = shape[model.monitors()[0]].abs().max(1e-3 * largest);
        let length =
            distance_to_stops(model).unwrap_or_else(|| nonlinear_amplitude(model, tracked).unwrap_or(1.0) * phi);
        let modal = length / phi;
        let damping = model.damping().diagonal(tracked);
        let force = model.modal_force().into_iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let forcing = modal * frequency * damping.max(1e-3 * frequency) / force;
        Self { length, frequency, modal, forcing }
    }

    /// Modal amplitudes, kg^½·m, at which the structure becomes nonlinear in one of its modes or the other: that of these scales alone
    /// where there is a gap, which is one length for all of them.
    pub fn nonlinear_amplitudes(&self, model: &Model) -> Vec<f64> {
        // Without a linear force every motion of a rigid-body mode is nonlinear.
        let elastic = (0..model.size()).filter(|&mode| !model.modes().is_rigid(mode));
        let of_modes = || elastic.filter_map(|mode| nonlinear_amplitude(model, mode)).collect::<Vec<f64>>();
        let found = if distance_to_stops(model).is_some() { Vec::new() } else { of_modes() };
        if found.is_empty() { vec![self.modal] } else { found }
    }
}

/// How far the structure moves until it touches or leaves a contact or stop, m: the smallest positive gap or, where all are pressed
/// at rest, the smallest depth.
fn distance_to_stops(model: &Model) -> Option<f64> {
    let clearances = || model.elements().iter().filter_map(|element| element.law.clearance());
    let gap = clearances().filter(|&gap| gap > 0.0).reduce(f64::min);
    gap.or_else(|| clearances().filter(|&gap| gap < 0.0).map(f64::abs).reduce(f64::min))
}

/// Ratio of the first harmonic of the nonlinear modal force to the linear one from which on a motion is nonlinear.
const NONLINEAR: f64 = 0.1;

/// A first harmonic smaller than this share of the mean is none.
const ROUNDING: f64 = 1e-9;

/// Ratios that differ by no more than this share are the same.
const SAME: f64 = 1e-6;

/// Largest modal amplitude of a mode at which the first harmonic of its nonlinear modal force, or of even forces the mean, is a tenth of the linear one. Where it is
/// more at all of them, and more at both ends, the least nonlinear one. Otherwise that at which the force differs by a tenth, or by half
/// of what it ever does, from that of the smallest motions, which laws may add to the linear one. It depends on units by a quarter
/// of a decade at most, the grid of amplitudes, and not at all where these are powers of ten.
/// `None` if all motions are alike.
fn nonlinear_amplitude(model: &Model, mode: usize) -> Option<f64> {
    let (shape, frequency) = (model.modes().shapes.column(mode), model.modes().frequencies[mode]);
    let mut aft = Aft::new(HarmonicSettings { count: 1, samples: 64, quadrature: Quadrature::Samples });
    let nc = width(1);
    let ratio = |amplitude: f64, aft: &mut Aft| -> f64 {
        let (mut force, mut mean) = ([0.0; 2], 0.0);
        // A contact without gap scales with the motion: it sets no length.
        for element in model.elements().iter().filter(|element| element.law.rigid().is_none()) {
            let count = element.law.arguments();
            let reach: Vec<f64> = element
                .channels
                .iter()
                .take(count)
                .map(|channel| channel.iter().map(|&(dof, factor)| factor * shape[dof]).sum())
                .collect();
            let mut arguments = vec![0.0; count * nc];
            for (series, reach) in arguments.chunks_mut(nc).zip(&reach) {
                series[1] = amplitude * reach;
            }
            let mut out = ElementForce::default();
            let rate = Rate { omega: frequency, harmonic: model.forcing().harmonic as f64 };
            with_law!(&element.law, law => aft.evaluate(law, &arguments, rate, &mut out));
            for (series, reach) in out.force.chunks(nc).zip(&reach) {
                force[0] += reach * series[1];
                force[1] += reach * series[2];
                mean += reach * series[0];
            }
        }
        let (linear, first) = (frequency.powi(2) * amplitude, force[0].hypot(force[1]));
        // Of even forces the first harmonic is rounding, which of motions large enough is more than the linear force.
        if first < ROUNDING * mean.abs() { mean.abs() / linear } else { first / linear }
    };
    let amplitudes: Vec<f64> = (-48..=48).rev().map(|step| 10f64.powf(f64::from(step) / 4.0)).collect();
    let ratios: Vec<f64> = amplitudes.iter().map(|&amplitude| ratio(amplitude, &mut aft)).collect();
    let largest_across = |values: &[f64], level: f64| {
        let crosses = |pair: &[f64]| (pair[0] > level) != (pair[1] > level);
        values.windows(2).position(crosses).map(|before| amplitudes[before + 1])
    };
    if let Some(amplitude) = largest_across(&ratios, NONLINEAR) {
        return Some(amplitude);
    }
    let least = (0..ratios.len()).min_by(|&a, &b| ratios[a].total_cmp(&ratios[b]))?;
    let is_less_than = |end: Option<&f64>| end.is_some_and(|end| ratios[least] < end * (1.0 - SAME));
    if ratios[least] > NONLINEAR && is_less_than(ratios.first()) && is_less_than(ratios.last()) {
        return Some(amplitudes[least]);
    }
    let small = *ratios.last()?;
    let changes: Vec<f64> = ratios.iter().map(|ratio| (ratio - small).abs() / (1.0 + small)).collect();
    let most = changes.iter().copied().fold(0.0, f64::max);
    if most > SAME { largest_across(&changes, NONLINEAR.min(0.5 * most)) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring of eigenfrequency 1 rad/s, with laws, in lengths of `unit` m; the laws are functions of it.
    fn length(unit: f64, laws: impl Fn(f64) -> String) -> f64 {
        let text = format!(
            "dofs = [\"x\"]\n[matrices]\nmass = [[1]]\nstiffness = [[1]]\n[damping]\ndefault_ratio = 0.01\n\
             [forcing]\nshape = {{ dofs = {{ x = 1 }} }}\nharmonic = 1\n{}",
            laws(unit)
        );
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("model.toml"), text).unwrap();
        let model = crate::files::load(folder.path()).unwrap();
        Scales::new(&model, 0).length
    }

    fn law(law: &str) -> String {
        format!("[[laws]]\ndof = \"x\"\nlaw = {{ {law} }}\n")
    }

    /// The same structure in other units has the same reference length, whatever acts.
    #[test]
    fn lengths_do_not_depend_on_units() {
        let cubic = |unit: f64, c: f64| {
            law(&format!("polynomial_spring = {{ terms = [{{ power = 3, coefficient = {:e} }}] }}", c / unit.powi(2)))
        };
        let tanh = |unit: f64, limit: f64, velocity: f64| {
            law(&format!("tanh_friction = {{ limit = {:e}, velocity = {:e} }}", limit * unit, velocity * unit))
        };
        let stop =
            |unit: f64, gap: f64| law(&format!("penalty_spring = {{ stiffness = 7.5, gap = {:e} }}", gap * unit));
        let joint = |unit: f64, stiffness: f64| {
            law(&format!("jenkins = {{ stiffness = {stiffness:e}, limit = {:e} }}", 0.03 * unit))
        };
        let quadratic = |unit: f64, c: f64| {
            law(&format!("polynomial_spring = {{ terms = [{{ power = 2, coefficient = {:e} }}] }}", c / unit))
        };
        let structures: [&dyn Fn(f64) -> String; 9] = [
            // Even forces, which have no first harmonic but for rounding, alone and with odd ones.
            &|unit| quadratic(unit, 0.3),
            &|unit| quadratic(unit, 0.3) + &cubic(unit, 0.02),
            &|unit| cubic(unit, 0.5),
            // Nonlinear at every amplitude: friction takes over where the cubic spring ends.
            &|unit| cubic(unit, 0.02) + &tanh(unit, 1.0, 0.1),
            // Pressed at rest, as stiff as the structure: never nearly linear.
            &|unit| stop(unit, -0.1),
            &|unit| stop(unit, -0.1) + &stop(unit, 0.3),
            // A joint that is a twentieth of the structure's stiffness.
            &|unit| joint(unit, 0.05),
            &|unit| joint(unit, 3.0),
            // As stiff as the structure for the smallest motions, and stiffer for larger ones.
            &|unit| law("polynomial_spring = { terms = [{ power = 1, coefficient = 1 }] }") + &cubic(unit, 0.02),
        ];
        for (i, structure) in structures.iter().enumerate() {
            let [large, small] = [1.0, 1e-6].map(|unit| length(unit, structure) / unit);
            assert!((large / small - 1.0).abs() < 1e-6, "{i}: {large} {small}");
            assert!((1e-3..1e3).contains(&large), "{i}: {large}");
        }
        assert_eq!(length(1.0, |unit| stop(unit, -0.1)), 0.1);
        assert_eq!(length(1.0, |unit| stop(unit, -0.1) + &stop(unit, 0.3)), 0.3);
        // As a contact without a gap every motion is like every other.
        assert_eq!(length(1.0, |unit| stop(unit, 0.0)), length(1e-6, |unit| stop(unit, 0.0)));
    }
}
