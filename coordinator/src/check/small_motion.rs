//! Modes of small motions, which some laws make others than those of the matrices.

use super::touch::shape;
use crate::study::Study;
use results::words::{digits, number};
use solver::linalg::{Matrix, symmetric_eigen};
use solver::structure::laws::{Law, LawKind};
use solver::structure::{Element, Model};

/// Frequencies shown.
const MODES: usize = 6;
/// Frequencies that laws change by a smaller share are those of the matrices.
const SAME: f64 = 1e-3;
/// Eigenvalues below this share of the largest are rounding.
const ROUNDED: f64 = 1e-9;

/// What the eigenfrequencies of small motions are, if laws change them: joints that stick, springs that are linear there.
pub(super) fn frequencies(study: &Study) -> Option<String> {
    let model = &study.model;
    let unit = study.frequency_unit();
    let motion = SmallMotion::of(model, &stiffness).filter(|motion| !motion.stiff.is_empty())?;
    let squares: Vec<f64> = model.modes().frequencies.iter().map(|omega| omega * omega).collect();
    let (values, floor) = (&motion.squares, motion.floor());
    let is_other =
        |(value, square): (&f64, &f64)| (value - square).abs() > floor.max(2.0 * SAME * square.abs().max(value.abs()));
    let changed = values.iter().zip(&squares).any(is_other);
    let frequency = |value: &f64| match *value {
        value if value < -floor => "none (it snaps away)".into(),
        value if value <= floor => format!("0 {unit}"),
        value => format!("{} {unit}", number(unit.factor() * value.sqrt())),
    };
    let shown = values.iter().take(MODES).map(frequency);
    let shown: Vec<String> = shown.collect();
    let names: Vec<String> = motion
        .stiff
        .iter()
        .map(|(element, stiffness)| format!("`{}` ({} N/m)", element.name, digits(*stiffness, 3)))
        .collect();
    changed.then(|| {
        format!(
            "of small motions, with {}: {}; those above are of the matrices alone",
            names.join(", "),
            shown.join(", ")
        )
    })
}

/// The structure with the stiffness that laws have at rest.
pub(super) struct SmallMotion<'m> {
    /// What is stiff, and how stiff, N/m.
    stiff: Vec<(&'m Element, f64)>,
    /// Squares of its eigenfrequencies, ascending.
    squares: Vec<f64>,
}

impl<'m> SmallMotion<'m> {
    /// With these stiffnesses of the elements; `None` where its modes are not found.
    pub fn of(model: &'m Model, stiffness: &dyn Fn(&Element) -> Option<f64>) -> Option<Self> {
        let stiff: Vec<(&Element, f64)> =
            model.elements().iter().filter_map(|element| Some((element, stiffness(element)?))).collect();
        let squares: Vec<f64> = model.modes().frequencies.iter().map(|omega| omega * omega).collect();
        if stiff.is_empty() {
            return Some(Self { stiff, squares });
        }
        let mut matrix = Matrix::diagonal(&squares);
        for (element, stiffness) in &stiff {
            let along = shape(model, element);
            for (i, a) in along.iter().enumerate() {
                for (j, b) in along.iter().enumerate() {
                    matrix[(i, j)] += stiffness * a * b;
                }
            }
        }
        let (squares, _) = symmetric_eigen(&matrix, &Matrix::diagonal(&vec![1.0; squares.len()])).ok()?;
        Some(Self { stiff, squares })
    }

    /// What rounding leaves of the square of a rigid body's frequency.
    fn floor(&self) -> f64 {
        ROUNDED * self.squares.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()))
    }

    /// Modes that vibrate, from 0, with their frequencies, rad/s.
    pub fn frequencies(&self) -> Vec<(usize, f64)> {
        let vibrating = self.squares.iter().enumerate().filter(|(_, square)| **square > self.floor());
        vibrating.map(|(mode, square)| (mode, square.sqrt())).collect()
    }
}

/// The stiffness of a law at rest, N/m, if it has one.
pub(super) fn stiffness(element: &Element) -> Option<f64> {
    let at_rest = match &element.law {
        LawKind::Jenkins(joint) => joint.stiffness,
        LawKind::PolynomialSpring(spring) => {
            spring.terms.iter().filter(|term| term.power == 1).map(|term| term.coefficient).sum()
        }
        law if law.clearance().is_some_and(|gap| gap < 0.0) => law.stiffness_bound(),
        _ => 0.0,
    };
    (at_rest != 0.0).then_some(at_rest)
}
