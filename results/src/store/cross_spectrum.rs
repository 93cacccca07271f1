//! What tells the motions of a branch from those of its images by a symmetry of the structure, which have the same frequencies: which dofs
//! move, and how they move with each other.

use super::levels::BranchRow;
use super::number::number;
use super::{Reader, Result};

/// The cross-spectral matrix of the motions of a branch, Σ_k X_k X_kᴴ over the harmonics of its dofs (the nonlinear and the monitored ones, m²),
/// mean over the frequencies that it passes: it depends neither on the phases of the motions nor on the steps along the branch, and is the
/// same for motions that are each other's mirror images half a period later.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CrossSpectrum {
    /// Real and imaginary parts of the entries, row by row.
    entries: Vec<[f64; 2]>,
}

impl CrossSpectrum {
    /// Of motions at frequencies `omega`, in the order of the arc: harmonics of displacements, points × dofs × (H + 1) × 2. `None` if they are
    /// not that many, or not finite.
    pub(crate) fn along(omega: &[f64], displacement: &[f64], dofs: usize, is_closed: bool) -> Option<Self> {
        let width = displacement.len().checked_div(omega.len() * dofs)?;
        let is_whole = width > 0 && width * omega.len() * dofs == displacement.len();
        if !is_whole || omega.iter().chain(displacement).any(|number| !number.is_finite()) {
            return None;
        }
        let count = omega.len();
        let step = |from: usize| {
            let is_last = from + 1 == count;
            if is_last && !is_closed { 0.0 } else { (omega[(from + 1) % count] - omega[from]).abs() }
        };
        let mut entries = vec![[0.0; 2]; dofs * dofs];
        let mut passed = 0.0;
        for (point, motion) in displacement.chunks(dofs * width).enumerate() {
            let weight = if count == 1 { 1.0 } else { 0.5 * (step(point) + step((point + count - 1) % count)) };
            passed += weight;
            add(&mut entries, motion, width, weight);
        }
        entries.iter_mut().flatten().for_each(|entry| *entry /= passed);
        (passed > 0.0).then_some(Self { entries })
    }

    /// ‖a − b‖ over the larger of the two norms: 0 of the same motions, and between 1 and √2 of such that have no dof in common.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let norm = |entries: &mut dyn Iterator<Item = f64>| entries.map(|entry| entry * entry).sum::<f64>().sqrt();
        let both = self.entries.iter().flatten().zip(other.entries.iter().flatten());
        let apart = norm(&mut both.map(|(a, b)| a - b));
        let [own, others] = [self, other].map(|one| norm(&mut one.entries.iter().flatten().copied()));
        apart / own.max(others)
    }
}

/// Adds the cross-spectral matrix of a motion: a series of `width` numbers for every dof.
fn add(entries: &mut [[f64; 2]], motion: &[f64], width: usize, weight: f64) {
    let dofs = motion.len() / width;
    for (i, a) in motion.chunks(width).enumerate() {
        for (j, b) in motion.chunks(width).enumerate() {
            let entry = &mut entries[i * dofs + j];
            for (x, y) in a.chunks(2).zip(b.chunks(2)) {
                entry[0] += weight * (x[0] * y[0] + x[1] * y[1]);
                entry[1] += weight * (x[1] * y[0] - x[0] * y[1]);
            }
        }
    }
}

impl Reader {
    /// The cross-spectral matrix of a branch; `None` if its motions are not there.
    pub(crate) fn cross_spectrum(&self, branch: &BranchRow) -> Result<Option<CrossSpectrum>> {
        let Some(array) = self.array(&branch.task, "displacement")? else { return Ok(None) };
        let sql = "SELECT omega FROM points WHERE branch = ?1 ORDER BY i";
        let omega: Vec<f64> = self.all(sql, [branch.id], |row| number(row, 0))?;
        let shape = array.shape.clone();
        let [_, dofs, ..] = shape[..] else { return Ok(None) };
        let values = array.values("displacement", &shape).map_err(|error| self.corrupt(error))?;
        Ok(CrossSpectrum::along(&omega, &values, dofs, branch.closed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Two dofs with one harmonic each, of these complex amplitudes, at so many frequencies.
    fn motions(amplitudes: [(f64, f64); 2], omega: &[f64]) -> CrossSpectrum {
        let series = |(size, phase): (f64, f64)| [0.0, 0.0, size * phase.cos(), size * phase.sin()];
        let motion = amplitudes.map(series).concat();
        let all: Vec<f64> = omega.iter().flat_map(|_| motion.clone()).collect();
        CrossSpectrum::along(omega, &all, 2, true).unwrap()
    }

    #[test]
    fn images_are_told_apart_and_phases_and_steps_do_not_count() {
        let steps: Vec<f64> = (0..40).map(|i| 1.0 + 0.1 * (TAU * f64::from(i) / 40.0).sin()).collect();
        let one = motions([(1.0, 0.0), (0.2, 0.5)], &steps);
        let later = motions([(1.0, 1.0), (0.2, 1.5)], &[0.9, 1.0, 1.1, 1.0]);
        assert!(one.distance(&later) < 1e-12);
        // The other dof moves more; and of the same sizes the other one is ahead.
        let mirrored = motions([(0.2, 0.5), (1.0, 0.0)], &steps);
        assert!(one.distance(&mirrored) > 0.5);
        let [ahead, behind] = [0.8, -0.8].map(|phase| motions([(1.0, 0.0), (1.0, phase)], &steps));
        assert!(ahead.distance(&behind) > 0.5);
        let apart = [motions([(1.0, 0.0), (0.0, 0.0)], &steps), motions([(0.0, 0.0), (1.0, 0.0)], &steps)];
        assert!((apart[0].distance(&apart[1]) - 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_motion_has_none() {
        assert_eq!(CrossSpectrum::along(&[], &[], 2, false), None);
        assert_eq!(CrossSpectrum::along(&[1.0], &[1.0, 2.0, 3.0], 2, false), None);
        assert_eq!(CrossSpectrum::along(&[1.0], &[f64::NAN, 0.0], 1, false), None);
    }
}
