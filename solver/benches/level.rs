//! Backbones and forcing levels of rotor 67, all four scenarios, one thread.
#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{Criterion, criterion_group, criterion_main};
use solver::files;
use solver::response::backbone::Backbone;
use solver::response::level::Level;
use solver::settings::Settings;
use std::path::Path;

const SCENARIOS: [(&str, &[(&str, &str)]); 4] = [
    ("frictionless", &[("contact.friction", "0")]),
    ("friction, sense -1", &[]),
    ("friction, sense +1", &[("contact.sense", "1")]),
    ("tuned, friction, sense -1", &[("matrices.stiffness", "rom_K_tuned.mtx")]),
];

fn rotor67(c: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let settings = Settings::default();
    let mut group = c.benchmark_group("rotor 67");
    group.sample_size(10);
    for (name, overrides) in SCENARIOS {
        let model = files::load_with(&folder, overrides).expect("the model is part of the repository");
        let compute = || Backbone::compute(&model, &settings).expect("it starts");
        let backbone = compute();
        group.bench_function(format!("{name}: backbone of {} points", backbone.points.len()), |b| b.iter(compute));
        group.bench_function(format!("{name}: level A = 60"), |b| {
            b.iter(|| Level::compute(&model, &settings, &backbone, 60.0))
        });
    }
    group.finish();
}

criterion_group!(benches, rotor67);
criterion_main!(benches);
