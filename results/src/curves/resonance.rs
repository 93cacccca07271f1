//! Frequency and amplitude of the largest response over the forcing amplitude, three ways.

use super::backbone::BackboneCurve;
use crate::overview::{BranchRow, Level};

/// The largest response over A: by continuation of the main branch alone, by the energy balance along the backbone
/// alone, and over all branches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResonanceComparison {
    /// Peaks of the main branches, one for each level that has one.
    pub continuation: Resonance,
    /// Largest amplitude of the backbones where A exceeds the threshold.
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
    /// Which of them are known only as far as their branch is: the response may be larger.
    pub at_least: Vec<usize>,
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
            curve.at_least.extend((!branch.at_least().is_empty()).then_some(curve.value.len()));
            curve.push(level.value, branch.omega_at_max, branch.amplitude_max);
        }
        curve
    }

    /// Up to A = `limit`, or to where the backbone ends before. Where a window is born with a larger response than any before, the curve
    /// steps.
    fn of_balance(backbone: &BackboneCurve, limit: f64) -> Self {
        let (threshold, omega) = (&backbone.threshold.values, &backbone.omega.values);
        let amplitude = &backbone.amplitude[0].values;
        let is_known = |&i: &usize| threshold[i] <= limit && !amplitude[i].is_nan();
        let mut order: Vec<usize> = (0..threshold.len()).filter(is_known).collect();
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
        let Some(best) = best else { return curve };
        // Towards a larger amplitude the threshold passes the limit between two points; at the end nothing is known beyond.
        let beside = [best.checked_sub(1), Some(best + 1).filter(|&i| i < threshold.len())];
        let next = beside.into_iter().flatten().find(|&i| amplitude[i] > amplitude[best] && threshold[i] > limit);
        if let Some(next) = next.filter(|&i| threshold[i].is_finite()) {
            let share = (limit - threshold[best]) / (threshold[next] - threshold[best]);
            let between = |column: &[f64]| column[best] + share * (column[next] - column[best]);
            curve.push(limit, between(omega), between(amplitude));
        } else if backbone.pieces.iter().all(|piece| piece.points.end != best + 1) {
            curve.push(limit, omega[best], amplitude[best]);
        }
        curve
    }

    /// Frequency and amplitude at a forcing amplitude, where the curve has one; the later ones where it steps.
    fn at(&self, value: f64) -> Option<(f64, f64)> {
        let after = self.value.partition_point(|known| *known <= value);
        let before = after.checked_sub(1)?;
        let Some(&next) = self.value.get(after) else {
            return (self.value[before] == value).then(|| (self.omega[before], self.amplitude[before]));
        };
        let share = (value - self.value[before]) / (next - self.value[before]);
        let between = |column: &[f64]| column[before] + share * (column[after] - column[before]);
        Some((between(&self.omega), between(&self.amplitude)))
    }

    /// The largest of several curves; from one to another it steps.
    fn largest(curves: &[Self]) -> Self {
        let mut values: Vec<f64> = curves.iter().flat_map(|curve| curve.value.iter().copied()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let mut all = Self::default();
        let mut last: Option<usize> = None;
        for value in values {
            let of = |k: usize| Some((k, curves[k].at(value)?));
            // Those that go on beyond it, if there are any.
            let goes_on = |k: &usize| curves[*k].value.last().is_some_and(|last| *last > value);
            let on: Vec<usize> = (0..curves.len()).filter(goes_on).collect();
            let among: Vec<usize> = if on.iter().any(|&k| of(k).is_some()) { on } else { (0..curves.len()).collect() };
            let largest = among.into_iter().filter_map(of).max_by(|a, b| a.1.1.total_cmp(&b.1.1));
            let Some((k, (omega, amplitude))) = largest else { continue };
            // What was largest up to here, then what is from here on; also where one curve steps.
            let own = curves[last.unwrap_or(k)].before(value);
            if let Some((omega, amplitude)) = own {
                all.push(value, omega, amplitude);
            }
            if own != Some((omega, amplitude)) {
                all.push(value, omega, amplitude);
            }
            last = Some(k);
        }
        all
    }

    /// As [`at`](Self::at), but the earlier ones where the curve steps.
    fn before(&self, value: f64) -> Option<(f64, f64)> {
        let first = self.value.partition_point(|known| *known < value);
        match self.value.get(first) {
            Some(known) if *known == value && first > 0 => Some((self.omega[first], self.amplitude[first])),
            _ if first > 0 => self.at(value),
            _ => None,
        }
    }
}

impl ResonanceComparison {
    /// Of the levels of a run and the backbones that are known.
    pub fn new<'b>(levels: &[Level], backbones: impl Iterator<Item = &'b BackboneCurve>) -> Self {
        let highest = levels.iter().map(|level| level.value).fold(0.0, f64::max);
        Self {
            continuation: Resonance::of_branches(levels, Level::main),
            balance: Resonance::largest(&backbones.map(|one| Resonance::of_balance(one, highest)).collect::<Vec<_>>()),
            isolas: Resonance::of_branches(levels, Level::peak),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Resonance {
        let mut curve = Resonance::default();
        points.iter().for_each(|&(value, amplitude)| curve.push(value, 10.0 * amplitude, amplitude));
        curve
    }

    #[test]
    fn one_curve_stays_as_it_is() {
        let one = curve(&[(1.0, 1.0), (2.0, 2.0), (3.0, 2.5), (3.0, 4.0), (5.0, 5.0)]);
        assert_eq!(Resonance::largest(std::slice::from_ref(&one)), one);
        assert_eq!(Resonance::largest(&[]), Resonance::default());
    }

    #[test]
    fn where_the_larger_one_ends_the_other_goes_on() {
        let largest =
            Resonance::largest(&[curve(&[(1.0, 1.0), (3.0, 5.0)]), curve(&[(1.0, 0.5), (2.0, 0.6), (10.0, 2.2)])]);
        assert_eq!(largest.value, [1.0, 2.0, 3.0, 3.0, 10.0]);
        assert_eq!(largest.amplitude, [1.0, 3.0, 5.0, 0.8, 2.2]);
    }

    #[test]
    fn the_larger_of_two_leads() {
        // The second one begins later, overtakes between its points and those of the first, and the first steps over it again.
        let first = curve(&[(1.0, 1.0), (3.0, 2.0), (4.0, 2.5), (4.0, 8.0), (5.0, 8.5)]);
        let second = curve(&[(2.0, 1.0), (3.0, 3.0), (5.0, 5.0)]);
        let largest = Resonance::largest(&[first, second]);
        assert_eq!(largest.value, [1.0, 2.0, 3.0, 3.0, 4.0, 4.0, 5.0]);
        assert_eq!(largest.amplitude, [1.0, 1.5, 2.0, 3.0, 4.0, 8.0, 8.5]);
        let omega: Vec<f64> = largest.amplitude.iter().map(|amplitude| 10.0 * amplitude).collect();
        assert_eq!(largest.omega, omega);
    }
}
