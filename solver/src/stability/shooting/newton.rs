//! Newton's method on the map of a period.
//!
//! A period with its tangent costs about six without. Near an orbit the tangent of the last point therefore serves for further
//! steps, and where the last step had to be shortened the next one is tried without a tangent first.

use super::{Period, Point, Shooting};
use crate::linalg::dot;
use std::cmp::Ordering;

/// Largest scaled residual of an orbit: rounding of thousands of steps is far below, what matters far above.
const TOLERANCE: f64 = 1e-9;

/// Scaled residual from which on a point is close to its orbit: an old tangent serves there, as long as the residual falls by
/// [`FALL`] with each step.
const CLOSE: f64 = 1e-3;

/// See [`CLOSE`].
const FALL: f64 = 0.1;

/// Most steps with one tangent.
const CHORDS: usize = 6;

/// Relative step of ω for the derivative of the map.
const NUDGE: f64 = 1e-6;

/// How Newton's method is led.
pub struct NewtonOptions<'w> {
    /// Normal of the plane that it stays in, scaled state and w; at fixed ω without.
    pub plane: Option<&'w [f64]>,
    /// Whether steps are shortened until the residual falls.
    pub searches: bool,
    /// Most iterations.
    pub iterations: usize,
}

/// Where a step has led.
struct Taken {
    at: Point,
    period: Period,
    is_shortened: bool,
}

impl Shooting<'_> {
    /// Newton's method from a point; the orbit's point and its last period, if it comes to one.
    pub fn solve(&mut self, start: &Point, options: &NewtonOptions<'_>) -> Option<(Point, Period)> {
        let period = self.period(start).ok()?;
        self.iterate(Taken { at: start.clone(), period, is_shortened: false }, options)
    }

    /// The same near an orbit with the period `near`: where the point is close to its own orbit already and steps with that tangent
    /// lead to it, only the last period is marched with a tangent.
    pub fn solve_near(&mut self, start: &Point, near: &Period, options: &NewtonOptions<'_>) -> Option<(Point, Period)> {
        match self.approach(start, near, options.plane).and_then(|at| Some((self.period(&at).ok()?, at))) {
            Some((period, at)) => self.iterate(Taken { at, period, is_shortened: false }, options),
            None => self.solve(start, options),
        }
    }

    /// How near steps with the tangent of another period lead to an orbit, from a point that is close to it.
    fn approach(&mut self, start: &Point, near: &Period, plane: Option<&[f64]>) -> Option<Point> {
        let residual = self.residual(start).ok()?;
        let error = largest(&residual);
        // What is not a number is not close.
        if !matches!(error.partial_cmp(&CLOSE), Some(Ordering::Less)) {
            return None;
        }
        let slope = if plane.is_some() { self.slope(start, &residual)? } else { vec![0.0; start.x.len()] };
        self.factor(near, &slope, plane)?;
        let step = self.step(near, &residual)?;
        self.close_in(start, error, near, &step)
    }

    fn iterate(&mut self, mut now: Taken, options: &NewtonOptions<'_>) -> Option<(Point, Period)> {
        for _ in 0..options.iterations {
            let error = now.period.error();
            if error < TOLERANCE {
                break;
            }
            let step = self.newton_step(&now.at, &now.period, options.plane)?;
            let close = if error < CLOSE { self.close_in(&now.at, error, &now.period, &step) } else { None };
            now = match close {
                Some(at) => Taken { period: self.period(&at).ok()?, at, is_shortened: false },
                None => self.take(&now, &step, options.searches)?,
            };
        }
        (now.period.error() < TOLERANCE).then_some((now.at, now.period))
    }

    /// The step to the zero of the linearised residual, in the plane or at fixed ω: scaled state, then w.
    fn newton_step(&mut self, at: &Point, period: &Period, plane: Option<&[f64]>) -> Option<Vec<f64>> {
        let slope = if plane.is_some() { self.slope(at, &period.residual)? } else { vec![0.0; at.x.len()] };
        self.factor(period, &slope, plane)?;
        self.step(period, &period.residual)
    }

    /// How far the branch goes on across the plane of this normal while w grows by 1: it changes sign through infinity
    /// where the branch turns in frequency.
    pub fn advance(&mut self, at: &Point, period: &Period, normal: &[f64]) -> Option<f64> {
        let slope = self.central_slope(at)?;
        self.factor(period, &slope, None)?;
        let mut way = vec![0.0; slope.len()];
        way.push(1.0);
        self.solve_bordered(period, &mut way)?;
        Some(dot(&way, normal))
    }

    /// Factorises [Φ − I, slope; row] with the normal of the plane as its row, or that of fixed w. In the row of a slider that sticks
    /// all the time, where this is singular, the offset stays as it is.
    fn factor(&mut self, period: &Period, slope: &[f64], plane: Option<&[f64]>) -> Option<()> {
        let n = slope.len();
        let matrix = self.lu.reset(n + 1);
        for i in 0..n {
            let target = &mut matrix[i * (n + 1)..(i + 1) * (n + 1)];
            target[..n].copy_from_slice(period.monodromy.row(i));
            target[i] -= 1.0;
            target[n] = slope[i];
        }
        for offset in &period.offsets {
            matrix[offset.force * (n + 1)..][..=n].copy_from_slice(&offset.form);
        }
        let last = &mut matrix[n * (n + 1)..];
        match plane {
            Some(normal) => last.copy_from_slice(normal),
            None => last[n] = 1.0,
        }
        self.lu.factor().ok()
    }

    /// Solves with the matrix that was factorised last, of this period, in place.
    fn solve_bordered(&mut self, period: &Period, b: &mut [f64]) -> Option<()> {
        period.offsets.iter().for_each(|offset| b[offset.force] = 0.0);
        self.lu.solve(b);
        b.iter().all(|entry| entry.is_finite()).then_some(())
    }

    /// The step that takes away this residual by the matrix that was factorised last, of this period: scaled state, then w.
    fn step(&mut self, period: &Period, residual: &[f64]) -> Option<Vec<f64>> {
        let mut step: Vec<f64> = residual.iter().map(|r| -r).chain([0.0]).collect();
        self.solve_bordered(period, &mut step)?;
        Some(step)
    }

    /// Derivative of the scaled map by w, by a difference: what it errs by, Newton's method makes good.
    fn slope(&mut self, at: &Point, residual: &[f64]) -> Option<Vec<f64>> {
        let after = self.residual(&Point { x: at.x.clone(), w: at.w + NUDGE }).ok()?;
        Some(after.iter().zip(residual).map(|(a, b)| (a - b) / NUDGE).collect())
    }

    /// The same by a central difference, where nothing makes good what it errs by.
    fn central_slope(&mut self, at: &Point) -> Option<Vec<f64>> {
        let mut beside = |by: f64| self.residual(&Point { x: at.x.clone(), w: at.w + by }).ok();
        let (after, before) = (beside(NUDGE)?, beside(-NUDGE)?);
        Some(after.iter().zip(&before).map(|(a, b)| (a - b) / (2.0 * NUDGE)).collect())
    }

    /// The step, and further ones with the same tangent, as far as the residual falls with each; `None` if it does not with the first.
    fn close_in(&mut self, from: &Point, error: f64, period: &Period, step: &[f64]) -> Option<Point> {
        let mut reached = None;
        let mut before = error;
        let mut to = from.moved(step, 1.0);
        for _ in 0..CHORDS {
            if !to.is_sound() {
                break;
            }
            let Ok(residual) = self.residual(&to) else { break };
            let error = largest(&residual);
            if error.is_nan() || error > FALL * before {
                break;
            }
            reached = Some(to.clone());
            if error < TOLERANCE {
                break;
            }
            let Some(step) = self.step(period, &residual) else { break };
            to = to.moved(&step, 1.0);
            before = error;
        }
        reached
    }

    /// The point at the end of a step, or of a part of it that lessens the residual.
    fn take(&mut self, now: &Taken, step: &[f64], searches: bool) -> Option<Taken> {
        let size = |r: &[f64]| dot(r, r).sqrt();
        let before = size(&now.period.residual);
        let full = now.at.moved(step, 1.0);
        if !searches {
            let period = if full.is_sound() { self.period(&full).ok()? } else { return None };
            return Some(Taken { at: full, period, is_shortened: false });
        }
        // Where the last step was too long this one may well be.
        let lessens = |shooting: &mut Self, point: &Point, share: f64| {
            point.is_sound() && shooting.residual(point).is_ok_and(|r| size(&r) < (1.0 - 0.1 * share) * before)
        };
        let is_likely = full.is_sound() && (!now.is_shortened || lessens(self, &full, 1.0));
        let period = if is_likely { self.period(&full).ok() } else { None };
        if let Some(period) = period.filter(|period| size(&period.residual) < 0.9 * before) {
            return Some(Taken { at: full, period, is_shortened: false });
        }
        for halvings in 1..=4 {
            let share = 0.5f64.powi(halvings);
            let at = now.at.moved(step, share);
            if lessens(self, &at, share) {
                let period = self.period(&at).ok()?;
                return Some(Taken { at, period, is_shortened: true });
            }
        }
        None
    }
}

impl Point {
    /// A point far off its orbit is of no use, and may not be marchable at all.
    fn is_sound(&self) -> bool {
        self.w > 0.5 && self.w < 2.0 && self.x.iter().all(|x| x.abs() < 1e3)
    }

    /// The point at a share of a step: scaled state, then w.
    fn moved(&self, step: &[f64], share: f64) -> Self {
        let (motion, turn) = step.split_at(self.x.len());
        let x = self.x.iter().zip(motion).map(|(x, s)| x + share * s).collect();
        Self { x, w: self.w + share * turn[0] }
    }
}

/// Largest modulus; not a number if one of them is not.
pub(super) fn largest(residual: &[f64]) -> f64 {
    residual.iter().fold(0.0, |m: f64, r| if m.is_nan() || r.abs() <= m { m } else { r.abs() })
}
