//! Closed curves that pass through main branches, where motions lose a symmetry of the structure that nobody tells the solver.

use crate::support::ring::{quiet, reach, ring, within};
use crate::support::starts::branches_from_starts;
use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::{BranchKind, BranchPoint, Side, SpecialKind};
use solver::response::folds::{Critical, CriticalKind, Extent, Quantity};
use solver::{Branch, Forced, Model, State};

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

/// An isola merges with the main branch where a cusp of its fold curve is so near, 1e-6 of the forcing, that steps pass over both. A shooting has
/// a main branch of 1.0217 m at A = 0.0254, and one of 2.1934 m at A = 0.0256: the isola is part of it.
#[test]
fn a_merge_beside_a_cusp_is_found_with_twice_the_harmonics() {
    let spring = |terms: &[(u32, f64)]| {
        let terms = terms.iter().map(|&(power, coefficient)| Term { power, coefficient });
        PolynomialSpring { terms: terms.collect() }
    };
    let model = Model::builder("softening and stiffening")
        .mass([[0.216, 0.0], [0.0, 0.44]])
        .stiffness([[2.229, -0.536], [-0.536, 2.539]])
        .damping_matrix([[0.00584, -0.001281], [-0.001281, 0.007111]])
        .force(0, 1.0)
        .element("x", spring(&[(3, -0.836), (5, 0.1254)]), [vec![(0, 1.0)]])
        .element("y", spring(&[(3, 0.191 + 0.321)]), [vec![(1, 1.0)]])
        .build()
        .unwrap();
    let study = Study::of_modes(model, with_harmonics(7));
    let level = study.level(0.0227);
    let isolas = of_kind(&level, Kind::Isola);
    let [isola] = isolas[..] else { panic!("{level:#?}") };
    let extent = Extent { forcing: (0.01, 0.05), frequency: (1.0, 10.0), points: 5000 };
    let mut critical = Critical::new(&study.model, &study.settings, Quantity::Frequency, extent).unwrap();
    let fold = isola.branch.special(SpecialKind::Fold).next().unwrap();
    let curve = critical.curve(&fold.state, &mut quiet).unwrap();
    let merge = curve.events.iter().find(|event| event.kind == CriticalKind::Merge).unwrap();
    let forcing = curve.points[merge.index].state.forcing;
    assert!((0.0254..0.0256).contains(&forcing), "{forcing}");
    let cusps = curve.events(CriticalKind::Cusp).map(|cusp| (cusp.state.forcing / forcing - 1.0).abs());
    assert!(cusps.fold(f64::INFINITY, f64::min) < 1e-5);
    let (doubled, _) = merge.doubled.expect("the same with twice the harmonics");
    assert!((doubled / forcing - 1.0).abs() < 1e-6, "{doubled} {forcing}");
}
