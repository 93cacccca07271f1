//! One Newton iteration of the pressure form on rotor 67 (friction 0.15, 3 touching nodes).

use criterion::{Criterion, criterion_group, criterion_main};
use solver::backbone::Backbone;
use solver::model::Model;
use solver::pressure::{PressureForm, Unknown};
use solver::problem::Problem;
use solver::scales::Scales;
use solver::settings::Settings;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::Path;

fn newton_iteration(c: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let model = Model::load(&folder).expect("the model is part of the repository");
    let settings = Settings::default();
    let backbone = Backbone::compute(&model, &settings, &mut |_| ControlFlow::Continue(())).expect("it starts");
    let touching = |p: &&solver::backbone::BackbonePoint| p.point.contact.iter().filter(|&&c| c > 0.0).count() == 3;
    let state = &backbone.points.iter().find(touching).expect("three nodes touch somewhere").point.state;
    let mut problem =
        PressureForm::new(&model, settings.harmonics, 0, Unknown::Mode { damped: true }, Scales::new(&model, 0));
    let mut y = problem.encode(state);
    let row = problem.parameter_row();
    let mut step = vec![0.0; problem.len()];
    let mut group = c.benchmark_group("pressure form, 3 nodes, H = 10");
    group.bench_function("residual", |b| b.iter(|| black_box(problem.linearise(black_box(&mut y)))));
    group.bench_function("assembly and factorisation", |b| b.iter(|| problem.factor(black_box(&row)).is_ok()));
    group.bench_function("solve", |b| b.iter(|| problem.newton_step(0.0, black_box(&mut step))));
    group.bench_function("iteration", |b| {
        b.iter(|| {
            problem.linearise(black_box(&mut y));
            problem.factor(&row).expect("regular");
            problem.newton_step(0.0, &mut step);
            step[0]
        })
    });
    group.finish();
}

criterion_group!(benches, newton_iteration);
criterion_main!(benches);
