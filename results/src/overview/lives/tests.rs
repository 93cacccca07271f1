//! Isolas along fold curves that are made up.

use super::*;

fn curve(points: &[(f64, &str)]) -> CurveRow {
    let point = |(i, &(forcing, event)): (usize, &(f64, &str))| CurvePoint {
        forcing,
        omega: 1.0 + i as f64,
        event: (!event.is_empty()).then(|| event.into()),
        ..CurvePoint::default()
    };
    CurveRow { points: points.iter().enumerate().map(point).collect(), ..CurveRow::default() }
}

fn told(curves: &[CurveRow]) -> Vec<(f64, f64)> {
    lives(curves).iter().map(|life| (life.from.forcing, life.to.forcing)).collect()
}

#[test]
fn what_comes_first_along_two_edges() {
    let merges = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")];
    assert_eq!(told(&[curve(&merges)]), [(1.5, 4.0)]);
    // Its other edge is not known up to there.
    assert_eq!(told(&[curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (3.0, "")])]), []);
    let both = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (3.0, "merge"), (1.0, "")];
    assert_eq!(told(&[curve(&both)]), [(1.5, 3.0)]);
    let mut closed = curve(&[(1.0, "birth"), (2.0, ""), (3.0, "death"), (2.0, "")]);
    closed.points.push(CurvePoint { event: None, ..closed.points[0].clone() });
    assert_eq!(told(&[closed]), [(1.0, 3.0)]);
    assert_eq!(told(&[curve(&[(1.0, "birth"), (2.0, "")])]), []);
}

#[test]
fn what_comes_to_no_end() {
    let bounded =
        |points: &[(f64, &str)]| CurveRow { status: "open: forcing bound to forcing bound".into(), ..curve(points) };
    let told = |curves: &[CurveRow]| lasting(curves).iter().map(|one| (one.from.forcing, one.to)).collect::<Vec<_>>();
    let both = bounded(&[(4.0, ""), (1.0, "birth"), (2.0, ""), (3.0, "")]);
    assert_eq!(told(std::slice::from_ref(&both)), [(1.0, 3.0)]);
    // Something else may be its end, or an edge turns or is lost before.
    for event in ["merge", "unknown"] {
        assert_eq!(told(&[both.clone(), curve(&[(9.0, ""), (2.5, event), (9.0, "")])]), []);
    }
    assert_eq!(told(&[bounded(&[(4.0, ""), (1.0, "birth"), (3.0, ""), (2.0, "")])]), []);
    assert_eq!(told(&[bounded(&[(4.0, ""), (1.0, "birth"), (3.0, "merge"), (2.0, "")])]), []);
    assert_eq!(told(&[CurveRow { is_unfinished: true, ..both.clone() }]), []);
    let met = Crossing { segment: 1, forcing: 1.5, branch: "main".into(), ..Crossing::default() };
    assert_eq!(told(&[CurveRow { crossings: vec![met], ..both.clone() }]), []);
    // Elsewhere than at the bound of the forcing it may end as an isola.
    for status in ["open: forcing bound to branch point", "open: frequency bound to forcing bound", "closed"] {
        assert_eq!(told(&[CurveRow { status: status.into(), ..both.clone() }]), []);
    }
    // The same curve, followed again, knows more.
    let farther = bounded(&[(8.0, ""), (1.0, "birth"), (2.0, ""), (6.0, "")]);
    assert_eq!(told(&[both.clone(), farther]), [(1.0, 6.0)]);
    let ends = bounded(&[(8.0, ""), (1.0, "birth"), (6.0, "merge"), (1.5, "")]);
    assert_eq!(told(&[both.clone(), ends.clone()]), []);
    assert_eq!(lives(&[both, ends]).len(), 1);
}

#[test]
fn what_may_join_another_branch() {
    let ends = |status: &str, points: &[(f64, &str)]| {
        let curves = [CurveRow { status: status.into(), ..curve(points) }];
        let birth = curves[0].points.iter().find(|point| point.event.as_deref() == Some("birth")).unwrap();
        joining(&curves, birth).map(|end| end.forcing)
    };
    let points = [(3.0, ""), (2.0, ""), (1.0, "birth"), (2.5, ""), (4.0, "")];
    assert_eq!(ends("open: branch point to forcing bound", &points), Some(3.0));
    assert_eq!(ends("open: forcing bound to branch point", &points), Some(4.0));
    assert_eq!([ends("open: forcing bound to forcing bound", &points), ends("closed", &points)], [None, None]);
    // What happens before is told.
    let merges = [(2.0, ""), (3.0, "merge"), (1.0, "birth"), (4.0, "")];
    assert_eq!(ends("open: branch point to forcing bound", &merges), None);
}

#[test]
fn through_cusps_and_from_deaths() {
    let cusp = [(9.0, ""), (2.378, "merge"), (2.379, "cusp"), (2.1, "birth"), (9.0, "")];
    assert_eq!(told(&[curve(&cusp)]), [(2.1, 2.378)]);
    let parts = [(0.8, ""), (0.74, "merge"), (0.73, "cusp"), (4.2, "death"), (3.0, "merge"), (3.2, "")];
    assert_eq!(told(&[curve(&parts)]), [(3.0, 4.2)]);
    // Two isolas of two curves are told one by one.
    assert_eq!(told(&[curve(&parts), curve(&cusp)]), [(2.1, 2.378), (3.0, 4.2)]);
}

#[test]
fn what_levels_have_is_no_other() {
    let crossing =
        |segment, forcing, branch: &str| Crossing { segment, forcing, branch: branch.into(), ..Crossing::default() };
    let with = |crossings: Vec<Crossing>| {
        let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
        told(&[CurveRow { crossings, ..merges }]).len()
    };
    assert_eq!(with(vec![crossing(1, 2.0, "isola 1"), crossing(2, 2.0, "isola 1"), crossing(2, 4.5, "main")]), 1);
    // At a level between it is part of something else by now, or still.
    assert_eq!(with(vec![crossing(1, 2.0, "isola 1"), crossing(1, 3.5, "main")]), 0);
    let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
    let lost = |end| CurveRow { is_unfinished: true, ..curve(&[(0.5, ""), (end, "")]) };
    assert_eq!(told(&[merges.clone(), lost(3.0)]).len(), 0);
    assert_eq!(told(&[merges, lost(7.0)]).len(), 1);
}

#[test]
fn what_begins_where_branches_merge_may_come_apart() {
    let parts = curve(&[(9.0, ""), (1.0, "merge"), (2.0, "death"), (0.5, "")]);
    let ends_at = |forcing| CurveRow {
        status: "open: forcing bound to branch point".into(),
        ..curve(&[(9.0, ""), (0.5, "birth"), (forcing, "")])
    };
    assert_eq!(told(std::slice::from_ref(&parts)), [(1.0, 2.0)]);
    for (forcing, expected) in [(1.5, 0), (0.9, 1), (2.5, 1)] {
        assert_eq!(told(&[parts.clone(), ends_at(forcing)]).len(), expected, "{forcing}");
    }
    // It is told where no level is.
    let missed = |values: &[f64]| {
        let levels: Vec<Level> = values.iter().map(|value| Level { value: *value, ..Level::default() }).collect();
        parted_between(std::slice::from_ref(&parts), &levels).len()
    };
    assert_eq!([missed(&[0.5, 3.0]), missed(&[0.5, 1.5, 3.0])], [1, 0]);
}

#[test]
fn what_happens_between_may_be_about_it() {
    let merges = curve(&[(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")]);
    for (event, forcing, expected) in
        [("merge", 2.0, 0), ("unknown", 2.0, 0), ("merge", 6.0, 1), ("birth", 2.0, 1), ("cusp", 2.0, 1)]
    {
        let other = curve(&[(7.0, ""), (forcing, event), (8.0, "")]);
        let all = [merges.clone(), other];
        let found = told(&all).into_iter().filter(|life| *life == (1.5, 4.0)).count();
        assert_eq!(found, expected, "{event} at {forcing}");
    }
}

/// Isolas of two curves that overlap in the forcing are told one by one, where it is known that the one is not the other.
#[test]
fn what_others_do_between_is_not_about_it() {
    let crossed = |row: CurveRow, crossings: &[(usize, f64, &str)]| {
        let crossing = |&(segment, forcing, branch): &(usize, f64, &str)| Crossing {
            segment,
            forcing,
            amplitude: forcing.to_string(),
            branch: branch.into(),
        };
        CurveRow { crossings: crossings.iter().map(crossing).collect(), ..row }
    };
    let outer = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (5.0, "")];
    let inner = [(1.0, ""), (3.0, "merge"), (2.0, "birth"), (3.5, "")];
    // The other one merges with the main branch, or with nobody knows what: with this one, perhaps.
    let told = |main: &[(usize, f64, &str)]| told(&[curve(&outer), crossed(curve(&inner), main)]);
    assert_eq!(told(&[(0, 1.2, "main")]), [(1.5, 4.0), (2.0, 3.0)]);
    assert_eq!(told(&[]), [(2.0, 3.0)]);
    assert_eq!(told(&[(0, 1.2, "isola 1")]), [(1.5, 4.0), (2.0, 3.0)], "it was there before this one was born");
    // At a level between it has a number of its own.
    let level = [(1, 2.5, "isola 1"), (2, 2.5, "isola 1")];
    let beside = |name| {
        let merges = [(2.2, ""), (3.0, "merge"), (2.2, "")];
        let other = crossed(curve(&merges), &[(0, 2.5, name), (1, 2.5, "main")]);
        lives(&[crossed(curve(&outer), &level), other]).len()
    };
    assert_eq!([beside("isola 2"), beside("isola 1"), beside("unfinished 1")], [1, 0, 1]);
    // What parts from the main branch need not be new.
    let parts = crossed(curve(&[(1.0, ""), (3.0, "merge"), (1.0, "")]), &[(0, 1.2, "main"), (1, 1.2, "main")]);
    assert_eq!(lives(&[curve(&outer), parts]).len(), 1);
}

/// What has the other edge of an isola beyond its end is what it has become part of.
#[test]
fn the_main_branch_has_the_other_edge_at_the_next_level() {
    let crossing = |segment, forcing: f64, branch: &str| Crossing {
        segment,
        forcing,
        amplitude: forcing.to_string(),
        branch: branch.into(),
    };
    let with = |points: &[(f64, &str)], crossings: Vec<Crossing>, others: &[CurveRow]| {
        let own = CurveRow { crossings, ..curve(points) };
        let all = [&[own], others].concat();
        let [life] = lives(&all)[..] else { panic!("{:?}", lives(&all)) };
        life.is_with_main
    };
    let merges = [(1.0, ""), (4.0, "merge"), (1.5, "birth"), (7.0, "")];
    assert!(with(&merges, vec![crossing(2, 5.0, "main"), crossing(2, 6.0, "isola 1")], &[]));
    assert!(!with(&merges, vec![crossing(2, 5.0, "isola 1"), crossing(2, 6.0, "main")], &[]));
    assert!(!with(&merges, vec![crossing(0, 2.0, "main")], &[]), "that is the fold that it meets");
    // Something may have happened before that level, and nothing that matters beyond it.
    let other = |forcing| curve(&[(9.0, ""), (forcing, "merge"), (9.0, "")]);
    assert!(!with(&merges, vec![crossing(2, 5.0, "main")], &[other(4.5)]));
    assert!(with(&merges, vec![crossing(2, 5.0, "main")], &[other(5.5)]));
    // And so what it parts from.
    let parts = [(9.0, ""), (3.0, "merge"), (6.0, "death"), (1.0, "")];
    assert!(with(&parts, vec![crossing(2, 2.0, "main")], &[]));
}

/// Beyond where an isola ends, what its other edge is that of turns at a cusp, and comes back to the levels from before.
#[test]
fn edges_that_come_back() {
    let points = [(0.05, ""), (1.8, "merge"), (0.9, "birth"), (2.0, ""), (9.0, "cusp"), (2.0, ""), (0.05, "")];
    let crossing = |segment: usize, forcing: f64, branch: &str| Crossing {
        segment,
        forcing,
        amplitude: forcing.to_string(),
        branch: branch.into(),
    };
    let crossings = [(0, 1.0, "main"), (1, 1.0, "isola 1"), (2, 1.0, "isola 1"), (3, 3.0, "main"), (4, 3.0, "main")];
    let back = (5, 1.0, "main");
    let crossings =
        crossings.into_iter().chain([back]).map(|(segment, forcing, branch)| crossing(segment, forcing, branch));
    let of = CurveRow { crossings: crossings.collect(), ..curve(&points) };
    assert_eq!(told(std::slice::from_ref(&of)), [(0.9, 1.8)]);
    assert!(lives(&[of])[0].is_with_main);
}
