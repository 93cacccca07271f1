//! Branches by pseudo-arclength continuation, to their ends or until they close.

use crate::balance::Balance;
use crate::newton::onto_plane;
use crate::quadrature::{dot, norm};
use crate::structure::Structure;

/// Largest motion of a walk, m.
pub const SIZE: f64 = 300.0;

/// Where a walk ends in any case.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Lowest and highest frequency, rad/s.
    pub omega: (f64, f64),
    /// Largest norm of the motion, m.
    pub size: f64,
    /// Most points of a walk.
    pub points: usize,
}

/// How a walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// It came back to its first point, in the same direction.
    Closed,
    /// Below the lowest frequency.
    Below,
    /// Above the highest frequency.
    Above,
    /// At the largest motion, the shortest step, or the last point: it goes on.
    Unfinished,
}

/// A branch: points y one after the other, and how it ends at both sides.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Unknowns of the balance, frequency last.
    pub points: Vec<Vec<f64>>,
    /// The ends, the first point's first.
    pub ends: (End, End),
}

impl Curve {
    /// Whether it is closed.
    pub fn is_closed(&self) -> bool {
        self.ends.1 == End::Closed
    }
}

/// Shortest and longest step, and the least cosine between tangents and steps.
const STEP: (f64, f64) = (1e-8, 0.05);
const COSINE: f64 = 0.98;

/// Largest share by which a motion changes in a step.
const CHANGE: f64 = 0.1;

/// Of a resonance, and of the distance to one, the share that a step may pass in frequency: none is stepped over.
const NARROW: (f64, f64) = (0.7, 0.35);

/// Distance from the first point, of the motion, at which a curve has closed.
const CLOSED: f64 = 1e-6;

/// The whole branch through a converged point.
pub fn branch(balance: &Balance, start: &[f64], tangent: &[f64], bounds: &Bounds) -> Curve {
    let (forward, end) = walk(balance, start, tangent, bounds);
    if end == End::Closed {
        return Curve { points: forward, ends: (end, end) };
    }
    let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
    let (mut points, begin) = walk(balance, start, &back, bounds);
    points.reverse();
    points.extend(forward.into_iter().skip(1));
    Curve { points, ends: (begin, end) }
}

/// Points from a converged one on, in the direction of a tangent.
pub fn walk(balance: &Balance, start: &[f64], tangent: &[f64], bounds: &Bounds) -> (Vec<Vec<f64>>, End) {
    let size = balance.size();
    let mut points = vec![start.to_vec()];
    let mut direction = tangent.to_vec();
    let mut step = 1e-3 * norm(&start[..size]).clamp(1e-3, 1.0);
    loop {
        let here = points.last().expect("there is a first point").clone();
        let limit = longest(balance.structure, &here, &direction, size);
        step = step.min(limit);
        let predicted: Vec<f64> = here.iter().zip(&direction).map(|(y, t)| y + step * t).collect();
        let mut next = predicted.clone();
        let converged = onto_plane(balance, &mut next, &direction, &predicted);
        let Some((steps, turned)) = converged.filter(|(_, turned)| is_smooth(&here, &next, &direction, turned, size))
        else {
            step *= 0.4;
            if step < STEP.0 {
                return (points, End::Unfinished);
            }
            continue;
        };
        if points.len() > 2 && closes(balance, start, tangent, &here, &next) {
            return (points, End::Closed);
        }
        let (omega, motion) = (next[size], norm(&next[..size]));
        points.push(next);
        direction = turned;
        if omega < bounds.omega.0 {
            return (points, End::Below);
        }
        if omega > bounds.omega.1 {
            return (points, End::Above);
        }
        if motion > bounds.size || points.len() >= bounds.points {
            return (points, End::Unfinished);
        }
        step *= if steps <= 3 { 1.5 } else { 0.8 };
    }
}

/// The longest step that neither changes the motion much nor passes over a resonance of the linear structure.
fn longest(structure: &Structure, y: &[f64], direction: &[f64], size: usize) -> f64 {
    let motion = CHANGE * norm(&y[..size]) / norm(&direction[..size]).max(1e-300);
    let width = size / structure.size();
    let omega = y[size];
    let resonances = structure.frequencies.iter().flat_map(|omega_j| (1..=width / 2).map(move |k| omega_j / k as f64));
    let narrow = resonances.map(|at| (NARROW.0 * structure.ratio * at).max(NARROW.1 * (omega - at).abs()));
    let frequency = narrow.fold(f64::INFINITY, f64::min) / direction[size].abs().max(1e-300);
    motion.min(frequency).min(STEP.1)
}

/// Whether a step turned little, and did not change the motion more than it should.
fn is_smooth(here: &[f64], next: &[f64], before: &[f64], after: &[f64], size: usize) -> bool {
    let chord: Vec<f64> = next.iter().zip(here).map(|(next, here)| next - here).collect();
    let length = norm(&chord).max(1e-300);
    dot(before, after) > COSINE
        && dot(&chord, before) > COSINE * length
        && norm(&chord[..size]) < 2.0 * CHANGE * norm(&here[..size])
}

/// Whether a curve passes through its first point between two others.
fn closes(balance: &Balance, start: &[f64], tangent: &[f64], here: &[f64], next: &[f64]) -> bool {
    let beyond = |y: &[f64]| -> f64 { tangent.iter().zip(y.iter().zip(start)).map(|(t, (y, s))| t * (y - s)).sum() };
    let (before, after) = (beyond(here), beyond(next));
    if !(before < 0.0 && after >= 0.0) {
        return false;
    }
    passes(balance, start, tangent, here, next, before / (before - after))
}

/// Whether a curve passes, at this share of the way between two of its points, through a converged one with this normal.
pub fn passes(balance: &Balance, point: &[f64], normal: &[f64], from: &[f64], to: &[f64], share: f64) -> bool {
    let mut y: Vec<f64> = from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect();
    let chord = distance(from, to);
    if distance(&y, point) > 0.5 * chord {
        return false;
    }
    onto_plane(balance, &mut y, normal, point).is_some() && distance(&y, point) < CLOSED * norm(point)
}

/// Euclidean distance.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
