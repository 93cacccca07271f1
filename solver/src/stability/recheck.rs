//! Whether what somebody else says of marched orbits is so: a period is marched on one of them.
//!
//! A period takes a hundredth of the time that finding the orbit and its multipliers took, and one with its tangent a tenth: the
//! latter is marched for some only.
//!
//! What is not computed again: how far an orbit is from the solution of the balance, and where along the branch it is told, for which all
//! of the branch would have to be read; that there is no orbit; where multipliers cross the unit circle between orbits; where pushes and
//! unstable motions end, since a period says nothing of that: they would have to be marched to the end, which is all of the work. Of
//! these it is checked that they are of what was asked for, and can be.

use super::multipliers::{Multiplier, Verdict};
use super::polish::{PolishSettings, comparable, noise_of_impacts, share_of_impacts};
use super::shooting::{Orbit, Shooting};
use super::verification::{MarchedOrbit, VerifiedPoint};
use crate::marching::{Marching, MarchingError};
use crate::structure::Model;
use thiserror::Error;

/// Largest scaled distance of both ends of a period: a thousand times what Newton's method leaves, since other processors round
/// differently, and an unstable orbit makes more of it.
const CLOSED: f64 = 1e-6;

/// Largest relative difference of an amplitude.
const SAME: f64 = 1e-6;

/// Largest difference of the share of energy that impacts take, as a share of that from which on nothing is said of an orbit: where the
/// forcing supplies next to nothing it moves ten thousand times as much as the motion does, with what Newton's method leaves.
const IMPACTS: f64 = 1e-2;

/// Largest difference of the moduli of multipliers, relative to the larger of them and 1: of two that nearly coincide, as
/// beside a fold, they move with the root of what rounding leaves.
const MULTIPLIERS: f64 = 1e-4;

/// The steps of a period are chosen by the frequency of the balance, which is that of the orbit within a hundredth.
const STEPS: f64 = 0.03;

/// Why an orbit is none.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoOrbit {
    /// It cannot be marched.
    #[error("the orbit cannot be marched: {0}")]
    Marching(#[from] MarchingError),
    /// Another number of entries than the marcher's state has.
    #[error("a state of {numbers} numbers where the model has {expected}")]
    Size {
        /// Numbers of its state.
        numbers: usize,
        /// Those of the model.
        expected: usize,
    },
    /// Not in as many steps as this model takes.
    #[error("a period of {steps} steps where {expected} are taken")]
    Steps {
        /// Steps of the orbit.
        steps: usize,
        /// About so many are taken.
        expected: usize,
    },
    /// It does not close.
    #[error("it does not come back after a period: it is {0:.1e} off")]
    Open(f64),
    /// It is another one than it is said to be.
    #[error("its {what} is {own:e}, not {told:e}")]
    Told {
        /// Which number.
        what: &'static str,
        /// What it is.
        own: f64,
        /// What was said.
        told: f64,
    },
    /// Its multipliers could not be computed.
    #[error("it has no multipliers")]
    Multipliers,
    /// Not what its multipliers say.
    #[error("it was said to be {told:?}, and its multipliers say {own:?}")]
    Verdict {
        /// What they say.
        own: Verdict,
        /// What was said.
        told: Verdict,
    },
}

/// Marches a period on the orbit that was found near a point, with the tangent if multipliers and verdict are to be
/// checked as well. `point` says of the orbit what was told; a point without an orbit says nothing.
///
/// # Errors
/// What does not hold.
pub fn recheck(model: &Model, orbit: &Orbit, point: &VerifiedPoint, with_tangent: bool) -> Result<(), NoOrbit> {
    let Some(told) = &point.orbit else { return Ok(()) };
    let settings = PolishSettings::default();
    let fresh = Marching::new(model, &settings.marching, orbit.forcing, orbit.omega)?;
    if orbit.state.len() != fresh.state_size() {
        return Err(NoOrbit::Size { numbers: orbit.state.len(), expected: fresh.state_size() });
    }
    let expected = fresh.steps_per_period();
    if (orbit.steps as f64 / expected as f64 - 1.0).abs() > STEPS {
        return Err(NoOrbit::Steps { steps: orbit.steps, expected });
    }
    let mut shooting = Shooting::around(model, orbit)?;
    let at = shooting.point_at(orbit);
    if !with_tangent {
        let mut marching = orbit.marching(model)?;
        let mut amplitudes = vec![0.0f64; model.monitors().len()];
        marching.walk(&mut |now| {
            for (i, largest) in amplitudes.iter_mut().enumerate() {
                *largest = largest.max(now.monitored(i).abs());
            }
        })?;
        let end = shooting.point_at(&Orbit { state: marching.state(), ..orbit.clone() });
        closes(end.x.iter().zip(&at.x).map(|(a, b)| a - b))?;
        return is_told(&amplitudes, told);
    }
    let period = shooting.period(&at)?;
    closes(period.residual.iter().copied())?;
    is_told(&period.amplitudes, told)?;
    let (impacts, noise) = (share_of_impacts(&period), noise_of_impacts(&period));
    if (impacts - told.impacts).abs() > IMPACTS * settings.impacts + noise {
        return Err(NoOrbit::Told { what: "share of energy lost in impacts", own: impacts, told: told.impacts });
    }
    let own = period.multipliers().map_err(|_| NoOrbit::Multipliers)?;
    for (own, told) in own.iter().map(Multiplier::modulus).zip(told.multipliers.iter().map(Multiplier::modulus)) {
        if (own - told).abs() > MULTIPLIERS * own.max(1.0) {
            return Err(NoOrbit::Told { what: "multiplier", own, told });
        }
    }
    let margin = shooting.margin(&at, &period);
    let own = comparable(&settings, &period, Verdict::of(&own, margin));
    // Where the largest modulus is the margin off 1 it may be said either way, and beside a fold a push decides.
    let largest = period.multipliers().ok().and_then(|all| all.first().map(Multiplier::excess)).unwrap_or(0.0);
    let (taken, before) = period.account.hardest;
    let near = [impacts / settings.impacts, taken / (settings.struck * before)];
    let is_close = (largest.abs() - margin).abs() < MULTIPLIERS
        || near.iter().any(|share| (share - 1.0).abs() < IMPACTS)
        || (impacts - settings.impacts).abs() < noise;
    let is_same = own == point.verdict || own == Verdict::Stable && point.verdict == Verdict::Marginal;
    if is_same || is_close { Ok(()) } else { Err(NoOrbit::Verdict { own, told: point.verdict }) }
}

fn closes(residual: impl Iterator<Item = f64>) -> Result<(), NoOrbit> {
    // What is not a number does not close.
    let off =
        residual.fold(0.0f64, |most, entry| if entry.abs() > most || entry.is_nan() { entry.abs() } else { most });
    if off <= CLOSED { Ok(()) } else { Err(NoOrbit::Open(off)) }
}

fn is_told(amplitudes: &[f64], orbit: &MarchedOrbit) -> Result<(), NoOrbit> {
    for (&own, &told) in amplitudes.iter().zip(&orbit.amplitudes) {
        if (own - told).abs() > SAME * own.max(told) {
            return Err(NoOrbit::Told { what: "amplitude", own, told });
        }
    }
    Ok(())
}
