//! Sliders that stick all the time: what they keep.
//!
//! A slider with stiffness k that does not slip in a period has the same offset c = f − k u at its end as at its begin, whatever
//! the motion: the map of the period has a multiplier 1 that says nothing of stability, only that the slider could rest
//! elsewhere. The other multipliers are those of motions with this offset.

use super::{Marching, dot};
use crate::linalg::Matrix;
use std::f64::consts::TAU;

/// The offset c = f − k u of a slider as a linear form: its derivative by the numbers of the state, then by the frequency.
pub struct Offset {
    /// Number of the slider's force in the state.
    pub force: usize,
    /// Derivatives, in the units of the state; by that of the force it is 1.
    pub form: Vec<f64>,
}

impl Offset {
    /// The same for numbers over their scales, and frequency over its own.
    pub fn scaled(&self, scales: &[f64], omega: f64) -> Self {
        let scale = scales[self.force];
        let form = self.form.iter().zip(scales.iter().chain([&omega])).map(|(entry, own)| entry * own / scale);
        Self { force: self.force, form: form.collect() }
    }
}

/// The map of a period on motions that keep their offsets: `monodromy` without the forces of the sliders that stick, which
/// follow from the other numbers.
pub fn reduced(monodromy: &Matrix, offsets: &[Offset]) -> Matrix {
    let free: Vec<usize> = (0..monodromy.rows()).filter(|i| offsets.iter().all(|offset| offset.force != *i)).collect();
    Matrix::from_fn(free.len(), free.len(), |i, j| {
        let (i, j) = (free[i], free[j]);
        offsets.iter().fold(monodromy[(i, j)], |sum, offset| sum - monodromy[(i, offset.force)] * offset.form[j])
    })
}

impl Marching<'_> {
    /// Marks of the laws that can stick, before a period.
    pub(crate) fn sliders(&self) -> Vec<bool> {
        self.laws.iter().map(|law| law.has_memory()).collect()
    }

    /// Takes the marks from the laws that slip in the step that is made ready.
    pub(crate) fn unmark(&self, marks: &mut [bool]) {
        marks.iter_mut().zip(&self.laws).for_each(|(mark, law)| *mark &= law.sticks());
    }

    /// Offsets of the marked laws, whose derivatives by ω are those at `state`.
    pub(crate) fn offsets(&self, state: &[f64], marks: &[bool]) -> Vec<Offset> {
        let (n, h) = (self.y.len(), self.step);
        let omega = TAU / (h * self.phases.steps as f64);
        let mut offsets = Vec::new();
        let mut end = 2 * n;
        for (law, &mark) in self.laws.iter().zip(marks) {
            end += law.memory_size();
            if mark {
                // The force that is remembered is that of the step before: u = b·(y − h v).
                let (row, k) = (law.rows.row(0), law.stiffness());
                let mut form = vec![0.0; state.len() + 1];
                for (j, b) in row.iter().enumerate() {
                    (form[j], form[n + j]) = (-k * b, k * h * b);
                }
                form[end - 1] = 1.0;
                form[state.len()] = -k * h / omega * dot(row, &state[n..2 * n]);
                offsets.push(Offset { force: end - 1, form });
            }
        }
        offsets
    }
}
