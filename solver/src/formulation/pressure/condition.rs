//! The condition of fold and peak curves: a quantity q has an extremum along the branch at fixed A.
//!
//! Along the branch (x, ω) moves on the null vector of \[R_x R_ω\], so at an extremum of q
//!
//! S = [[R_x, R_ω], [q_x, q_ω]] is singular.
//!
//! With q = ω these are the folds (R_x singular), with q the amplitude the peaks. Unlike a condition on the tangent, S has
//! a simple null space at births and merges too, where \[R_x R_ω\] has two null vectors. As in minimally extended systems
//! (Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000) the scalar equation is g = 0
//! from a bordered matrix, its gradient from that and the transposed solution:
//!
//! [[S, b], [cᵀ, 0]] [v; g] = [0; 1], [wᵀ g] [[S, b], [cᵀ, 0]] = [0 1], ∂g = −wᵀ ∂S v.
//!
//! b and c are the null vectors of the last matrix factorised; the zeros of g do not depend on them.

use super::PressureForm;
use super::assemble::Target;
use super::layout::{Layout, Pair};
use crate::curve::problem::{norm, weighted};
use crate::formulation::harmonics::evaluate;
use crate::formulation::unknown::{Quantity, Unknown};
use crate::linalg::{Lu, axpy, dot};
use std::f64::consts::{PI, TAU};

/// Cosine between a null vector and its border below which the border is renewed at once.
const POOR: f64 = 0.3;

/// Most matrices factorised at one state to make the borders fit.
const ATTEMPTS: usize = 5;

/// Bordered matrix of a state, and its solutions.
pub(super) struct Condition {
    quantity: Quantity,
    /// b: weights of the equations of all channels, all modes and the quantity's; those of rows that are not there do not
    /// count.
    column: Vec<f64>,
    /// cᵀ: a linear form on the state, without A.
    row: Vec<f64>,
    /// Rows of the harmonic balance, in both parameters.
    equations: Vec<f64>,
    inner: Lu,
    /// g.
    value: f64,
    /// v: a direction of the full state.
    direction: Vec<f64>,
    /// Its part on the unknowns of the matrix.
    solution: Vec<f64>,
    /// w: weights of the rows that are there, the quantity's last.
    weights: Vec<f64>,
    /// Places in `column` of these rows.
    places: Vec<usize>,
    /// Gradient of q as a linear form on the state.
    gradient: Vec<f64>,
    /// Instant of the largest |x| of the monitor, where it was last.
    instant: Option<f64>,
    /// Most matrices factorised at one state to make the borders fit: with one they stay as they are, and g is smooth.
    pub attempts: usize,
}

/// What an extremum of A along the curve is told by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degeneracy {
    /// Weight of the quantity in the left null vector of S, relative to all: zero where \[R_x R_ω\] loses its rank.
    pub multiplier: f64,
    /// Determinant of the reduced Hessian w_Rᵀ R_yy\[φ_i, φ_j\], y = (x, ω), φ spanning the null vectors of \[R_x R_ω\] there:
    /// positive where the branch is a point (an isola is born), negative where it crosses itself (two branches merge).
    pub hessian: f64,
}

impl Condition {
    pub fn new(unknown: Unknown, layout: &Layout) -> Option<Self> {
        let Unknown::Extremum(quantity) = unknown else { return None };
        // No two entries are alike, so that hardly any null vector is orthogonal.
        let spread = |i: usize| (1.0 + i as f64).cos();
        let modal = layout.modal();
        let mut row = vec![0.0; layout.len()];
        row[modal.clone()].iter_mut().enumerate().for_each(|(i, c)| *c = spread(i));
        let mut condition = Self {
            quantity,
            column: (0..=modal.end).map(spread).collect(),
            row,
            equations: Vec::new(),
            inner: Lu::default(),
            value: f64::NAN,
            direction: Vec::new(),
            solution: Vec::new(),
            weights: Vec::new(),
            places: Vec::new(),
            gradient: Vec::new(),
            instant: None,
            attempts: ATTEMPTS,
        };
        for border in [&mut condition.column, &mut condition.row] {
            let length = dot(border, border).sqrt();
            border.iter_mut().for_each(|c| *c /= length);
        }
        Some(condition)
    }

    /// Rows of the harmonic balance at the state last linearised.
    pub fn equations(&self) -> &[f64] {
        let size = self.places.len() + 1;
        &self.equations[..(size - 2) * size]
    }

    /// Sign of the determinant of the bordered matrix: both change with those of b and c.
    pub fn sign(&self) -> f64 {
        self.inner.determinant_sign()
    }

    /// Rounding error of g to expect: that of the terms of wᵀ S v.
    pub fn rounding(&self) -> f64 {
        let size = self.places.len() + 1;
        let product = |row: &[f64]| -> f64 { row.iter().zip(&self.solution).map(|(s, v)| (s * v).abs()).sum() };
        let rows = self.weights.iter().zip(self.equations.chunks(size));
        8.0 * f64::EPSILON * rows.map(|(w, row)| w.abs() * product(row)).sum::<f64>()
    }

    /// The borders, and where the largest |x| was: g and its gradient depend on them by rounding.
    pub fn memory(&self) -> Vec<f64> {
        let instant = self.instant.map_or([0.0; 2], |instant| [1.0, instant]);
        [&self.column[..], &self.row[..], &instant].concat()
    }

    /// Takes up what [`Condition::memory`] gave; anything else changes nothing.
    pub fn recall(&mut self, memory: &[f64]) {
        let (columns, rows) = (self.column.len(), self.row.len());
        if memory.len() == columns + rows + 2 {
            self.column.copy_from_slice(&memory[..columns]);
            self.row.copy_from_slice(&memory[columns..columns + rows]);
            self.instant = (memory[columns + rows] != 0.0).then_some(memory[columns + rows + 1]);
        }
    }

    /// Takes the null vectors of the state last linearised as borders.
    pub fn renew(&mut self, metric: &[f64], layout: &Layout) {
        let length = norm(metric, &self.direction);
        let size = dot(&self.weights, &self.weights).sqrt();
        if !(length.is_finite() && size.is_finite()) {
            return;
        }
        self.row = weighted(metric, &self.direction);
        self.row[layout.len() - 1] = 0.0;
        self.row.iter_mut().for_each(|c| *c /= length);
        self.column.fill(0.0);
        for (place, w) in self.places.iter().zip(&self.weights) {
            self.column[*place] = w / size;
        }
    }

    /// Fills the bordered matrix and solves with it; NaN if it is singular.
    fn solve(&mut self, border: &[f64]) -> f64 {
        let size = self.places.len() + 1;
        let inner = self.inner.reset(size);
        for (i, (target, source)) in inner.chunks_mut(size).zip(self.equations.chunks(size)).enumerate() {
            // The column of A is not part of S: b stands in its place.
            target.copy_from_slice(source);
            target[size - 1] = self.column[self.places[i]];
            if i + 1 == self.places.len() {
                break;
            }
        }
        let last = &mut inner[(size - 1) * size..];
        last.copy_from_slice(border);
        last[size - 1] = 0.0;
        if self.inner.factor().is_err() {
            return f64::NAN;
        }
        for vector in [&mut self.solution, &mut self.weights] {
            vector.clear();
            vector.resize(size, 0.0);
            vector[size - 1] = 1.0;
        }
        self.inner.solve(&mut self.solution);
        self.inner.solve_transposed(&mut self.weights);
        self.weights.truncate(size - 1);
        // The last entry is g; in its place v has that of A, which is none.
        std::mem::take(&mut self.solution[size - 1])
    }
}

impl PressureForm<'_> {
    /// Value g of the condition at the state last evaluated; NaN if its matrix is singular.
    pub(super) fn evaluate_condition(&mut self, condition: &mut Condition) -> f64 {
        let size = self.unknowns.len();
        condition.equations.clear();
        condition.equations.resize((size - 1) * size, 0.0);
        let mut target = Target { data: &mut condition.equations, size, first: 0 };
        self.assemble_equations(&mut target);
        condition.gradient = match condition.quantity {
            Quantity::Frequency => self.parameter_form(),
            Quantity::Amplitude => self.amplitude_form(&mut condition.instant),
            Quantity::Rms => self.mean_square_form(&self.monitored()),
        };
        self.assemble_form(&mut condition.equations[(size - 2) * size..], &condition.gradient);
        condition.places = self.places();
        let mut border = vec![0.0; size];
        for attempt in 1..=condition.attempts {
            border.fill(0.0);
            self.assemble_form(&mut border, &condition.row);
            condition.value = condition.solve(&border);
            if !condition.value.is_finite() {
                return f64::NAN;
            }
            condition.direction.resize(self.layout.len(), 0.0);
            self.expand(&condition.solution, &mut condition.direction);
            // Both borders have unit length, and unit products with the null vectors.
            let lengths =
                [norm(&self.metric, &condition.direction), dot(&condition.weights, &condition.weights).sqrt()];
            if attempt == condition.attempts || lengths.iter().all(|length| length * POOR < 1.0) {
                break;
            }
            condition.renew(&self.metric, &self.layout);
        }
        condition.value
    }

    /// Gradient of g as a linear form on the state.
    pub(super) fn condition_gradient(&mut self, condition: &Condition) -> Vec<f64> {
        let mut form = self.weighed_second(condition, &condition.direction);
        let weight = condition.weights.last().copied().unwrap_or_default();
        match condition.quantity {
            Quantity::Frequency => {}
            Quantity::Amplitude => self.add_amplitude_second(condition, weight, &mut form),
            Quantity::Rms => {
                let along = self.monitored_along(&condition.direction);
                axpy(weight, &self.mean_square_form(&along), &mut form);
            }
        }
        form.iter_mut().for_each(|f| *f = -*f);
        form
    }

    /// w_Rᵀ R_yy\[direction, ·\] as a linear form on the state.
    fn weighed_second(&mut self, condition: &Condition, direction: &[f64]) -> Vec<f64> {
        let (quantity, balance) = condition.weights.split_last().unwrap_or((&0.0, &[]));
        // What the eliminated equations weigh also depends on the two rows that are no equations.
        let rows = condition.gradient.iter().zip(&condition.row);
        let rest: Vec<f64> = rows.map(|(q, c)| quantity * q + condition.value * c).collect();
        self.second_form(balance, &rest, direction)
    }

    /// What tells an extremum of A, at the state last linearised; none if this is no curve of extrema.
    pub fn degeneracy(&mut self) -> Option<Degeneracy> {
        let mut condition = self.condition.take()?;
        let size = self.unknowns.len();
        let multiplier =
            condition.weights.last().copied().unwrap_or_default() / dot(&condition.weights, &condition.weights).sqrt();
        // The other null vector has q = 1.
        let mut solution = vec![0.0; size];
        solution[size - 2] = 1.0;
        condition.inner.solve(&mut solution);
        solution[size - 1] = 0.0;
        let mut other = vec![0.0; self.layout.len()];
        self.expand(&solution, &mut other);
        let vectors = [condition.direction.clone(), other];
        let rows = [0, 1].map(|i| self.weighed_second(&condition, &vectors[i]));
        let entry = |i: usize, j: usize| dot(&rows[i], &vectors[j]);
        let hessian = entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0);
        self.condition = Some(condition);
        Some(Degeneracy { multiplier, hessian })
    }

    /// What has an extremum, if this is a curve of extrema.
    pub fn quantity(&self) -> Option<Quantity> {
        self.condition.as_ref().map(|condition| condition.quantity)
    }

    /// Null vector of S (not of unit length) at the state last linearised; none if this is no curve of extrema.
    pub fn null_vector(&self) -> Option<&[f64]> {
        self.condition.as_ref().map(|condition| condition.direction.as_slice())
    }

    /// Places of the rows of S in a full list: channels, modes, the quantity.
    fn places(&self) -> Vec<usize> {
        let mut places = Vec::with_capacity(self.unknowns.len() - 1);
        for block in &self.unknowns.blocks {
            places.extend(self.layout.element(&block.channels));
        }
        for at in &self.unknowns.kept {
            let pair = Pair::of(at.kept.harmonic).after(self.layout.mode(at.kept.mode).start);
            places.push(pair.a);
            places.extend(pair.b);
        }
        places.push(self.layout.modal().end);
        places
    }

    /// ω as a linear form on the state.
    fn parameter_form(&self) -> Vec<f64> {
        let mut form = vec![0.0; self.layout.len()];
        form[self.layout.parameters().start] = 1.0;
        form
    }

    /// Gradient of the monitored displacement at the instant of its largest |x|, in reference lengths. The instant near the
    /// one given is taken if there still is one.
    fn amplitude_form(&self, instant: &mut Option<f64>) -> Vec<f64> {
        let series = self.monitored();
        let near = instant.and_then(|instant| extremum_near(&series, instant));
        let tau = near.unwrap_or_else(|| largest(&series));
        *instant = Some(tau);
        let sign = evaluate(&series, tau)[0].signum();
        self.monitor_form(tau, sign / self.system.scales.length, 0)
    }

    /// Adds weight × q_xx\[v, ·\]: by the movement of the instant.
    fn add_amplitude_second(&self, condition: &Condition, weight: f64, form: &mut [f64]) {
        let (series, Some(tau)) = (self.monitored(), condition.instant) else { return };
        let [value, _, curvature] = evaluate(&series, tau);
        let slope = self.monitor_form(tau, 1.0, 1);
        let along = dot(&slope, &condition.direction);
        let factor = -weight * value.signum() * along / (curvature * self.system.scales.length);
        axpy(factor, &slope, form);
    }

    /// Displacement of the first monitored dof, m.
    fn monitored(&self) -> Vec<f64> {
        let model = self.system.model;
        self.current.displacement(model, model.monitors()[0])
    }

    /// Displacement of the first monitored dof along a direction of the scaled state, m.
    fn monitored_along(&self, direction: &[f64]) -> Vec<f64> {
        let (model, scale) = (self.system.model, self.system.scales.modal);
        let mut series = vec![0.0; self.layout.nc];
        for (j, shape) in model.modes().shapes.row(model.monitors()[0]).iter().enumerate() {
            axpy(shape * scale, &direction[self.layout.mode(j)], &mut series);
        }
        series
    }

    /// Half the gradient of the mean square of the monitored displacement (where it is `series`), in squares of the reference
    /// length; linear in `series`.
    fn mean_square_form(&self, series: &[f64]) -> Vec<f64> {
        let (model, scales) = (self.system.model, &self.system.scales);
        let mean: Vec<f64> = series.iter().enumerate().map(|(h, x)| if h == 0 { *x } else { 0.5 * x }).collect();
        let mut form = vec![0.0; self.layout.len()];
        for (j, shape) in model.modes().shapes.row(model.monitors()[0]).iter().enumerate() {
            axpy(shape * scales.modal / scales.length.powi(2), &mean, &mut form[self.layout.mode(j)]);
        }
        form
    }

    /// factor × displacement of the monitor at an instant (`order` 0), or its slope (1), as a linear form on the scaled state.
    fn monitor_form(&self, tau: f64, factor: f64, order: usize) -> Vec<f64> {
        let (model, layout) = (self.system.model, &self.layout);
        let mut basis = vec![0.0; layout.nc];
        basis[0] = if order == 0 { 1.0 } else { 0.0 };
        for k in 1..=layout.nc / 2 {
            let (sine, cosine) = (k as f64 * tau).sin_cos();
            let (a, b) = if order == 0 { (cosine, sine) } else { (-(k as f64) * sine, k as f64 * cosine) };
            (basis[2 * k - 1], basis[2 * k]) = (a, b);
        }
        let mut form = vec![0.0; layout.len()];
        for (j, shape) in model.modes().shapes.row(model.monitors()[0]).iter().enumerate() {
            axpy(factor * shape * self.system.scales.modal, &basis, &mut form[layout.mode(j)]);
        }
        form
    }
}

/// The extremum of |x| near an instant, if there is one within a quarter of the shortest period.
fn extremum_near(series: &[f64], near: f64) -> Option<f64> {
    let reach = 0.5 * PI / (series.len() / 2).max(1) as f64;
    let mut tau = near;
    for _ in 0..20 {
        let [value, slope, curvature] = evaluate(series, tau);
        let step = slope / curvature;
        tau -= step;
        if value * curvature >= 0.0 || (tau - near).abs() > reach || !tau.is_finite() {
            return None;
        }
        if step.abs() < 1e-14 * TAU {
            break;
        }
    }
    Some(tau)
}

/// The instant of the largest |x|.
fn largest(series: &[f64]) -> f64 {
    let count = (8 * series.len()).max(64);
    let instant = |i: usize| TAU * i as f64 / count as f64;
    let size = |tau: f64| evaluate(series, tau)[0].abs();
    let best = (0..count).max_by(|&a, &b| size(instant(a)).total_cmp(&size(instant(b))));
    let tau = instant(best.unwrap_or_default());
    extremum_near(series, tau).unwrap_or(tau)
}
