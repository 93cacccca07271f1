//! Derivatives of the pressure form against central differences, at states with contact partly open and several kept
//! modal amplitudes; the model and the differences serve the other formulation's tests too.

use super::PressureForm;
use super::elements::BoundElement;
use crate::curve::problem::Problem;
use crate::formulation::Formulation;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::{Parameter, Unknown};
use crate::linalg::{Matrix, dot, symmetric_eigen};
use crate::settings::{HarmonicSettings, Quadrature};
use crate::structure::laws::{
    Contact, Friction, Jenkins, LawKind, PenaltySpring, PolynomialDamper, PolynomialSpring, TanhFriction, Term,
};
use crate::structure::{Damping, Element, Forcing, Model, ModelData, Modes};
use num_complex::Complex64;

pub(crate) const HARMONICS: usize = 4;
const SAMPLES: usize = 48;
/// Mode 0 is a rigid-body mode.
pub(crate) const TRACKED: usize = 1;
/// Rigid-body mode at k = 0; near 101 rad/s one pole at k = 1 (mode 1), two at k = 2 (modes 3 and 4), one at k = 3.
const FREQUENCIES: [f64; 9] = [0.0, 100.0, 137.0, 199.0, 203.0, 305.0, 450.0, 530.0, 690.0];
const OMEGA: f64 = 100.7;
const FORCING: f64 = 3.0;
const LENGTH: f64 = 1e-3;

/// Uniform numbers in ±1.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// What varies between the cases.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case {
    pub unknown: Unknown,
    pub friction: bool,
    pub full_damping: bool,
    pub other_laws: bool,
    pub forcing_harmonic: usize,
    pub quadrature: Quadrature,
}

impl Case {
    pub fn truncation(&self) -> HarmonicSettings {
        HarmonicSettings { count: HARMONICS, samples: SAMPLES, quadrature: self.quadrature }
    }
}

/// Every combination, for the kinds of unknowns given.
pub(crate) fn cases(unknowns: &[Unknown]) -> impl Iterator<Item = Case> {
    (0..32 * unknowns.len()).map(|i| {
        let (unknown, i) = (unknowns[i % unknowns.len()], i / unknowns.len());
        Case {
            unknown,
            friction: i & 1 != 0,
            full_damping: i & 2 != 0,
            other_laws: i & 4 != 0,
            forcing_harmonic: if i & 8 != 0 { 2 } else { 1 },
            quadrature: if i & 16 != 0 { Quadrature::Samples } else { Quadrature::Arcs },
        }
    })
}

/// The kinds that both formulations have.
pub(crate) const COMMON: [Unknown; 4] = [
    Unknown::Frequency { forcing: FORCING },
    Unknown::Forcing { omega: OMEGA },
    Unknown::Mode { damped: true },
    BLENDED,
];
const BLENDED: Unknown =
    Unknown::Blended { forcing: FORCING, fundamental: Complex64::new(0.4 * FORCING, -0.7 * FORCING) };
pub(super) const ALL: [Unknown; 6] = [
    Unknown::Frequency { forcing: FORCING },
    Unknown::Forcing { omega: OMEGA },
    Unknown::Mode { damped: true },
    Unknown::Mode { damped: false },
    Unknown::PhaseResonance,
    BLENDED,
];

fn contact(name: &str, gap: f64, friction: Option<Friction>, channels: [&[(usize, f64)]; 3]) -> Element {
    let law = Contact { gap, epsilon: 1.3e4, friction };
    let count = if law.friction.is_some() { 3 } else { 1 };
    let channels = channels[..count].iter().map(|c| c.to_vec()).collect();
    Element { name: name.into(), channels, law: LawKind::Contact(law) }
}

fn scalar(name: &str, channel: &[(usize, f64)], law: LawKind) -> Element {
    Element { name: name.into(), channels: vec![channel.to_vec()], law }
}

/// Nine dofs, given eigenfrequencies, random mode shapes: a contact with the ground, one between two bodies, one with
/// the ground that is too far away to touch.
pub(crate) fn model(case: Case) -> Model {
    let n = FREQUENCIES.len();
    let mut next = random(5);
    let mut symmetric = Matrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            symmetric[(i, j)] = next();
            symmetric[(j, i)] = symmetric[(i, j)];
        }
    }
    let (_, q) = symmetric_eigen(&symmetric, &Matrix::diagonal(&[1.0; 9])).unwrap();
    let root_mass: Vec<f64> = (0..n).map(|_| (1.0 + 0.4 * next()).sqrt()).collect();
    let stiffness = Matrix::from_fn(n, n, |i, j| {
        let sum: f64 = (0..n).map(|l| q[(i, l)] * q[(j, l)] * FREQUENCIES[l].powi(2)).sum();
        root_mass[i] * root_mass[j] * sum
    });
    let damping = if case.full_damping {
        let factor = Matrix::from_fn(n, n, |_, _| next());
        let square = factor.matmul(&factor.transpose());
        Damping::Full(Matrix::from_fn(n, n, |i, j| 0.5 * square[(i, j)]))
    } else {
        Damping::Modal(FREQUENCIES.iter().map(|w| 0.02 * w).collect())
    };
    // By samples the derivatives are exact however slow the sliding is; Gauss points need its direction to be smooth, so
    // there it is faster than the local velocities.
    let radius = match case.quadrature {
        Quadrature::Samples => 4e-3,
        Quadrature::Arcs => 2e-2,
    };
    let friction = |sense| case.friction.then_some(Friction { coefficient: 0.3, radius, sense });
    let mut elements = vec![
        contact("ground", LENGTH, friction(1.0), [&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)]]),
        contact("pair", 2.0 * LENGTH, friction(-1.0), [&[(3, 1.0), (4, -1.0)], &[(5, 1.0)], &[(2, 0.5), (8, 1.0)]]),
        contact("far", 40.0 * LENGTH, friction(1.0), [&[(6, 1.0)], &[(7, 1.0)], &[(8, 1.0)]]),
    ];
    if case.other_laws {
        let cubic = vec![Term { power: 1, coefficient: 500.0 }, Term { power: 3, coefficient: 4e9 }];
        elements.extend([
            scalar("cubic", &[(7, 1.0), (8, -1.0)], LawKind::PolynomialSpring(PolynomialSpring { terms: cubic })),
            scalar(
                "damper",
                &[(1, 1.0)],
                LawKind::PolynomialDamper(PolynomialDamper { terms: vec![Term { power: 3, coefficient: 200.0 }] }),
            ),
            scalar("tanh", &[(6, 1.0), (7, -1.0)], LawKind::TanhFriction(TanhFriction { limit: 2.0, velocity: 0.1 })),
            scalar("jenkins", &[(2, 1.0), (5, -1.0)], LawKind::Jenkins(Jenkins { stiffness: 5e3, limit: 2.0 })),
            scalar("stop", &[(8, -1.0)], LawKind::PenaltySpring(PenaltySpring { stiffness: 3e3, gap: 3e-4 })),
        ]);
    }
    let data = ModelData {
        name: "nine dofs".into(),
        dofs: (0..n).map(|i| format!("x{i}")).collect(),
        mass: Matrix::diagonal(&root_mass.iter().map(|r| r * r).collect::<Vec<_>>()),
        stiffness,
        modes: Modes {
            frequencies: FREQUENCIES.to_vec(),
            shapes: Matrix::from_fn(n, n, |i, j| q[(i, j)] / root_mass[i]),
        },
        damping,
        forcing: Forcing { shape: (0..n).map(|_| next()).collect(), harmonic: case.forcing_harmonic },
        elements,
        monitors: vec![0],
    };
    Model::try_from(data).unwrap()
}

/// System of a case, and a random state at which two nodes touch part of the period and one never.
pub(super) fn form<'m>(case: Case, model: &'m Model, seed: u64) -> (PressureForm<'m>, Vec<f64>) {
    let scales = Scales::new(model, TRACKED);
    let mut form = PressureForm::new(model, case.truncation(), TRACKED, case.unknown, scales);
    let (layout, mut next) = (form.layout, random(seed));
    let mut y = vec![0.0; form.len()];
    for bound in &form.elements {
        for (i, u) in bound.channels.clone().enumerate() {
            for (h, value) in y[layout.channel(u)].iter_mut().enumerate() {
                let size = if h == 0 || (bound.is_contact && i > 0) { 0.3 } else { 1.0 };
                *value = size * next() / (1 + h.div_ceil(2)) as f64;
            }
        }
    }
    let normal = |bound: &BoundElement| layout.channel(bound.channels.start);
    for bound in form.elements.iter().filter(|bound| bound.is_contact) {
        y[normal(bound)][1] = 1.5;
    }
    y[normal(&form.elements[2])][0] = -40.0;
    y[layout.modal()].iter_mut().for_each(|q| *q = next());
    for (p, parameter) in case.unknown.parameters().iter().enumerate() {
        let value = match parameter {
            Parameter::Frequency => OMEGA,
            Parameter::Decay => 0.4,
            Parameter::Forcing => FORCING,
        };
        y[layout.parameters()][p] = value / parameter.unit(&scales);
    }
    assert!(form.linearise(&mut y).is_finite());
    if let Some(condition) = &mut form.condition {
        condition.attempts = 1;
    }
    assert_eq!(form.active()[..3], [true, true, false], "{case:?}");
    for e in 0..2 {
        let share = form.aft.coverage(&form.current.arguments[normal(&form.elements[e])], 0.0).fraction();
        assert!((0.1..0.95).contains(&share), "{case:?}: element {e} touches for {share} of the period");
    }
    (form, y)
}

/// The random state in physical units.
pub(crate) fn random_state(case: Case, model: &Model, seed: u64) -> State {
    let (mut form, y) = form(case, model, seed);
    form.decode(&y).unwrap()
}

/// Positions in the full state of the unknowns that are factorised.
fn unknowns(form: &PressureForm<'_>) -> Vec<usize> {
    let mut list = Vec::new();
    for bound in form.elements.iter().filter(|bound| bound.active) {
        list.extend(form.layout.element(&bound.channels));
    }
    for kept in form.receptance.kept() {
        let start = form.layout.mode(kept.mode).start;
        match kept.harmonic {
            0 => list.push(start),
            k => list.extend([start + 2 * k - 1, start + 2 * k]),
        }
    }
    list.extend(form.layout.parameters());
    list
}

/// Derivative of `f` at 0, extrapolated from two central differences; `None` if a sample changes its state within the
/// step: the two then differ by more than smooth functions allow.
pub(crate) fn derivative(mut f: impl FnMut(f64) -> Vec<f64>) -> Option<Vec<f64>> {
    const STEP: f64 = 1.6e-5;
    let mut difference =
        |h: f64| -> Vec<f64> { f(h).iter().zip(f(-h)).map(|(plus, minus)| (plus - minus) / (2.0 * h)).collect() };
    let (wide, narrow) = (difference(STEP), difference(0.5 * STEP));
    let largest = wide.iter().fold(1.0f64, |m, d| m.max(d.abs()));
    let pairs = || wide.iter().zip(&narrow);
    let kink = pairs().any(|(wide, narrow)| (wide - narrow).abs() > 2e-9 * largest);
    (!kink).then(|| pairs().map(|(wide, narrow)| (4.0 * narrow - wide) / 3.0).collect())
}

/// Panics unless `exact` agrees with differences: 1e-6 of each entry, and rounding of the largest one.
pub(crate) fn assert_column(exact: &[f64], differences: &[f64], what: impl std::fmt::Debug) {
    let largest = exact.iter().fold(1.0f64, |m, v| m.max(v.abs()));
    for (i, (e, d)) in exact.iter().zip(differences).enumerate() {
        let tolerance = 1e-6 * e.abs() + 1e-8 * largest;
        assert!((e - d).abs() < tolerance, "{what:?}, row {i}: {e} exact, {d} by differences (largest {largest})");
    }
}

/// y + h·direction.
pub(crate) fn moved(y: &[f64], h: f64, direction: &[f64]) -> Vec<f64> {
    y.iter().zip(direction).map(|(y, d)| y + h * d).collect()
}

/// Weights on the modal entries and the parameters, as in every border row of the continuation.
pub(super) fn border(form: &PressureForm<'_>, seed: u64) -> Vec<f64> {
    let mut next = random(seed);
    form.metric().iter().map(|w| w * next()).collect()
}

/// The transposed system agrees with the solutions of the system: along the tangent no residual changes, and along the step
/// the residuals, and the mismatch, go to zero.
pub(crate) fn assert_adjoint(
    weights: &[f64],
    form: &[f64],
    (residual, mismatch): (&[f64], f64),
    (step, tangent): (&[f64], &[f64]),
) {
    let (last, rest) = weights.split_last().unwrap();
    let along_step = -dot(rest, residual) - last * mismatch;
    // Both sides are sums of terms that may cancel: compared with their sizes.
    let size = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum::<f64>();
    for (weighed, direction, other) in [(*last, tangent, last.abs()), (along_step, step, size(rest, residual))] {
        let (found, scale) = (dot(form, direction), size(form, direction) + other);
        assert!((found - weighed).abs() < 1e-9 * scale, "{found} and {weighed} of {scale}");
    }
}

/// Compares every column of the bordered Jacobian with differences; how many were compared, and how many skipped.
pub(super) fn compare_columns(case: Case, model: &Model, seed: u64) -> (usize, usize) {
    let (mut form, y) = form(case, model, seed);
    let row = border(&form, 77);
    let unknowns = unknowns(&form);
    assert!(form.receptance.kept().len() >= 4, "modes 1, 3, 4, 5 are kept");
    let size = unknowns.len();
    assert_eq!(size, form.residual.len() + 1);
    form.assemble(&row);
    let matrix = form.lu.entries().to_vec();
    let mut skipped = 0;
    for (column, &position) in unknowns.iter().enumerate() {
        let mut unit = vec![0.0; y.len()];
        unit[position] = 1.0;
        let differences = derivative(|h| {
            let mut y = moved(&y, h, &unit);
            form.linearise(&mut y);
            let mut values = form.residual.clone();
            values.push(dot(&row, &y));
            values
        });
        let exact: Vec<f64> = (0..size).map(|i| matrix[i * size + column]).collect();
        match differences {
            Some(differences) => assert_column(&exact, &differences, (case, column, size)),
            None => skipped += 1,
        }
    }
    (size - skipped, skipped)
}

#[test]
fn every_column_of_the_bordered_jacobian_matches_differences() {
    let counts = (100..).zip(cases(&ALL)).map(|(seed, case)| compare_columns(case, &model(case), seed));
    let (tested, skipped) = counts.fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    assert!(skipped * 50 < tested, "{skipped} columns skipped, {tested} tested");
}

/// Compares direction and step with differences; how many of the two were skipped.
pub(super) fn compare_directions(case: Case, model: &Model, seed: u64) -> usize {
    let (mut form, y) = form(case, model, seed);
    let row = border(&form, 77);
    let residual = form.residual.clone();
    form.assemble(&row);
    form.factored.clone_from(&form.unknowns);
    form.lu.factor().unwrap();
    let (mut tangent, mut step) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    form.solve(0.3, &mut step, &mut tangent);
    let other = border(&form, 79);
    assert_adjoint(&form.solve_transposed(&other), &other, (&residual, 0.3), (&step, &tangent));
    let mut skipped = 0;
    for (vector, product, rate) in [(&tangent, 1.0, 0.0), (&step, -0.3, -1.0)] {
        assert!((dot(&row, vector) - product).abs() < 1e-9, "{case:?}: {}", dot(&row, vector));
        // A unit step, so that the differences are as good as for a single unknown.
        let length = vector.iter().fold(1.0f64, |m, v| m.max(v.abs()));
        let direction: Vec<f64> = vector.iter().map(|v| v / length).collect();
        let differences = derivative(|h| {
            let mut y = moved(&y, h, &direction);
            form.linearise(&mut y);
            [form.residual.clone(), y].concat()
        });
        let Some(differences) = differences else {
            skipped += 1;
            continue;
        };
        let exact: Vec<f64> = residual.iter().map(|r| rate * r / length).chain(direction.iter().copied()).collect();
        assert_column(&exact, &differences, case);
    }
    skipped
}

#[test]
fn directions_and_steps_move_dependent_entries_along() {
    let skipped: usize =
        (200..).zip(cases(&ALL)).map(|(seed, case)| compare_directions(case, &model(case), seed)).sum();
    assert!(skipped * 20 < 2 * cases(&ALL).count(), "{skipped} of {} skipped", 2 * cases(&ALL).count());
}

#[test]
fn a_node_that_touches_after_all_takes_its_place_in_the_state() {
    let case = Case {
        unknown: Unknown::Frequency { forcing: 0.0 },
        friction: true,
        full_damping: false,
        other_laws: false,
        forcing_harmonic: 1,
        quadrature: Quadrature::Arcs,
    };
    // All nodes are held to be open, and the kept amplitudes push the far one against the casing.
    let mut data = ModelData::from(model(case));
    let LawKind::Contact(far) = &mut data.elements[2].law else { unreachable!() };
    far.gap = 0.5 * LENGTH;
    let model = Model::try_from(data).unwrap();
    let scales = Scales::new(&model, TRACKED);
    let mut form = PressureForm::new(&model, case.truncation(), TRACKED, case.unknown, scales);
    let mut y = vec![0.0; form.len()];
    for bound in &form.elements {
        y[form.layout.channel(bound.channels.start)][0] = -1.0;
    }
    y[form.layout.mode(TRACKED)][1] = 3.0;
    *y.last_mut().unwrap() = OMEGA / scales.frequency;
    form.linearise(&mut y);
    assert!(form.active().contains(&true));
    let stored = form.encode(&form.current.clone());
    for (a, b) in y.iter().zip(&stored) {
        assert!((a - b).abs() < 1e-12, "the state holds {a}, the forces were computed at {b}");
    }
}
