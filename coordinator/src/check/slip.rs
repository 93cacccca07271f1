//! From which forcing on joints slip and dry friction slides.

use super::small_motion::{SmallMotion, stiffness};
use super::touch::{linear_problem, shape, smallest};
use super::units::frequency;
use crate::study::Study;
use num_complex::Complex64;
use results::overview::is_within;
use results::words::number;
use solver::formulation::Formulation;
use solver::formulation::receptance::Receptance;
use solver::formulation::state::Parameters;
use solver::linalg::solve_complex;
use solver::structure::laws::{Law, LawKind};
use solver::structure::{Element, Model};

/// Dry friction that lets nothing move, in stiffnesses of the structure.
const LOCKED: f64 = 1e6;

/// Where an element that sticks slips first, in the linear response with all of them stuck.
pub(super) struct FirstSlip<'m> {
    /// Forcing amplitude A.
    forcing: f64,
    element: &'m Element,
    /// At which frequency of the response, rad/s.
    omega: f64,
    /// What resonates there; `None` at a bound of the study.
    near: Option<Resonance>,
    /// Whether there is something with a gap, or that is closed at rest.
    may_touch: bool,
}

impl FirstSlip<'_> {
    /// In words.
    pub fn told(&self, study: &Study) -> String {
        let what = match self.element.law {
            LawKind::TanhFriction(_) => "slides (its velocity reaches that of its regularisation)",
            _ => "slips",
        };
        let omega = frequency(study, self.omega);
        let place = match &self.near {
            Some(Resonance { is_locked: true, .. }) => {
                format!("at {omega}, near a resonance of the structure that its friction holds")
            }
            Some(Resonance { mode, .. }) => {
                format!("at {omega}, near the resonance of mode {} as long as all sticks", mode + 1)
            }
            None => format!("at the bound {omega}"),
        };
        let touching = if self.may_touch { " with nothing that touches" } else { "" };
        format!(
            "from A = {} on, {} {what} first, {place}, in the linear response{touching} (looked for at bounds and at resonances up to those \
             of modes that are followed; isolas may be there much earlier)",
            number(self.forcing),
            self.element.name
        )
    }
}

/// A resonance of the structure with what sticks.
#[derive(Clone, Copy)]
struct Resonance {
    /// Mode, from 0, of that structure.
    mode: usize,
    /// Frequency of the force, rad/s.
    omega: f64,
    /// Whether dry friction lets nothing move, or is not there.
    is_locked: bool,
}

/// Where a joint or dry friction begins to slip, the forcing growing, in the linear response at bounds of the study and about resonances
/// between them of what sticks: up to those of the modes that are followed, and all if both bounds are given. `None` if nothing can slip, or where
/// the linear response has no bound.
pub(super) fn first_slip<'s>(study: &'s Study, followed: &[usize]) -> Option<FirstSlip<'s>> {
    let model = &study.model;
    if !model.elements().iter().any(|element| sticks(&element.law)) {
        return None;
    }
    let held = Held::of(study)?;
    let given = study.settings.frequency;
    let m = model.forcing().harmonic as f64;
    let may_touch = model.elements().iter().any(|element| element.law.clearance().is_some_and(|gap| gap >= 0.0));
    let slip = |omega: f64, near: Option<Resonance>| {
        let (forcing, element) = held.slips_at(omega)?;
        Some(FirstSlip { forcing, element, omega, near, may_touch })
    };
    let resonances = held.resonances(m);
    // Main branches lead past what lies below, whichever mode is followed.
    let of_followed = resonances.iter().filter(|found| followed.contains(&found.mode)).map(|found| found.omega);
    let highest =
        if given.min.is_some() && given.max.is_some() { f64::INFINITY } else { of_followed.fold(0.0, f64::max) };
    let is_looked_at = |found: &&Resonance| is_within(given, found.omega) && found.omega <= highest;
    let about = resonances.iter().filter(is_looked_at).filter_map(|found| {
        let omega = found.omega;
        let others = resonances.iter().map(|other| other.omega).filter(|&other| other != omega);
        let middle = others.fold((0.0_f64, 2.0 * omega), |(low, high), other| {
            let at = f64::midpoint(other, omega);
            if at < omega { (low.max(at), high) } else { (low, high.min(at)) }
        });
        let low = middle.0.max(given.min.unwrap_or(0.0)).max(1e-2 * omega);
        let high = middle.1.min(given.max.unwrap_or(f64::INFINITY));
        let first = smallest(|omega| held.slips_at(omega).map(|(forcing, _)| forcing), omega, (low, high))?;
        // Least at an end is no resonance.
        let is_inside = (first - low).min(high - first) > 1e-6 * (high - low);
        is_inside.then(|| slip(first, Some(*found))).flatten()
    });
    let bounds = [given.min, given.max].into_iter().flatten().filter_map(|omega| slip(omega, None));
    about.chain(bounds).min_by(|a, b| a.forcing.total_cmp(&b.forcing))
}

fn sticks(law: &LawKind) -> bool {
    matches!(law, LawKind::Jenkins(_) | LawKind::TanhFriction(_))
}

/// The linear structure with everything that acts on the smallest motions.
struct Held<'s> {
    model: &'s Model,
    /// What acts there, and its shape in every mode.
    elements: Vec<(&'s Element, Vec<f64>)>,
    /// Of the matrices alone.
    problem: solver::formulation::pressure::PressureForm<'s>,
    harmonics: usize,
}

impl<'s> Held<'s> {
    fn of(study: &'s Study) -> Option<Self> {
        let model = &study.model;
        let acting = model.elements().iter().filter(|element| impedance(element, 1.0) != Complex64::default());
        let elements = acting.map(|element| (element, shape(model, element))).collect();
        let harmonics = study.settings.harmonics.count;
        Some(Self { model, elements, problem: linear_problem(study)?, harmonics })
    }

    /// What slips first at a frequency of the response, and from which forcing on.
    fn slips_at(&self, omega: f64) -> Option<(f64, &'s Element)> {
        let (n, m, size) = (self.model.size(), self.model.forcing().harmonic, self.elements.len());
        let mut receptance = Receptance::new(self.model, self.harmonics, self.problem.system().modal.clone(), true);
        let complex = |values: &[f64]| values.iter().map(|&value| value.into()).collect::<Vec<Complex64>>();
        let along = |shape: &[f64], y: &[Complex64]| shape.iter().zip(y).map(|(b, y)| b * y).sum::<Complex64>();
        let mut y = vec![Complex64::default(); n];
        let point = Parameters { omega, decay: 0.0, forcing: 1.0 };
        receptance.solve_all(point, m, &complex(&self.model.modal_force()), &mut y).ok()?;
        // u = u₀ − G Z u: what the elements see of the force, and of each other's.
        let mut u: Vec<Complex64> = self.elements.iter().map(|(_, shape)| along(shape, &y)).collect();
        let mut matrix = vec![Complex64::default(); size * size];
        for (j, (element, shape)) in self.elements.iter().enumerate() {
            receptance.inverse_times(m, &complex(shape), &mut y);
            let z = impedance(element, m as f64 * omega);
            for (i, (_, other)) in self.elements.iter().enumerate() {
                matrix[i * size + j] = z * along(other, &y);
            }
            matrix[j * size + j] += 1.0;
        }
        solve_complex(&matrix, &mut u, size, 1).ok()?;
        let slips = self.elements.iter().zip(&u).filter_map(|((element, _), u)| {
            let most = match &element.law {
                LawKind::Jenkins(joint) => joint.limit / joint.stiffness,
                LawKind::TanhFriction(friction) => friction.velocity / (m as f64 * omega),
                _ => return None,
            };
            Some((most / u.norm(), *element))
        });
        slips.filter(|(forcing, _)| forcing.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Resonances of what sticks, by frequency of the force, which acts on harmonic `m`: with dry friction as if it were not there, and as if it
    /// let nothing move, since it may be anything between.
    fn resonances(&self, m: f64) -> Vec<Resonance> {
        let largest = self.model.modes().frequencies.iter().fold(0.0_f64, |largest, omega| largest.max(*omega));
        let locked = |element: &Element| match &element.law {
            LawKind::TanhFriction(_) => {
                let share: f64 = shape(self.model, element).iter().map(|b| b * b).sum();
                (share > 0.0).then(|| LOCKED * largest * largest / share)
            }
            _ => stiffness(element),
        };
        let of = |stiffness: &dyn Fn(&Element) -> Option<f64>, is_locked: bool| {
            let found = SmallMotion::of(self.model, stiffness).map(|motion| motion.frequencies()).unwrap_or_default();
            found.into_iter().map(move |(mode, omega)| Resonance { mode, omega: omega / m, is_locked })
        };
        let mut list: Vec<Resonance> = of(&stiffness, false).chain(of(&locked, true)).collect();
        list.sort_by(|a, b| a.omega.total_cmp(&b.omega));
        list.dedup_by(|a, b| {
            let is_same = (a.omega - b.omega).abs() <= 1e-9 * b.omega;
            // What is there without the friction is not the friction's.
            if is_same && b.is_locked {
                *b = *a;
            }
            is_same
        });
        list
    }
}

/// Force per displacement of an element on the smallest motions of this frequency, rad/s, in N/m.
fn impedance(element: &Element, omega: f64) -> Complex64 {
    let damping = match &element.law {
        LawKind::TanhFriction(friction) => friction.limit / friction.velocity,
        LawKind::PolynomialDamper(damper) => {
            damper.terms.iter().filter(|term| term.power == 1).map(|term| term.coefficient).sum()
        }
        _ => 0.0,
    };
    Complex64::new(stiffness(element).unwrap_or(0.0), omega * damping)
}
