//! Time marching of a model of the size of a reduced blade: 39 dofs, 9 contact nodes with friction.
#![expect(missing_docs, reason = "criterion's macros write functions without any")]

use criterion::{Criterion, criterion_group, criterion_main};
use solver::linalg::{Matrix, symmetric_eigen};
use solver::marching::{Marching, MarchingSettings};
use solver::structure::laws::{Contact, Friction, LawKind};
use solver::structure::{Damping, Element, Forcing, Model, ModelData, Modes};

/// A clamped chain of 39 masses; three neighbours make the normal and tangential dofs of a contact node. So many of the nodes, from the
/// free end on, are `near` their stops.
fn chain(near: usize, damping: impl Fn(Vec<f64>) -> Damping) -> Model {
    let (n, nodes) = (39, 9);
    let stiffness = Matrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 2.0 * if i == n - 1 { 0.5 } else { 1.0 },
        1 => -1.0,
        _ => 0.0,
    });
    let mass = Matrix::diagonal(&vec![1.0; n]);
    let (squares, shapes) = symmetric_eigen(&stiffness, &mass).expect("a clamped chain is positive definite");
    let frequencies: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
    let friction = Some(Friction { coefficient: 0.15, radius: 1.0, sense: 1.0 });
    let data = ModelData {
        name: "chain".into(),
        dofs: (0..n).map(|i| format!("x{i}")).collect(),
        damping: damping(frequencies.iter().map(|w| 0.01 * w).collect()),
        forcing: Forcing { shape: shapes.column(0), harmonic: 1 },
        modes: Modes { frequencies, shapes },
        mass,
        stiffness,
        elements: (0..nodes)
            .map(|node| Element {
                name: format!("node {node}"),
                channels: (0..3).map(|i| vec![(n - 1 - 3 * node - i, 1.0)]).collect(),
                law: LawKind::Contact(Contact {
                    gap: if node < near { 1.0 } else { 1e3 },
                    epsilon: 1.0,
                    friction: friction.clone(),
                }),
            })
            .collect(),
        monitors: vec![n - 1],
    };
    Model::try_from(data).expect("it is a model")
}

fn marching(criterion: &mut Criterion) {
    let settings = MarchingSettings { min_steps_per_period: Some(7500), ..MarchingSettings::default() };
    let modal = chain(9, Damping::Modal);
    let few = chain(2, Damping::Modal);
    let full = chain(9, |rates| Damping::Full(Matrix::diagonal(&rates)));
    let omega = 1.2 * modal.modes().frequencies[0];
    // The chain's period of 7500 steps without any contact, then with two of nine nodes rubbing, as a blade has it, and with every node.
    for (name, model, amplitude) in [
        ("free", &modal, 1e-6),
        ("two nodes rubbing", &few, 1.0),
        ("rubbing", &modal, 1.0),
        ("rubbing, full damping", &full, 1.0),
    ] {
        let mut marching = Marching::new(model, &settings, amplitude, omega).expect("the settings are in range");
        criterion.bench_function(&format!("marching: period of 7500 steps, {name}"), |bencher| {
            bencher.iter(|| marching.period().expect("the motion is bounded"))
        });
        let state = marching.state();
        criterion.bench_function(&format!("marching: the same with its tangent, {name}"), |bencher| {
            bencher.iter(|| {
                marching.restart(&state).expect("it was there before");
                marching.monodromy().expect("the motion is bounded")
            })
        });
        println!("share of contact: {:.2?}", marching.period().expect("the motion is bounded").contact);
    }
}

criterion_group!(benches, marching);
criterion_main!(benches);
