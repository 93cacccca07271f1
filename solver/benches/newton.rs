//! One Newton iteration (residual, Jacobian, factorisation, step and tangent) on rotor 67 with friction: pressure form
//! against displacement form where three nodes touch, the parts of an iteration, one on a fold curve, and the cost over contact
//! nodes and harmonics.
#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use solver::curve::problem::Problem;
use solver::files;
use solver::formulation::Formulation;
use solver::formulation::aft::{Aft, ElementForce, Rate};
use solver::formulation::displacement::DisplacementForm;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::state::State;
use solver::formulation::unknown::{Quantity, Unknown};
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::settings::{HarmonicSettings, Quadrature, Settings};
use solver::structure::laws::LawKind;
use solver::structure::{Element, Model, ModelData};
use std::hint::black_box;
use std::path::Path;

const MODE: Unknown = Unknown::Mode { damped: true };

fn rotor() -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    files::load(&folder).expect("the model is part of the repository")
}

/// A backbone motion during which exactly three nodes touch.
fn three_nodes(model: &Model) -> State {
    let mut settings = Settings::default();
    settings.backbone.max_amplitude = Some(1e-3);
    let backbone = Backbone::compute(model, &settings).expect("it starts");
    let touching = |p: &&BackbonePoint| p.point.contact().iter().filter(|&&share| share > 0.0).count() == 3;
    backbone.points.iter().find(touching).expect("three nodes touch somewhere").point.state.clone()
}

/// Linearises, factorises and solves at `y`; the unknowns are not moved.
fn iteration(problem: &mut impl Problem, y: &mut [f64], row: &[f64], work: &mut [Vec<f64>; 2]) -> f64 {
    let [step, tangent] = work;
    problem.linearise(black_box(y));
    problem.factor(row).expect("regular");
    problem.solve(0.0, step, tangent);
    step[0]
}

fn formulations(c: &mut Criterion) {
    let model = rotor();
    let state = three_nodes(&model);
    let scales = Scales::new(&model, 0);
    let mut group = c.benchmark_group("iteration, 3 nodes, H = 10, N_t = 512");
    for quadrature in [Quadrature::Arcs, Quadrature::Samples] {
        let truncation = HarmonicSettings { quadrature, ..Default::default() };
        let mut pressure = PressureForm::new(&model, truncation, 0, MODE, scales);
        let (mut y, row) = (pressure.encode(&state), pressure.parameter_row());
        let mut work = [vec![0.0; y.len()], vec![0.0; y.len()]];
        group.bench_function(BenchmarkId::new("pressure form", format!("{quadrature:?}")), |b| {
            b.iter(|| iteration(&mut pressure, &mut y, &row, &mut work));
        });
        let mut displacement = DisplacementForm::new(&model, truncation, 0, MODE, scales).expect("separable");
        let mut y = displacement.encode(&state);
        let mut row = vec![0.0; y.len()];
        row[y.len() - 2] = 1.0;
        let mut work = [vec![0.0; y.len()], vec![0.0; y.len()]];
        group.bench_function(BenchmarkId::new("displacement form", format!("{quadrature:?}")), |b| {
            b.iter(|| iteration(&mut displacement, &mut y, &row, &mut work));
        });
    }
    group.finish();
}

/// Where the time of an iteration goes.
fn parts(c: &mut Criterion) {
    let model = rotor();
    let state = three_nodes(&model);
    parts_of(c, "3 nodes, H = 10", &model, &state);
    for nodes in [9, 27] {
        let (model, state) = with_nodes(nodes);
        parts_of(c, &format!("{nodes} nodes, H = 20"), &model, &state(20));
    }
}

fn parts_of(c: &mut Criterion, name: &str, model: &Model, state: &State) {
    let truncation = HarmonicSettings { count: state.harmonics, ..Default::default() };
    let scales = Scales::new(model, 0);
    let mut group = c.benchmark_group(format!("parts of an iteration, {name}"));
    group.sample_size(20);
    let nc = 2 * state.harmonics + 1;
    let (law, series) = (&model.elements()[0].law, &state.arguments[..3 * nc]);
    let LawKind::Contact(law) = law else { unreachable!("every element of the rotor is a contact") };
    let (mut aft, mut force) = (Aft::new(truncation), ElementForce::default());
    let rate = Rate { omega: state.omega, harmonic: 1.0 };
    group.bench_function("arcs of a node", |b| b.iter(|| aft.coverage(black_box(&series[..nc]), 0.0).fraction()));
    group.bench_function("forces of a node", |b| b.iter(|| aft.evaluate(law, black_box(series), rate, &mut force)));
    let mut problem = PressureForm::new(model, truncation, 0, MODE, scales);
    let (mut y, row) = (problem.encode(state), problem.parameter_row());
    let (mut step, mut tangent) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    group.bench_function("residual", |b| b.iter(|| problem.linearise(black_box(&mut y))));
    group.bench_function("assembly and factorisation", |b| b.iter(|| problem.factor(black_box(&row)).is_ok()));
    group.bench_function("solution", |b| b.iter(|| problem.solve(0.0, black_box(&mut step), &mut tangent)));
    group.bench_function("transposed solution", |b| b.iter(|| problem.solve_transposed(black_box(&row))));
    group.bench_function("rounding", |b| b.iter(|| problem.rounding()));
    group.finish();
}

/// One iteration at a point of a fold curve: two matrices and the second derivatives.
fn folds(c: &mut Criterion) {
    let model = rotor();
    let state = State { forcing: 60.0, ..three_nodes(&model) };
    let (unknown, scales) = (Unknown::Extremum(Quantity::Frequency), Scales::new(&model, 0));
    let mut problem = PressureForm::new(&model, HarmonicSettings::default(), 0, unknown, scales);
    let (mut y, row) = (problem.encode(&state), problem.parameter_row());
    let mut work = [vec![0.0; y.len()], vec![0.0; y.len()]];
    c.bench_function("iteration on a fold curve, 3 nodes, H = 10", |b| {
        b.iter(|| iteration(&mut problem, &mut y, &row, &mut work));
    });
}

/// `count` nodes along the tip line of the blade, interpolated between its nine, every one of them in contact for the
/// same part of the period.
fn with_nodes(count: usize) -> (Model, impl Fn(usize) -> State) {
    let mut data = ModelData::from(rotor());
    let nine = data.elements.clone();
    data.elements = (0..count)
        .map(|i| {
            let place = 8.0 * i as f64 / (count - 1) as f64;
            let (left, share) = ((place as usize).min(7), place - (place as usize).min(7) as f64);
            let mut element = Element { name: format!("node {i}"), ..nine[left].clone() };
            for (channel, next) in element.channels.iter_mut().zip(&nine[left + 1].channels) {
                channel.iter_mut().for_each(|(_, factor)| *factor *= 1.0 - share);
                channel.extend(next.iter().map(|&(dof, factor)| (dof, factor * share)));
            }
            element
        })
        .collect();
    let model = Model::try_from(data).expect("it is a model");
    let modes = model.size();
    let state = move |harmonics: usize| {
        let nc = 2 * harmonics + 1;
        let mut arguments = vec![0.0; 3 * count * nc];
        // Predicted pressures that are positive for a quarter of the period.
        for series in arguments.chunks_mut(3 * nc) {
            (series[0], series[1]) = (-700.0, 1000.0);
        }
        let (omega, decay) = (2400.0, 3.0);
        State { harmonics, omega, decay, forcing: 0.0, arguments, modal: vec![1e-6; modes * nc] }
    };
    (model, state)
}

fn growth(c: &mut Criterion) {
    let mut group = c.benchmark_group("iteration over nodes and harmonics");
    group.sample_size(10);
    for nodes in [3, 9, 27, 54] {
        let (model, state) = with_nodes(nodes);
        let scales = Scales::new(&model, 0);
        for count in [5, 10, 20, 40] {
            let truncation = HarmonicSettings { count, ..Default::default() };
            let mut problem = PressureForm::new(&model, truncation, 0, MODE, scales);
            let (mut y, row) = (problem.encode(&state(count)), problem.parameter_row());
            problem.linearise(&mut y);
            assert!(problem.active().iter().all(|&active| active));
            let mut work = [vec![0.0; y.len()], vec![0.0; y.len()]];
            group.bench_function(BenchmarkId::new(format!("{nodes} nodes"), format!("H = {count}")), |b| {
                b.iter(|| iteration(&mut problem, &mut y, &row, &mut work));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, formulations, parts, folds, growth);
criterion_main!(benches);
