//! Whether a stable orbit is left by next to no push: beside a fold the unstable orbit, from which motions go elsewhere, is as
//! near as one likes.

use super::multipliers::Multiplier;
use super::shooting::{Period, Point, Shooting};
use crate::linalg::{Lu, Matrix, dot};

/// A push of this share of the motion's size, in all modes at once.
const PUSH: f64 = 1e-4;

/// It is looked at where a real multiplier is nearer to 1 than this.
const NEARLY: f64 = 0.02;

/// Steps along the leading direction by which the map is found to be curved, in shares of the motion's size.
const STEP: f64 = 1e-3;

/// How far a multiplier is missed by inverse iteration, and its steps.
const SHIFT: f64 = 1e-8;
const ITERATIONS: usize = 3;

/// The unstable orbit counts as within reach if it is this many times as far as a push leads.
const SAFETY: f64 = 2.0;

/// Whether the orbit at a point, all of whose multipliers are inside the unit circle, has an unstable one within reach of a small
/// push: to second order along the direction of the real multiplier next to 1, where folds come from. Two periods more; false where
/// that cannot be told.
pub(super) fn is_left_by_a_push(
    shooting: &mut Shooting<'_>,
    at: &Point,
    period: &Period,
    multipliers: &[Multiplier],
) -> bool {
    let real = multipliers.iter().filter(|multiplier| multiplier.is_real()).map(|multiplier| multiplier.re);
    let leading = real.fold(0.0, f64::max);
    if leading < 1.0 - NEARLY || !period.offsets.is_empty() {
        return false;
    }
    apart(shooting, at, period, leading).is_some_and(|(apart, push)| apart < SAFETY * push)
}

/// How far the unstable orbit is along the direction of a multiplier, and how far a push leads.
fn apart(shooting: &mut Shooting<'_>, at: &Point, period: &Period, multiplier: f64) -> Option<(f64, f64)> {
    let [direction, mut form] = eigenvectors(&period.monodromy, multiplier)?;
    let scale = dot(&form, &direction);
    form.iter_mut().for_each(|entry| *entry /= scale);
    let mut moved = |by: f64| {
        let x = at.x.iter().zip(&direction).map(|(x, d)| x + by * d).collect();
        Some(dot(&form, &shooting.residual(&Point { x, w: at.w }).ok()?))
    };
    let (ahead, behind) = (moved(STEP)?, moved(-STEP)?);
    let curvature = (0.5 * (ahead + behind) - dot(&form, &period.residual)) / (STEP * STEP);
    let apart = ((1.0 - multiplier) / curvature).abs();
    let push = PUSH * form.iter().map(|entry| entry.abs()).sum::<f64>();
    (push.is_finite() && !apart.is_nan()).then_some((apart, push))
}

/// Unit right and left eigenvectors of a real eigenvalue, by inverse iteration.
fn eigenvectors(matrix: &Matrix, eigenvalue: f64) -> Option<[Vec<f64>; 2]> {
    let n = matrix.rows();
    let mut lu = Lu::default();
    let target = lu.reset(n);
    for i in 0..n {
        target[i * n..(i + 1) * n].copy_from_slice(matrix.row(i));
        target[i * n + i] -= eigenvalue + SHIFT;
    }
    lu.factor().ok()?;
    let mut found = [vec![1.0; n], vec![1.0; n]];
    for _ in 0..ITERATIONS {
        lu.solve(&mut found[0]);
        lu.solve_transposed(&mut found[1]);
        for vector in &mut found {
            let length = dot(vector, vector).sqrt();
            vector.iter_mut().for_each(|x| *x /= length);
        }
    }
    found.iter().flatten().all(|x| x.is_finite()).then_some(found)
}
