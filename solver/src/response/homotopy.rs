//! Homotopy to sub-harmonic motion (the two-harmonic homotopy of Raze and Kerschen): a free motion is driven by a force on its
//! fundamental, which gives way step by step to the force on harmonic m. What is left at the end is a motion that the latter alone
//! drives, of the same order or of a lower one.

use crate::curve::least_norm::{ROUGH, nearest};
use crate::curve::problem::Failure;
use crate::formulation::harmonics::complex;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::melnikov::Energies;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Steps from the one force to the other; each is halved as often as it takes.
const STEPS: usize = 16;

/// Smallest step, over the others.
const SMALLEST: f64 = 1.0 / 16.0;

/// Most steps of least norm in each.
const ITERATIONS: usize = 12;

/// The motion that a force of amplitude `forcing` on harmonic m keeps going of a free one (ω and ζ of a damped mode, as `free` has
/// it), with a force on its fundamental at first whose phase is `phase` (rad); of the balances that `form` builds. ω is free all the
/// way: the motion goes along its branch as it likes, and ends where that does.
///
/// # Errors
/// If the motion does not move along the force, or the way ends before the force on the fundamental has gone.
pub(super) fn follow<'m, C: Formulation<'m>>(
    form: impl Fn(Unknown) -> Result<C, FormulationError>,
    free: &mut C,
    motion: &State,
    forcing: f64,
    phase: f64,
) -> Result<State, Failure> {
    let (strength, mut state) = driven(free, motion, phase).ok_or(Failure::Singular)?;
    let fundamental = Complex64::from_polar(strength, phase);
    let settle = |share: f64, state: &State| {
        let forcing = share * forcing;
        let unknown = Unknown::Blended { forcing, fundamental: (1.0 - share) * fundamental };
        let mut problem = form(unknown).map_err(|_| Failure::Singular)?;
        let mut y = problem.encode(&State { forcing, ..state.clone() });
        nearest(&mut problem, &mut y, ROUGH, ITERATIONS)?;
        problem.decode(&y).map_err(|_| Failure::Singular)
    };
    state = settle(0.0, &state)?;
    let (mut share, mut step) = (0.0, 1.0 / STEPS as f64);
    while share < 1.0 {
        let next = f64::min(share + step, 1.0);
        match settle(next, &state) {
            Ok(settled) => (share, state) = (next, settled),
            Err(failure) if step <= SMALLEST / STEPS as f64 => return Err(failure),
            Err(_) => step *= 0.5,
        }
    }
    Ok(state)
}

/// How strong a force on the fundamental keeps a free motion going, and that motion, shifted to where the force of this phase works
/// on it most. `None` if it does not work on it.
fn driven<'m>(free: &mut impl Formulation<'m>, motion: &State, phase: f64) -> Option<(f64, State)> {
    let y = free.encode(motion);
    let energies = Energies::evaluate(free, &y, motion);
    let projection = complex(&motion.combine(free.modal().forcing().iter().copied()), 1);
    let strength = (energies.linear + energies.nonlinear) / (PI * projection.norm());
    let is_driven = strength.is_finite() && strength > 0.0;
    // The velocity in phase with the force: a quarter period behind it.
    let shifted = || motion.shifted(phase - FRAC_PI_2 - projection.arg());
    is_driven.then(|| (strength, State { decay: 0.0, ..shifted() }))
}
