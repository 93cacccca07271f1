//! What time marching says: where the structure can settle, what leads there, and what unstable motions turn into.

use super::*;
use crate::store::{MotionRow, PushRow};
use solver::stability::endings::Ending;

/// A branch that was verified.
fn verified(stable: f64, unstable: f64, peak: &str, branch: BranchRow) -> BranchRow {
    let peak = Some(PeakOrbit { verdict: peak.into(), at: Some((120.0, 1.5e-3)) });
    let largest = (stable > 0.0 && !branch.is_main()).then_some((115.0, 1.8e-3));
    BranchRow {
        stability: Some(Stability {
            is_whole: !branch.is_main(),
            stable,
            unstable,
            peak,
            largest,
            ..Stability::default()
        }),
        ..branch
    }
}

#[test]
fn what_can_settle_is_told() {
    let danger = |isolas: Vec<BranchRow>| {
        let one = |isola: BranchRow| level(1.0, vec![verified(0.1, 0.0, "stable", main(1e-3)), isola]);
        let levels: Vec<Level> = isolas.into_iter().map(one).collect();
        texts(&levels)[0].clone()
    };
    let unstable = "By time marching, the isola is unstable wherever it could tell; nothing was seen to settle there;";
    let cases = [
        (
            vec![verified(0.5, 0.5, "unstable", isola(2e-3))],
            "By time marching, the isola is stable in parts: there the structure can settle, found stable up to 1.8 mm at 115 rad/s (18.3 Hz);",
        ),
        (vec![verified(0.0, 1.0, "unstable", isola(2e-3))], unstable),
        (vec![verified(0.0, 0.9, "none", isola(2e-3))], unstable),
        (
            vec![verified(0.0, 0.0, "not_comparable", isola(2e-3))],
            "By time marching, the isola is not known to be stable or unstable;",
        ),
        (
            vec![verified(0.5, 0.5, "stable", isola(2e-3)), verified(0.0, 1.0, "unstable", isola(1e-3)), isola(1e-3)],
            "By time marching, of 3 isolas 1 is stable in parts, 1 is unstable wherever it could tell, 1 is not verified: there the structure \
             can settle, on isolas found stable up to 1.8 mm (isola 1 at A = 1) at 115 rad/s (18.3 Hz);",
        ),
        (
            vec![verified(0.0, 0.0, "none", isola(2e-3)), verified(0.0, 0.0, "none", isola(1e-3))],
            "By time marching, both isolas are not known to be stable or unstable;",
        ),
    ];
    for (isolas, expected) in cases {
        let said = danger(isolas);
        assert!(said.contains(expected), "{said}");
        assert!(!said.contains("Largest periodic response found stable"), "{said}");
        let end = if said.contains("there the structure can settle") {
            "; what leads there was not looked for (isola disturb does)."
        } else {
            "; isola disturb pushes onto what is known to be stable of isolas, and there is none."
        };
        assert!(said.contains(end), "{said}");
    }
    for (peak, expected) in [
        (
            "stable",
            "near the largest response, 1.5 mm (25 % less) at 120 rad/s (19.1 Hz), is stable, which the largest response itself need not be.",
        ),
        (
            "unstable",
            "near the largest response, 1.5 mm (25 % less) at 120 rad/s (19.1 Hz), is unstable, which the largest response itself need not be.",
        ),
        (
            "marginal",
            "near the largest response, 1.5 mm (25 % less) at 120 rad/s (19.1 Hz), is marginal (at the edge of stability).",
        ),
        (
            "none",
            "Whether the largest response is stable is not known: time marching came to no periodic motion near it.",
        ),
        (
            "not_comparable",
            "is stable is not known: time marching is not comparable there (marching loses impact energy that the balance keeps).",
        ),
    ] {
        let said = danger(vec![verified(0.0, 0.5, peak, isola(2e-3))]);
        assert!(said.contains(expected), "{peak}: {said}");
    }
}

#[test]
fn what_is_larger_than_isolas_is_told() {
    let stable = |largest, row: BranchRow| {
        let row = verified(0.5, 0.5, "unstable", row);
        let stability = row.stability.map(|known| Stability { largest: Some((61.0, largest)), ..known });
        BranchRow { stability, ..row }
    };
    let branched = stable(2e-2, branch("branched", 1, (92.0, 95.0), 2e-2));
    let levels = [
        level(1.0, vec![main(1e-3), stable(8e-3, isola(1.2e-2))]),
        level(2.0, vec![main(1e-3), stable(7e-3, isola(2.1e-2)), branched]),
    ];
    let all = told(&levels, |evidence| evidence.search = SearchCounts { hanging: 2, ..SearchCounts::default() });
    let settles = "By time marching, both isolas are stable in parts: there the structure can settle, on isolas found stable up to 8 mm (isola 1 at A = 1) at 61 rad/s";
    let largest = "Largest periodic response found stable, of the points that were marched: 20 mm, on branched 1 at A = 2 and 61 rad/s (9.708 Hz).";
    assert!(all[0].contains(settles) && all[0].contains(largest), "{}", all[0]);
    // Nothing over the forcing hangs on what is not followed if nothing is followed.
    assert!(!all[1].contains("branch off"), "{}", all[1]);
    assert!(
        all[0].contains("; folds of 2 branches that branch off others were not followed over the forcing."),
        "{}",
        all[0]
    );
    let birth = CurvePoint { forcing: 0.5, omega: 60.0, event: Some("birth".into()), ..CurvePoint::default() };
    let curves = [CurveRow { points: vec![birth], ..CurveRow::default() }];
    let [_, onset, _] = told(&levels, |evidence| {
        evidence.curves = &curves;
        evidence.search = SearchCounts { hanging: 1, ..SearchCounts::default() };
    });
    let missing = "Births and merges along folds of 1 branch that branches off others are not among these: such folds were not followed";
    assert!(onset.contains(missing), "{onset}");
}

#[test]
fn the_push_of_least_energy_is_told_with_its_isola() {
    let push = |forcing: &str, monitor, impulse: f64, velocity: f64| PushRow {
        forcing: forcing.into(),
        branch: "isola 1".into(),
        mode: monitor + 1,
        omega: 58.6,
        monitor,
        motions: 16,
        largest: Some(9.0),
        impulse: Some(impulse),
        below: Some(0.9 * impulse),
        velocity: Some(velocity),
        phase: Some(0.25),
        confirmed: Some(true),
        reason: None,
        from_rest: None,
    };
    let levels = [level(1.0, vec![main(1e-3), verified(0.5, 0.5, "unstable", isola(2e-3))])];
    // The larger impulse acts on what is heavier, and takes less.
    let pushes = [push("1", 0, 0.4, 0.4), push("2", 1, 2.0, 0.05)];
    let [danger, ..] = told(&levels, |evidence| {
        evidence.pushes = &pushes;
        evidence.structure.monitors = vec!["sink".into(), "machine".into()];
    });
    let least = "Of the pushes looked for, one frequency an isola, the one found with least energy to lead to an \
                 isola leads to isola 1 of A = 2 at 58.6 rad/s (9.326 Hz): 0.05 J, all dofs at once in the shape of mode 2, +0.05 m/s at \
                 machine (what +2 N s at that dof put into the mode), 0.25 of a period of the isola's motion after an instant at which the \
                 force is largest.";
    assert!(danger.contains(least), "{danger}");
    let none = [PushRow { impulse: None, velocity: None, ..push("1", 0, 0.4, 0.4) }];
    let [danger, ..] = told(&levels, |evidence| evidence.pushes = &none);
    assert!(danger.contains("No push that leads to an isola was found among those tried; others may."), "{danger}");
    let untried = [PushRow { reason: Some("nothing lasts there".into()), ..none[0].clone() }];
    let [danger, ..] = told(&levels, |evidence| evidence.pushes = &untried);
    assert!(danger.contains(" No push onto an isola was tried: nothing lasts there."), "{danger}");
    let switched_on = [PushRow { from_rest: Some(Ending::Onto), ..untried[0].clone() }];
    let [danger, ..] = told(&levels, |evidence| evidence.pushes = &switched_on);
    let onto = "The force switched on at rest (at once, where it is largest) leads onto isola 1 at A = 1 and 58.6000 rad/s without a push.";
    assert!(danger.contains(onto), "{danger}");
}

#[test]
fn what_the_main_branch_turns_into_is_told_where_it_is_larger() {
    let motion = |branch: &str, amplitude| MotionRow {
        forcing: "1".into(),
        branch: branch.into(),
        point: 7,
        omega: 95.0,
        motion: "chaotic".into(),
        repeats: None,
        onto: None,
        amplitude: Some((1e-4, amplitude)),
        growth: None,
        periods: 300,
    };
    let missed = |motions: &[MotionRow], row: BranchRow| {
        let levels = [level(1.0, vec![main(1e-3), row])];
        told(&levels, |evidence| evidence.motions = motions)[2].clone()
    };
    let larger = [motion("main", 1.1e-3), motion("main", 1.25e-3), motion("isola 1", 3e-3)];
    let expected = "Unstable motions of main branches turn into larger ones: by time marching, at A = 1 into chaotic motions of up to \
                    1.25 mm at 95 rad/s (15.12 Hz), 25 % more than the main branch has.";
    assert!(missed(&larger, isola(2e-3)).ends_with(expected), "{}", missed(&larger, isola(2e-3)));
    let none = missed(&larger, branch("open", 1, (120.0, 130.0), 1.5e-3));
    assert!(none.starts_with("No isola was found") && none.contains(expected), "{none}");
    assert!(!missed(&[motion("main", 1e-3)], isola(2e-3)).contains("turn into"));
}

/// An isola that nothing confirms is no answer; where another is confirmed that one is.
#[test]
fn what_may_be_an_artefact_is_said_to() {
    let artefact = || BranchRow { peak_standing: Some(Standing::At), ..verified(0.0, 0.0, "none", isola(9e-3)) };
    let with = |isolas: Vec<BranchRow>| {
        let branches = std::iter::once(main(1e-3)).chain(isolas).collect();
        texts(&[level(1.0, branches)])
    };
    let [danger, _, missed] = with(vec![artefact()]);
    assert!(
        danger.contains(" 9 mm (not converged in H) at tip. It may be an artefact of too few harmonics. "),
        "{danger}"
    );
    assert!(
        missed.contains(
            "Unless the isola is an artefact of too few harmonics, yes. At A = 1 ordinary continuation goes up"
        ),
        "{missed}"
    );
    let [danger, _, missed] = with(vec![artefact(), verified(0.5, 0.5, "stable", isola(2e-3))]);
    assert!(danger.contains(" Some of these isolas may be artefacts of too few harmonics. "), "{danger}");
    assert!(
        missed.contains("Yes. At A = 1 it goes up to 1 mm")
            && missed.contains(" times as much. Farther than these two, up to 9 mm"),
        "{missed}"
    );
}

#[test]
fn what_is_larger_than_main_branch_and_isola() {
    let missed = |amplitude: f64| {
        let branched = branch("branched", 1, (90.0, 95.0), amplitude);
        texts(&[level(1.0, vec![main(5e-3), isola(2e-3), branched])])[2].clone()
    };
    assert!(
        missed(6e-3).contains(" 60 % less. Farther than these two goes branched 1 there, up to 6 mm at "),
        "{}",
        missed(6e-3)
    );
    assert!(missed(4e-3).contains(" 60 % less.") && !missed(4e-3).contains("Farther"), "{}", missed(4e-3));
}
