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

/// Lowest and highest frequency at which any contact element touches at a point.
pub(super) fn contact_range(points: &Scalars) -> Option<(f64, f64)> {
    let all = points.omega.iter().copied().zip(points.get("contact").iter().copied());
    range(all.filter(|(_, contact)| *contact > 0.0).map(|(omega, _)| omega))
}

fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.map(|value| (value, value)).reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}
