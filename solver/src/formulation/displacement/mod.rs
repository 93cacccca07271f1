//! Displacement form of the harmonic balance: the reference formulation, as in the paper.
//!
//! Unknowns are the harmonics of the displacements X_r of all dofs that carry a nonlinear force, with the rest condensed
//! exactly from the physical matrices; neither modes nor receptances enter:
//!
//! * balance: D_r X_r + F − E_r = 0
//! * contact (DLFT, paper [16–19]): λ = max(0, p), p̂ = P(E − D X − F_other) − ε ĝ, with P the left inverse of the
//!   contact normals, F_other the forces of the other laws
//! * backbone: Re(φᵀ M x_1) = 0, φ the tracked mode and x_1 the first harmonic of all dofs, recovered from X_r: the same
//!   phase as that of the pressure form
//!
//! Simple, general and slow: it serves to check the pressure form.

mod condensation;
mod contacts;
mod evaluate;
mod jacobian;
#[cfg(test)]
mod tests;

use crate::curve::problem::Problem;
use crate::formulation::aft::{Aft, ElementForce};
use crate::formulation::harmonics::{complex, set_complex, width};
use crate::formulation::narrow;
use crate::formulation::scales::Scales;
use crate::formulation::slider::passes_over_beginning;
use crate::formulation::state::{Parameters, State};
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError, System};
use crate::linalg::{LinalgError, Lu, Matrix, axpy, dot};
use crate::settings::HarmonicSettings;
use crate::structure::Model;
use crate::structure::laws::{Law, LawKind, RigidContact};
use condensation::{Condensation, Condensed};
use num_complex::Complex64;

/// A nonlinear element as the displacement form sees it.
struct Part {
    law: LawKind,
    /// Index of its first argument among all.
    first: usize,
    /// Relative displacements: (position among the dofs kept, coefficient) pairs.
    channels: Vec<Vec<(usize, f64)>>,
    contact: Option<Normal>,
}

/// Rigid contact: row of the left inverse, ε and gap.
#[derive(Clone, Copy)]
struct Normal {
    index: usize,
    epsilon: f64,
    gap: f64,
}

/// The system in displacement form, bound to a model, a truncation and a kind of unknown parameters.
pub struct DisplacementForm<'m> {
    system: System<'m>,
    nc: usize,
    parts: Vec<Part>,
    condensation: Condensation,
    /// P, contacts × dofs kept.
    left_inverse: Matrix,
    aft: Aft,
    /// Unit of the residual, N.
    force_scale: f64,
    metric: Vec<f64>,
    /// Where it is evaluated.
    at: Parameters,
    /// X_r, dofs kept × nc, m.
    displacement: Vec<f64>,
    /// Arguments of the laws, channels × nc, as in [`State`].
    arguments: Vec<f64>,
    condensed: Vec<Condensed>,
    forces: Vec<ElementForce>,
    /// D X + F − E in N; on a backbone the phase condition in units of the modal amplitude.
    residual: Vec<f64>,
    lu: Lu,
}

impl<'m> DisplacementForm<'m> {
    /// System for `model` at a truncation; mode `tracked` fixes the phase of a backbone.
    ///
    /// # Errors
    /// If contact pressures cannot be told apart from the forces on the dofs (two contacts at one dof), or for a kind of
    /// curve that this form does not have.
    pub fn new(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError> {
        let channels = model.elements().iter().flat_map(|element| &element.channels);
        let mut kept: Vec<usize> = channels.flatten().map(|&(dof, _)| dof).collect();
        kept.sort_unstable();
        kept.dedup();
        Self::keeping(kept, model, truncation, tracked, unknown, scales)
    }

    /// The same with no dof condensed: polynomial in ω, where what is condensed has resonances of its own.
    ///
    /// # Errors
    /// Those of [`DisplacementForm::new`].
    pub fn of_all_dofs(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError> {
        Self::keeping((0..model.size()).collect(), model, truncation, tracked, unknown, scales)
    }

    /// `kept`: the dofs that are not condensed, in ascending order, at least those that carry a nonlinear force.
    fn keeping(
        kept: Vec<usize>,
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError> {
        if matches!(unknown, Unknown::PhaseResonance | Unknown::Extremum(_) | Unknown::Mode { damped: false }) {
            return Err(FormulationError::Unsupported);
        }
        if model.elements().is_empty() {
            return Err(FormulationError::Linear);
        }
        let harmonics = truncation.count;
        let nc = width(harmonics);
        let (mut parts, mut names) = (Vec::new(), Vec::new());
        for (first, element) in model.numbered() {
            let local = |channel: &Vec<(usize, f64)>| {
                channel.iter().map(|&(dof, factor)| (kept.partition_point(|&k| k < dof), factor)).collect()
            };
            let normal = |c: RigidContact<'_>| Normal { index: names.len(), epsilon: c.epsilon, gap: c.gap };
            let contact = element.law.rigid().map(normal);
            if contact.is_some() {
                names.push(element.name.as_str());
            }
            let channels = element.channels.iter().map(local).collect();
            parts.push(Part { law: element.law.clone(), first, channels, contact });
        }
        let contacts: Vec<&Part> = parts.iter().filter(|part| part.contact.is_some()).collect();
        let normals = directions(kept.len(), contacts.iter().map(|part| &part.channels[0]));
        let tangents = directions(kept.len(), contacts.iter().flat_map(|part| &part.channels[1..]));
        let epsilon = contacts.iter().filter_map(|part| part.contact).map(|c| c.epsilon).fold(0.0, f64::max);
        let stiffness = kept.iter().map(|&i| model.stiffness()[(i, i)]).fold(0.0, f64::max);
        let left_inverse = contacts::left_inverse(&normals, &tangents, &names)?;
        let unknowns = kept.len() * nc;
        let parameters = unknown.parameters().len();
        Ok(Self {
            forces: parts.iter().map(|_| ElementForce::default()).collect(),
            displacement: vec![0.0; unknowns],
            arguments: vec![0.0; model.arguments() * nc],
            metric: vec![1.0; unknowns + parameters],
            condensation: Condensation::new(model, kept, tracked),
            aft: Aft::new(truncation),
            force_scale: if epsilon > 0.0 { epsilon } else { stiffness } * scales.length,
            at: unknown.fixed(&scales),
            condensed: Vec::new(),
            residual: Vec::new(),
            lu: Lu::default(),
            system: System::new(model, truncation, tracked, unknown, scales),
            nc,
            parts,
            left_inverse,
        })
    }

    /// Norm of the unbalanced forces at a solution of any formulation, over the dofs kept and all harmonics, relative to
    /// that of the forcing, A‖s‖. A backbone has no forcing: relative to its damping forces C ẋ, which a forcing would
    /// have to balance.
    ///
    /// # Errors
    /// If the dofs without nonlinear force have an undamped resonance there.
    pub fn residual_of(&mut self, state: &State) -> Result<f64, LinalgError> {
        let y = self.encode(state);
        self.load(&y);
        self.at = state.parameters();
        self.evaluate()?;
        let rows = &self.residual[..self.displacement.len()];
        let reference = if self.at.forcing == 0.0 {
            let square = |k| {
                let force = self.condensation.damping_times(&self.recover(k));
                self.at.lambda(k).norm_sqr() * force.iter().map(Complex64::norm_sqr).sum::<f64>()
            };
            (0..=self.system.harmonics).map(square).sum::<f64>().sqrt()
        } else {
            self.at.forcing.abs() * self.condensation.shape_norm()
        };
        Ok(dot(rows, rows).sqrt() / reference)
    }

    /// Displacements of all dofs at harmonic k of the state last evaluated.
    fn recover(&self, k: usize) -> Vec<Complex64> {
        let kept: Vec<Complex64> = self.displacement.chunks(self.nc).map(|series| complex(series, k)).collect();
        self.condensation.recover(&self.condensed[k], &kept, self.force(k))
    }

    /// Unscales `y`.
    fn load(&mut self, y: &[f64]) {
        let (displacement, parameters) = y.split_at(self.displacement.len());
        for (x, y) in self.displacement.iter_mut().zip(displacement) {
            *x = y * self.system.scales.length;
        }
        self.at = self.system.unknown.fixed(&self.system.scales);
        self.system.unknown.decode(parameters, &self.system.scales, &mut self.at);
    }

    /// Residual divided by its units, row after row.
    fn scaled_residual(&self) -> impl Iterator<Item = f64> + '_ {
        let balance = self.displacement.len();
        self.residual.iter().enumerate().map(move |(i, r)| if i < balance { r / self.force_scale } else { *r })
    }
}

/// Matrix of the directions of some channels, one column each.
fn directions<'c>(dofs: usize, channels: impl Iterator<Item = &'c Vec<(usize, f64)>>) -> Matrix {
    let channels: Vec<_> = channels.collect();
    let mut matrix = Matrix::zeros(dofs, channels.len());
    for (j, channel) in channels.iter().enumerate() {
        for &(dof, factor) in *channel {
            matrix[(dof, j)] += factor;
        }
    }
    matrix
}

impl Problem for DisplacementForm<'_> {
    fn len(&self) -> usize {
        self.metric.len()
    }

    fn parameters(&self) -> usize {
        self.system.unknown.parameters().len()
    }

    fn metric(&self) -> &[f64] {
        &self.metric
    }

    fn linearise(&mut self, y: &mut [f64]) -> f64 {
        self.load(y);
        if !y.iter().all(|v| v.is_finite()) || self.at.omega <= 0.0 || self.evaluate().is_err() {
            return f64::NAN;
        }
        self.scaled_residual().fold(0.0, |m, r| if r.is_nan() { f64::NAN } else { m.max(r.abs()) })
    }

    fn factor(&mut self, row: &[f64]) -> Result<(), LinalgError> {
        self.assemble(row);
        self.lu.factor()
    }

    fn is_factorisation_current(&self) -> bool {
        true
    }

    fn orientation(&mut self) -> f64 {
        self.lu.determinant_sign() * self.lu.distance_from_singular()
    }

    fn rounding(&self) -> f64 {
        let size = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let stiffness = self.condensed.iter().flat_map(|condensed| &condensed.stiffness).map(|d| d.norm());
        let elastic = stiffness.fold(0.0, f64::max) * size(&self.displacement);
        let forces = self.forces.iter().map(|element| size(&element.force)).fold(0.0, f64::max);
        64.0 * f64::EPSILON * elastic.max(forces) / self.force_scale
    }

    fn longest_step(&mut self, y: &[f64], tangent: &[f64]) -> f64 {
        let Ok(state) = self.decode(y) else { return f64::INFINITY };
        let metric = &self.metric[..self.displacement.len()];
        narrow::longest_step(&self.system, metric, [y, tangent], &state.modal, state.parameters())
    }

    fn are_neighbours(&self, from: &[f64], to: &[f64]) -> bool {
        narrow::are_neighbours(&self.system, self.motion_metric(), from, to)
    }

    fn hops(&self, from: &[f64], to: &[f64]) -> bool {
        let mut sliders = self.parts.iter().filter_map(|part| Some((part.law.slider()?, &part.channels[0])));
        narrow::hops(&self.system, self.motion_metric(), [from, to])
            || sliders.any(|(slider, channel)| {
                let motion = |y: &[f64]| {
                    let mut series = vec![0.0; self.nc];
                    for &(dof, factor) in channel {
                        axpy(factor * self.system.scales.length, &y[dof * self.nc..(dof + 1) * self.nc], &mut series);
                    }
                    series
                };
                passes_over_beginning(slider, [&motion(from), &motion(to)])
            })
    }

    fn images(&self) -> usize {
        self.system.images()
    }

    fn image(&self, y: &[f64], index: usize) -> Vec<f64> {
        self.system.image(y, self.displacement.len(), index)
    }

    fn solve(&mut self, mismatch: f64, step: &mut [f64], tangent: &mut [f64]) {
        for ((s, t), r) in step.iter_mut().zip(tangent.iter_mut()).zip(self.scaled_residual()) {
            (*s, *t) = (-r, 0.0);
        }
        let last = self.metric.len() - 1;
        (step[last], tangent[last]) = (-mismatch, 1.0);
        self.lu.solve(step);
        self.lu.solve(tangent);
    }

    fn solve_transposed(&mut self, form: &[f64]) -> Vec<f64> {
        let mut weights = form.to_vec();
        self.lu.solve_transposed(&mut weights);
        weights
    }
}

impl<'m> Formulation<'m> for DisplacementForm<'m> {
    fn build(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError> {
        Self::new(model, truncation, tracked, unknown, scales)
    }

    fn system(&self) -> &System<'m> {
        &self.system
    }

    fn aft(&mut self) -> &mut Aft {
        &mut self.aft
    }

    /// X_r = Φ_r y.
    fn encode(&self, state: &State) -> Vec<f64> {
        let mut y = Vec::with_capacity(self.metric.len());
        for &dof in self.condensation.kept() {
            let series = state.displacement(self.system.model, dof);
            y.extend(series.iter().map(|x| x / self.system.scales.length));
        }
        y.extend(self.system.unknown.encode(state, &self.system.scales));
        y
    }

    /// All dofs recovered: modal amplitudes Φᵀ M x.
    fn decode(&mut self, y: &[f64]) -> Result<State, LinalgError> {
        self.load(y);
        self.evaluate()?;
        let projection = self.system.model.modes().shapes.transpose().matmul(self.system.model.mass());
        let (n, nc) = (self.system.model.size(), self.nc);
        let mut modal = vec![0.0; n * nc];
        for k in 0..=self.system.harmonics {
            let x = self.recover(k);
            for (j, series) in modal.chunks_mut(nc).enumerate() {
                set_complex(series, k, projection.row(j).iter().zip(&x).map(|(p, x)| p * x).sum());
            }
        }
        let Parameters { omega, decay, forcing } = self.at;
        Ok(State { harmonics: self.system.harmonics, omega, decay, forcing, arguments: self.arguments.clone(), modal })
    }

    fn growth(&self, y: &[f64]) -> Vec<f64> {
        let motion = self.displacement.len();
        let mut direction = vec![0.0; y.len()];
        direction[..motion].copy_from_slice(&y[..motion]);
        direction
    }

    fn forces(&mut self, y: &[f64]) -> Vec<f64> {
        self.linearise(&mut y.to_vec());
        self.forces.iter().flat_map(|element| element.force.iter().copied()).collect()
    }
}
