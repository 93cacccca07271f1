//! Responses from random motions at random frequencies, and from free motions that such lead to.

use crate::balance::{Balance, Evaluation};
use crate::images::shifted;
use crate::model::Law;
use crate::newton::{least_norm, nearest, onto_plane};
use crate::quadrature::norm;
use crate::structure::Structure;
use faer::Mat;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha20Rng;
use rand_distr::StandardNormal;

/// Harmonics of a first try; with a forcing on harmonic m, as many times m but never more than all.
const COARSE: usize = 5;

/// Most steps of least norm with few harmonics, and with all of them.
const STEPS: (usize, usize) = (30, 15);

/// Residual, of the forcing, that leads from few harmonics to all of them.
const ROUGH: f64 = 1e-4;

/// What random starts within ranges of frequency, rad/s, and size, m, lead to, one after the other: a converged
/// response with the tangent of its branch, or nothing.
pub fn responses<'a>(
    balance: &'a Balance,
    omega: (f64, f64),
    sizes: (f64, f64),
    seed: u64,
) -> impl Iterator<Item = Option<(Vec<f64>, Vec<f64>)>> + 'a {
    let mut random = ChaCha20Rng::seed_from_u64(seed);
    let few = (COARSE * balance.structure.harmonic).min(balance.harmonics());
    let coarse = Balance::new(balance.structure, few, balance.forcing);
    let conservative = conservative(balance.structure);
    std::iter::repeat_with(move || {
        let mut y = motion(&coarse, omega, sizes, &mut random);
        if random.gen_range(0..2) == 0 {
            y = free(&Balance::new(&conservative, few, 0.0), y)?;
            y = shifted(&coarse, &y, random.gen_range(0.0..std::f64::consts::TAU));
        }
        nearest(&coarse, &mut y, STEPS.0, ROUGH)?;
        let (low, high) = (0.9 * omega.0, 1.1 * omega.1);
        if !(low..high).contains(&y[coarse.size()]) {
            return None;
        }
        converged(balance, &with_harmonics(&y, &coarse, balance))
    })
}

/// The response near a motion, and the tangent of its branch.
pub fn converged(balance: &Balance, near: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut y = near.to_vec();
    let tangent = nearest(balance, &mut y, STEPS.1, ROUGH)?;
    let origin = y.clone();
    let (_, tangent) = onto_plane(balance, &mut y, &tangent, &origin)?;
    Some((y, tangent))
}

/// The same motion with fewer or more harmonics.
pub fn with_harmonics(y: &[f64], from: &Balance, to: &Balance) -> Vec<f64> {
    let mut motion = Vec::with_capacity(to.size() + 1);
    for series in y[..from.size()].chunks(from.width()) {
        motion.extend((0..to.width()).map(|i| series.get(i).copied().unwrap_or(0.0)));
    }
    motion.push(y[from.size()]);
    motion
}

/// A motion in a random mix of modes, its harmonics falling as fast as chance has it.
fn motion(balance: &Balance, (low, high): (f64, f64), sizes: (f64, f64), random: &mut ChaCha20Rng) -> Vec<f64> {
    let (structure, width) = (balance.structure, balance.width());
    let n = structure.size();
    let size = sizes.0 * (sizes.1 / sizes.0).powf(random.gen_range(0.0..1.0));
    let decay = random.gen_range(1.0..5.0);
    // Newton's method does not leave the motions that are their own mirror images: fewer unknowns, and most isolas are among them.
    let is_mirrored = structure.is_odd() && structure.harmonic % 2 == 1 && random.gen_range(0..3) > 0;
    let mut y = vec![0.0; balance.size()];
    for j in 0..n {
        let share = random.gen_range(0.0..1.0f64).powi(2) * size * structure.frequencies[0] / structure.frequencies[j];
        for i in 0..width {
            let k = i.div_ceil(2);
            let q = share * (k.max(1) as f64).powf(-decay) * random.sample::<f64, _>(StandardNormal);
            if is_mirrored && k % 2 == 0 {
                continue;
            }
            (0..n).for_each(|dof| y[dof * width + i] += structure.shapes[(dof, j)] * q);
        }
    }
    y.push(low * (high / low).powf(random.gen_range(0.0..1.0)));
    y
}

/// The structure without anything that dissipates.
fn conservative(structure: &Structure) -> Structure {
    let n = structure.size();
    let elements = structure.elements.iter().filter(|(_, law)| !matches!(law, Law::PolynomialDamper { .. })).cloned();
    Structure { damping: Mat::zeros(n, n), elements: elements.collect(), ..structure.clone() }
}

/// A free motion of a conservative structure, symmetric in time, near a motion: forced responses of light damping are
/// near such motions, of some phase.
fn free(balance: &Balance, mut y: Vec<f64>) -> Option<Vec<f64>> {
    let (size, width) = (balance.size(), balance.width());
    // Constants and cosines, and the equations of both.
    let kept: Vec<usize> = (0..size).filter(|i| i % width == 0 || i % width % 2 == 1).chain([size]).collect();
    let full = |half: &[f64]| {
        let mut y = vec![0.0; size + 1];
        kept.iter().zip(half).for_each(|(&i, half)| y[i] = *half);
        y
    };
    let evaluate = |half: &[f64]| {
        let at = balance.evaluate(&full(half));
        let residual = kept[..kept.len() - 1].iter().map(|&i| at.residual[i]).collect();
        let jacobian = Mat::from_fn(kept.len() - 1, kept.len(), |i, j| at.jacobian[(kept[i], kept[j])]);
        Evaluation { residual, jacobian }
    };
    let is_enough = |half: &[f64], residual: &[f64]| norm(residual) < ROUGH * norm(&half[..half.len() - 1]);
    let mut half: Vec<f64> = kept.iter().map(|&i| y[i]).collect();
    least_norm(&evaluate, &is_enough, &mut half, STEPS.0)?;
    y.copy_from_slice(&full(&half));
    Some(y)
}
