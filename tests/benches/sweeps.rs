//! Whole sweeps, from the first grant to the last acceptance: 2,000 tasks that compute next to nothing, and rotor 67 at 28
//! levels with one worker and with two.

#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use tests::System;
use tests::results::{first_grant_to_last_acceptance, number};

/// A level of one branch of two points and seeds that do not land.
const NOTHING: &[&str] = &[
    "--set",
    "harmonics.count=1",
    "--set",
    "harmonics.samples=8",
    "--set",
    "branch.max_points=2",
    "--set",
    "continuation.newton.max_iterations=1",
];

fn sweep(study: &str, more: &[&str]) -> (Duration, i64) {
    let mut system = System::sweep_with(study, more);
    assert!(system.coordinator.wait().success(), "{}", system.coordinator.output());
    let done = number(&system.directory(), "SELECT count(*) FROM tasks WHERE state = 'done'");
    (first_grant_to_last_acceptance(&system.directory()), done)
}

fn overhead(c: &mut Criterion) {
    let mut group = c.benchmark_group("overhead");
    group.sample_size(10).throughput(Throughput::Elements(2000));
    let amplitudes = ["--amplitudes", "0.00005:0.035:0.00005", "--workers", "2"];
    group.bench_function("2000 tasks, 2 workers", |b| {
        b.iter_custom(|iterations| {
            let once = |_| {
                let (time, done) = sweep("models/duffing/study.toml", &[NOTHING, &amplitudes].concat());
                assert!(done >= 2000, "{done} tasks");
                time.mul_f64(2000.0 / done as f64)
            };
            (0..iterations).map(once).sum()
        });
    });
}

fn scaling(c: &mut Criterion) {
    let mut group = c.benchmark_group("rotor 67, 28 levels");
    group.sample_size(10);
    for workers in ["1", "2"] {
        group.bench_function(BenchmarkId::new("workers", workers), |b| {
            let more = ["--amplitudes", "5:140:5", "--workers", workers];
            b.iter_custom(|iterations| {
                let once = |_| {
                    let (time, done) = sweep("models/rotor67/study.toml", &more);
                    assert_eq!(done, 172);
                    time
                };
                (0..iterations).map(once).sum()
            });
        });
    }
}

criterion_group!(benches, overhead, scaling);
criterion_main!(benches);
