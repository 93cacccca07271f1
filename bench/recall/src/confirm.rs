//! Closed branches that the truth does not have, looked at with the equations of the truth: whether they are there.

use crate::balance::Balance;
use crate::closed::isola;
use crate::known::Extent;
use crate::record::{Isola, Record};
use crate::starts::converged;
use crate::structure::Structure;
use crate::survey::{HARMONICS, bounds};
use crate::walk::branch;

/// The closed branch of a structure at a forcing amplitude through one of these motions, unknowns of the balance with
/// [`HARMONICS`] harmonics: followed from there anew, with no regard to where they come from; the first that is the one looked for.
pub fn closed_through(
    record: &Record,
    forcing: f64,
    motions: &[Vec<f64>],
    is_it: &dyn Fn(&Isola) -> bool,
) -> Option<Isola> {
    let structure = Structure::new(&record.model);
    let balance = Balance::new(&structure, HARMONICS, forcing);
    let bounds = bounds((record.range[0], record.range[1]));
    motions.iter().find_map(|motion| {
        let (y, tangent) = converged(&balance, motion)?;
        let curve = branch(&balance, &y, &tangent, &bounds);
        let extent = Extent::of(&balance, &curve.points);
        curve.is_closed().then(|| isola(&balance, &curve, &extent, 0)).filter(is_it)
    })
}
