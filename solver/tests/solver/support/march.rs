//! The equation of motion from rest by the classical Runge–Kutta method, for small models whose laws have no memory.

use super::balance::{Matrices, scalar_force};
use solver::{Matrix, Model};
use std::f64::consts::TAU;

/// A motion that repeats itself every period 2π/ω.
pub struct Settled {
    /// Harmonics of every dof, n × (2H + 1), m.
    pub series: Vec<Vec<f64>>,
    /// Largest |x| of every dof, m.
    pub amplitude: Vec<f64>,
    /// Share (rms) of the motion beyond harmonic H.
    pub beyond: f64,
}

/// A model with its inverse mass matrix.
pub struct March<'m> {
    model: &'m Model,
    matrices: Matrices,
    inverse: Matrix,
}

impl<'m> March<'m> {
    pub fn new(model: &'m Model) -> Self {
        let shapes = &model.modes().shapes;
        Self { model, matrices: Matrices::of(model), inverse: shapes.matmul(&shapes.transpose()) }
    }

    /// Whether all laws of a model have no memory.
    pub fn fits(model: &Model) -> bool {
        model.elements().iter().all(|element| scalar_force(&element.law, 0.0, 0.0).is_some())
    }

    fn acceleration(&self, x: &[f64], v: &[f64], forcing: f64) -> Vec<f64> {
        let (damped, held) = (self.matrices.damping.mul_vec(v), self.matrices.stiffness.mul_vec(x));
        let shape = &self.model.forcing().shape;
        let mut force: Vec<f64> = (0..x.len()).map(|i| forcing * shape[i] - damped[i] - held[i]).collect();
        for element in self.model.elements() {
            let [channel] = element.channels.as_slice() else { panic!("{}: not a scalar law", element.name) };
            let along = |z: &[f64]| channel.iter().map(|&(dof, b)| b * z[dof]).sum::<f64>();
            let value = scalar_force(&element.law, along(x), along(v)).expect("a law without memory");
            channel.iter().for_each(|&(dof, b)| force[dof] -= b * value);
        }
        self.inverse.mul_vec(&force)
    }

    /// One period from (x, v) in `steps` steps, telling `visit` of every new displacement.
    fn period(
        &self,
        state: &mut (Vec<f64>, Vec<f64>),
        forcing: f64,
        omega: f64,
        steps: usize,
        visit: &mut dyn FnMut(&[f64]),
    ) {
        let h = TAU / omega / steps as f64;
        let harmonic = self.model.forcing().harmonic as f64;
        let moved =
            |z: &[f64], by: f64, rate: &[f64]| z.iter().zip(rate).map(|(z, r)| z + by * r).collect::<Vec<f64>>();
        for step in 0..steps {
            let force = |share: f64| forcing * (harmonic * omega * h * (step as f64 + share)).cos();
            let (x, v) = (&state.0, &state.1);
            let a1 = self.acceleration(x, v, force(0.0));
            let (x2, v2) = (moved(x, 0.5 * h, v), moved(v, 0.5 * h, &a1));
            let a2 = self.acceleration(&x2, &v2, force(0.5));
            let (x3, v3) = (moved(x, 0.5 * h, &v2), moved(v, 0.5 * h, &a2));
            let a3 = self.acceleration(&x3, &v3, force(0.5));
            let (x4, v4) = (moved(x, h, &v3), moved(v, h, &a3));
            let a4 = self.acceleration(&x4, &v4, force(1.0));
            let mean = |a: &[f64], b: &[f64], c: &[f64], d: &[f64]| -> Vec<f64> {
                (0..a.len()).map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0).collect()
            };
            let (speed, rate) = (mean(v, &v2, &v3, &v4), mean(&a1, &a2, &a3, &a4));
            *state = (moved(x, h, &speed), moved(v, h, &rate));
            visit(&state.0);
        }
    }

    /// The motion of period 2π/ω on which the model settles from rest, within `periods` periods; `None` if it does not.
    pub fn settle(&self, forcing: f64, omega: f64, harmonics: usize, periods: usize) -> Option<Settled> {
        let n = self.model.size();
        let fastest = self.model.modes().frequencies[n - 1].max(self.stiffest());
        let steps = ((TAU / omega) * fastest / 0.2).ceil().max(100.0) as usize;
        let mut state = (vec![0.0; n], vec![0.0; n]);
        let mut before = state.clone();
        let mut calm = 0;
        for _ in 0..periods {
            self.period(&mut state, forcing, omega, steps, &mut |_| {});
            let size = |z: &(Vec<f64>, Vec<f64>)| z.0.iter().chain(&z.1).fold(0.0f64, |m, z| m.max(z.abs()));
            let pairs = state.0.iter().chain(&state.1).zip(before.0.iter().chain(&before.1));
            let change = pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            if !size(&state).is_finite() {
                return None;
            }
            calm = if change < 1e-6 * size(&state) { calm + 1 } else { 0 };
            if calm == 3 {
                return Some(self.measure(&mut state, forcing, omega, harmonics, steps));
            }
            before = state.clone();
        }
        None
    }

    /// Frequency of the stiffest law on the lightest mass, rad/s.
    fn stiffest(&self) -> f64 {
        use solver::laws::Law;
        let largest = self.model.elements().iter().map(|element| element.law.stiffness_bound()).fold(0.0, f64::max);
        let lightest = (0..self.model.size()).map(|i| self.model.mass()[(i, i)]).fold(f64::INFINITY, f64::min);
        (largest / lightest).sqrt()
    }

    fn measure(
        &self,
        state: &mut (Vec<f64>, Vec<f64>),
        forcing: f64,
        omega: f64,
        harmonics: usize,
        steps: usize,
    ) -> Settled {
        let n = self.model.size();
        let mut path = vec![state.0.clone()];
        self.period(state, forcing, omega, steps, &mut |x| path.push(x.to_vec()));
        path.pop();
        let signal = |dof: usize| path.iter().map(move |x| x[dof]);
        let project = |dof: usize, wave: &dyn Fn(f64) -> f64| -> f64 {
            signal(dof).enumerate().map(|(i, x)| x * wave(TAU * i as f64 / steps as f64)).sum::<f64>() / steps as f64
        };
        let series = |dof: usize| {
            let mut series = vec![project(dof, &|_| 1.0)];
            for k in 1..=harmonics {
                series.push(2.0 * project(dof, &|t| (k as f64 * t).cos()));
                series.push(2.0 * project(dof, &|t| (k as f64 * t).sin()));
            }
            series
        };
        let series: Vec<Vec<f64>> = (0..n).map(series).collect();
        let amplitude = (0..n).map(|dof| signal(dof).fold(0.0f64, |m, x| m.max(x.abs()))).collect();
        let total: f64 = (0..n).map(|dof| project_square(signal(dof), steps)).sum();
        let kept: f64 = series.iter().map(|s| s[0] * s[0] + 0.5 * s[1..].iter().map(|c| c * c).sum::<f64>()).sum();
        Settled { series, amplitude, beyond: ((total - kept).max(0.0) / total).sqrt() }
    }
}

fn project_square(signal: impl Iterator<Item = f64>, steps: usize) -> f64 {
    signal.map(|x| x * x).sum::<f64>() / steps as f64
}
