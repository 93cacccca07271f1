//! Small linear complementarity problems by block principal pivoting.

use super::factors::Factors;
use thiserror::Error;

/// No solution was found: a principal submatrix is singular, or pivoting did not end (the matrix is not a P-matrix).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the complementarity problem has no solution that pivoting finds")]
pub struct Unsolvable;

/// 0 ≤ z ⟂ A z − b ≥ 0 with a square, possibly nonsymmetric A, in buffers that are kept.
///
/// Block principal pivoting (Júdice & Pires, Comput. Oper. Res. 21, 1994, pp. 587–596): every index whose sign is wrong
/// changes side at once, so that the release of one node re-checks all the others. When that does not reduce the number
/// of wrong signs any more, one index at a time changes side (Murty's rule), which ends for every P-matrix.
pub struct Complementarity {
    /// A, row-major.
    pub matrix: Vec<f64>,
    /// b.
    pub offset: Vec<f64>,
    /// z.
    pub solution: Vec<f64>,
    active: Vec<bool>,
    wrong: Vec<bool>,
    /// Columns of A that are known.
    known: Vec<bool>,
    indices: Vec<usize>,
    reduced: Vec<f64>,
    factors: Factors,
}

/// Block changes without progress before Murty's rule takes over.
const PATIENCE: usize = 3;

/// A sign is wrong beyond this share of max |b|: below it is rounding.
const TOLERANCE: f64 = 1e-12;

/// Relative increase of the diagonal, far below the accuracy of the compliances.
const HAIR: f64 = 1e-12;

impl Complementarity {
    /// Room for `size` unknowns.
    pub fn new(size: usize) -> Self {
        Self {
            matrix: vec![0.0; size * size],
            offset: vec![0.0; size],
            solution: vec![0.0; size],
            active: vec![false; size],
            wrong: vec![false; size],
            known: vec![false; size],
            indices: Vec::with_capacity(size),
            reduced: Vec::with_capacity(size),
            factors: Factors::new(size),
        }
    }

    /// Computes `solution` from `offset` and the columns of A that it takes: `column` is asked for each of them once, with the number
    /// of the column and the matrix.
    #[inline(always)]
    pub fn solve(&mut self, mut column: impl FnMut(usize, &mut [f64])) -> Result<(), Unsolvable> {
        let n = self.offset.len();
        let tolerance = TOLERANCE * self.offset.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        for (active, offset) in self.active.iter_mut().zip(&self.offset) {
            *active = *offset > 0.0;
        }
        self.known.fill(false);
        let (mut fewest, mut patience) = (n + 1, PATIENCE);
        // Murty's rule is exponential at worst, and takes of the order of n pivots in practice.
        for _ in 0..50 + 20 * n {
            self.solve_active(&mut column)?;
            let count = self.find_wrong(tolerance);
            if count == 0 {
                self.solution.iter_mut().for_each(|z| *z = z.max(0.0));
                return Ok(());
            }
            if count < fewest {
                (fewest, patience) = (count, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else if let Some(last) = self.wrong.iter().rposition(|&wrong| wrong) {
                self.active[last] = !self.active[last];
                continue;
            }
            for (active, wrong) in self.active.iter_mut().zip(&self.wrong) {
                *active ^= wrong;
            }
        }
        Err(Unsolvable)
    }

    /// The indices that may have z > 0 in the last solution.
    #[inline(always)]
    pub fn active(&self) -> &[usize] {
        &self.indices
    }

    /// Solves A z = b on the active indices once more, in place: one row of `offsets` for each of them, `columns` right-hand sides.
    #[inline(always)]
    pub fn solve_again(&mut self, offsets: &mut [f64], columns: usize) {
        self.factors.solve(offsets, columns);
    }

    /// z from A z = b on the active indices, zero elsewhere. Dependent nodes (two stops on one dof) make A singular: a
    /// diagonal that is larger by a hair shares the force between them.
    #[inline(always)]
    fn solve_active(&mut self, column: &mut impl FnMut(usize, &mut [f64])) -> Result<(), Unsolvable> {
        let n = self.offset.len();
        self.indices.clear();
        self.indices.extend((0..n).filter(|&i| self.active[i]));
        for &j in &self.indices {
            if !std::mem::replace(&mut self.known[j], true) {
                column(j, &mut self.matrix);
            }
        }
        self.reduced.clear();
        self.reduced.extend(self.indices.iter().map(|&i| self.offset[i]));
        let size = self.indices.len();
        if size > 0 {
            let a = self.factors.reset(size);
            for (row, &i) in a.chunks_exact_mut(size).zip(&self.indices) {
                for (entry, &j) in row.iter_mut().zip(&self.indices) {
                    *entry = self.matrix[i * n + j] * if i == j { 1.0 + HAIR } else { 1.0 };
                }
            }
            self.factors.factor().map_err(|_| Unsolvable)?;
            self.factors.solve(&mut self.reduced, 1);
        }
        self.solution.fill(0.0);
        for (&i, z) in self.indices.iter().zip(&self.reduced) {
            self.solution[i] = *z;
        }
        Ok(())
    }

    /// Marks the indices whose sign is wrong and counts them. A z_i is weighed by A_ii, which gives it the unit of b.
    #[inline(always)]
    fn find_wrong(&mut self, tolerance: f64) -> usize {
        let n = self.offset.len();
        for i in 0..n {
            let row = &self.matrix[i * n..(i + 1) * n];
            self.wrong[i] = if self.active[i] {
                self.solution[i] * row[i].abs() < -tolerance
            } else {
                let product: f64 = self.indices.iter().map(|&j| row[j] * self.solution[j]).sum();
                product - self.offset[i] < -tolerance
            };
        }
        self.wrong.iter().filter(|&&wrong| wrong).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dot;
    use proptest::prelude::*;

    /// The solution by trying all active sets; P-matrices have exactly one.
    fn enumerate(matrix: &[f64], offset: &[f64]) -> Vec<f64> {
        let n = offset.len();
        (0..1usize << n)
            .find_map(|set| {
                let mut problem = filled(matrix, offset);
                (0..n).for_each(|i| problem.active[i] = set >> i & 1 == 1);
                problem.solve_active(&mut |_, _| ()).unwrap();
                (problem.find_wrong(0.0) == 0).then_some(problem.solution)
            })
            .expect("a P-matrix has a solution")
    }

    fn filled(matrix: &[f64], offset: &[f64]) -> Complementarity {
        let mut problem = Complementarity::new(offset.len());
        problem.matrix.copy_from_slice(matrix);
        problem.offset.copy_from_slice(offset);
        problem
    }

    /// B Bᵀ + small diagonal + skew part: positive definite and nonsymmetric, hence a P-matrix.
    fn p_matrix(n: usize, b: &[f64], skew: &[f64]) -> Vec<f64> {
        let mut matrix = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                matrix[i * n + j] = dot(&b[i * n..(i + 1) * n], &b[j * n..(j + 1) * n]);
                matrix[i * n + j] += if i == j { 0.01 } else { skew[i * n + j] - skew[j * n + i] };
            }
        }
        matrix
    }

    proptest! {
        #[test]
        fn it_finds_the_solution_that_enumeration_finds(
            n in 1usize..7,
            b in prop::collection::vec(-1.0f64..1.0, 36),
            skew in prop::collection::vec(-0.5f64..0.5, 36),
            offset in prop::collection::vec(-1.0f64..1.0, 6),
        ) {
            let matrix = p_matrix(n, &b, &skew);
            let offset = &offset[..n];
            let mut problem = filled(&matrix, offset);
            prop_assert_eq!(problem.solve(|_, _| ()), Ok(()));
            let expected = enumerate(&matrix, offset);
            let size = expected.iter().fold(1.0, |a: f64, z| a.max(z.abs()));
            for (z, expected) in problem.solution.iter().zip(&expected) {
                // Conditioned by the 0.01 on the diagonal; signs are decided at 1e-12.
                prop_assert!((z - expected).abs() < 1e-8 * size);
            }
        }

        #[test]
        fn large_problems_are_solved_to_their_definition(
            b in prop::collection::vec(-1.0f64..1.0, 27 * 27),
            skew in prop::collection::vec(-0.5f64..0.5, 27 * 27),
            offset in prop::collection::vec(-1.0f64..1.0, 27),
        ) {
            let matrix = p_matrix(27, &b, &skew);
            let mut problem = filled(&matrix, &offset);
            prop_assert_eq!(problem.solve(|_, _| ()), Ok(()));
            let size = problem.solution.iter().fold(1.0, |a: f64, z| a.max(z.abs()));
            for i in 0..27 {
                let slack = dot(&matrix[27 * i..27 * (i + 1)], &problem.solution) - offset[i];
                prop_assert!(problem.solution[i] >= 0.0 && slack > -1e-10 * size);
                prop_assert!(problem.solution[i] == 0.0 || slack.abs() < 1e-10 * size);
            }
        }
    }

    #[test]
    fn releasing_one_node_rechecks_the_others() {
        // Both penetrate, but pushing node 0 back lifts node 1 off: only one is in contact.
        let mut problem = filled(&[1.0, 0.9, 0.9, 1.0], &[1.0, 0.5]);
        problem.solve(|_, _| ()).unwrap();
        assert!((problem.solution[0] - 1.0).abs() < 1e-11 && problem.solution[1] == 0.0);
        // Node 1 does not penetrate until node 0 is pushed back.
        let mut problem = filled(&[1.0, -0.9, -0.9, 1.0], &[1.0, -0.5]);
        problem.solve(|_, _| ()).unwrap();
        assert!(problem.solution[0] > 1.0 && problem.solution[1] > 0.0);
    }

    #[test]
    fn a_problem_without_solution_is_reported() {
        assert_eq!(filled(&[-1.0], &[1.0]).solve(|_, _| ()), Err(Unsolvable));
        assert_eq!(filled(&[1.0, -2.0, -2.0, 1.0], &[1.0, 1.0]).solve(|_, _| ()), Err(Unsolvable));
    }

    #[test]
    fn dependent_nodes_share_a_force_and_the_tighter_stop_takes_it() {
        let mut problem = filled(&[1.0, 1.0, 1.0, 1.0], &[1.0, 1.0]);
        problem.solve(|_, _| ()).unwrap();
        assert!((problem.solution[0] + problem.solution[1] - 1.0).abs() < 1e-11);
        let mut problem = filled(&[1.0, 1.0, 1.0, 1.0], &[1.0, 2.0]);
        problem.solve(|_, _| ()).unwrap();
        assert!(problem.solution[0] == 0.0 && (problem.solution[1] - 2.0).abs() < 1e-11);
    }
}
