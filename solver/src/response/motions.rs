//! Motions that starts begin with: random ones, the free motions that these lead to, and others made of them.

use crate::curve::least_norm::{ROUGH, of_size};
use crate::formulation::Formulation;
use crate::formulation::harmonics::{complex, width};
use crate::formulation::linear::forced_response;
use crate::formulation::state::State;
use crate::response::forced::Forced;
use crate::settings::FrequencySettings;
use crate::structure::Model;
use crate::structure::laws::Law;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::FRAC_PI_2;

/// Of random motions, the sizes: between these multiples of the amplitude at which the structure becomes nonlinear in one of its modes,
/// which is drawn: an absorber does so long before what it is fixed to.
const SIZES: (f64, f64) = (0.03, 30.0);

/// The smallest where nothing but rigid contact is nonlinear: what is smaller does not touch.
const SMALLEST_TOUCHING: f64 = 0.3;

/// Harmonics of random motions fall with these powers of their number.
const FALLS: (f64, f64) = (1.0, 4.0);

/// Share of random motions that are their own mirror images half a period later, where such can be responses.
const MIRRORED: f64 = 2.0 / 3.0;

/// Decay rate that free motions are looked for with, of the frequency, where there is next to no damping.
const LEAST_DECAY: f64 = 1e-4;

/// Most steps of least norm towards a free motion.
const STEPS: usize = 40;

/// A random motion: in every mode as much energy as in any other on average, harmonics falling as fast as chance has it.
pub(super) fn motion<'m, F: Formulation<'m>, C: Formulation<'m>>(
    random: &mut ChaCha8Rng,
    forced: &Forced<'m, F>,
    coarse: &C,
    sizes: &[f64],
) -> State {
    let (model, harmonics) = (forced.model(), coarse.harmonics());
    let mut between = |(low, high): (f64, f64)| (low.ln() + random.gen_range(0.0..1.0) * (high / low).ln()).exp();
    let omega = between(drawn(forced.reach().frequency, &forced.settings().frequency));
    let smallest = if is_linear_until_touched(model) { SMALLEST_TOUCHING } else { SIZES.0 };
    let multiple = between((smallest, SIZES.1));
    let nonlinear = if let [only] = sizes { *only } else { sizes[random.gen_range(0..sizes.len())] };
    let size = multiple * nonlinear;
    let fall = random.gen_range(FALLS.0..FALLS.1);
    // Newton's method does not leave the motions that are their own mirror images: half the unknowns, and most isolas are of them.
    let has_mirrored = coarse.system().is_symmetric && model.forcing().harmonic % 2 == 1;
    let is_mirrored = has_mirrored && random.gen_bool(MIRRORED);
    let reference = model.modes().frequencies[forced.settings().tracked(forced.model())];
    let nc = width(harmonics);
    let mut modal = vec![0.0; model.size() * nc];
    for (series, frequency) in modal.chunks_mut(nc).zip(&model.modes().frequencies) {
        let size = size * (reference / frequency).min(1.0);
        for (i, q) in series.iter_mut().enumerate() {
            let k = i.div_ceil(2);
            let size = if is_mirrored && k % 2 == 0 { 0.0 } else { size * (k.max(1) as f64).powf(-fall) };
            *q = size * random.sample::<f64, _>(StandardNormal);
        }
    }
    let arguments = coarse.modal().open_arguments(&modal);
    State { harmonics, omega, decay: 0.0, forcing: forced.forcing(), arguments, modal }
}

/// The free motion that a start leads to: responses of light damping are near such motions, of some phase, and of far more of
/// them than there are backbones that begin at linear modes. None where it leads to none, or next to rest.
pub(super) fn freed<'m, F: Formulation<'m>>(free: &mut F, start: &State, mode: usize) -> Option<State> {
    let model = free.system().model;
    let (damping, frequency) = (model.damping().diagonal(mode), model.modes().frequencies[mode]);
    // Steps change a parameter by a share of itself, and never one that is zero.
    let decay = start.omega * (0.5 * damping / frequency).max(LEAST_DECAY);
    // As the phase condition wants it: otherwise it is the motion that changes for it.
    let start = start.shifted(FRAC_PI_2 - complex(start.mode(mode), 1).arg());
    let mut y = free.encode(&State { decay, forcing: 0.0, ..start });
    of_size(free, &mut y, ROUGH, STEPS).ok()?;
    let state = free.decode(&y).ok()?;
    let size = state.modal.iter().map(|q| q * q).sum::<f64>().sqrt();
    (size > SIZES.0 * free.scales().modal).then_some(state)
}

/// A motion with the linear response to the forcing on top; none at an undamped resonance.
pub(super) fn driven<'m, F: Formulation<'m>>(coarse: &F, start: &State) -> Option<State> {
    let mut state = forced_response(coarse, start.forcing, start.omega).ok()?;
    state.modal.iter_mut().zip(&start.modal).for_each(|(driven, own)| *driven += own);
    state.arguments = coarse.modal().open_arguments(&state.modal);
    Some(state)
}

/// The range from which frequencies are drawn. Of bounds that nobody gave the logarithms are rounded, to less than a thousandth of their
/// difference: they depend on steps in their last digits, and what a start leads to, which is a matter of chance, would with them.
fn drawn((low, high): (f64, f64), given: &FrequencySettings) -> (f64, f64) {
    let unit = 10f64.powf((high / low).ln().log10().floor() - 3.0);
    let rounded = |omega: f64| ((omega.ln() / unit).round() * unit).exp();
    let bound = |omega: f64, given: Option<f64>| if given.is_some() { omega } else { rounded(omega) };
    (bound(low, given.min), bound(high, given.max))
}

fn is_linear_until_touched(model: &Model) -> bool {
    model.elements().iter().all(|element| element.law.rigid().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::problem::Problem;
    use crate::formulation::displacement::DisplacementForm;
    use crate::formulation::scales::Scales;
    use crate::formulation::unknown::Unknown;
    use crate::settings::HarmonicSettings;
    use crate::structure::laws::{PolynomialSpring, Term};
    use rand::SeedableRng;

    #[test]
    fn last_digits_of_bounds_change_no_start() {
        let none = FrequencySettings::default();
        let ranges = [(1992.75123, 2745.06661), (1992.75124, 2745.06662)];
        assert_eq!(drawn(ranges[0], &none), drawn(ranges[1], &none));
        for (low, high) in [ranges[0], (0.99996, 1.00004), (1e-3, 2e5)] {
            let (from, to) = drawn((low, high), &none);
            assert!((from / low).ln().abs().max((to / high).ln().abs()) < 1e-3 * (high / low).ln(), "{from} {to}");
        }
        let given = FrequencySettings { max: Some(2745.06661), ..none };
        assert_eq!(drawn(ranges[0], &given), (drawn(ranges[0], &none).0, 2745.06661));
    }

    /// Free motions that random ones of two masses lead to, of so many random ones; the spring of the first to the ground has this linear
    /// part, and `mode` is the lowest that deforms the structure without it.
    fn free_motions(stiffness: [[f64; 2]; 2], linear: f64, mode: usize, tried: usize) -> usize {
        let terms = vec![Term { power: 1, coefficient: linear }, Term { power: 3, coefficient: 1.0 }];
        let model = Model::builder("two masses")
            .mass([[1.0, 0.0], [0.0, 1.0]])
            .stiffness(stiffness)
            .damping_ratio(0.01)
            .force("x1", 1.0)
            .element("spring", PolynomialSpring { terms }, ["x1"])
            .build()
            .unwrap();
        assert_eq!(model.modes().lowest_deforming(), Some(mode));
        let harmonics = 5;
        let truncation = HarmonicSettings { count: harmonics, ..HarmonicSettings::default() };
        let (unknown, scales) = (Unknown::Mode { damped: true }, Scales::new(&model, mode));
        let mut free = DisplacementForm::of_all_dofs(&model, truncation, mode, unknown, scales).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut found = 0;
        for _ in 0..tried {
            let mut modal: Vec<f64> = (0..2 * width(harmonics)).map(|_| random.sample(StandardNormal)).collect();
            for series in modal.chunks_mut(width(harmonics)) {
                series.iter_mut().enumerate().for_each(|(i, q)| *q /= (i.div_ceil(2).max(1) as f64).powi(2));
            }
            let omega = random.gen_range(0.8..3.0);
            let arguments = free.modal().open_arguments(&modal);
            let start = State { harmonics, omega, decay: 0.0, forcing: 0.0, arguments, modal };
            let Some(state) = freed(&mut free, &start, mode) else { continue };
            let mut y = free.encode(&state);
            assert!(free.linearise(&mut y) < ROUGH, "{state:?}");
            found += 1;
        }
        found
    }

    /// Rest is a free motion as well, and most motions are nearer to it than to any other.
    #[test]
    fn random_motions_lead_to_free_motions_that_are_not_rest() {
        let held = free_motions([[2.0, -1.0], [-1.0, 2.0]], 0.0, 0, 64);
        assert!(held >= 12, "{held} of 64");
        // What a law alone holds has a rigid-body mode below.
        let free = free_motions([[1.0, -1.0], [-1.0, 1.0]], 1.0, 1, 64);
        assert!(free >= 12, "{free} of 64");
    }
}
