//! What was not found, and what the energy balance predicts.

use super::*;
use solver::response::windows::{Event, EventKind};

#[test]
fn none_was_found_where_it_was_looked_for() {
    let mut levels = [level(1.0, vec![main(1e-3)]), level(2.0, vec![main(3e-3)])];
    levels[1].seeds.failed = 1;
    let [danger, onset, missed] = texts(&levels);
    let searched = "the windows of mode 1 at 2 levels (4 seeds tried, 1 without a branch near them)";
    assert!(danger.starts_with("No isola was found where it was looked for. The largest"), "{danger}");
    assert!(danger.ends_with(&format!("Looked for: {searched}; {NOT_SEARCHED}")), "{danger}");
    // What it was looked for with is said once.
    assert_eq!(missed, "No isola was found where it was looked for (see the first answer).");
    let balance = "the energy balance of mode 1 predicts no separate response at the levels and frequencies of the run";
    let same = "From one level to the next the frequency of the largest computed response changes by less than 0.1 %.";
    assert_eq!(onset, format!("None was found where it was looked for (see the first answer); {balance}. {same}"));
    // One mode has no others; a forcing on the third harmonic is a search for one subharmonic.
    let [danger, ..] = told(&levels, |evidence| {
        (evidence.structure.modes, evidence.structure.harmonic) = (1, 3);
    });
    assert!(danger.contains("the forcing acting on harmonic 3)"), "{danger}");
    assert!(danger.contains("; isolas of other sub- and super-harmonics and those"), "{danger}");
}

#[test]
fn a_prediction_that_was_not_found_is_one() {
    let mut levels = [level(1.0, vec![main(1e-3)])];
    levels[0].windows.push(WindowRow::of(WindowOutcome::NotFound("no seed converged".into())));
    let [danger, onset, _] = texts(&levels);
    let estimate = "1 response that the energy balance predicts, which is an estimate, not found at A = 1: none of its seeds \
                    led to a branch near.";
    assert!(danger.contains(estimate), "{danger}");
    assert!(onset.starts_with("None was found where"), "{onset}");
    assert!(!onset.contains("predicts no separate response"), "{onset}");
    // Where no seed landed, but a known branch passes by, it may be that or another one.
    let passed =
        WindowOutcome::Passed { branches: "main".into(), told: "no seed landed near it, but main passes by".into() };
    levels[0].windows[0].outcome = passed;
    let [danger, onset, _] = texts(&levels);
    let doubt = "No seed landed near 1 response that the energy balance predicts, which is an estimate, at A = 1, but known branches pass \
                 by: what is predicted may be on these, and isolas near it are not excluded.";
    assert!(danger.contains(doubt) && !danger.contains(estimate), "{danger}");
    assert!(!onset.contains("predicts no separate response"), "{onset}");
    assert!(!levels[0].is_settled());
    levels[0].windows[0].outcome = WindowOutcome::NotFound("no seed converged".into());
    // Fold curves may have an isola born there, but later.
    let birth = |forcing, omega| CurveRow {
        points: vec![CurvePoint {
            forcing,
            omega,
            amplitude: 1e-3,
            event: Some("birth".into()),
            doubled: Some((forcing, omega)),
        }],
        ..CurveRow::default()
    };
    for (curve, is_later) in [(birth(1.25, 105.0), true), (birth(1.25, 115.0), false), (birth(0.75, 105.0), false)] {
        let curves = [curve];
        let [danger, ..] = told(&levels, |evidence| evidence.curves = &curves);
        let later = "At A = 1 the energy balance predicts a response in a range of frequencies in which, along fold curves, \
                     an isola is born at A = 1.25 only: none was found there.";
        assert_eq!([danger.contains(later), danger.contains(estimate)], [is_later, !is_later], "{danger}");
    }
    for (forcing, place) in [(1.25, "above the highest"), (1.9, "above the highest"), (0.75, "below the lowest")] {
        let curves = [birth(forcing, 105.0)];
        let [danger, ..] = told(&levels, |evidence| evidence.curves = &curves);
        let born = format!(
            "looked for, but along fold curves one is born {place} level, at A = {forcing} (105 rad/s, 16.71 Hz)."
        );
        assert!(danger.contains(&born), "{danger}");
        let mut curves = curves;
        curves[0].points[0].doubled = None;
        let [danger, ..] = told(&levels, |evidence| evidence.curves = &curves);
        let doubtful = "(105 rad/s, 16.71 Hz, not confirmed with twice the harmonics).";
        assert!(danger.contains(doubtful), "{danger}");
    }
    // Whether it is still there at the next level is another question.
    let higher = [levels[0].clone(), Level { amplitude: "2".into(), value: 2.0, ..levels[0].clone() }];
    for (forcing, is_between) in [(1.25, true), (0.75, false), (2.75, false)] {
        let curves = [birth(forcing, 105.0)];
        let [danger, ..] = told(&higher, |evidence| evidence.curves = &curves);
        let between = "looked for, but along fold curves one is born between two of the levels, at A = 1.25 (105 rad/s, 16.71 Hz).";
        assert_eq!(danger.contains(between), is_between, "{danger}");
    }
    // Nor if one was born earlier there, or is there at this level.
    let both = [birth(1.25, 105.0), birth(0.75, 100.0)];
    let [danger, ..] = told(&levels, |evidence| evidence.curves = &both);
    assert!(danger.contains(estimate), "{danger}");
    let later = [birth(1.25, 105.0)];
    levels[0].branches.push(branch("isola", 1, (108.0, 112.0), 2e-3));
    let [danger, ..] = told(&levels, |evidence| evidence.curves = &later);
    let met = "led to a branch near, though branches found otherwise lie in its range of frequencies.";
    assert!(danger.contains(met) && !danger.contains("is born at"), "{danger}");
}

#[test]
fn births_that_round_off_made() {
    let study = crate::fixture::Study::damper();
    let of = |threshold: f64| {
        let mut curve = BackboneCurve::new(&study.backbone, &study.model);
        let event = *curve.events.iter().find(|event| event.kind == EventKind::Birth).unwrap();
        curve.events = vec![Event { threshold, ..event }];
        curve
    };
    let is_kept = |threshold: f64| {
        let mut curve = of(threshold);
        curve.keep_events_near([0.003, 0.006].into_iter());
        !curve.events.is_empty()
    };
    assert!(is_kept(0.0048) && is_kept(1e-5) && is_kept(5.0));
    assert!(!is_kept(1e-18) && !is_kept(1e-6) && !is_kept(1e14) && !is_kept(f64::NAN));
    // Where the nonlinear forces feed in what the damping takes, A* does go to zero.
    let mut curve = of(1e-7);
    let index = curve.events[0].index;
    curve.r_nl.values[index] = -1.1 * curve.r_lin.values[index];
    curve.r_nl.values[index + 1] = -0.5 * curve.r_lin.values[index + 1];
    curve.r_nl.values[index - 1] = -1.2 * curve.r_lin.values[index];
    curve.keep_events_near([0.003, 0.006].into_iter());
    assert_eq!(curve.events.len(), 1);
}

#[test]
fn modes_without_windows_are_named_with_the_reason() {
    let levels = [level(1.0, vec![main(1e-3)])];
    let lost = LeftOut::NotStarted("singular".into());
    let left_out = vec![(1, LeftOut::NotListed), (2, LeftOut::OutOfRange), (3, lost), (4, LeftOut::RigidBody)];
    let modes = ModesFollowed { followed: vec![0], left_out };
    let [danger, _, missed] = told(&levels, |evidence| evidence.modes = Some(&modes));
    let named = "; isolas of mode 2 (not in the list of modes), of mode 5 (a rigid body but for laws, without a backbone), of mode 3 (far above the primary mode or beyond the reach of given bounds, and \
                 followed only if backbone.modes lists it), of mode 4 (its backbone does not start), of sub- and super-harmonics and those to which no energy balance of mode 1";
    assert!(danger.contains(named), "{danger}");
    assert!(missed.starts_with("Not all is known (no backbone of mode 4). "), "{missed}");
    let loss = "There is no backbone of mode 4, nor are there windows of it: singular.";
    assert!(danger.starts_with(&format!("Not all is known. {loss}")), "{danger}");
}

#[test]
fn the_first_prediction_of_all_modes_is_told() {
    let study = crate::fixture::Study::damper();
    let with_events = BackboneCurve::new(&study.backbone, &study.model);
    let further = [BackboneCurve { mode: 1, ..with_events }];
    let levels = [level(0.006, vec![main(1e-3)])];
    let [_, onset, _] = told(&levels, |evidence| evidence.further = &further);
    let predicted = "(see the first answer); the energy balance of mode 2 predicts separate";
    assert!(onset.contains(predicted), "{onset}");
}

/// From which forcing on there may be isolas: also where a window is one with the main response's at all levels.
#[test]
fn windows_that_no_level_sees_apart_are_told() {
    let study = crate::fixture::Study::damper();
    let mut curve = BackboneCurve::new(&study.backbone, &study.model);
    let birth = |threshold, index| Event { kind: EventKind::Birth, threshold, index, ..curve.events[0] };
    let births = vec![birth(0.003, 20), birth(0.004, 40)];
    curve.threshold.values.fill(0.0);
    (curve.threshold.values[10], curve.threshold.values[30]) = (0.0055, 0.01);
    let onset_beside = |births: &[Event], others: &[BranchRow]| {
        let further = [BackboneCurve { mode: 1, events: births.to_vec(), ..curve.clone() }];
        let levels = [level(0.006, [&[main(1e-3)], others].concat())];
        let [_, onset, _] = told(&levels, |evidence| evidence.further = &further);
        onset
    };
    let onset = |births| onset_beside(births, &[]);
    // What seeds found to be the main branch is told to be so, and gives way to what may be separate.
    let led_to = |main: &[Event], isolas: &[Event]| {
        let window = |birth: &Event, found: &str| WindowRow {
            mode: 2,
            points: [birth.index, birth.index, birth.index],
            ..WindowRow::of(WindowOutcome::Found(found.into()))
        };
        let windows = main.iter().map(|birth| window(birth, "main"));
        let windows = windows.chain(isolas.iter().map(|birth| window(birth, "main; isola 1"))).collect();
        let births = [main, isolas].concat();
        let further = [BackboneCurve { mode: 1, events: births, ..curve.clone() }];
        let levels = [Level { windows, ..level(0.004, vec![super::main(1e-3)]) }];
        let [_, onset, _] = told(&levels, |evidence| evidence.further = &further);
        onset
    };
    let on_main = ", though seeds there led to main branches";
    let said = led_to(&births[..1], &[]);
    assert!(said.contains("predicts separate responses from A = 0.003 ") && said.contains(on_main), "{said}");
    let said = led_to(&[], &births[..1]);
    assert!(said.contains("predicts separate responses from A = 0.003 ") && !said.contains(on_main), "{said}");
    // Isolas that go on beyond their window are no reason to say that it was not there.
    let said = onset_beside(&births[..1], &[isola(2e-3)]);
    let alone = " predicts separate responses from A = 0.003 to 0.0055 alone, where the run has no level";
    assert!(said.contains(alone), "{said}");
    assert!(onset_beside(&[], &[isola(2e-3)]).contains("has no birth of it"));
    let said = onset(&births);
    assert!(said.contains("predicts separate responses from A = 0.004 on, near "), "{said}");
    assert!(said.contains(" and already from A = 0.003 to 0.0055, where the run has no level"), "{said}");
    let said = onset(&births[1..]);
    assert!(said.contains("from A = 0.004 on") && !said.contains("already"), "{said}");
    // Where all of them lie above the levels it is told which forcing to try.
    let further = [BackboneCurve { mode: 1, events: births.clone(), ..curve.clone() }];
    let of = |order: &[Level], is_further: bool| {
        let [_, onset, _] = told(order, |evidence| (evidence.further, evidence.is_further) = (&further, is_further));
        onset
    };
    let nothing = |forcing| [Level { is_without_mains: true, ..level(forcing, Vec::new()) }];
    let said = of(&[level(0.001, vec![main(1e-3)])], false);
    let none = " predicts no separate response at the levels and frequencies of the run, but 2 at larger forcing, the first from A = 0.003 to 0.0055, near ";
    assert!(said.contains(none), "{said}");
    let said = of(&nothing(0.001), true);
    assert!(
        said.starts_with(&format!(
            "{NOTHING} (see the first answer); the energy balance predicts 2 at larger forcing, the first from A = 0.003 to 0.0055, near "
        )),
        "{said}"
    );
    // Where the backbone begins with the highest threshold nothing ends it.
    let mut from_rest = curve.clone();
    from_rest.threshold.values[0] = 1.0;
    let further = [BackboneCurve { mode: 1, events: births.clone(), ..from_rest }];
    let [_, onset, _] = told(&nothing(0.001), |evidence| (evidence.further, evidence.is_further) = (&further, true));
    assert!(onset.contains("predicts 2 at larger forcing, the first from A = 0.003 on, near "), "{onset}");
    let said = of(&nothing(0.02), true);
    assert_eq!(said, format!("{NOTHING} (see the first answer)."));
}

/// Births and merges that the balance has between the levels stand beside what fold curves compute, as estimates.
#[test]
fn what_the_balance_predicts_between_levels_is_told() {
    let study = crate::fixture::Study::damper();
    let mut curve = BackboneCurve::new(&study.backbone, &study.model);
    let first = curve.events[0];
    let event = |kind, threshold, omega| Event { kind, threshold, omega, ..first };
    curve.events = vec![
        event(EventKind::Birth, 1.75, 105.0),
        event(EventKind::Birth, 1.25, 110.0),
        event(EventKind::Merge, 1.5, 100.0),
        event(EventKind::Merge, 2.5, 100.0),
    ];
    let further = [BackboneCurve { mode: 1, ..curve }];
    let levels = [level(1.0, vec![main(1e-3)]), level(2.0, vec![main(1e-3)])];
    let said = |change: &dyn Fn(&mut Evidence<'_>)| {
        let [_, onset, _] = told(&levels, |evidence| {
            evidence.further = &further;
            change(evidence);
        });
        onset
    };
    let both = "Among the levels the energy balance predicts, as an estimate, births at A = 1.25 (near 110 rad/s, 17.51 Hz), 1.75 (near 105 rad/s, 16.71 Hz) and a \
                merge at A = 1.5 (near 100 rad/s, 15.92 Hz).";
    assert!(said(&|_| {}).ends_with(both), "{}", said(&|_| {}));
    // Beyond the frequencies of the study nothing is told.
    let within = said(&|evidence| evidence.bounds.min = Some(108.0));
    assert!(within.ends_with("as an estimate, a birth at A = 1.25 (near 110 rad/s, 17.51 Hz)."), "{within}");
    let [_, onset, _] = told(&levels, |_| {});
    assert!(!onset.contains("as an estimate"), "{onset}");
}

#[test]
fn a_backbone_that_ends_among_the_levels() {
    let levels = [level(1.0, vec![main(1e-3)])];
    let mut short = BACKBONE.clone();
    for (end, is_short) in [(0.5, true), (2.0, false)] {
        short.end = Some(BackboneEnd { threshold: end, branch_point: None });
        let [danger, onset, _] = told(&levels, |evidence| evidence.backbone = Some(&short));
        let sentence = "; the backbone of mode 1 ends at A* = 0.5, and no window beyond was looked for";
        assert_eq!(danger.contains(sentence), is_short, "{danger}");
        assert_eq!(onset.contains("balance of mode 1, as far as it is known, predicts no"), is_short, "{onset}");
    }
}
