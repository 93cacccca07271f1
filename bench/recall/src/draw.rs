//! Random structures: a number decides everything.

use crate::model::{Damping, Element, Forcing, Law, Matrices, Model, Shape, Term, dof};
use crate::record::Kind;
use crate::structure::Structure;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha20Rng;
use std::collections::BTreeMap;

/// A structure with the forcing levels and frequencies to look at.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// What it is.
    pub kind: Kind,
    /// The model.
    pub model: Model,
    /// Forcing amplitudes, rising.
    pub forcings: Vec<f64>,
    /// Lowest and highest frequency, rad/s.
    pub range: [f64; 2],
}

/// Levels of a structure, and the ratio between them.
const LEVELS: i32 = 3;
const RATIO: f64 = 1.6;

/// The range, times the lowest and the highest eigenfrequency: third-order resonances of the first mode are in it,
/// or, where the force has a multiple of the response's frequency, the sub-harmonic resonances of all modes.
const RANGE: (f64, f64) = (0.3, 1.6);
const SUB_HARMONIC: (f64, f64) = (0.6, 1.6);

/// The structure of a number: the kinds take turns.
pub fn structure(number: u64) -> Drawn {
    let mut random = Draw(ChaCha20Rng::seed_from_u64(number));
    let kind = [Kind::Springs, Kind::Absorber, Kind::Stop, Kind::Damper][(number % 4) as usize];
    let (mut model, base) = match kind {
        Kind::Springs => springs(&mut random),
        Kind::Absorber => absorber(&mut random),
        Kind::Stop => stop(&mut random),
        Kind::Damper => damper(&mut random),
    };
    model.name = format!("{number}");
    let forcings = (0..LEVELS).map(|level| rounded(base * RATIO.powi(level))).collect();
    let structure = Structure::new(&model);
    let highest = structure.frequencies[structure.size() - 1];
    let factors = if structure.harmonic == 1 { RANGE } else { SUB_HARMONIC };
    let range = [rounded(factors.0 * structure.frequencies[0]), rounded(factors.1 * highest)];
    Drawn { kind, model, forcings, range }
}

struct Draw(ChaCha20Rng);

impl Draw {
    /// Evenly between two numbers.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        rounded(self.0.gen_range(low..high))
    }

    /// Between two numbers, evenly in the logarithm.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        rounded(self.0.gen_range(low.ln()..high.ln()).exp())
    }

    fn below(&mut self, count: usize) -> usize {
        self.0.gen_range(0..count)
    }
}

/// To four digits: files stay small, and everyone reads the same number.
fn rounded(value: f64) -> f64 {
    let unit = 10f64.powf(value.abs().log10().floor() - 3.0);
    let digits = (value / unit).round();
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit }
}

/// A chain from the ground on, some masses with a spring to the ground as well, driven at one of them.
fn chain(random: &mut Draw, n: usize, ratio: f64, harmonic: usize) -> Model {
    let masses: Vec<f64> = (0..n).map(|_| random.between(0.5, 2.0)).collect();
    let links: Vec<f64> = (0..n).map(|_| random.between(0.3, 3.0)).collect();
    let grounds: Vec<f64> = (0..n).map(|_| if random.below(2) == 0 { 0.0 } else { random.between(0.1, 2.0) }).collect();
    let row = |f: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..n).map(|i| (0..n).map(|j| f(i, j)).collect()).collect()
    };
    let stiffness = row(&|i, j| match i.abs_diff(j) {
        0 => links[i] + grounds[i] + if i + 1 < n { links[i + 1] } else { 0.0 },
        1 => -links[i.max(j)],
        _ => 0.0,
    });
    let mass = row(&|i, j| if i == j { masses[i] } else { 0.0 });
    let driven = random.below(n);
    Model {
        name: String::new(),
        monitors: vec![dof(driven)],
        matrices: Matrices { mass, stiffness },
        damping: Damping { default_ratio: ratio },
        forcing: Forcing { shape: Shape { dofs: BTreeMap::from([(dof(driven), 1.0)]) }, harmonic },
        laws: Vec::new(),
    }
}

/// A law at a mass, half of the time between it and the one before.
fn element(random: &mut Draw, n: usize, law: Law) -> Element {
    let at = random.below(n);
    let mut coefficients = BTreeMap::from([(dof(at), 1.0)]);
    if at > 0 && random.below(2) == 0 {
        coefficients.insert(dof(at - 1), -1.0);
    }
    Element { name: String::new(), coefficients, law }
}

fn named(mut model: Model, laws: impl IntoIterator<Item = Element>) -> Model {
    model.laws = laws.into_iter().enumerate().map(|(i, e)| Element { name: format!("law {}", i + 1), ..e }).collect();
    model
}

/// Stiffness that the force meets at its own mass.
fn driven_stiffness(model: &Model) -> f64 {
    let structure = Structure::new(model);
    structure.stiffness[(structure.monitor, structure.monitor)]
}

/// A cubic spring and perhaps a quintic one, both hardening, or one that softens before it hardens.
fn springs(random: &mut Draw) -> (Model, f64) {
    let n = 1 + random.below(4);
    let harmonic = if n == 1 || random.below(2) == 0 { 3 } else { 1 };
    let ratio = random.decades(if harmonic == 1 { 1e-3 } else { 5e-3 }, 0.05);
    let model = chain(random, n, ratio, harmonic);
    let count = 1 + random.below(2);
    let laws: Vec<Element> = (0..count)
        .map(|_| {
            let fifth = random.decades(0.02, 1.0);
            let term = |power, coefficient| Term { power, coefficient };
            let terms = match random.below(3) {
                0 => vec![term(3, random.decades(0.1, 2.0))],
                1 => vec![term(3, random.decades(0.1, 2.0)), term(5, fifth)],
                // The stiffness of the spring alone falls by 9 z²/(20 fifth) at most.
                _ => vec![term(3, -random.between(0.1, 0.8) * fifth.sqrt()), term(5, fifth)],
            };
            let terms = terms.into_iter().map(|t| Term { coefficient: rounded(t.coefficient), ..t }).collect();
            element(random, n, Law::PolynomialSpring { terms })
        })
        .collect();
    let model = named(model, laws);
    let reference = driven_stiffness(&model);
    // At three times the frequency of the response nothing but the force's own motion opens the way.
    let base = if harmonic == 1 { 2.0 * ratio * random.decades(0.5, 15.0) } else { random.decades(0.4, 2.5) };
    (model, reference * base)
}

/// A light mass, tuned to the first mode of a chain with a cubic spring.
fn absorber(random: &mut Draw) -> (Model, f64) {
    let n = 1 + random.below(3);
    let ratio = random.decades(3e-3, 0.05);
    let mut model = chain(random, n, ratio, 1);
    let host = random.below(n);
    let first = Structure::new(&model).frequencies[0];
    let mass = rounded(model.matrices.mass[host][host] * random.decades(0.02, 0.1));
    let stiffness = rounded(mass * (first * random.between(0.85, 1.1)).powi(2));
    for (i, (mass_row, stiffness_row)) in model.matrices.mass.iter_mut().zip(&mut model.matrices.stiffness).enumerate()
    {
        mass_row.push(0.0);
        stiffness_row.push(if i == host { -stiffness } else { 0.0 });
    }
    model.matrices.stiffness[host][host] += stiffness;
    let last = |value: f64, coupling: f64| {
        (0..=n)
            .map(|j| {
                if j == n {
                    value
                } else if j == host {
                    coupling
                } else {
                    0.0
                }
            })
            .collect::<Vec<f64>>()
    };
    model.matrices.mass.push(last(mass, 0.0));
    model.matrices.stiffness.push(last(stiffness, -stiffness));
    let cubic = |coefficient| Law::PolynomialSpring { terms: vec![Term { power: 3, coefficient }] };
    let primary = Element {
        name: String::new(),
        coefficients: BTreeMap::from([(dof(host), 1.0)]),
        law: cubic(random.decades(0.2, 2.0)),
    };
    let light = Element {
        name: String::new(),
        coefficients: BTreeMap::from([(dof(host), 1.0), (dof(n), -1.0)]),
        law: cubic(rounded(mass * random.decades(0.02, 2.0))),
    };
    let model = named(model, [primary, light]);
    let reference = driven_stiffness(&model);
    (model, reference * 2.0 * ratio * random.decades(0.5, 10.0))
}

/// An elastic stop before a mass, perhaps beside a cubic spring.
fn stop(random: &mut Draw) -> (Model, f64) {
    let n = 1 + random.below(4);
    let harmonic = if random.below(2) == 0 { 2 } else { 1 };
    let ratio = random.decades(if harmonic == 1 { 1e-3 } else { 5e-3 }, 0.05);
    let model = chain(random, n, ratio, harmonic);
    let gap = random.between(0.1, 1.0);
    let law = Law::PenaltySpring { stiffness: random.decades(0.3, 10.0), gap };
    let mut laws = vec![element(random, n, law)];
    if random.below(3) == 0 {
        let law = Law::PolynomialSpring { terms: vec![Term { power: 3, coefficient: random.decades(0.1, 1.0) }] };
        laws.push(element(random, n, law));
    }
    let model = named(model, laws);
    let reference = gap * driven_stiffness(&model);
    let base = if harmonic == 1 { 2.0 * ratio * random.decades(1.0, 12.0) } else { random.decades(0.15, 0.6) };
    (model, reference * base)
}

/// A damper that takes least of one mode at a velocity of its own, but never gives energy; perhaps beside a cubic
/// spring.
fn damper(random: &mut Draw) -> (Model, f64) {
    let n = 1 + random.below(4);
    let ratio = random.decades(2e-3, 0.05);
    let model = chain(random, n, ratio, 1);
    let structure = Structure::new(&model);
    let (at, mode) = (random.below(n), random.below(n));
    let shape = structure.shapes[(at, mode)].abs().max(0.1);
    // Of motion in the mode alone, with velocity V of the mass: c V − ¾ third V³ + ⅝ fifth V⁵, with two extrema if
    // third² > (200/81) c fifth, above zero if third² < (40/9) c fifth.
    let linear = 2.0 * ratio * structure.frequencies[mode] / (shape * shape);
    let velocity = random.decades(0.3, 2.0);
    let third = random.between(2.6, 3.8);
    // The minimum is where 25/8 fifth V⁴ − 9/4 third V² + c = 0, the larger root.
    let root = (2.25 * third.sqrt() + (5.0625 * third - 12.5).sqrt()) / 6.25;
    let fifth = linear * root * root / velocity.powi(4);
    let third = (third * linear * fifth).sqrt();
    let terms = vec![Term { power: 3, coefficient: -rounded(third) }, Term { power: 5, coefficient: rounded(fifth) }];
    let mut laws = vec![Element {
        name: String::new(),
        coefficients: BTreeMap::from([(dof(at), 1.0)]),
        law: Law::PolynomialDamper { terms },
    }];
    if random.below(2) == 0 {
        let law = Law::PolynomialSpring { terms: vec![Term { power: 3, coefficient: random.decades(0.01, 0.3) }] };
        laws.push(element(random, n, law));
    }
    let least = linear * velocity - 0.75 * third * velocity.powi(3) + 0.625 * fifth * velocity.powi(5);
    let driven = structure.shapes[(structure.monitor, mode)].abs().max(0.05);
    (named(model, laws), least * shape / driven * random.between(0.8, 1.4))
}
