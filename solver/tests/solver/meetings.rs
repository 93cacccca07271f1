//! Closed curves that pass through main branches, where motions lose a symmetry of the structure that nobody tells the solver.

use crate::support::ring::{quiet, reach, ring, within};
use crate::support::starts::branches_from_starts;
use solver::response::branch::{BranchKind, BranchPoint, Side};
use solver::{Branch, Forced, State};

/// Batches of random starts.
const BATCHES: usize = 12;

/// Smallest relative distance of two branches: of the points of the first one from the chords of the second.
fn apart(forced: &Forced<'_>, branch: &Branch, main: &Branch) -> f64 {
    let chord = |state: &State, pair: &[BranchPoint]| {
        let [from, to] = [&pair[0].state, &pair[1].state];
        let share = ((state.omega - from.omega) / (to.omega - from.omega)).clamp(0.0, 1.0);
        forced.distance(&from.interpolate(to, share), state)
    };
    let states = branch.points.iter().map(|point| &point.state);
    let distances = states.flat_map(|state| main.points.windows(2).map(move |pair| chord(state, pair)));
    distances.fold(f64::INFINITY, f64::min)
}

/// In the main branch's motion the other two sectors rest. Where they begin to move, two opposite ones alike, a closed curve leaves it, to
/// come back a little higher; such curves are no isolas. The others are.
#[test]
fn closed_curves_through_a_main_branch_branch_off_it() {
    let (model, settings) = (ring(), within(3));
    let mut forced = Forced::new(&model, &settings, reach(), 0.02);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    assert_eq!(main.kind, BranchKind::Main);
    let mut found = branches_from_starts(&mut forced, main, BATCHES);
    let (_, main) = found.remove(0);
    let closed = found.iter().map(|(_, branch)| branch).filter(|branch| branch.is_closed());
    let told: Vec<(BranchKind, f64)> = closed.map(|branch| (branch.kind, apart(&forced, branch, &main))).collect();
    let of = |kind| told.iter().filter(move |(other, _)| *other == kind).map(|(_, apart)| *apart);
    assert!(of(BranchKind::Branched).count() > 0 && of(BranchKind::Isola).count() > 0, "{told:?}");
    assert!(of(BranchKind::Branched).all(|apart| apart < 1e-2), "{told:?}");
    assert!(of(BranchKind::Isola).all(|apart| apart > 1e-2), "{told:?}");
}
