//! Exact condensation of the physical dynamic stiffness to the dofs that carry nonlinear forces (paper [6]).

use crate::linalg::{LinalgError, Matrix, solve_complex};
use crate::structure::Model;
use num_complex::Complex64;

/// Physical matrices, partitioned into the dofs kept (r) and the others (l).
pub(super) struct Condensation {
    mass: Matrix,
    damping: Matrix,
    stiffness: Matrix,
    kept: Vec<usize>,
    others: Vec<usize>,
    /// Forcing shape s.
    shape: Vec<f64>,
    /// M φ of the tracked mode.
    momentum: Vec<f64>,
}

/// What is left of one harmonic: with T = [I; t], t = −D_ll⁻¹ D_lr, everything on the c dofs kept, row-major.
pub(super) struct Condensed {
    /// D_r = Tᵀ D T, c × c.
    pub stiffness: Vec<Complex64>,
    /// ∂D_r/∂λ = Tᵀ (2λM + C) T, c × c.
    pub stiffness_rate: Vec<Complex64>,
    /// E_r = Tᵀ s per unit of A.
    pub force: Vec<Complex64>,
    /// ∂E_r/∂λ.
    pub force_rate: Vec<Complex64>,
    /// Row w = φᵀ M T: w·X_r is the tracked mode's amplitude where no external force acts.
    pub mode: Vec<Complex64>,
    /// ∂w/∂λ.
    pub mode_rate: Vec<Complex64>,
    /// t, (n − c) × c.
    transfer: Vec<Complex64>,
    /// z = D_ll⁻¹ s_l per unit of A.
    particular: Vec<Complex64>,
}

impl Condensation {
    /// Partition of `model`; `kept` in ascending order.
    pub fn new(model: &Model, kept: Vec<usize>, tracked: usize) -> Self {
        let n = model.size();
        let weighted = model.mass().matmul(&model.modes().shapes);
        Self {
            mass: model.mass().clone(),
            damping: weighted.matmul(&model.damping().matrix()).matmul(&weighted.transpose()),
            stiffness: model.stiffness().clone(),
            others: (0..n).filter(|i| !kept.contains(i)).collect(),
            kept,
            shape: model.forcing().shape.clone(),
            momentum: weighted.column(tracked),
        }
    }

    /// Dofs kept, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// D_ij and ∂D_ij/∂λ.
    fn entry(&self, lambda: Complex64, i: usize, j: usize) -> (Complex64, Complex64) {
        let (m, c, k) = (self.mass[(i, j)], self.damping[(i, j)], self.stiffness[(i, j)]);
        (lambda * (lambda * m + c) + k, 2.0 * lambda * m + c)
    }

    /// Condenses one harmonic; `forced` if the external force acts on it.
    ///
    /// # Errors
    /// If D_ll is singular: the other dofs have an undamped resonance there.
    pub fn condense(&self, lambda: Complex64, forced: bool) -> Result<Condensed, LinalgError> {
        let (c, l) = (self.kept.len(), self.others.len());
        let zero = Complex64::default();
        let load = if forced { 1.0 } else { 0.0 };
        // One factorisation for t, z and g = D_ll⁻¹ (M φ)_l.
        let columns = c + 2;
        let (mut inner, mut inner_rate) = (vec![zero; l * l], vec![zero; l * l]);
        let mut solution = vec![zero; l * columns];
        // (2λM + C) T, rows of the other dofs; starts as the part of the dofs kept.
        let mut below = vec![zero; l * c];
        for (a, &i) in self.others.iter().enumerate() {
            for (b, &j) in self.others.iter().enumerate() {
                (inner[a * l + b], inner_rate[a * l + b]) = self.entry(lambda, i, j);
            }
            for (b, &j) in self.kept.iter().enumerate() {
                let (entry, rate) = self.entry(lambda, i, j);
                solution[a * columns + b] = -entry;
                below[a * c + b] = rate;
            }
            solution[a * columns + c] = (load * self.shape[i]).into();
            solution[a * columns + c + 1] = self.momentum[i].into();
        }
        if l > 0 {
            solve_complex(&inner, &mut solution, l, columns)?;
        }
        let t = |a: usize, b: usize| solution[a * columns + b];
        for a in 0..l {
            for b in 0..c {
                below[a * c + b] += (0..l).map(|q| inner_rate[a * l + q] * t(q, b)).sum::<Complex64>();
            }
        }
        let mut out = Condensed {
            stiffness: vec![zero; c * c],
            stiffness_rate: vec![zero; c * c],
            force: vec![zero; c],
            force_rate: vec![zero; c],
            mode: vec![zero; c],
            mode_rate: vec![zero; c],
            transfer: (0..l * c).map(|i| t(i / c, i % c)).collect(),
            particular: (0..l).map(|a| t(a, c)).collect(),
        };
        for (a, &i) in self.kept.iter().enumerate() {
            for (b, &j) in self.kept.iter().enumerate() {
                let (mut entry, mut rate) = self.entry(lambda, i, j);
                for (q, &other) in self.others.iter().enumerate() {
                    let (coupling, coupling_rate) = self.entry(lambda, i, other);
                    entry += coupling * t(q, b);
                    rate += coupling_rate * t(q, b) + t(q, a) * below[q * c + b];
                }
                out.stiffness[a * c + b] = entry;
                out.stiffness_rate[a * c + b] = rate;
            }
            out.force[a] = (load * self.shape[i]).into();
            out.mode[a] = self.momentum[i].into();
            for (q, &other) in self.others.iter().enumerate() {
                out.force[a] += t(q, a) * (load * self.shape[other]);
                out.force_rate[a] -= below[q * c + a] * t(q, c);
                out.mode[a] += t(q, a) * self.momentum[other];
                out.mode_rate[a] -= below[q * c + a] * t(q, c + 1);
            }
        }
        Ok(out)
    }

    /// Displacements of all dofs at one harmonic from those kept: x = T X_r + A [0; z].
    pub fn recover(&self, condensed: &Condensed, kept: &[Complex64], forcing: Complex64) -> Vec<Complex64> {
        let mut x = vec![Complex64::default(); self.kept.len() + self.others.len()];
        for (&i, value) in self.kept.iter().zip(kept) {
            x[i] = *value;
        }
        for (a, &i) in self.others.iter().enumerate() {
            let row = &condensed.transfer[a * kept.len()..(a + 1) * kept.len()];
            let moved: Complex64 = row.iter().zip(kept).map(|(t, x)| t * x).sum();
            x[i] = moved + forcing * condensed.particular[a];
        }
        x
    }

    /// Euclidean norm of the forcing shape.
    pub fn shape_norm(&self) -> f64 {
        crate::linalg::dot(&self.shape, &self.shape).sqrt()
    }

    /// C x at one harmonic.
    pub fn damping_times(&self, x: &[Complex64]) -> Vec<Complex64> {
        (0..x.len()).map(|i| self.damping.row(i).iter().zip(x).map(|(c, x)| c * x).sum()).collect()
    }
}
