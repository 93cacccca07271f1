//! The branches known at a forcing level.

use crate::balance::Balance;
use crate::images::{Image, images};
use crate::quadrature::norm;
use crate::walk::{Bounds, Curve, branch, distance, passes};

/// Branches, and what leads to more.
#[derive(Debug)]
pub struct Known<'b, 's> {
    balance: &'b Balance<'s>,
    images: Vec<Image>,
    bounds: Bounds,
    /// The branches, each with the number of converged responses that were found to lie on it.
    pub curves: Vec<(Curve, usize)>,
}

/// Segments of a branch, the nearest ones, that a response is compared with.
const NEAREST: usize = 3;

impl<'b, 's> Known<'b, 's> {
    /// None yet.
    pub fn new(balance: &'b Balance<'s>, bounds: Bounds) -> Self {
        Self { balance, images: images(balance), bounds, curves: Vec::new() }
    }

    /// Takes up the branch through a converged response, unless it is known.
    pub fn add(&mut self, y: &[f64], tangent: &[f64]) {
        if let Some(at) = self.find(y) {
            self.curves[at].1 += 1;
            return;
        }
        let curve = branch(self.balance, y, tangent, &self.bounds);
        // Where two sheets are near, a point may not be recognised on the branch that has it; the branch as a whole is.
        match self.curves.iter().position(|(known, _)| is_same(self.balance, known, &curve)) {
            Some(at) => self.curves[at].1 += 1,
            None => self.curves.push((curve, 1)),
        }
    }

    /// The branch that has a response or an image of it.
    fn find(&self, y: &[f64]) -> Option<usize> {
        let images: Vec<Vec<f64>> = self.images.iter().map(|image| image.of(self.balance, y)).collect();
        self.curves.iter().position(|(curve, _)| images.iter().any(|y| self.has(curve, y)))
    }

    fn has(&self, curve: &Curve, y: &[f64]) -> bool {
        let points = &curve.points;
        let last = if curve.is_closed() { points.len() } else { points.len() - 1 };
        let mut segments: Vec<(f64, usize)> = (0..last)
            .map(|i| {
                let (from, to) = (&points[i], &points[(i + 1) % points.len()]);
                (distance(from, y).min(distance(to, y)), i)
            })
            .collect();
        let nearest = NEAREST.min(segments.len());
        if nearest == 0 {
            return false;
        }
        segments.select_nth_unstable_by(nearest - 1, |a, b| a.0.total_cmp(&b.0));
        segments[..nearest].iter().any(|&(_, i)| {
            let (from, to) = (&points[i], &points[(i + 1) % points.len()]);
            let chord: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
            let length = norm(&chord);
            let share =
                chord.iter().zip(y.iter().zip(from)).map(|(c, (y, f))| c * (y - f)).sum::<f64>() / (length * length);
            let normal: Vec<f64> = chord.iter().map(|c| c / length).collect();
            (-0.5..=1.5).contains(&share) && passes(self.balance, y, &normal, from, to, share)
        })
    }
}

/// Whether two closed branches are images of each other: frequencies and motions of the same extent.
fn is_same(balance: &Balance, a: &Curve, b: &Curve) -> bool {
    if !(a.is_closed() && b.is_closed()) {
        return false;
    }
    let (a, b) = (Extent::of(balance, &a.points), Extent::of(balance, &b.points));
    let near = |a: f64, b: f64| (a - b).abs() < 1e-5 * b;
    near(a.omega.0, b.omega.0) && near(a.omega.1, b.omega.1) && near(a.peak.1, b.peak.1)
}

/// Where a branch lies.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Lowest and highest frequency, rad/s.
    pub omega: (f64, f64),
    /// Frequency in rad/s and size in m of the largest amplitude of the monitored dof.
    pub peak: (f64, f64),
    /// The point nearest to it.
    pub at: usize,
}

impl Extent {
    /// Of a branch with these points.
    pub fn of(balance: &Balance, points: &[Vec<f64>]) -> Self {
        let size = balance.size();
        let omegas: Vec<f64> = points.iter().map(|y| y[size]).collect();
        let amplitudes: Vec<f64> = points.iter().map(|y| amplitude(balance, y)).collect();
        let largest = |values: &[f64]| (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0);
        let negative: Vec<f64> = omegas.iter().map(|omega| -omega).collect();
        let at = largest(&amplitudes);
        let omega = (-vertex(points, &negative, largest(&negative)), vertex(points, &omegas, largest(&omegas)));
        Self { omega, peak: (omegas[at], vertex(points, &amplitudes, at)), at }
    }
}

/// The extremum of the parabola through a point and its neighbours.
fn vertex(points: &[Vec<f64>], values: &[f64], at: usize) -> f64 {
    if at == 0 || at + 1 >= points.len() {
        return values[at];
    }
    let (before, after) = (distance(&points[at], &points[at - 1]), distance(&points[at + 1], &points[at]));
    let (fall, rise) = ((values[at] - values[at - 1]) / before, (values[at + 1] - values[at]) / after);
    let curvature = (rise - fall) / (before + after);
    let slope = (fall * after + rise * before) / (before + after);
    if curvature < 0.0 { values[at] - slope * slope / (4.0 * curvature) } else { values[at] }
}

/// Largest displacement of the monitored dof over a period, m.
pub fn amplitude(balance: &Balance, y: &[f64]) -> f64 {
    let width = balance.width();
    let monitor = balance.structure.monitor;
    balance.largest(&y[monitor * width..(monitor + 1) * width])
}
