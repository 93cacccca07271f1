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
    /// Reference length ℓ, m: the smallest positive gap; without a gap the amplitude (of the first monitored dof) at which
    /// the nonlinear modal force has fallen or risen to a tenth of the linear one; if it never does, that of unit modal
    /// amplitude.
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
        let length = smallest_gap(model).unwrap_or_else(|| nonlinear_amplitude(model, tracked).unwrap_or(1.0) * phi);
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
        let found = if smallest_gap(model).is_some() { Vec::new() } else { of_modes() };
        if found.is_empty() { vec![self.modal] } else { found }
    }
}

/// The smallest positive gap of the contacts and stops, m.
fn smallest_gap(model: &Model) -> Option<f64> {
    let gaps = model.elements().iter().filter_map(|element| element.law.clearance());
    gaps.filter(|&gap| gap > 0.0).reduce(f64::min)
}

/// Largest modal amplitude of a mode at which the first harmonic of its nonlinear modal force is a tenth of the linear one.
fn nonlinear_amplitude(model: &Model, mode: usize) -> Option<f64> {
    let (shape, frequency) = (model.modes().shapes.column(mode), model.modes().frequencies[mode]);
    let mut aft = Aft::new(HarmonicSettings { count: 1, samples: 64, quadrature: Quadrature::Samples });
    let nc = width(1);
    let ratio = |amplitude: f64, aft: &mut Aft| -> f64 {
        let mut force = [0.0; 2];
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
            }
        }
        let linear = frequency.powi(2) * amplitude;
        force[0].hypot(force[1]) / linear
    };
    let mut above: Option<bool> = None;
    for step in (-48..=48).rev() {
        let amplitude = 10f64.powf(f64::from(step) / 4.0);
        let now = ratio(amplitude, &mut aft) > 0.1;
        if above.is_some_and(|above| above != now) {
            return Some(amplitude);
        }
        above = Some(now);
    }
    None
}
