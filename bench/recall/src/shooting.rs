//! Periodic orbits by time integration: Newton's method on the map over a period of the response, stable or not.

use crate::balance::Balance;
use crate::quadrature::{Nodes, dot, norm};
use crate::structure::Structure;
use faer::linalg::solvers::Solve;
use faer::{Col, Mat};

/// Steps of the classical Runge–Kutta method over a period.
const STEPS: usize = 2000;

/// Most steps of Newton's method, and the relative change of the state at which it has converged.
const NEWTON: (usize, f64) = (12, 1e-8);

/// Largest relative distance of the orbit's state from the balance's: beyond it, it is another motion.
const NEAR: f64 = 0.25;

/// Relative difference between the amplitude of the orbit next to a point of a branch and the point's; none if there
/// is none.
pub fn deviation(balance: &Balance, y: &[f64]) -> Option<f64> {
    let (omega, start) = (y[balance.size()], state(balance, y));
    let mut z = start.clone();
    for _ in 0..NEWTON.0 {
        let Period { end, monodromy, .. } = period(balance, omega, &z, true);
        let size = z.len();
        let matrix = Mat::from_fn(size, size, |i, j| monodromy[j][i] - f64::from(u8::from(i == j)));
        let mut change = Col::from_fn(size, |i| z[i] - end[i]);
        matrix.partial_piv_lu().solve_in_place(&mut change);
        let change: Vec<f64> = change.iter().copied().collect();
        z.iter_mut().zip(&change).for_each(|(z, change)| *z += change);
        let away: Vec<f64> = z.iter().zip(&start).map(|(z, start)| z - start).collect();
        let away = norm(&away);
        if away.is_nan() || away > NEAR * norm(&start) {
            return None;
        }
        if norm(&change) < NEWTON.1 * norm(&z) {
            let marched = period(balance, omega, &z, false).amplitude;
            let width = balance.width();
            let monitor = balance.structure.monitor;
            let balanced = balance.largest(&y[monitor * width..(monitor + 1) * width]);
            return Some((marched - balanced).abs() / balanced);
        }
    }
    None
}

/// Displacements and velocities at τ = 0.
fn state(balance: &Balance, y: &[f64]) -> Vec<f64> {
    let (size, origin) = (balance.size(), Nodes::even(1, balance.harmonics()));
    let series = || y[..size].chunks(balance.width());
    let displacements = series().map(|series| dot(origin.at(0), series));
    displacements.chain(series().map(|series| y[size] * dot(origin.slope_at(0), series))).collect()
}

/// What integration over a period gives.
struct Period {
    end: Vec<f64>,
    /// Columns of the derivative of the end by the start.
    monodromy: Vec<Vec<f64>>,
    amplitude: f64,
}

fn period(balance: &Balance, omega: f64, start: &[f64], varied: bool) -> Period {
    let structure = balance.structure;
    let (n, size) = (structure.size(), start.len());
    // The state and, one after the other, its derivatives by the start.
    let mut z = start.to_vec();
    if varied {
        (0..size).for_each(|j| z.extend((0..size).map(|i| f64::from(u8::from(i == j)))));
    }
    let step = std::f64::consts::TAU / omega / STEPS as f64;
    let rate = |t: f64, z: &[f64]| rates(structure, balance.forcing, omega * t, z);
    let moved = |z: &[f64], k: &[f64], by: f64| -> Vec<f64> { z.iter().zip(k).map(|(z, k)| z + by * k).collect() };
    let mut amplitude = 0.0f64;
    for i in 0..STEPS {
        let t = i as f64 * step;
        let k1 = rate(t, &z);
        let k2 = rate(t + 0.5 * step, &moved(&z, &k1, 0.5 * step));
        let k3 = rate(t + 0.5 * step, &moved(&z, &k2, 0.5 * step));
        let k4 = rate(t + step, &moved(&z, &k3, step));
        for (i, z) in z.iter_mut().enumerate() {
            *z += step / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        amplitude = amplitude.max(z[structure.monitor].abs());
    }
    let monodromy = z[size..].chunks(size).map(<[f64]>::to_vec).collect();
    Period { end: z[..2 * n].to_vec(), monodromy, amplitude }
}

/// Rates of the state and of its variations.
fn rates(structure: &Structure, forcing: f64, tau: f64, z: &[f64]) -> Vec<f64> {
    let n = structure.size();
    let state = &z[..2 * n];
    let laws: Vec<(f64, f64, f64)> = structure
        .elements
        .iter()
        .map(|(direction, law)| law.respond(dot(direction, &state[..n]), dot(direction, &state[n..])))
        .collect();
    let drive = forcing * (structure.harmonic as f64 * tau).cos();
    let mut rates = Vec::with_capacity(z.len());
    for (block, x) in z.chunks(2 * n).enumerate() {
        rates.extend_from_slice(&x[n..]);
        for i in 0..n {
            let linear = |(j, x): (usize, &f64)| {
                if j < n { structure.stiffness[(i, j)] * x } else { structure.damping[(i, j - n)] * x }
            };
            let mut force = if block == 0 { drive * structure.forcing[i] } else { 0.0 };
            force -= x.iter().enumerate().map(linear).sum::<f64>();
            for ((direction, _), (f, by_u, by_v)) in structure.elements.iter().zip(&laws) {
                let varied = || by_u * dot(direction, &x[..n]) + by_v * dot(direction, &x[n..]);
                force -= direction[i] * if block == 0 { *f } else { varied() };
            }
            rates.push(force / structure.mass[i]);
        }
    }
    rates
}
