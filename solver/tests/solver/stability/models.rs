//! Small models of every law.

use solver::Model;
use solver::laws::{
    Contact, Friction, Jenkins, LawKind, PenaltySpring, PolynomialDamper, PolynomialSpring, TanhFriction, Term,
};
use solver::linalg::Matrix;
use solver::structure::{Damping, ModelData};

/// A law and the channels that it acts on.
pub type Acting = (LawKind, Vec<Vec<(usize, f64)>>);

/// A chain of three masses on the ground, forced at its second one, with the elements given.
pub fn chain(elements: Vec<Acting>) -> Model {
    let model = Model::builder("chain")
        .mass([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.5]])
        .stiffness([[2000.0, -1000.0, 0.0], [-1000.0, 2000.0, -1000.0], [0.0, -1000.0, 1500.0]])
        .damping_ratio(0.02)
        .force("x2", 1.0)
        .build()
        .unwrap();
    let mut data = ModelData::from(model);
    let named = |(i, (law, channels)): (usize, Acting)| solver::structure::Element {
        name: format!("element {i}"),
        channels,
        law,
    };
    data.elements = elements.into_iter().enumerate().map(named).collect();
    Model::try_from(data).unwrap()
}

/// The same damping as a full matrix, with modes that it couples.
pub fn coupled(model: Model) -> Model {
    let mut data = ModelData::from(model);
    if let Damping::Modal(rates) = &data.damping {
        let coupling = |i: usize, j: usize| if i == j { rates[i] } else { 0.1 * (rates[i] * rates[j]).sqrt() };
        data.damping = Damping::Full(Matrix::from_fn(rates.len(), rates.len(), coupling));
    }
    Model::try_from(data).unwrap()
}

pub fn stop(gap: f64) -> LawKind {
    LawKind::Contact(Contact { gap, epsilon: 1.0, friction: None })
}

pub fn rubbing(gap: f64, radius: f64, sense: f64) -> LawKind {
    LawKind::Contact(Contact { gap, epsilon: 1.0, friction: Some(Friction { coefficient: 0.2, radius, sense }) })
}

pub fn cubic(coefficient: f64) -> Vec<Term> {
    vec![Term { power: 3, coefficient }]
}

pub fn spring(coefficient: f64) -> LawKind {
    LawKind::PolynomialSpring(PolynomialSpring { terms: cubic(coefficient) })
}

pub fn damper(coefficient: f64) -> LawKind {
    LawKind::PolynomialDamper(PolynomialDamper { terms: cubic(coefficient) })
}

pub fn tanh_friction(limit: f64, velocity: f64) -> LawKind {
    LawKind::TanhFriction(TanhFriction { limit, velocity })
}

pub fn penalty(stiffness: f64, gap: f64) -> LawKind {
    LawKind::PenaltySpring(PenaltySpring { stiffness, gap })
}

pub fn jenkins(stiffness: f64, limit: f64) -> LawKind {
    LawKind::Jenkins(Jenkins { stiffness, limit })
}
