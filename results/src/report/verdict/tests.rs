//! Sentence by sentence: nothing that is said is more than what is known.

mod orders;
mod predictions;
mod stability;

use super::*;
use crate::curves::BackboneCurve;
use crate::overview::Seeds;
use crate::report::evidence::Structure;
use crate::store::{CurvePoint, CurveRow, Origin, PeakOrbit, SearchCounts, Stability, WindowOutcome, WindowRow};
use crate::summary_table::Units;
use protocol::to_everyone::Stage;
use solver::response::backbone::BackboneEnd;
use solver::response::branch::{Outcome, Standing, Stop};
use solver::response::certificate::Certificate;
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::settings::FrequencySettings;
use std::sync::LazyLock;

fn branch(kind: &str, number: usize, omega: (f64, f64), amplitude: f64) -> BranchRow {
    BranchRow {
        kind: kind.into(),
        number,
        closed: kind == "isola",
        points: 3,
        omega,
        amplitude_max: amplitude,
        omega_at_max: omega.1,
        certificate: Certificate { contact_omega: Some(omega), ..Certificate::default() },
        ..BranchRow::default()
    }
}

fn level(value: f64, branches: Vec<BranchRow>) -> Level {
    let seeds = Seeds { tried: 2, failed: 0 };
    Level { amplitude: value.to_string(), value, branches, seeds, ..Level::default() }
}

fn main(amplitude: f64) -> BranchRow {
    branch("main", 1, (90.0, 100.0), amplitude)
}

fn isola(amplitude: f64) -> BranchRow {
    branch("isola", 1, (120.0, 130.0), amplitude)
}

fn at_least(branch: BranchRow) -> BranchRow {
    BranchRow { peak_standing: Some(Standing::AtLeast), ..branch }
}

static BACKBONE: LazyLock<BackboneCurve> = LazyLock::new(|| {
    let study = crate::fixture::Study::damper();
    BackboneCurve { events: Vec::new(), ..BackboneCurve::new(&study.backbone, &study.model) }
});

fn structure() -> Structure {
    Structure {
        monitor: "tip".into(),
        touch: Some(Touch { at: 4e-4, is_gap: true }),
        modes: 3,
        harmonic: 1,
        stops: 1,
        ..Structure::default()
    }
}

/// What is said of these levels, changed on the way.
fn told<'r>(levels: &'r [Level], change: impl FnOnce(&mut Evidence<'r>)) -> [String; 3] {
    let mut evidence = Evidence {
        max_amplitude: None,
        damaged: 0,
        levels,
        backbone: Some(&BACKBONE),
        further: &[],
        modes: None,
        mains: &[],
        folded: Vec::new(),
        curves: &[],
        search: SearchCounts::default(),
        motions: &[],
        pushes: &[],
        why_no_folds: None,
        stage: Some(Stage::Finished),
        structure: structure(),
        harmonics: 10,
        least_added: 2,
        bounds: FrequencySettings::default(),
        given: FrequencySettings::default(),
        reached: None,
        asked: vec![1],
        orders: Vec::new(),
        is_further: false,
        ordinary: Box::new(|_, _| None),
        units: Units::default(),
        length_unit: None,
    };
    change(&mut evidence);
    verdict(&evidence).map(|sentence| sentence.whole())
}

fn texts(levels: &[Level]) -> [String; 3] {
    told(levels, |_| {})
}

/// What several levels lack for one reason is told once.
#[test]
fn sides_without_a_start() {
    let failed = |value| Level { main_failure: Some("it turned back".into()), ..level(value, vec![main(1e-3)]) };
    let [danger, ..] = texts(&[failed(1.0), failed(2.0)]);
    assert!(
        danger.contains(" At A = 1 and 2 no main branch starts at one of the two sides: it turned back."),
        "{danger}"
    );
}

/// What is lost is told in sentences.
#[test]
fn losses_begin_as_sentences_do() {
    let levels = [level(1.0, vec![main(1e-3)])];
    let [danger, ..] = told(&levels, |evidence| evidence.search.uncrossed = 2);
    assert!(danger.contains("Not all is known. Nothing found at 2 possible branch points: other"), "{danger}");
}

const NOT_SEARCHED: &str = "isolas of other modes, of sub- and super-harmonics and those to which no energy balance of mode 1 \
                            leads were not looked for.";

#[test]
fn isolas_apart() {
    let levels = [
        level(1.0, vec![main(1e-3)]),
        level(2.0, vec![main(1e-3), isola(2e-3), branch("isola", 2, (150.0, 160.0), 1.5e-3)]),
        level(3.0, vec![main(1e-3), branch("isola", 1, (125.0, 140.0), 1e-3)]),
        level(4.0, vec![main(2.5e-3)]),
        level(5.0, vec![main(1e-3), branch("isola", 1, (155.0, 165.0), 1.2e-3)]),
    ];
    let [danger, onset, missed] = texts(&levels);
    assert_eq!(
        danger,
        "Between 120 and 140 rad/s (19.1 and 22.28 Hz), or between 150 and 165 rad/s (23.87 and 26.26 Hz), taken over \
         all 3 levels with isolas (A = 2 to 5): there an isola, a closed branch apart from the main one, is another periodic response at the same forcing, with up to \
         2 mm at tip, at 130 rad/s (20.69 Hz). The largest computed response, 2.5 mm at tip (gap 0.4 mm), is on the main branch, at 100 rad/s \
         (15.92 Hz) and A = 4. Whether isolas are stable and what leads there was not verified. Whether the largest \
         response is stable was not verified. Looked for: the windows of mode 1 at 5 levels (10 seeds tried); isolas of other modes, of sub- \
         and super-harmonics and those to which no energy balance of mode 1 leads were not looked for."
    );
    let [danger, ..] = texts(&levels[..3]);
    assert!(danger.contains(", taken over both levels with isolas (A = 2 and 3): there an isola"), "{danger}");
    // Of one level they are its own.
    let [danger, ..] = texts(&levels[..2]);
    assert!(danger.contains("(23.87 and 25.46 Hz), at A = 2: there an isola"), "{danger}");
    // Found and not predicted is said as one thing.
    assert_eq!(
        onset,
        "Isolas were found at A = 2 to 3, 5; the energy balance of mode 1 has no birth of theirs. The frequency of the largest computed response \
         changes most from A = 4 to 5: from the main branch to isola 1, by 65 rad/s (10.35 Hz), to 165 rad/s (26.26 Hz)."
    );
    assert!(missed.starts_with("Yes. At A = 2 it goes up to 1 mm at 100 rad/s"), "{missed}");
    assert!(missed.contains("up to 2 mm at 130 rad/s (20.69 Hz), 2 times as much."), "{missed}");
}

/// How far an isola reaches where nothing stays is not told without how far what is stable of it does.
#[test]
fn an_isola_that_is_unstable_at_its_largest() {
    let told = |verdict: &str, stable, largest| {
        let peak = Some(PeakOrbit { verdict: verdict.into(), at: None });
        let stability = Some(Stability { stable, unstable: 0.5, peak, largest, ..Stability::default() });
        let [danger, _, missed] = texts(&[level(2.0, vec![main(1e-3), BranchRow { stability, ..isola(2e-3) }])]);
        (danger, missed)
    };
    for (stable, largest, expected) in [
        (0.5, Some((125.0, 9e-4)), " (unstable there; found stable up to 0.9 mm at 125 rad/s (19.89 Hz))"),
        (0.5, None, " (unstable there)"),
        (0.0, None, " (unstable there, and that isola was found stable nowhere)"),
    ] {
        let (danger, missed) = told("unstable", stable, largest);
        assert!(danger.contains(&format!("with up to 2 mm at tip{expected}.")), "{danger}");
        assert!(missed.contains(&format!("(20.69 Hz){expected}, 2 times as much")), "{missed}");
    }
    assert!(!told("stable", 0.5, Some((130.0, 2e-3))).0.contains("unstable there"));
}

#[test]
fn what_led_to_isolas_is_told() {
    let found = |found_by| BranchRow { found_by: Some(found_by), ..isola(2e-3) };
    let levels =
        [level(1.0, vec![main(1e-3), found(Origin::Start)]), level(2.0, vec![main(1e-3), found(Origin::Curve)])];
    let [_, onset, _] = texts(&levels);
    let expected = "has no birth of theirs: they were found along curves over the forcing and from random starts. From one level to the next the";
    assert!(onset.contains(expected), "{onset}");
}

#[test]
fn where_the_last_one_ends() {
    let mut levels = [level(1.0, vec![main(1e-3), isola(0.9e-3)]), level(2.0, vec![main(3e-3)])];
    let [_, onset, missed] = texts(&levels);
    let end = "At A = 2 none was found any more where it was looked for: the main branch goes up to 3 mm at 100 rad/s (15.92 Hz).";
    assert!(onset.contains(end), "{onset}");
    // The peak of another resonance says nothing of where the isola has gone.
    let far = BranchRow { omega_at_max: 40.0, ..main(3e-3) };
    let [_, elsewhere, _] = texts(&[levels[0].clone(), level(2.0, vec![far])]);
    assert!(
        elsewhere.contains(" At A = 2 none was found any more where it was looked for. The frequency"),
        "{elsewhere}"
    );
    assert!(
        missed.starts_with("Yes, the isola, but not the largest response: at A = 1 the main branch goes up to 1 mm"),
        "{missed}"
    );
    assert!(missed.contains(" 10 % less."), "{missed}");
    // Where tasks are left, where the main branch stalled, where a branch is not known for what it is: nobody knows.
    let stalled = [("2".to_string(), Outcome::Open(Stop::FrequencyBound, Stop::Reversed))];
    let [danger, onset, _] = told(&levels, |evidence| evidence.mains = &stalled);
    assert!(!onset.contains("any more"), "{onset}");
    assert!(
        danger.contains(" Between 120 and")
            && danger.starts_with(
                "Not all is known. The main branch at A = 2 is known only in part (turned back along itself): \
                 larger responses may lie beyond. The largest computed response, 3 mm"
            ),
        "{danger}"
    );
    levels[1].branches.push(branch("cut", 1, (150.0, 160.0), 1e-3));
    assert!(!texts(&levels)[1].contains("any more"));
    levels[1].branches.pop();
    levels[1].pending = 3;
    assert!(!texts(&levels)[1].contains("any more"));
    // What else goes up farther is missed as well; what may be no response leaves it open.
    let missed = |other: BranchRow| texts(&[level(1.0, vec![main(1e-3), isola(5e-4), other])])[2].clone();
    let open = branch("open", 1, (120.0, 130.0), 2e-3);
    assert!(
        missed(open).starts_with("Yes, the isola: at A = 1"),
        "{}",
        missed(branch("open", 1, (120.0, 130.0), 2e-3))
    );
    let doubtful = BranchRow { number: 2, peak_standing: Some(Standing::At), ..isola(2e-3) };
    let said = missed(doubtful);
    assert!(said.contains("; whether the largest response as well is not known: at A = 1"), "{said}");
}

#[test]
fn a_cancelled_run_says_so_first() {
    let mut levels = [
        level(1.0, vec![main(1e-3), isola(2e-3)]),
        level(2.0, vec![main(1e-3), isola(2e-3)]),
        level(3.0, vec![main(1e-3), isola(3e-3)]),
        level(4.0, Vec::new()),
    ];
    (levels[2].pending, levels[3].pending) = (2, 3);
    let all = told(&levels, |evidence| evidence.stage = Some(Stage::Cancelled));
    let [danger, onset, missed] = &all;
    let lost = "Not all is known. The run was cancelled. 5 tasks still to come, at A = 3 and 4. Between 120 and";
    assert!(danger.starts_with(lost), "{danger}");
    let caveat = "Not all is known (cancelled; 2 levels unfinished). ";
    let found = onset.strip_prefix(caveat).unwrap();
    assert!(found.starts_with("Isolas were found at A = 1 to 2, and at A = 3, of which not all is known"), "{onset}");
    assert!(danger.contains("the windows of mode 1 at 4 levels, 2 of them completely (8 seeds tried"), "{danger}");
    assert!(missed.starts_with(&format!("{caveat}Yes. At A = ")), "{missed}");
    assert!(!missed.contains("A = 3"), "{missed}");
    // One that goes on is not finished, whatever it has.
    let [danger, ..] = told(&levels[..2], |evidence| evidence.stage = Some(Stage::Sweep));
    assert!(danger.starts_with("Not all is known. The run is not finished: verifications are still to come, or what follows from its results. Between"), "{danger}");
    let [danger, _, missed] = told(&[level(1.0, vec![main(1e-3)])], |evidence| evidence.stage = Some(Stage::Sweep));
    assert!(
        danger.contains(" or what follows from its results. No isola has been found so far where it was looked for."),
        "{danger}"
    );
    assert!(
        missed.ends_with(" No isola has been found so far where it was looked for (see the first answer)."),
        "{missed}"
    );
}

#[test]
fn grave_losses_come_before_the_answer() {
    let mut levels = [level(1.0, vec![main(1e-3)]), level(2.0, Vec::new())];
    (levels[0].dead, levels[1].main_failure) = (1, Some("it did not converge".into()));
    let mut short = BACKBONE.clone();
    (short.pieces[0].is_unfinished, short.pieces[0].status) = (true, "open: linear range to stalled".into());
    let [danger, onset, _] = told(&levels, |evidence| evidence.backbone = Some(&short));
    assert!(
        danger.starts_with(
            "Not all is known. 1 task given up, at A = 1. There is no main branch at A = 2: it did not converge. The backbone of mode 1 \
             stopped early (open: linear range to stalled): the energy balance beyond is not known. No isola was found where it was \
             looked for."
        ),
        "{danger}"
    );
    assert!(danger.contains("Looked for: the windows of mode 1 at 2 levels, none of them completely"), "{danger}");
    let caveat = "Not all is known (1 task given up; no main branch at A = 2; backbone stopped early). None was found";
    assert!(onset.starts_with(caveat), "{onset}");
}

#[test]
fn what_others_contradict_is_a_loss() {
    let mut levels = [level(1.0, vec![main(1e-3)]), level(2.0, vec![main(1e-3)])];
    (levels[0].refuted, levels[1].disputed) = (2, 1);
    let [danger, onset, _] = texts(&levels);
    assert!(
        danger.contains(" Not all is known. 3 results contradicted by other workers, at A = 1 and 2. "),
        "{danger}"
    );
    assert!(
        onset.starts_with("None was found") && onset.contains(" Not all is known (3 results contradicted)."),
        "{onset}"
    );
}

#[test]
fn kinds_are_named_for_what_they_are() {
    let cut = at_least(branch("cut", 1, (120.0, 130.0), 2e-3));
    let open = branch("open", 1, (120.0, 130.0), 1.5e-3);
    let levels = [level(1.0, vec![at_least(main(1e-3)), cut.clone(), open]), level(2.0, vec![main(1e-3), cut])];
    let [danger, onset, missed] = texts(&levels);
    // That it is not known of some what they are is said before every answer.
    let lost = "Not all is known. 2 branches, at A = 1 and 2 (at least 2 mm), leave through bounds that were given: whether they are detached is not known.";
    assert!(danger.starts_with(&format!("{lost} No isola was found where")), "{danger}");
    let kind =
        "1 branch, at A = 1 (up to 1.5 mm), leaves through the widest bounds at both ends: detached, but not closed.";
    assert!(danger.contains(kind), "{danger}");
    assert!(danger.contains(" The largest computed response, at least 2 mm at tip (gap 0.4 mm)"), "{danger}");
    let brief = "Not all is known (2 branches cut by bounds).";
    assert!(onset.starts_with(&format!("{brief} None was found where")), "{onset}");
    assert!(
        missed.starts_with(&format!(
            "{brief} No isola was found where it was looked for; what is cut or unfinished may be one"
        )) && missed.ends_with(kind),
        "{missed}"
    );
    let branched = branch("branched", 1, (92.0, 95.0), 2e-3);
    let [danger, ..] = texts(&[level(1.0, vec![main(1e-3), branched.clone()])]);
    let kind = " 1 branch, at A = 1 (up to 2 mm), branches off other responses, less symmetric than those or of a longer period.";
    assert!(danger.contains(kind) && danger.contains("2 mm at tip (gap 0.4 mm), is on branched 1, at"), "{danger}");
    let [danger, ..] = texts(&[level(1.0, vec![main(1e-3), branched.clone(), branched])]);
    assert!(danger.contains(" 2 branches, at A = 1 (up to 2 mm), branch off other responses, "), "{danger}");
    let unfinished = branch("unfinished", 1, (120.0, 130.0), 2e-3);
    let [danger, ..] = texts(&[level(1.0, vec![main(1e-3), unfinished])]);
    assert!(
        danger.starts_with(
            "Not all is known. 1 branch, at A = 1 (up to 2 mm), is unfinished: whether it is detached is not known. "
        ),
        "{danger}"
    );
    let cut = branch("cut", 1, (120.0, 130.0), 2e-3);
    let [danger, ..] = texts(&[level(1.0, vec![main(1e-3), cut])]);
    let one = "Not all is known. 1 branch, at A = 1 (up to 2 mm), leaves through bounds that were given: whether it is detached is not known. ";
    assert!(danger.starts_with(one), "{danger}");
}

#[test]
fn a_main_branch_known_in_part_is_no_measure() {
    let [_, _, missed] = texts(&[level(1.0, vec![at_least(main(1e-3)), isola(2e-3)])]);
    assert_eq!(
        missed,
        "The isola, yes; by how much is not known: at A = 1 the main branch goes up to at least 1 mm, an isola up to 2 mm \
         at 130 rad/s (20.69 Hz)."
    );
}

#[test]
fn what_the_structure_does_of_itself() {
    let levels = [level(1.0, vec![BranchRow { certificate: Certificate::default(), ..main(1e-3) }])];
    let [danger, ..] = texts(&levels);
    assert!(danger.contains(" No branch of any level touches a stop. Looked"), "{danger}");
    let [danger, ..] = told(&levels, |evidence| evidence.structure.stops = 0);
    assert!(!danger.contains("touches a stop"), "{danger}");
    let [danger, ..] = told(&levels, |evidence| evidence.structure.excitation.excited = vec![1]);
    assert!(
        danger.starts_with(
            "Mode 2 has negative linear damping: unless the laws take more, the structure can vibrate by itself"
        ),
        "{danger}"
    );
    let [danger, ..] = told(&levels, |evidence| evidence.structure.excitation.undamped = vec![0, 2]);
    assert!(
        danger.starts_with("Modes 1 and 3 have no linear damping: nothing but the laws limits the resonance. No isola"),
        "{danger}"
    );
    // What the laws take at small amplitudes is known of modes with a backbone.
    for (balance, so) in [
        (-1.0, ": the structure can vibrate by itself, from rest and without forcing."),
        (1.0, ", of which the laws take more at small amplitudes."),
    ] {
        let unforced = Unforced { mode: 0, linear: -3.0, nonlinear: 3.0 + balance, ..Unforced::default() };
        let backbone = BackboneCurve { unforced: Some(unforced), ..BACKBONE.clone() };
        let [danger, ..] = told(&levels, |evidence| {
            evidence.structure.excitation.excited = vec![0];
            evidence.backbone = Some(&backbone);
        });
        assert!(danger.starts_with(&format!("Mode 1 has negative linear damping{so}")), "{danger}");
    }
    let of = |unforced| BackboneCurve { unforced: Some(unforced), ..BACKBONE.clone() };
    let fed = of(Unforced { mode: 0, linear: 1.0, nonlinear: -2.0, is_fed_at_rest: true, ..Unforced::default() });
    let [danger, ..] = told(&levels, |evidence| evidence.backbone = Some(&fed));
    assert!(danger.starts_with("At small amplitudes the nonlinear forces feed more energy into mode 1"), "{danger}");
    let pushed =
        of(Unforced { mode: 0, linear: 1.0, nonlinear: 0.0, fed_from: Some((8e-4, 100.0)), ..Unforced::default() });
    let [danger, ..] = told(&levels, |evidence| evidence.backbone = Some(&pushed));
    let by_itself = "Pushed just beyond motions of mode 1 of about 0.8 mm at 100 rad/s (15.92 Hz), the structure can vibrate by itself";
    assert!(danger.starts_with(by_itself), "{danger}");
}

#[test]
fn numbers_that_cannot_be_read() {
    let levels = [level(1.0, vec![main(1e-3), isola(f64::NAN)])];
    assert!(texts(&levels).iter().all(|text| !text.contains("NaN")), "{:?}", texts(&levels));
    assert!(texts(&[level(1.0, vec![isola(1e-3)])])[2].starts_with("Ordinary continuation has no main branch"));
    let bare = level(1.0, Vec::new());
    let over = texts(std::slice::from_ref(&bare));
    assert!(over[0].ends_with("No branch was found."), "{over:?}");
    assert!(over[1..].iter().all(|text| text == "Not known: no branch was found."), "{over:?}");
    let begun = texts(&[Level { pending: 3, ..bare }]);
    assert!(begun[0].ends_with(" No branch has been computed yet."), "{begun:?}");
    assert!(begun[1].ends_with(" Nothing is known yet: 1 forcing level to come."), "{begun:?}");
}
