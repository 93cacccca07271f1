//! Structures whose place is not determined.

use crate::words;
use solver::Matrix;
use solver::linalg::eigenvalues;
use solver::structure::Model;
use solver::structure::laws::LawKind;

/// A rigid-body motion of which springs feel no more than the square root of this share is held by none.
const HELD: f64 = 1e-12;

/// Of structures that move as a rigid body, and that only contacts, stops or sliders may hold: where these let go the same motion goes on
/// anywhere. A sentence.
pub fn undetermined(model: &Model) -> Option<String> {
    let rigid: Vec<usize> = (0..model.size()).filter(|&mode| model.modes().is_rigid(mode)).collect();
    // A polynomial resists wherever the structure is; several may hold one motion and leave another free.
    let springs = model.elements().iter().filter(|element| matches!(element.law, LawKind::PolynomialSpring(_)));
    let felt: Vec<Vec<f64>> = springs
        .map(|spring| {
            let shape: Vec<f64> = model.modes().along(&spring.channels[0]).collect();
            let length = shape.iter().map(|b| b * b).sum::<f64>().sqrt();
            rigid.iter().map(|&mode| shape[mode] / length).collect()
        })
        .collect();
    let resistance = Matrix::from_fn(rigid.len(), rigid.len(), |i, j| felt.iter().map(|felt| felt[i] * felt[j]).sum());
    let is_free = !rigid.is_empty() && eigenvalues(&resistance).ok()?.iter().any(|value| value.re <= HELD);
    is_free.then(|| {
        format!(
            "not every rigid-body motion of {} is resisted at every place: wherever contacts, stops and sliders let go, the same motion goes \
             on at any mean position, and which one is listed, with its amplitude, is arbitrary; how it deforms is not. Hold it by a soft spring",
            words::modes(&rigid)
        )
    })
}
