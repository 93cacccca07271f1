//! One point of rotor 67's isola polished to the marcher's orbit, with all multipliers.
#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{Criterion, criterion_group, criterion_main};
use solver::stability::polish::{Around, PolishSettings, polish};
use solver::{Backbone, Level, Model, Settings, State, files};
use std::path::Path;

/// Two solutions of the highest isola below 2.75 krad/s, each between its two neighbours.
fn solutions(model: &Model, forcing: f64) -> [[State; 3]; 2] {
    let settings = Settings::default();
    let backbone = Backbone::compute(model, &settings).expect("rotor 67 has a backbone");
    let level = Level::compute(model, &settings, &backbone, forcing).expect("the level can be computed");
    let low = |isola: &&solver::Branch| isola.frequency_range().1 < 2750.0;
    let isola = level.isolas().filter(low).max_by(|a, b| a.peak().amplitude().total_cmp(&b.peak().amplitude()));
    let isola = isola.expect("the level has an isola");
    let peak = isola.points.iter().position(|point| point == isola.peak()).expect("the peak is a point of it");
    let count = isola.points.len();
    // On the upper half, as far below the peak as shows the ordinary case and not a fold.
    [16, 20].map(|back| [1, 0, 2].map(|by| isola.points[(peak + count + by - 1 - back) % count].state.clone()))
}

fn polished(criterion: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
    let mut group = criterion.benchmark_group("polish");
    group.sample_size(10);
    for (name, forcing, friction) in [("frictionless", 60.0, "0"), ("friction 0.15", 20.0, "0.15")] {
        let model = files::load_with(&folder, &[("contact.friction", friction)]).expect("the model is shipped");
        let [[state, before, after], [far, far_before, far_after]] = solutions(&model, forcing);
        let settings = PolishSettings::default();
        let alone =
            polish(&model, &settings, &far, Around { between: Some([&far_before, &far_after]), neighbour: None });
        let orbit = alone.polished.expect("it has an orbit nearby").orbit;
        let around = Around { between: Some([&before, &after]), neighbour: Some((&far, &orbit)) };
        let one = polish(&model, &settings, &state, around);
        assert!(one.polished.is_some(), "{name}: {:?}", one.reason);
        println!("{name}: {:?} after {:?} periods with and without tangent", one.verdict, one.periods);
        group.bench_function(name, |bencher| bencher.iter(|| polish(&model, &settings, &state, around)));
    }
}

criterion_group!(benches, polished);
criterion_main!(benches);
