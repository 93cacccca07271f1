//! Frequency and amplitude of the largest response over the forcing amplitude, three ways.

use super::backbone::BackboneCurve;
use crate::overview::{BranchRow, Level};

/// The largest response over A: by continuation of the main branch alone, by the energy balance along the backbone
/// alone, and over all branches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResonanceComparison {
    /// Peaks of the main branches, one for each level that has one.
    pub continuation: Resonance,
    /// Largest amplitude of the backbone where A exceeds the threshold.
    pub balance: Resonance,
    /// Largest peak over main branch and isolas, one for each level that has a branch.
    pub isolas: Resonance,
}

/// A curve over the forcing amplitude, of the first monitored dof.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Resonance {
    /// Forcing amplitude A.
    pub value: Vec<f64>,
    /// Frequency of the largest response, rad/s.
    pub omega: Vec<f64>,
    /// Its amplitude, m.
    pub amplitude: Vec<f64>,
}

impl Resonance {
    fn push(&mut self, value: f64, omega: f64, amplitude: f64) {
        self.value.push(value);
        self.omega.push(omega);
        self.amplitude.push(amplitude);
    }

    fn of_branches<'l>(levels: &'l [Level], pick: impl Fn(&'l Level) -> Option<&'l BranchRow>) -> Self {
        let mut curve = Self::default();
        for (level, branch) in levels.iter().filter_map(|level| Some((level, pick(level)?))) {
            curve.push(level.value, branch.omega_at_max, branch.amplitude_max);
        }
        curve
    }

    /// Up to A = `limit`. Where a window is born with a larger response than any before, the curve steps.
    fn of_balance(backbone: &BackboneCurve, limit: f64) -> Self {
        let (threshold, omega) = (&backbone.threshold.values, &backbone.omega.values);
        let amplitude = &backbone.amplitude[0].values;
        let mut order: Vec<usize> = (0..threshold.len()).filter(|&i| threshold[i] <= limit).collect();
        order.sort_by(|&i, &j| threshold[i].total_cmp(&threshold[j]));
        let mut curve = Self::default();
        let mut best: Option<usize> = None;
        for i in order {
            match best {
                Some(best) if amplitude[i] <= amplitude[best] => continue,
                Some(before) if before.abs_diff(i) > 1 => curve.push(threshold[i], omega[before], amplitude[before]),
                _ => {}
            }
            curve.push(threshold[i], omega[i], amplitude[i]);
            best = Some(i);
        }
        if let Some(best) = best {
            curve.push(limit, omega[best], amplitude[best]);
        }
        curve
    }
}

impl ResonanceComparison {
    /// Of the levels of a run and its backbone, if that is known.
    pub fn new(levels: &[Level], backbone: Option<&BackboneCurve>) -> Self {
        let highest = levels.iter().map(|level| level.value).fold(0.0, f64::max);
        Self {
            continuation: Resonance::of_branches(levels, Level::main),
            balance: backbone.map(|backbone| Resonance::of_balance(backbone, highest)).unwrap_or_default(),
            isolas: Resonance::of_branches(levels, Level::peak),
        }
    }
}
