//! Periodic orbits of the time marcher by Newton's method on its map of a period (shooting).
//!
//! Unknowns are the state of the marcher, scaled, and the frequency; the number of steps in a period is fixed, so that the
//! map is smooth in ω as long as no contact grazes.

mod newton;

use super::multipliers::{Multiplier, margin, multipliers};
use crate::formulation::state::State;
use crate::linalg::{LinalgError, Lu, Matrix, dot, vectorised};
use crate::marching::{Account, Marching, MarchingError, MarchingSettings, Offset, reduced};
use crate::structure::Model;
pub use newton::NewtonOptions;
use serde::{Deserialize, Serialize};

/// A periodic orbit of the time marcher: enough to march on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// Frequency ω of the response, rad/s.
    pub omega: f64,
    /// Forcing amplitude A.
    pub forcing: f64,
    /// Time steps in a period.
    pub steps: usize,
    /// State at t = 0 ([`Marching::state`]).
    pub state: Vec<f64>,
}

impl Orbit {
    /// The marcher on this orbit at t = 0.
    ///
    /// # Errors
    /// If the marcher refuses it.
    pub fn marching<'m>(&self, model: &'m Model) -> Result<Marching<'m>, MarchingError> {
        let mut marching = Marching::with_steps(model, self.steps, self.forcing, self.omega)?;
        marching.restart(&self.state)?;
        Ok(marching)
    }
}

/// Instants of a period at which a motion is compared.
const INSTANTS: usize = 256;

/// Scaled state and scaled frequency.
#[derive(Debug, Clone)]
pub struct Point {
    /// State over its scales.
    pub x: Vec<f64>,
    /// ω over that of the shooting.
    pub w: f64,
}

/// A period from a point.
pub struct Period {
    /// Scaled state at its end less that at its begin.
    pub residual: Vec<f64>,
    /// Derivative of the scaled state at its end by that at its begin.
    pub monodromy: Matrix,
    /// Modal displacements at [`instants`](Self::stride), one after the other, kg^½·m.
    pub path: Vec<f64>,
    /// Steps between two instants of the path.
    pub stride: usize,
    /// Largest |x| of each monitored dof, m.
    pub amplitudes: Vec<f64>,
    /// Its energies.
    pub account: Account,
    /// Whether no contact opened or closed and no slider slipped.
    pub is_smooth: bool,
    /// Offsets of the sliders that stick all the time, as forms of the scaled state and w.
    pub offsets: Vec<Offset>,
}

impl Period {
    /// Largest scaled residual.
    pub fn error(&self) -> f64 {
        newton::largest(&self.residual)
    }

    /// Multipliers of the orbit, the largest first, without those of sliders that stick all the time: these are 1.
    ///
    /// # Errors
    /// If the monodromy matrix is not finite, or the iteration does not converge.
    pub fn multipliers(&self) -> Result<Vec<Multiplier>, LinalgError> {
        multipliers(&reduced(&self.monodromy, &self.offsets))
    }
}

/// Orbits at one forcing amplitude near one frequency.
pub struct Shooting<'m> {
    model: &'m Model,
    /// Any motion with these steps: others are made beside it.
    grid: Marching<'m>,
    forcing: f64,
    /// ω of w = 1, rad/s.
    omega: f64,
    steps: usize,
    scales: Vec<f64>,
    /// Numbers of y and of v; what laws remember comes after them.
    motion: usize,
    lu: Lu,
    /// Periods that were marched with their tangent, and without.
    pub periods: (usize, usize),
}

impl<'m> Shooting<'m> {
    /// Near the motion `state` of the balance.
    ///
    /// # Errors
    /// If the marcher refuses model or settings.
    pub fn new(model: &'m Model, settings: &MarchingSettings, state: &State) -> Result<Self, MarchingError> {
        let marching = Marching::new(model, settings, state.forcing, state.omega)?;
        let start = marching.state_of(state);
        let orbit =
            Orbit { omega: state.omega, forcing: state.forcing, steps: marching.steps_per_period(), state: start };
        Self::around(model, &orbit)
    }

    /// Near a motion of the marcher.
    ///
    /// # Errors
    /// If the marcher refuses it.
    pub fn around(model: &'m Model, orbit: &Orbit) -> Result<Self, MarchingError> {
        let n = model.size();
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let size = largest(&orbit.state[..n]).max(largest(&orbit.state[n..2 * n]) / orbit.omega);
        let size = if size > 0.0 { size } else { 1.0 };
        let grid = orbit.marching(model)?;
        let scales = grid.scales(size, orbit.omega);
        Ok(Self {
            model,
            grid,
            forcing: orbit.forcing,
            omega: orbit.omega,
            steps: orbit.steps,
            scales,
            motion: 2 * n,
            lu: Lu::default(),
            periods: (0, 0),
        })
    }

    /// Time steps of a period times numbers of the tangent of a step, with what a step takes besides.
    pub fn work(&self) -> f64 {
        let size = self.scales.len() as f64;
        self.steps as f64 * (64.0 + size * size)
    }

    /// The point of a motion of the balance.
    ///
    /// # Errors
    /// If the marcher refuses its frequency.
    pub fn point_of(&self, state: &State) -> Result<Point, MarchingError> {
        let marching = self.grid.beside(self.forcing, state.omega)?;
        Ok(self.scaled(&marching.state_of(state), state.omega))
    }

    /// The point of an orbit.
    pub fn point_at(&self, orbit: &Orbit) -> Point {
        self.scaled(&orbit.state, orbit.omega)
    }

    fn scaled(&self, state: &[f64], omega: f64) -> Point {
        Point { x: state.iter().zip(&self.scales).map(|(x, s)| x / s).collect(), w: omega / self.omega }
    }

    /// The orbit at a point.
    pub fn orbit(&self, point: &Point) -> Orbit {
        let state = point.x.iter().zip(&self.scales).map(|(x, s)| x * s).collect();
        Orbit { omega: point.w * self.omega, forcing: self.forcing, steps: self.steps, state }
    }

    /// Half width of the band of moduli round 1 in which a multiplier decides nothing at the orbit of a period.
    pub fn margin(&self, point: &Point, period: &Period) -> f64 {
        margin(self.model, point.w * self.omega, period.is_smooth)
    }

    /// The way from `a` to `b`, scaled state and w; what laws remember has no part in it.
    fn way(&self, a: &Point, b: &Point) -> Vec<f64> {
        let mut way: Vec<f64> = b.x.iter().zip(&a.x).map(|(b, a)| b - a).collect();
        way[self.motion..].fill(0.0);
        way.push(b.w - a.w);
        way
    }

    /// Its length.
    pub fn distance(&self, a: &Point, b: &Point) -> f64 {
        let way = self.way(a, b);
        dot(&way, &way).sqrt()
    }

    /// Unit normal of the plane across the way from `a` to `b`.
    pub fn across(&self, a: &Point, b: &Point) -> Option<Vec<f64>> {
        let mut normal = self.way(a, b);
        let length = dot(&normal, &normal).sqrt();
        normal.iter_mut().for_each(|entry| *entry /= length);
        (length > 0.0 && length.is_finite()).then_some(normal)
    }

    fn marching(&self, point: &Point) -> Result<Marching<'m>, MarchingError> {
        let mut marching = self.grid.beside(self.forcing, point.w * self.omega)?;
        marching.restart(&self.orbit(point).state)?;
        Ok(marching)
    }

    /// The scaled residual of a point.
    ///
    /// # Errors
    /// If the motion cannot be marched.
    pub(super) fn residual(&mut self, point: &Point) -> Result<Vec<f64>, MarchingError> {
        self.periods.1 += 1;
        let mut marching = self.marching(point)?;
        marching.walk(&mut |_| {})?;
        let end = self.scaled(&marching.state(), 1.0).x;
        Ok(end.iter().zip(&point.x).map(|(a, b)| a - b).collect())
    }

    /// The period from a point, with its tangent.
    ///
    /// # Errors
    /// If the motion cannot be marched.
    pub fn period(&mut self, point: &Point) -> Result<Period, MarchingError> {
        self.periods.0 += 1;
        let mut marching = self.marching(point)?;
        let stride = (self.steps / INSTANTS).max(1);
        let mut path = Vec::with_capacity(self.model.size() * (INSTANTS + 2));
        let mut amplitudes = vec![0.0f64; self.model.monitors().len()];
        let mut account = Account::default();
        let mut is_smooth = true;
        let mut sticks = marching.sliders();
        let monodromy = marching.walk_with_tangent(&mut |now| {
            if now.index().is_multiple_of(stride) {
                path.extend(now.modal());
            }
            vectorised(
                #[inline(always)]
                || {
                    for (i, largest) in amplitudes.iter_mut().enumerate() {
                        *largest = largest.max(now.monitored(i).abs());
                    }
                    now.balance(&mut account);
                },
            );
            is_smooth &= now.is_smooth();
            now.unmark(&mut sticks);
        })?;
        let end = self.scaled(&marching.state(), 1.0).x;
        let residual = end.iter().zip(&point.x).map(|(a, b)| a - b).collect();
        let offsets = marching.offsets(&self.orbit(point).state, &sticks);
        let offsets = offsets.iter().map(|offset| offset.scaled(&self.scales, self.omega)).collect();
        let scaled = |i: usize, j: usize| monodromy[(i, j)] * self.scales[j] / self.scales[i];
        let monodromy = Matrix::from_fn(point.x.len(), point.x.len(), scaled);
        Ok(Period { residual, monodromy, path, stride, amplitudes, account, is_smooth, offsets })
    }
}
