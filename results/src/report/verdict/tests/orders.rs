//! Motions of several periods of the force.

use super::*;
use crate::report::ordinary::Ordinary;

/// How much larger they are than what ordinary continuation has under the same force.
#[test]
fn beside_the_main_branch_under_the_same_force() {
    let levels = [level(1.0, vec![isola(2e-3)])];
    let missed = |ordinary: Option<Ordinary>| {
        let [_, _, missed] =
            told(&levels, |evidence| (evidence.is_further, evidence.ordinary) = (true, Box::new(move |_, _| ordinary)));
        missed
    };
    let all = "All of it: ordinary continuation follows motions of a shorter period.";
    assert_eq!(missed(None), all);
    for (amplitude, is_of_main, compared) in [
        (1e-4, true, "20 times the 0.1 mm or so of the main branch"),
        (1.6e-3, true, "25 % more than the 1.6 mm or so of the main branch"),
        (4e-3, false, "50 % less than the 4 mm or so of the linear response"),
    ] {
        let said = missed(Some(Ordinary { omega: 260.0, amplitude, is_of_main }));
        let where_it_is = "an isola goes up to 2 mm at 130 rad/s (20.69 Hz)";
        let force = "where the force has the same frequency, 260 rad/s (41.38 Hz).";
        assert_eq!(said, format!("{all} At A = 1 {where_it_is}, {compared} {force}"));
    }
}

/// An isola that is small beside the peak of the main branch may be large beside what that has at its frequency.
#[test]
fn what_the_main_branch_has_where_the_isola_is() {
    let missed = |main: BranchRow, ordinary: Option<f64>| {
        let levels = [level(1.0, vec![main, isola(2e-3)])];
        let at = move |_, omega| Some(Ordinary { omega, amplitude: ordinary?, is_of_main: true });
        let [_, _, missed] = told(&levels, |evidence| evidence.ordinary = Box::new(at));
        missed
    };
    let said = missed(main(4e-3), Some(1e-3));
    assert!(said.ends_with("50 % less. At 130 rad/s (20.69 Hz) the main branch reaches about 1 mm."), "{said}");
    let bound = |said: &str, how: &str| {
        let told =
            format!("50 % less. The main branch was not followed to that frequency (at {how} follows it farther).");
        assert!(said.ends_with(&told), "{said}");
    };
    bound(&missed(main(4e-3), None), "100 rad/s (15.92 Hz) it ends; a higher frequency.max");
    bound(
        &missed(branch("main", 1, (140.0, 150.0), 4e-3), None),
        "140 rad/s (22.28 Hz) it begins; a lower frequency.min",
    );
    // Known in part it may be what ends too early; and there is no telling where it has a gap.
    let said = missed(at_least(main(4e-3)), None);
    assert!(!said.contains("followed"), "{said}");
    let said = missed(branch("main", 1, (90.0, 150.0), 4e-3), None);
    assert!(said.ends_with("50 % less."), "{said}");
}

/// Motions that are no isolas are motions of the order all the same.
#[test]
fn from_which_forcing_on_there_are_such_motions() {
    let levels = [level(1.0, vec![branch("branched", 1, (120.0, 130.0), 1e-3)])];
    let onset = |is_further: bool| {
        let [_, onset, _] = told(&levels, |evidence| evidence.is_further = is_further);
        onset
    };
    let such = "No isola was found where it was looked for, but such motions that are no isolas, at A = 1 (see the first answer)";
    assert!(onset(true).starts_with(such), "{}", onset(true));
    assert!(
        onset(false).starts_with("None was found where it was looked for (see the first answer)"),
        "{}",
        onset(false)
    );
}

/// Where no level has any, what fold curves have of them is told all the same.
#[test]
fn births_beyond_levels_without_motions() {
    let point = CurvePoint {
        forcing: 1.25,
        omega: 105.0,
        event: Some("birth".into()),
        doubled: Some((1.25, 105.0)),
        ..CurvePoint::default()
    };
    let curves = [CurveRow { points: vec![point], ..CurveRow::default() }];
    let levels = [Level { is_without_mains: true, ..level(1.0, Vec::new()) }];
    let [danger, onset, _] = told(&levels, |evidence| (evidence.is_further, evidence.curves) = (true, &curves));
    let born = format!(
        "{NOTHING}, but along fold curves one is born above the highest level, at A = 1.25 (105 rad/s, 16.71 Hz)."
    );
    assert!(danger.starts_with(&born), "{danger}");
    assert!(
        onset.contains(" Computed along fold curves: an isola is born at A = 1.25 (105 rad/s, 16.71 Hz)"),
        "{onset}"
    );
}
