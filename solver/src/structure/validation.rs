//! What is refused: matrices, names, parameters and elements that make no model. Errors name keys as they stand in model
//! files.

use super::Element;
use super::error::{ModelError, Place};
use super::laws::{Law, LawKind};
use crate::linalg::Matrix;

/// Refuses a matrix that is not n × n, finite and symmetric to 1e-8; removes the asymmetry that is left.
pub(crate) fn symmetric(key: &str, matrix: Matrix, n: usize) -> Result<Matrix, ModelError> {
    let (rows, cols) = (matrix.rows(), matrix.cols());
    if rows != n || cols != n {
        let expected = format!("but the mass matrix is {n} × {n}; M, K and C must have the same size");
        return Err(ModelError::Size { place: Place::key(key), rows, cols, expected });
    }
    if let Some(at) = matrix.entries().iter().position(|v| !v.is_finite()) {
        let (row, col) = (at / n + 1, at % n + 1);
        return Err(ModelError::NotFinite { place: Place::key(key), row, col, value: matrix.entries()[at] });
    }
    let largest = matrix.entries().iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    for i in 0..n {
        for j in 0..i {
            let (value, mirrored) = (matrix[(i, j)], matrix[(j, i)]);
            if (value - mirrored).abs() > 1e-8 * largest {
                let (row, col) = (i + 1, j + 1);
                return Err(ModelError::NotSymmetric { place: Place::key(key), row, col, value, mirrored });
            }
        }
    }
    Ok(Matrix::from_fn(n, n, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)])))
}

/// The first name that comes twice.
pub(crate) fn duplicate<'a>(names: impl IntoIterator<Item = &'a String>) -> Option<String> {
    let mut seen = std::collections::HashSet::new();
    names.into_iter().find(|&name| !seen.insert(name)).cloned()
}

pub(crate) fn check_ratio(place: Place, ratio: f64) -> Result<(), ModelError> {
    let remedy = "a damping ratio must be at least 0 and below 1 (0.01 is one percent of critical)";
    if (0.0..1.0).contains(&ratio) { Ok(()) } else { Err(ModelError::value(place, ratio, remedy)) }
}

pub(crate) fn at_least_zero(place: Place, value: f64, unit: &str) -> Result<(), ModelError> {
    let ok = value.is_finite() && value >= 0.0;
    if ok {
        Ok(())
    } else {
        Err(ModelError::value(place, value, format!("must be finite, zero or positive{}", in_unit(unit))))
    }
}

pub(crate) fn above_zero(place: Place, value: f64, unit: &str) -> Result<(), ModelError> {
    let ok = value.is_finite() && value > 0.0;
    if ok {
        Ok(())
    } else {
        Err(ModelError::value(place, value, format!("must be finite and positive{}", in_unit(unit))))
    }
}

pub(crate) fn check_sense(place: Place, sense: f64) -> Result<(), ModelError> {
    let remedy = "must be 1 or -1: the sign of the sliding velocity along the first tangential direction";
    if sense.abs() == 1.0 { Ok(()) } else { Err(ModelError::value(place, sense, remedy)) }
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(", in {unit}") }
}

/// Refuses a force that is not one finite number per dof, or zero.
pub(crate) fn check_force(force: &[f64], dofs: &[String]) -> Result<(), ModelError> {
    let (n, place) = (dofs.len(), Place::key("forcing.shape"));
    if force.len() != n {
        let value = format!("{} entries", force.len());
        return Err(ModelError::value(place, value, format!("give {n}, one per dof, in N")));
    }
    if let Some(i) = force.iter().position(|f| !f.is_finite()) {
        let value = format!("{} on dof `{}`", force[i], dofs[i]);
        return Err(ModelError::value(place, value, "a force must be a finite number, in N"));
    }
    if force.iter().all(|&f| f == 0.0) {
        return Err(ModelError::NoForce { place });
    }
    Ok(())
}

pub(crate) fn check_harmonic(harmonic: usize) -> Result<(), ModelError> {
    if harmonic > 0 {
        return Ok(());
    }
    Err(ModelError::value(Place::key("forcing.harmonic"), 0, "the harmonic must be 1 or more"))
}

pub(crate) fn check_monitors(monitors: &[usize], n: usize) -> Result<(), ModelError> {
    let place = || Place::key("monitors");
    if monitors.is_empty() {
        return Err(ModelError::value(place(), "[]", "name at least one dof"));
    }
    match monitors.iter().find(|&&dof| dof >= n) {
        None => Ok(()),
        Some(dof) if n == 0 => Err(ModelError::value(place(), dof, "there is no dof")),
        Some(dof) => Err(ModelError::value(place(), dof, format!("dofs count from 0 to {}", n - 1))),
    }
}

/// Refuses a name that comes twice, and elements that do not fit `n` dofs.
pub(crate) fn check_elements(elements: &[Element], n: usize) -> Result<(), ModelError> {
    if let Some(name) = duplicate(elements.iter().map(|element| &element.name)) {
        return Err(ModelError::Duplicate { place: Place::key("elements"), what: "nonlinear element", name });
    }
    elements.iter().try_for_each(|element| check_element(element, n))
}

fn check_element(element: &Element, n: usize) -> Result<(), ModelError> {
    check_channels(&element.name, &element.channels, element.law.arguments(), n)?;
    check_law(&element.law, |key| Place::key(format!("elements.{}.{key}", element.name)))
}

/// Refuses dofs that do not exist, and displacements that are not one for each of a law's `needed` arguments.
pub(crate) fn check_channels(
    name: &str,
    channels: &[Vec<(usize, f64)>],
    needed: usize,
    n: usize,
) -> Result<(), ModelError> {
    let place = || Place::key(format!("elements.{name}.channels"));
    for channel in channels {
        if let Some((dof, b)) = channel.iter().find(|(dof, b)| *dof >= n || !b.is_finite()) {
            let remedy = format!("expected a dof counted from 0 to {} and a finite coefficient", n - 1);
            return Err(ModelError::value(place(), format!("({dof}, {b})"), remedy));
        }
    }
    // A second tangential direction may be missing; a first argument that never moves would switch the law off.
    if channels.first().is_none_or(|channel| channel.iter().all(|(_, b)| *b == 0.0)) {
        let remedy = "the law acts on no dof; give it one with a coefficient other than zero";
        return Err(ModelError::value(place(), "[]", remedy));
    }
    let given = channels.len();
    if given != needed {
        return Err(ModelError::value(place(), given, format!("this law acts on {needed} displacements")));
    }
    Ok(())
}

/// Refuses parameters that are out of range; `place` finds the place of one.
pub(crate) fn check_law(law: &LawKind, place: impl Fn(&str) -> Place) -> Result<(), ModelError> {
    law.validate().map_err(|e| ModelError::value(place(&e.parameter), e.value, format!("expected {}", e.expected)))
}
