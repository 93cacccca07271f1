//! Bordered Jacobian of the displacement form: rows in N, columns per m and per unit of the parameters; scaled last.

use super::{DisplacementForm, Part};
use crate::formulation::harmonics::{complex, set_complex};
use crate::formulation::unknown::Parameter;
use crate::linalg::{Matrix, axpy};
use num_complex::Complex64;

impl DisplacementForm<'_> {
    /// Fills the bordered matrix of the state last evaluated.
    pub(super) fn assemble(&mut self, row: &[f64]) {
        let unknowns = self.displacement.len();
        let mut jacobian = Matrix::zeros(unknowns, self.metric.len());
        self.add_linear(&mut jacobian);
        let (contacts, others): (Vec<usize>, Vec<usize>) =
            (0..self.parts.len()).partition(|&e| self.parts[e].contact.is_some());
        for e in others {
            let arguments = self.argument_rates(&self.parts[e], None);
            self.add_forces(e, &arguments, &mut jacobian);
        }
        let arguments: Vec<Matrix> =
            contacts.iter().map(|&e| self.argument_rates(&self.parts[e], Some(&jacobian))).collect();
        for (&e, arguments) in contacts.iter().zip(&arguments) {
            self.add_forces(e, arguments, &mut jacobian);
        }
        let mut lu = std::mem::take(&mut self.lu);
        let size = self.metric.len();
        let buffer = lu.reset(size);
        let units: Vec<f64> = (0..size).map(|j| self.unit(j)).collect();
        for (i, target) in buffer.chunks_mut(size).take(unknowns).enumerate() {
            for (t, (value, unit)) in target.iter_mut().zip(jacobian.row(i).iter().zip(&units)) {
                *t = value * unit / self.force_scale;
            }
        }
        if self.system.unknown.is_autonomous() {
            let target = &mut buffer[unknowns * size..(unknowns + 1) * size];
            self.phase_row(target);
            target.iter_mut().zip(&units).for_each(|(t, unit)| *t *= unit / self.system.scales.modal);
        }
        buffer[(size - 1) * size..].copy_from_slice(row);
        self.lu = lu;
    }

    /// Unit of an entry of the state.
    fn unit(&self, column: usize) -> f64 {
        match column.checked_sub(self.displacement.len()) {
            None => self.system.scales.length,
            Some(p) => self.system.unknown.parameters()[p].unit(&self.system.scales),
        }
    }

    /// Derivatives of D X − E.
    fn add_linear(&self, jacobian: &mut Matrix) {
        let (c, nc) = (self.condensation.kept().len(), self.nc);
        for (k, condensed) in self.condensed.iter().enumerate() {
            for i in 0..c {
                for j in 0..c {
                    add_complex(jacobian, (i * nc, j * nc), k, condensed.stiffness[i * c + j]);
                }
            }
            let x: Vec<Complex64> = self.displacement.chunks(nc).map(|series| complex(series, k)).collect();
            for (p, &parameter) in self.system.unknown.parameters().iter().enumerate() {
                for i in 0..c {
                    let value = if parameter == Parameter::Forcing {
                        -condensed.force[i]
                    } else {
                        let row = &condensed.stiffness_rate[i * c..(i + 1) * c];
                        let elastic: Complex64 = row.iter().zip(&x).map(|(d, x)| d * x).sum();
                        parameter.rate(k) * (elastic - self.force(k) * condensed.force_rate[i])
                    };
                    let mut series = vec![0.0; nc];
                    set_complex(&mut series, k, value);
                    for (h, value) in series.iter().enumerate() {
                        jacobian[(i * nc + h, c * nc + p)] += value;
                    }
                }
            }
        }
    }

    /// Derivatives of an element's arguments. `balance` are those of D X + F_other − E, for the predicted pressure of a
    /// contact.
    fn argument_rates(&self, part: &Part, balance: Option<&Matrix>) -> Matrix {
        let nc = self.nc;
        let mut rates = Matrix::zeros(part.channels.len() * nc, self.metric.len());
        for (i, channel) in part.channels.iter().enumerate() {
            let normal = part.contact.filter(|_| i == 0);
            let gain = normal.map_or(1.0, |normal| normal.epsilon);
            for h in 0..nc {
                for &(dof, factor) in channel {
                    rates[(i * nc + h, dof * nc + h)] += gain * factor;
                }
                if let (Some(normal), Some(balance)) = (normal, balance) {
                    for (dof, weight) in self.left_inverse.row(normal.index).iter().enumerate() {
                        axpy(-weight, balance.row(dof * nc + h), rates.row_mut(i * nc + h));
                    }
                }
            }
        }
        rates
    }

    /// Adds the derivatives of an element's forces, given those of its arguments.
    fn add_forces(&self, e: usize, arguments: &Matrix, jacobian: &mut Matrix) {
        let (part, force, nc) = (&self.parts[e], &self.forces[e], self.nc);
        let frequency = self.system.unknown.parameters().iter().position(|&p| p == Parameter::Frequency);
        let mut rate = vec![0.0; self.metric.len()];
        for (i, channel) in part.channels.iter().enumerate() {
            for h in 0..nc {
                let row = i * nc + h;
                rate.fill(0.0);
                let width = part.channels.len() * nc;
                for (j, &slope) in force.jacobian[row * width..(row + 1) * width].iter().enumerate() {
                    if slope != 0.0 {
                        axpy(slope, arguments.row(j), &mut rate);
                    }
                }
                if let Some(p) = frequency {
                    rate[self.displacement.len() + p] += force.domega[row];
                }
                for &(dof, factor) in channel {
                    axpy(factor, &rate, jacobian.row_mut(dof * nc + h));
                }
            }
        }
    }

    /// Derivatives of Re(w·X_1), per m and per unit of the parameters.
    fn phase_row(&self, target: &mut [f64]) {
        let (nc, unknowns) = (self.nc, self.displacement.len());
        let condensed = &self.condensed[1];
        let mut drift = Complex64::default();
        for (i, series) in self.displacement.chunks(nc).enumerate() {
            // X = a − i b.
            target[i * nc + 1] = condensed.mode[i].re;
            target[i * nc + 2] = condensed.mode[i].im;
            drift += condensed.mode_rate[i] * complex(series, 1);
        }
        for (p, parameter) in self.system.unknown.parameters().iter().enumerate() {
            target[unknowns + p] = (parameter.rate(1) * drift).re;
        }
    }
}

/// Adds the real form of multiplication by `factor` at harmonic k to the block that starts at `corner`.
fn add_complex(matrix: &mut Matrix, (row, column): (usize, usize), k: usize, factor: Complex64) {
    if k == 0 {
        matrix[(row, column)] += factor.re;
        return;
    }
    let (a, b) = (2 * k - 1, 2 * k);
    matrix[(row + a, column + a)] += factor.re;
    matrix[(row + a, column + b)] += factor.im;
    matrix[(row + b, column + a)] -= factor.im;
    matrix[(row + b, column + b)] += factor.re;
}
