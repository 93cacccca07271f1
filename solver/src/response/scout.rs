//! Scouts: random starts beyond the forcing amplitudes of a study, for the folds of the branches that they meet. A detached
//! branch that few starts meet at one forcing may be met by many at a larger one, and its folds lead back down.

use crate::formulation::Formulation;
use crate::response::branch::{Branch, BranchKind, BranchPoint, SpecialKind};
use crate::response::forced::Forced;
use crate::response::name::BranchId;
use crate::response::seeds::Landing;
use crate::response::starts::{StartPlace, land};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Forcing amplitude of a scout over that of the one before, the first one's over that of the largest level.
const RATIO: f64 = 1.25;

/// Scouts of a run: up to about twice its largest forcing amplitude, as far as folds are followed.
const SCOUTS: usize = 3;

/// The levels have so many times as many starts as each scout.
const SHARE: usize = 12;

/// What looks for folds at one forcing amplitude beyond those of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ScoutPlace {
    /// Number of the scout, from 0: the larger, the larger its forcing amplitude.
    pub number: usize,
    /// Batches of random starts.
    pub batches: usize,
}

impl ScoutPlace {
    /// Forcing amplitude, of a study whose largest is `largest`.
    pub fn forcing(&self, largest: f64) -> f64 {
        largest * RATIO.powi(self.number as i32 + 1)
    }
}

/// The scouts of a run whose levels have so many batches of random starts.
pub fn scouts(batches: usize) -> impl Iterator<Item = ScoutPlace> {
    let each = batches / SHARE;
    (0..SCOUTS).filter(move |_| each > 0).map(move |number| ScoutPlace { number, batches: each })
}

/// The first branch through landings that is not among those known, if there is one; it breaks if it is cancelled.
pub(super) type Begin<'b, 'm, F> =
    dyn FnMut(&mut Forced<'m, F>, &[Landing], &[(BranchId, &Branch)]) -> ControlFlow<(), Option<Branch>> + 'b;

/// The folds of all branches that a scout meets, at its own forcing amplitude; `forced` is of the study's largest one. `None` if
/// it is cancelled.
pub(super) fn scout<'m, F: Formulation<'m>>(
    forced: &Forced<'m, F>,
    place: &ScoutPlace,
    begin: &mut Begin<'_, 'm, F>,
) -> Option<Vec<Landing>> {
    let (model, forcing) = (forced.model(), place.forcing(forced.forcing()));
    let mut forced = Forced::<F>::build(model, forced.settings(), forced.reach(), forcing)
        .expect("what can be built at one forcing amplitude can be at another")
        .recorded(forced.recorder())
        .interrupted_by(forced.interrupt().clone());
    let mut known: Vec<Branch> = Vec::new();
    for batch in 0..place.batches {
        if forced.interrupt().is_set() {
            return None;
        }
        let Ok(mut landings) = land(&mut forced, &StartPlace::random(batch)) else { continue };
        landings.retain(|landing| !forced.is_shorter(&landing.state));
        // Each landing leads to one branch at most that is new.
        for _ in &landings {
            let name = |(number, branch)| (BranchId::new(BranchKind::Isola, number), branch);
            let named: Vec<(BranchId, &Branch)> = known.iter().enumerate().map(name).collect();
            match begin(&mut forced, &landings, &named) {
                ControlFlow::Continue(Some(branch)) => known.push(branch),
                ControlFlow::Continue(None) => break,
                ControlFlow::Break(()) => return None,
            }
        }
    }
    let folds = known.iter().filter(|branch| !branch.is_branched()).flat_map(true_folds);
    Some(folds.map(|fold| Landing { state: fold.state.clone(), distance: 0.0 }).collect())
}

/// How many points from a branch point a curve may turn because of it: both are located, next to each other.
const BESIDE: usize = 2;

/// The folds of a branch that are none of the turns which it makes where it crosses one of more symmetric motions.
fn true_folds(branch: &Branch) -> impl Iterator<Item = &BranchPoint> {
    let of = |kind| branch.special.iter().filter(move |special| special.kind == kind).map(|special| special.index);
    let count = branch.points.len();
    let is_beside = move |a: usize, b: usize| a.abs_diff(b).min(count - a.abs_diff(b)) <= BESIDE;
    let crossed: Vec<usize> = of(SpecialKind::BranchPoint).collect();
    of(SpecialKind::Fold)
        .filter(move |&fold| !crossed.iter().any(|&point| is_beside(point, fold)))
        .map(|index| &branch.points[index])
}
