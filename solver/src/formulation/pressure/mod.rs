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
//! Contact nodes with p < 0 at every instant have no force and identity columns; they are eliminated exactly.

mod assemble;
mod evaluate;
#[cfg(test)]
pub(crate) mod tests;

use crate::curve::problem::Problem;
use crate::formulation::aft::{Aft, ElementForce};
use crate::formulation::harmonics::width;
use crate::formulation::receptance::{Kept, Receptance};
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::{Parameter, Unknown};
use crate::linalg::Lu;
use crate::settings::HarmonicSettings;
use crate::structure::laws::{Law, LawKind, MAX_ARGUMENTS};
use crate::structure::{Damping, Model};
use rustfft::num_complex::Complex64;

/// A nonlinear element as the pressure form sees it.
struct Slot {
    law: LawKind,
    /// First channel and number of channels.
    first: usize,
    count: usize,
    /// Rigid contact: ε and gap.
    contact: Option<(f64, f64)>,
    /// For each force, one more than the last argument it depends on.
    reach: [usize; MAX_ARGUMENTS],
    active: bool,
}

/// Row constants of a channel: residual = a − δ f − s x + c, divided by the scale of a.
#[derive(Debug, Clone, Copy)]
struct Channel {
    /// s: ε for a contact normal, 1 otherwise.
    gain: f64,
    /// δ: 1 for a contact normal, 0 otherwise.
    feedback: f64,
    /// c: ε × gap for a contact normal, 0 otherwise (harmonic 0).
    offset: f64,
    /// Scale of the argument.
    scale: f64,
}

/// The system in pressure form, bound to a model, a truncation and a kind of unknown parameters.
pub struct PressureForm<'m> {
    model: &'m Model,
    unknown: Unknown,
    tracked: usize,
    scales: Scales,
    harmonics: usize,
    nc: usize,
    slots: Vec<Slot>,
    channels: Vec<Channel>,
    /// Φᵀ s.
    modal_forcing: Vec<f64>,
    receptance: Receptance,
    aft: Aft,
    metric: Vec<f64>,
    /// Phase condition as a linear form on the state, if there is one.
    phase: Option<Vec<f64>>,
    /// The state last linearised, in physical units.
    current: State,
    /// Forces per element; jacobian columns are per scaled argument.
    forces: Vec<ElementForce>,
    /// Channel displacements, channels × nc.
    displacement: Vec<f64>,
    residual: Vec<f64>,
    /// Derivatives of the dependent modal amplitudes with respect to each parameter, modes × nc each.
    modal_rates: Vec<Vec<f64>>,
    lu: Lu,
    /// Active elements and kept amplitudes of the matrix last factorised.
    factored: (Vec<bool>, Vec<Kept>),
    solutions: Vec<f64>,
    work: Vec<Complex64>,
    receptance_re: Vec<f64>,
    receptance_im: Vec<f64>,
    receptance_work: Vec<f64>,
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
        let harmonics = truncation.count;
        let (n, nc) = (model.size(), width(harmonics));
        let mut slots = Vec::new();
        let mut channels = Vec::new();
        let mut shapes = Vec::new();
        for element in &model.elements {
            let count = element.law.arguments();
            let contact = match &element.law {
                LawKind::Contact(contact) => Some((contact.epsilon, contact.gap)),
                _ => None,
            };
            let pattern = element.law.pattern();
            let depends = |i: usize, j: &usize| pattern.du[i][*j] || pattern.dv[i][*j];
            let reach = std::array::from_fn(|i| (0..count).rev().find(|j| depends(i, j)).map_or(0, |j| j + 1));
            let first = channels.len();
            slots.push(Slot { law: element.law.clone(), first, count, contact, reach, active: false });
            for (i, combination) in element.channels.iter().take(count).enumerate() {
                channels.push(match contact {
                    Some((epsilon, gap)) if i == 0 => {
                        Channel { gain: epsilon, feedback: 1.0, offset: epsilon * gap, scale: epsilon * scales.length }
                    }
                    _ => Channel { gain: 1.0, feedback: 0.0, offset: 0.0, scale: scales.length },
                });
                shapes.extend((0..n).map(|j| {
                    combination.iter().map(|&(dof, factor)| factor * model.modes.shapes[(dof, j)]).sum::<f64>()
                }));
            }
        }
        let parameters = unknown.parameters().len();
        let arguments = channels.len() * nc;
        let mut metric = vec![0.0; arguments + n * nc + parameters];
        metric[arguments..].fill(1.0);
        let modal_forcing = model.modes.shapes.transpose().mul_vec(&model.forcing.shape);
        let mut phase = vec![0.0; metric.len()];
        match unknown {
            Unknown::Mode { .. } => phase[arguments + tracked * nc + 1] = 1.0,
            Unknown::PhaseResonance => {
                let size = crate::linalg::dot(&modal_forcing, &modal_forcing).sqrt();
                for (j, projection) in modal_forcing.iter().enumerate() {
                    phase[arguments + j * nc + 2 * model.forcing.harmonic - 1] = projection / size;
                }
            }
            Unknown::Frequency | Unknown::Forcing => {}
        }
        Self {
            unknown,
            tracked,
            harmonics,
            nc,
            phase: (parameters == 2).then_some(phase),
            modal_forcing,
            receptance: Receptance::new(model, harmonics, shapes, unknown != Unknown::Mode { damped: false }),
            aft: Aft::new(truncation),
            metric,
            current: State {
                harmonics,
                omega: scales.frequency,
                decay: 0.0,
                forcing: 0.0,
                arguments: vec![0.0; arguments],
                modal: vec![0.0; n * nc],
            },
            forces: slots.iter().map(|_| ElementForce::default()).collect(),
            displacement: vec![0.0; arguments],
            residual: Vec::new(),
            modal_rates: vec![vec![0.0; n * nc]; parameters],
            lu: Lu::default(),
            factored: (Vec::new(), Vec::new()),
            solutions: Vec::new(),
            work: Vec::new(),
            receptance_re: Vec::new(),
            receptance_im: Vec::new(),
            receptance_work: Vec::new(),
            slots,
            channels,
            model,
            scales,
        }
    }

    /// The model.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// Scales of the unknowns.
    pub fn scales(&self) -> &Scales {
        &self.scales
    }

    /// Frequency–time work space.
    pub fn aft(&mut self) -> &mut Aft {
        &mut self.aft
    }

    /// Sets the forcing amplitude A of a system whose unknown is the frequency.
    pub fn set_forcing(&mut self, forcing: f64) {
        self.current.forcing = forcing;
    }

    /// Sets the frequency of a system whose unknown is the forcing amplitude, rad/s.
    pub fn set_frequency(&mut self, omega: f64) {
        self.current.omega = omega;
    }

    /// Scaled state vector of a solution.
    pub fn encode(&self, state: &State) -> Vec<f64> {
        let mut y = Vec::with_capacity(self.metric.len());
        for (series, channel) in state.arguments.chunks(self.nc).zip(&self.channels) {
            y.extend(series.iter().map(|a| a / channel.scale));
        }
        y.extend(state.modal.iter().map(|q| q / self.scales.modal));
        y.extend(self.unknown.encode(state, &self.scales));
        y
    }

    /// Solution of a scaled state vector.
    pub fn decode(&mut self, y: &[f64]) -> State {
        self.load(y);
        self.current.clone()
    }

    /// Unscales `y` into `current`.
    fn load(&mut self, y: &[f64]) {
        let (arguments, rest) = y.split_at(self.current.arguments.len());
        let (modal, parameters) = rest.split_at(self.current.modal.len());
        let targets = self.current.arguments.chunks_mut(self.nc);
        for ((target, source), channel) in targets.zip(arguments.chunks(self.nc)).zip(&self.channels) {
            target.iter_mut().zip(source).for_each(|(t, s)| *t = s * channel.scale);
        }
        self.current.modal.iter_mut().zip(modal).for_each(|(t, s)| *t = s * self.scales.modal);
        for (&parameter, value) in self.unknown.parameters().iter().zip(parameters) {
            let value = value * parameter.unit(&self.scales);
            match parameter {
                Parameter::Frequency => self.current.omega = value,
                Parameter::Decay => self.current.decay = value,
                Parameter::Forcing => self.current.forcing = value,
            }
        }
    }

    /// Number of unknown parameters.
    fn parameters(&self) -> usize {
        self.modal_rates.len()
    }

    /// Direction in which the motion of a scaled state grows, its parameters unchanged.
    pub fn growth(&self, y: &[f64]) -> Vec<f64> {
        let (arguments, modal) = (self.current.arguments.len(), self.current.modal.len());
        let mut direction = vec![0.0; y.len()];
        direction[arguments..arguments + modal].copy_from_slice(&y[arguments..arguments + modal]);
        direction
    }

    /// Arguments of the laws when none of them exerts a force: displacements, and −ε times the open gap for contact
    /// normals.
    pub fn open_arguments(&self, modal: &[f64]) -> Vec<f64> {
        let mut arguments = vec![0.0; self.current.arguments.len()];
        for (u, (series, channel)) in arguments.chunks_mut(self.nc).zip(&self.channels).enumerate() {
            self.receptance.channel(u, modal, series);
            series.iter_mut().for_each(|x| *x *= channel.gain);
            series[0] -= channel.offset;
        }
        arguments
    }

    /// Force harmonics at the state last linearised, channels × nc, N (left-hand side).
    pub fn force(&self) -> Vec<f64> {
        let mut force = vec![0.0; self.current.arguments.len()];
        for (slot, element) in self.slots.iter().zip(&self.forces).filter(|(slot, _)| slot.active) {
            let start = slot.first * self.nc;
            force[start..start + slot.count * self.nc].copy_from_slice(&element.force);
        }
        force
    }

    /// The part of the metric that measures motions, without the parameters.
    pub fn motion_metric(&self) -> &[f64] {
        &self.metric[..self.metric.len() - self.parameters()]
    }

    /// Linear form that takes the (first) parameter out of the state: the frequency, or the forcing amplitude.
    pub fn parameter_row(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.metric.len()];
        row[self.metric.len() - self.parameters()] = 1.0;
        row
    }

    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// The linear damping that acts, in modal coordinates.
    pub fn damping(&self) -> &Damping {
        self.receptance.damping()
    }

    /// Φᵀ s: the forcing shape in modal coordinates.
    pub fn modal_forcing(&self) -> &[f64] {
        &self.modal_forcing
    }

    /// Modal shape b̂ of channel `u`.
    pub fn channel_shape(&self, u: usize) -> &[f64] {
        self.receptance.shape(u)
    }

    /// Elements that carry a force at the state last linearised.
    pub fn active(&self) -> Vec<bool> {
        self.slots.iter().map(|slot| slot.active).collect()
    }
}

impl Problem for PressureForm<'_> {
    fn len(&self) -> usize {
        self.metric.len()
    }

    fn metric(&self) -> &[f64] {
        &self.metric
    }

    fn linearise(&mut self, y: &mut [f64]) -> f64 {
        self.evaluate(y)
    }

    fn factor(&mut self, row: &[f64]) -> Result<(), crate::linalg::LinalgError> {
        self.assemble(row);
        self.factored = (self.active(), self.receptance.kept().to_vec());
        self.lu.factor()
    }

    fn is_factorisation_current(&self) -> bool {
        let active = self.slots.iter().map(|slot| slot.active);
        self.factored.0.iter().copied().eq(active) && self.factored.1 == self.receptance.kept()
    }

    fn orientation(&self) -> f64 {
        self.lu.determinant_sign()
    }

    fn solve(&mut self, mismatch: f64, step: &mut [f64], tangent: &mut [f64]) {
        let mut solutions = std::mem::take(&mut self.solutions);
        solutions.clear();
        solutions.extend(self.residual.iter().map(|r| -r));
        solutions.push(-mismatch);
        let size = solutions.len();
        solutions.resize(2 * size, 0.0);
        solutions[2 * size - 1] = 1.0;
        self.lu.solve(&mut solutions);
        self.expand(&solutions[..size], step);
        self.expand(&solutions[size..], tangent);
        self.solutions = solutions;
    }
}
