//! Pressure form of the harmonic balance: the formulation that runs.
//!
//! Unknowns are the harmonics of the arguments of the nonlinear laws: for rigid contact the predicted pressure p and the
//! tangential displacements of each node, for other laws their relative displacements. Forces follow by alternating
//! frequency–time, displacements from the receptance, x = D⁻¹(E − F):
//!
//! * contact, normal: p̂ − λ̂ + ε ĝ(x_N) = 0, g = c − x_N
//! * everything else: û − x̂_u(F) = 0
//! * kept modal amplitudes (poles): D̂ y − φᵀ(E − F) = 0
//!
//! Fold and peak curves have one equation more, whose value and gradient come from a second bordered matrix (`condition`).
//!
//! Contact nodes with p < 0 at every instant have no force and identity columns; they are eliminated exactly.

mod assemble;
mod asymmetry;
mod compressed;
#[cfg(test)]
mod compressed_tests;
mod condition;
#[cfg(test)]
mod condition_tests;
mod elements;
mod evaluate;
mod forms;
mod layout;
mod reduced;
#[cfg(test)]
mod reduced_tests;
mod second;
mod solution;
#[cfg(test)]
pub(crate) mod tests;
mod touch;

use crate::curve::problem::Problem;
use crate::formulation::aft::{Aft, ElementForce};
use crate::formulation::modal::Modal;
use crate::formulation::narrow;
use crate::formulation::receptance::Receptance;
use crate::formulation::scales::Scales;
use crate::formulation::state::{Parameters, State};
use crate::formulation::unknown::{Parameter, Unknown};
use crate::formulation::{Formulation, FormulationError, System};
use crate::linalg::{LinalgError, Lu};
use crate::settings::HarmonicSettings;
use crate::structure::laws::{LawKind, with_law};
use crate::structure::{Exchange, Model};
use assemble::Receptances;
use compressed::Compressed;
use condition::Condition;
pub use condition::Degeneracy;
use elements::{BoundElement, Channel, bound_elements};
use layout::{Layout, Unknowns};
use num_complex::Complex64;
use reduced::Reduced;
pub use touch::Touch;

/// How the matrix last factorised was made smaller.
enum Reduction {
    /// Not at all.
    Whole,
    Arcs(Reduced),
    Elements(Compressed),
}

/// The system in pressure form, bound to a model, a truncation and a kind of unknown parameters.
pub struct PressureForm<'m> {
    system: System<'m>,
    layout: Layout,
    elements: Vec<BoundElement>,
    channels: Vec<Channel>,
    receptance: Receptance,
    aft: Aft,
    metric: Vec<f64>,
    /// Phase condition as a linear form on the state, if there is one.
    phase: Option<Vec<f64>>,
    /// Extremum that a fold or peak curve follows.
    condition: Option<Condition>,
    /// Exchanges of equal parts of the structure, along such curves.
    exchanges: Vec<Exchange>,
    /// The state last linearised, in physical units.
    current: State,
    /// Forces per element; jacobian columns are per scaled argument.
    forces: Vec<ElementForce>,
    /// Channel displacements, channels × nc.
    displacement: Vec<f64>,
    /// Unknowns at the state last linearised, and their residual.
    unknowns: Unknowns,
    residual: Vec<f64>,
    /// Derivatives of the dependent modal amplitudes with respect to each parameter, modes × nc each.
    modal_rates: Vec<Vec<f64>>,
    lu: Lu,
    /// Unknowns of the matrix last factorised.
    factored: Unknowns,
    reduction: Reduction,
    /// T of [`reduced`], or rows of one element.
    rows: Vec<f64>,
    solutions: Vec<f64>,
    work: Vec<Complex64>,
    receptances: Receptances,
}

impl<'m> PressureForm<'m> {
    /// System for `model` at a truncation; mode `tracked` is the one whose first-harmonic amplitude stays an unknown.
    pub fn new(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Self {
        let system = System::new(model, truncation, tracked, unknown, scales);
        let (harmonics, modal) = (system.harmonics, system.modal.clone());
        let layout = Layout {
            nc: crate::formulation::harmonics::width(harmonics),
            channels: modal.channels(),
            modes: model.size(),
            parameters: unknown.parameters().len(),
        };
        let (elements, channels) = bound_elements(model, &modal, &scales);
        let mut metric = vec![0.0; layout.len()];
        metric[layout.modal().start..].fill(1.0);
        let Parameters { omega, decay, forcing } = unknown.fixed(&scales);
        let condition = Condition::new(unknown, &layout);
        let (arguments, amplitudes) = (vec![0.0; layout.arguments().len()], vec![0.0; layout.modal().len()]);
        Self {
            phase: phase(unknown, &layout, tracked, &modal),
            exchanges: condition.as_ref().map(|_| model.exchanges()).unwrap_or_default(),
            condition,
            receptance: Receptance::new(model, harmonics, modal, unknown.is_damped()),
            aft: Aft::new(truncation),
            forces: elements.iter().map(|_| ElementForce::default()).collect(),
            displacement: arguments.clone(),
            unknowns: Unknowns::default(),
            residual: Vec::new(),
            modal_rates: vec![amplitudes.clone(); layout.parameters],
            current: State { harmonics, omega, decay, forcing, arguments, modal: amplitudes },
            lu: Lu::default(),
            factored: Unknowns::default(),
            reduction: Reduction::Whole,
            rows: Vec::new(),
            solutions: Vec::new(),
            work: Vec::new(),
            receptances: Receptances::default(),
            system,
            layout,
            elements,
            channels,
            metric,
        }
    }

    /// Measures a free forcing amplitude by `reference` instead of its scale: on curves that go through many scales of it.
    pub fn measure_forcing_by(&mut self, reference: f64) {
        let parameters = self.system.unknown.parameters();
        if let Some(index) = parameters.iter().position(|parameter| *parameter == Parameter::Forcing) {
            self.metric[self.layout.parameters().start + index] = (self.system.scales.forcing / reference).powi(2);
        }
    }

    /// Unscales `y` into `current`.
    fn load(&mut self, y: &[f64]) {
        let arguments = y[self.layout.arguments()].chunks(self.layout.nc);
        let targets = self.current.arguments.chunks_mut(self.layout.nc);
        for ((target, source), channel) in targets.zip(arguments).zip(&self.channels) {
            target.iter_mut().zip(source).for_each(|(t, s)| *t = s * channel.scale);
        }
        let modal = &y[self.layout.modal()];
        self.current.modal.iter_mut().zip(modal).for_each(|(t, s)| *t = s * self.system.scales.modal);
        let mut values = self.current.parameters();
        self.system.unknown.decode(&y[self.layout.parameters()], &self.system.scales, &mut values);
        let Parameters { omega, decay, forcing } = values;
        (self.current.omega, self.current.decay, self.current.forcing) = (omega, decay, forcing);
    }

    /// How the matrix of the state last evaluated, bordered by a row, is made smaller.
    fn reduce(&self, row: &[f64]) -> Reduction {
        match self.compression(row) {
            Some(compressed) => Reduction::Elements(compressed),
            None => self.reduction(row).map_or(Reduction::Whole, Reduction::Arcs),
        }
    }

    /// Elements that carry a force at the state last linearised.
    pub fn active(&self) -> Vec<bool> {
        self.elements.iter().map(|bound| bound.active).collect()
    }
}

/// Phase condition of a free motion, Re q = 0 of the tracked mode, or of a phase-resonant one, Re(X_m·s) = 0.
fn phase(unknown: Unknown, layout: &Layout, tracked: usize, modal: &Modal) -> Option<Vec<f64>> {
    let mut phase = vec![0.0; layout.len()];
    match unknown {
        Unknown::Mode { .. } => phase[layout.mode(tracked).start + 1] = 1.0,
        Unknown::PhaseResonance => {
            let size = crate::linalg::dot(modal.forcing(), modal.forcing()).sqrt();
            for (j, projection) in modal.forcing().iter().enumerate() {
                phase[layout.mode(j).start + 2 * modal.harmonic() - 1] = projection / size;
            }
        }
        Unknown::Frequency { .. } | Unknown::Blended { .. } | Unknown::Forcing { .. } | Unknown::Extremum(_) => {
            return None;
        }
    }
    Some(phase)
}

impl<'m> Formulation<'m> for PressureForm<'m> {
    fn build(
        model: &'m Model,
        truncation: HarmonicSettings,
        tracked: usize,
        unknown: Unknown,
        scales: Scales,
    ) -> Result<Self, FormulationError> {
        let is_rough = |law: &LawKind| !with_law!(law, law => Aft::has_second_derivatives(law, truncation.quadrature));
        let rough = model.elements().iter().filter(|element| is_rough(&element.law));
        let names: Vec<String> = rough.map(|element| element.name.clone()).collect();
        match unknown {
            Unknown::Extremum(_) if !names.is_empty() => Err(FormulationError::Rough { names }),
            _ => Ok(Self::new(model, truncation, tracked, unknown, scales)),
        }
    }

    fn system(&self) -> &System<'m> {
        &self.system
    }

    fn aft(&mut self) -> &mut Aft {
        &mut self.aft
    }

    fn encode(&self, state: &State) -> Vec<f64> {
        let mut y = Vec::with_capacity(self.layout.len());
        for (series, channel) in state.arguments.chunks(self.layout.nc).zip(&self.channels) {
            y.extend(series.iter().map(|a| a / channel.scale));
        }
        y.extend(state.modal.iter().map(|q| q / self.system.scales.modal));
        y.extend(self.system.unknown.encode(state, &self.system.scales));
        y
    }

    fn decode(&mut self, y: &[f64]) -> Result<State, LinalgError> {
        self.load(y);
        Ok(self.current.clone())
    }

    fn growth(&self, y: &[f64]) -> Vec<f64> {
        let modal = self.layout.modal();
        let mut direction = vec![0.0; y.len()];
        direction[modal.clone()].copy_from_slice(&y[modal]);
        direction
    }

    fn forces(&mut self, y: &[f64]) -> Vec<f64> {
        self.linearise(&mut y.to_vec());
        let mut force = vec![0.0; self.layout.arguments().len()];
        for block in &self.unknowns.blocks {
            force[self.layout.element(&block.channels)].copy_from_slice(&self.forces[block.element].force);
        }
        force
    }
}

impl Problem for PressureForm<'_> {
    fn len(&self) -> usize {
        self.metric.len()
    }

    fn asymmetries(&self, y: &[f64]) -> Vec<f64> {
        self.asymmetries_of(&y[self.layout.modal()])
    }

    fn parameters(&self) -> usize {
        self.layout.parameters
    }

    fn metric(&self) -> &[f64] {
        &self.metric
    }

    fn linearise(&mut self, y: &mut [f64]) -> f64 {
        let residual = self.evaluate(y);
        match self.condition.take() {
            Some(mut condition) if residual.is_finite() => {
                let value = self.evaluate_condition(&mut condition);
                self.condition = Some(condition);
                self.residual.push(value);
                if value.is_finite() { residual.max(value.abs()) } else { f64::NAN }
            }
            condition => {
                self.condition = condition;
                residual
            }
        }
    }

    fn factor(&mut self, row: &[f64]) -> Result<(), LinalgError> {
        self.reduction = self.reduce(row);
        match std::mem::replace(&mut self.reduction, Reduction::Whole) {
            Reduction::Whole => self.assemble(row),
            Reduction::Arcs(reduced) => {
                self.assemble_reduced(&reduced, row);
                self.reduction = Reduction::Arcs(reduced);
            }
            Reduction::Elements(compressed) => {
                self.assemble_compressed(&compressed, row);
                self.reduction = Reduction::Elements(compressed);
            }
        }
        self.factored.clone_from(&self.unknowns);
        if let Some(condition) = &mut self.condition {
            condition.renew(&self.metric, &self.layout);
        }
        self.lu.factor()
    }

    fn is_factorisation_current(&self) -> bool {
        self.factored == self.unknowns
    }

    fn orientation(&mut self) -> f64 {
        let sign = self.lu.determinant_sign() * self.condition.as_ref().map_or(1.0, Condition::sign);
        sign * self.lu.distance_from_singular()
    }

    fn rounding(&self) -> f64 {
        self.condition.as_ref().map_or(0.0, Condition::rounding).max(self.rounding_error())
    }

    fn memory(&self) -> Vec<f64> {
        self.condition.as_ref().map_or_else(Vec::new, Condition::memory)
    }

    fn recall(&mut self, memory: &[f64]) {
        if let Some(condition) = &mut self.condition {
            condition.recall(memory);
        }
    }

    fn longest_step(&mut self, y: &[f64], tangent: &[f64]) -> f64 {
        self.load(y);
        let (metric, at) = (&self.metric[..self.layout.modal().end], self.current.parameters());
        narrow::longest_step(&self.system, metric, [y, tangent], &self.current.modal, at)
    }

    fn are_neighbours(&self, from: &[f64], to: &[f64]) -> bool {
        narrow::are_neighbours(&self.system, self.motion_metric(), from, to)
    }

    fn hops(&self, from: &[f64], to: &[f64]) -> bool {
        narrow::hops(&self.system, self.motion_metric(), [from, to]) || self.begins_to_slide(from, to)
    }

    fn turns_corners(&self) -> bool {
        self.condition.is_none()
    }

    fn images(&self) -> usize {
        self.system.images()
    }

    fn image(&self, y: &[f64], index: usize) -> Vec<f64> {
        self.system.image(y, self.layout.modal().end, index)
    }

    fn solve(&mut self, mismatch: f64, step: &mut [f64], tangent: &mut [f64]) {
        let mut solutions = std::mem::take(&mut self.solutions);
        solutions.clear();
        solutions.extend(self.residual.iter().map(|r| -r));
        solutions.push(-mismatch);
        let size = solutions.len();
        solutions.resize(2 * size, 0.0);
        solutions[2 * size - 1] = 1.0;
        match std::mem::replace(&mut self.reduction, Reduction::Whole) {
            Reduction::Elements(compressed) => {
                self.solve_compressed(&compressed, &solutions, [step, tangent]);
                self.reduction = Reduction::Elements(compressed);
            }
            other => {
                match &other {
                    Reduction::Arcs(reduced) => self.solve_reduced(reduced, &mut solutions),
                    _ => self.lu.solve(&mut solutions),
                }
                self.reduction = other;
                self.expand(&solutions[..size], step);
                self.expand(&solutions[size..], tangent);
            }
        }
        self.solutions = solutions;
    }

    fn solve_transposed(&mut self, form: &[f64]) -> Vec<f64> {
        debug_assert!(self.is_factorisation_current(), "the unknowns have changed since the matrix was factorised");
        let reduction = std::mem::replace(&mut self.reduction, Reduction::Whole);
        let weights = match &reduction {
            Reduction::Whole => {
                let mut weights = vec![0.0; self.unknowns.len()];
                self.assemble_form(&mut weights, form);
                self.lu.solve_transposed(&mut weights);
                weights
            }
            Reduction::Arcs(reduced) => self.solve_reduced_transposed(reduced, form),
            Reduction::Elements(compressed) => self.solve_compressed_transposed(compressed, form),
        };
        self.reduction = reduction;
        weights
    }
}
