//! A branch in numbers.

use super::scalars::Scalars;
use protocol::branch::BranchMessage;

/// A branch in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lowest frequency, rad/s.
    pub omega_min: f64,
    /// Highest frequency, rad/s.
    pub omega_max: f64,
    /// Largest amplitude of the first monitored dof, m.
    pub amplitude_max: f64,
    /// Frequency there, rad/s.
    pub omega_at_max: f64,
    /// Number of points; none where that is not known.
    pub points: usize,
}

impl Extent {
    /// Of a branch that was received; not numbers if it has no points or its arrays do not fit together.
    pub fn of(branch: &BranchMessage) -> Self {
        let nothing = [f64::NAN; 4];
        Scalars::new(&branch.points).map_or(Self::from(nothing), |points| Self::of_scalars(&points))
    }

    /// Of the points of a branch.
    pub(super) fn of_scalars(points: &Scalars) -> Self {
        let (low, high) = range(points.omega.iter().copied()).unwrap_or((f64::NAN, f64::NAN));
        let amplitude = points.get("amplitude");
        let peak = (0..amplitude.len()).max_by(|&a, &b| amplitude[a].total_cmp(&amplitude[b]));
        let (amplitude, omega) = peak.map_or((f64::NAN, f64::NAN), |i| (amplitude[i], points.omega[i]));
        Self {
            omega_min: low,
            omega_max: high,
            amplitude_max: amplitude,
            omega_at_max: omega,
            points: points.omega.len(),
        }
    }

    /// Whether range and peak agree to the relative `tolerance`. The frequency of the peak does not count: a flat
    /// peak has none that is sharp.
    pub fn agrees(&self, other: &Self, tolerance: f64) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= tolerance * a.abs().max(b.abs());
        close(self.omega_min, other.omega_min)
            && close(self.omega_max, other.omega_max)
            && close(self.amplitude_max, other.amplitude_max)
    }
}

impl From<[f64; 4]> for Extent {
    fn from([omega_min, omega_max, amplitude_max, omega_at_max]: [f64; 4]) -> Self {
        Self { omega_min, omega_max, amplitude_max, omega_at_max, points: 0 }
    }
}

/// Lowest and highest frequency at which any contact element touches; where that begins or ends, between two points, as far from the touching
/// ones as these suggest: the share of the period in contact is as the root of the distance from there.
pub(super) fn contact_range(points: &Scalars) -> Option<(f64, f64)> {
    let all: Vec<(f64, f64)> = points.omega.iter().copied().zip(points.get("contact").iter().copied()).collect();
    let begins = |[(free, none), (near, first), (far, second)]: [(f64, f64); 3]| {
        let begun = near - (far - near) * first * first / (second * second - first * first);
        (none == 0.0 && first > 0.0 && second > first).then(|| begun.clamp(free.min(near), free.max(near)))
    };
    let edges = all.windows(3).flat_map(|three| [[three[0], three[1], three[2]], [three[2], three[1], three[0]]]);
    let touching = all.iter().filter(|(_, contact)| *contact > 0.0).map(|(omega, _)| *omega);
    range(touching.chain(edges.filter_map(begins)))
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.map(|value| (value, value)).reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

#[cfg(test)]
mod tests {
    use super::super::scalars::Scalar;
    use super::*;
    use solver::response::columns::named;

    #[test]
    fn where_a_contact_begins_lies_between_points() {
        let range = |points: &[(f64, f64)]| {
            let (omega, values) = points.iter().copied().unzip();
            let columns = vec![Scalar { column: named("contact").unwrap(), values }];
            contact_range(&Scalars { omega, columns })
        };
        let touching = |omega: f64| (omega, f64::sqrt(omega - 1.0).min(f64::sqrt(3.0 - omega)) / 2.0);
        let free = |omega: f64| (omega, 0.0);
        let through =
            [free(0.9), touching(1.04), touching(1.1), touching(2.0), touching(2.9), touching(2.97), free(3.01)];
        let (low, high) = range(&through).unwrap();
        assert!((low - 1.0).abs() < 1e-12 && (high - 3.0).abs() < 1e-12, "{low} {high}");
        // No farther than the point that does not touch.
        let (low, _) = range(&[free(1.03), (1.04, 0.2), (1.1, 0.21), (1.2, 0.3)]).unwrap();
        assert_eq!(low, 1.03);
        // Of an isolated point nothing more is known.
        assert_eq!(range(&[free(0.9), touching(1.1), free(1.2)]), Some((1.1, 1.1)));
        assert_eq!(range(&[free(0.9), free(1.2)]), None);
    }
}
