//! The motion that time marching has near a point of a branch, beside that of the balance.

use super::motion::Motions;
use solver::formulation::state::State;
use solver::stability::multipliers::Verdict;
use solver::stability::polish::{Around, PolishSettings, Reason, polish};
use solver::stability::shooting::Orbit;
use solver::structure::Model;

/// Instants of a period, at least, of which displacements are kept.
const INSTANTS: usize = 512;

/// One period of a marched orbit.
#[derive(Debug, Clone, PartialEq)]
pub struct MarchedPeriod {
    /// Its frequency, rad/s.
    pub omega: f64,
    /// Whether it is stable.
    pub verdict: Verdict,
    /// Instants, in periods.
    pub times: Vec<f64>,
    /// Displacement of every node at these instants, m.
    pub displacements: Vec<Vec<f64>>,
}

/// The marched orbit near point `index` of a branch, as of Fig. 8 of the paper.
///
/// # Errors
/// Why there is none.
///
/// # Panics
/// If there is no such point.
pub fn marched(
    motions: &Motions,
    model: &Model,
    (states, is_closed): (&[State], bool),
    index: usize,
) -> Result<MarchedPeriod, Reason> {
    let count = states.len();
    let has_neighbours = is_closed || (index > 0 && index + 1 < count);
    let between = has_neighbours.then(|| [&states[(index + count - 1) % count], &states[(index + 1) % count]]);
    let polished = |around| polish(model, &PolishSettings::default(), &states[index], around);
    // At the same frequency if there is one: near folds the marched branch does not reach as far.
    let found = Some(polished(Around::default())).filter(|found| found.polished.is_some());
    let found = found.unwrap_or_else(|| polished(Around { between, neighbour: None }));
    let Some(polished) = found.polished else { return Err(found.reason.unwrap_or(Reason::NotConverged)) };
    let (times, displacements) = period(motions, model, &polished.orbit).ok_or(Reason::Failed)?;
    Ok(MarchedPeriod { omega: polished.orbit.omega, verdict: found.verdict, times, displacements })
}

/// Instants, in periods, and the displacements of every node there.
fn period(motions: &Motions, model: &Model, orbit: &Orbit) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let mut marching = orbit.marching(model).ok()?;
    let stride = (orbit.steps / INSTANTS).max(1);
    let (mut times, mut displacements) = (Vec::new(), vec![Vec::new(); motions.nodes.len()]);
    for step in 0..=orbit.steps {
        if step % stride == 0 || step == orbit.steps {
            times.push(step as f64 / orbit.steps as f64);
            let now = motions.displacements(&marching.state()[..model.size()]);
            displacements.iter_mut().zip(now).for_each(|(list, x)| list.push(x));
        }
        marching.step().ok()?;
    }
    Some((times, displacements))
}
