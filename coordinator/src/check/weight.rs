//! From which forcing on polynomial laws weigh as much as the damping, where nothing has a gap that tells it.

use super::touch::{linear_problem, shape};
use crate::study::Study;
use results::words::digits;
use solver::formulation::Formulation;
use solver::formulation::harmonics::complex;
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::structure::Element;
use solver::structure::laws::{LawKind, Term};

/// Where polynomials weigh only at more than so many times the linear response, the structure is linear for all that can be seen of it.
const LINEAR: f64 = 100.0;
/// Relative rounding of that multiple.
const ROUNDING: f64 = 1e-9;
/// Decades of the forcing that are looked at, below and above the largest level.
const DECADES: f64 = 12.0;
/// Times that the decades are halved.
const HALVINGS: usize = 60;

/// Where the forces of all laws together are first as large as that of the damping.
pub(super) struct Weight {
    /// Forcing amplitude A; infinite if nowhere.
    pub forcing: f64,
    /// The mode, from 0, at whose linear resonance.
    mode: usize,
}

impl std::fmt::Display for Weight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "their forces are as large as that of the damping from about A = {} on, at the resonance of mode {}, in the linear response \
             (isolas may be there much earlier)",
            digits(self.forcing, 2),
            self.mode + 1
        )
    }
}

impl Weight {
    /// Of the modes that are followed, if all laws are polynomials.
    pub fn of(study: &Study, followed: &[usize]) -> Option<Self> {
        let laws: Vec<Polynomial<'_>> = study.model.elements().iter().map(Polynomial::of).collect::<Option<_>>()?;
        let highest = study.amplitudes.iter().map(|amplitude| amplitude.value).fold(0.0, f64::max);
        let problem = linear_problem(study)?;
        let at = |&mode: &usize| Some(Self { forcing: weighs_from(&problem, &laws, mode, highest)?, mode });
        // Without damping the linear response has no size at its resonance.
        let (driven, rates) = (study.model.driven(), study.model.damping().rates());
        followed
            .iter()
            .filter(|mode| driven.contains(mode) && rates[**mode] > 0.0)
            .filter_map(at)
            .min_by(|a, b| a.forcing.total_cmp(&b.forcing))
    }

    /// A sentence, if that is far above all levels.
    pub fn practically_linear(&self, study: &Study) -> Option<String> {
        let highest = study.amplitudes.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
        let multiple = self.forcing / highest.value;
        let names: Vec<String> = study.model.elements().iter().map(|element| format!("`{}`", element.name)).collect();
        if multiple == f64::INFINITY {
            return Some(format!(
                "practically linear: at the resonances followed no term of the laws beyond linear ones does any work; check {}",
                names.join(", ")
            ));
        }
        (multiple > LINEAR * (1.0 + ROUNDING)).then(|| {
            format!(
                "practically linear: at A = {} the laws would matter only where the response is {} times the linear one or more; check units of \
                 {}",
                highest.text,
                digits(multiple, 1),
                names.join(", ")
            )
        })
    }
}

/// A law that is a polynomial.
struct Polynomial<'m> {
    element: &'m Element,
    terms: &'m [Term],
    /// Whether it is one of the velocity.
    is_damper: bool,
}

impl<'m> Polynomial<'m> {
    fn of(element: &'m Element) -> Option<Self> {
        match &element.law {
            LawKind::PolynomialSpring(spring) => Some(Self { element, terms: &spring.terms, is_damper: false }),
            LawKind::PolynomialDamper(damper) => Some(Self { element, terms: &damper.terms, is_damper: true }),
            _ => None,
        }
    }

    /// Its virtual work along its own displacement, J, of a response of this amplitude, m, and angular frequency, rad/s.
    fn work(&self, amplitude: f64, omega: f64) -> f64 {
        let rate = if self.is_damper { amplitude * omega } else { amplitude };
        // What is linear is part of the linear response, if of one that is not computed here.
        let force = |term: &Term| term.coefficient.abs() * rate.powi(term.power as i32);
        self.terms.iter().filter(|term| term.power > 1).map(force).sum::<f64>() * amplitude
    }
}

/// The forcing amplitude from which on laws do as much virtual work as the damping, and so the forcing, at the linear resonance of a
/// mode; infinite if they do none.
fn weighs_from(problem: &PressureForm<'_>, laws: &[Polynomial<'_>], mode: usize, highest: f64) -> Option<f64> {
    let model = problem.model();
    let m = model.forcing().harmonic;
    let omega = model.modes().frequencies[mode] / m as f64;
    let response = forced_response(problem, highest, omega).ok()?;
    let displacement = |modal: Vec<f64>| complex(&response.combine(modal), m).norm();
    let supplied = highest * displacement(model.modal_force());
    let arguments: Vec<f64> = laws.iter().map(|law| displacement(shape(model, law.element))).collect();
    // The response grows with the forcing, what is supplied with its square.
    let is_heavy = |decade: f64| {
        let multiple = 10_f64.powf(decade);
        let work = laws.iter().zip(&arguments).map(|(law, argument)| law.work(multiple * argument, omega * m as f64));
        work.sum::<f64>() >= multiple * multiple * supplied
    };
    if is_heavy(-DECADES) {
        return None;
    }
    if !is_heavy(DECADES) {
        return (!laws.is_empty()).then_some(f64::INFINITY);
    }
    let (mut low, mut high) = (-DECADES, DECADES);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        *if is_heavy(middle) { &mut high } else { &mut low } = middle;
    }
    Some(highest * 10_f64.powf(high))
}
