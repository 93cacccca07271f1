//! A long branch, and what is left of it when nine tenths of its steps were recorded before.
#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{Criterion, criterion_group, criterion_main};
use solver::curve::record::{Recorder, Step};
use solver::files;
use solver::response::branch::Side;
use solver::response::task::Task;
use solver::response::trace::{Given, execute};
use solver::{Backbone, Forced, SearchRange, Settings};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Forcing amplitude.
const FORCING: f64 = 40.0;
/// Small enough for several hundred steps.
const MAX_STEP: f64 = 2e-2;

fn main_branch(c: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let model = files::load(&folder).expect("the model is part of the repository");
    let mut settings = Settings::default();
    settings.continuation.max_step = MAX_STEP;
    let backbone = Backbone::compute(&model, &settings).expect("it starts");
    let reach = SearchRange::new(&settings, &backbone).expect("there is a range");
    let trace = |before: Vec<Step>| {
        let steps: Arc<Mutex<Vec<Step>>> = Arc::default();
        let kept = steps.clone();
        let recorder = Recorder::new(before, move |_, step| kept.lock().expect("one thread").push(step));
        let mut forced = Forced::new(&model, &settings, reach, FORCING).recorded(recorder);
        let result =
            execute(&mut forced, &Task::Main(Side::Below), &Given::default(), &mut |_| ControlFlow::Continue(()));
        drop(forced);
        (result, std::mem::take(&mut *steps.lock().expect("one thread")))
    };
    let (_, all) = trace(Vec::new());
    let mut group = c.benchmark_group("rotor 67, main branch at A = 40");
    group.sample_size(10);
    group.bench_function(format!("{} steps", all.len()), |b| b.iter(|| trace(Vec::new())));
    let most = &all[..all.len() * 9 / 10];
    group.bench_function(format!("after {} of them", most.len()), |b| b.iter(|| trace(most.to_vec())));
    group.finish();
}

criterion_group!(benches, main_branch);
criterion_main!(benches);
