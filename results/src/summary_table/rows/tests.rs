//! Rows of levels that are made up.

use super::*;
use crate::store::{Crossing, CurvePoint};
use solver::response::branch::Standing;

fn rows(mains: &[(String, Outcome)]) -> Rows<'_> {
    Rows {
        units: Units::default(),
        mains,
        peaks: &[],
        curves: &[],
        lesser: Lesser::default(),
        has_exchanges: false,
        given: FrequencySettings::default(),
        reached: None,
        smallest: None,
        lowest: None,
        notes: Footnotes::default(),
    }
}

fn main(number: usize, amplitude_max: f64, status: &str) -> BranchRow {
    let kind = BranchKind::Main.name().into();
    BranchRow { kind, number, amplitude_max, omega_at_max: 21.5, status: status.into(), ..BranchRow::default() }
}

fn level(branches: Vec<BranchRow>) -> Level {
    Level { amplitude: "3".into(), value: 3.0, branches, ..Level::default() }
}

#[test]
fn every_resonance_has_its_peak() {
    let peaks = [(7, vec![(30.0, 0.5), (55.0, 0.25)]), (8, vec![(1.0, 1.0)])];
    let mut rows = Rows { peaks: &peaks, ..rows(&[]) };
    let mut listed = |id| rows.of(&level(vec![BranchRow { id, ..main(1, 2.0, "open") }]))[1].clone();
    assert_eq!(listed(7), "2.0000 at 21.5000\nand 0.50000 at 30.0000\nand 0.25000 at 55.0000");
    assert_eq!(listed(9), "2.0000 at 21.5000");
}

#[test]
fn a_cut_branch_says_at_which_bounds() {
    let cut = |omega, min, max| {
        let status = "open: frequency bound to frequency bound".into();
        let row = BranchRow { kind: BranchKind::Cut.name().into(), omega, status, ..BranchRow::default() };
        Rows { given: FrequencySettings { min, max }, ..rows(&[]) }.cut_at(&row).unwrap()
    };
    assert_eq!(cut((1.0, 2.0), Some(1.0), Some(2.0)), "leaves through frequency.min and frequency.max");
    assert_eq!(cut((1.5, 2.0), Some(1.0), Some(2.0)), "leaves through frequency.max at both ends");
    assert_eq!(cut((1.0, 1.5), Some(1.0), Some(2.0)), "leaves through frequency.min at both ends");
    assert_eq!(cut((1.5, 2.0), None, Some(2.0)), "leaves through bounds at both ends, frequency.max among them");
    let reaching = |low| {
        let status = "open: frequency bound to frequency bound".into();
        let row = BranchRow { kind: BranchKind::Cut.name().into(), omega: (1.5, 2.0), status, ..BranchRow::default() };
        let given = FrequencySettings { min: None, max: Some(2.0) };
        Rows { given, reached: Some((low, 2.0)), ..rows(&[]) }.cut_at(&row).unwrap()
    };
    assert_eq!(reaching(1.0), "leaves through frequency.max at both ends");
    assert_eq!(reaching(1.5), "leaves through bounds at both ends, frequency.max among them");
}

#[test]
fn a_main_branch_in_pieces_has_one_peak() {
    let whole = "open: linear range to frequency bound";
    let piece = "open: frequency bound to known branch";
    let pieces = level(vec![main(1, 1.0, whole), main(2, 2.0, piece)]);
    let mut told = rows(&[]);
    assert_eq!(told.of(&pieces)[1], "2.0000 at 21.5000");
    assert_eq!(pieces.main_curves(), 1);
    // Which of two a piece runs on to is not known, also where it may close the gap between them: no peak is left out.
    let both =
        level(vec![main(1, 1.0, whole), main(2, 2.0, whole), main(3, 4.0, "open: known branch to known branch")]);
    assert_eq!(told.of(&both)[1], "1.0000 at 21.5000\n2.0000 at 21.5000\n4.0000 at 21.5000¹");
    // Of two curves the piece says that it is none of its own.
    let apart = level(vec![main(1, 1.0, whole), main(2, 2.0, whole), main(3, 4.0, piece)]);
    assert_eq!(told.of(&apart)[1], "1.0000 at 21.5000\n2.0000 at 21.5000\n4.0000 at 21.5000¹");
    assert_eq!(apart.main_curves(), 2);
    assert_eq!(crate::overview::in_words(&pieces.branches[1]), "the main branch");
}

/// Of one curve in pieces only the largest one's peak is told, and marked.
#[test]
fn a_peak_that_twice_the_harmonics_do_not_confirm_is_marked() {
    let lost = |number, amplitude_max, status| BranchRow {
        peak_standing: Some(Standing::At),
        ..main(number, amplitude_max, status)
    };
    let marked = |branches: Vec<BranchRow>| {
        let mut told = rows(&[]);
        (told.of(&level(branches))[1].clone(), told.notes.lines(200))
    };
    let whole = "open: linear range to frequency bound";
    let (text, notes) = marked(vec![lost(1, 2.0, whole)]);
    assert_eq!(
        (text.as_str(), &notes[..]),
        ("2.0000 at 21.5000¹", &["¹ with twice the harmonics no such peak is confirmed".to_string()][..])
    );
    let piece = main(2, 3.0, "open: frequency bound to known branch");
    assert_eq!(marked(vec![lost(1, 2.0, whole), piece]), ("3.0000 at 21.5000".into(), Vec::new()));
    assert_eq!(marked(vec![main(1, 2.0, whole)]).1, Vec::<String>::new());
}

#[test]
fn a_window_that_a_branch_passes_by_carries_its_doubt() {
    let window = |told: &str| {
        WindowRow::of(match told {
            "" => WindowOutcome::Found("main".into()),
            told => WindowOutcome::Passed { branches: "main".into(), told: told.into() },
        })
    };
    let doubt = "no seed landed near it, but main passes by (relative distance 0.22): an isola nearby is not excluded";
    let mut level = level(vec![main(1, 1.0, "")]);
    level.windows = vec![window(""), window(doubt)];
    let mut told = rows(&[]);
    assert_eq!(told.of(&level)[3], "2 of 2¹");
    let lines = told.notes.lines(200).concat();
    assert!(lines.contains("no seed landed near it, but main passes by: an isola nearby is not excluded"), "{lines}");
    level.windows.pop();
    assert_eq!(rows(&[]).of(&level)[3], "1 of 1");
    // What is in it need not be an isola.
    let is_on_main = |outcome| {
        let mut level = level.clone();
        level.windows[0].outcome = outcome;
        is_on_main(&level)
    };
    assert!(is_on_main(WindowOutcome::Found("main".into())));
    assert!(!is_on_main(WindowOutcome::Found("main; isola 1".into())));
    assert!(!is_on_main(WindowOutcome::NotFound("nothing".into())));
}

/// An isola of the lowest level begins below it, whether that is known or not.
#[test]
fn isolas_of_the_lowest_level_go_on_below_it() {
    let isola = |number| BranchRow { kind: "isola".into(), number, closed: true, ..BranchRow::default() };
    let point = |(forcing, event): (f64, Option<&str>)| CurvePoint {
        forcing,
        omega: forcing,
        event: event.map(str::to_string),
        ..CurvePoint::default()
    };
    let crossing = Crossing { segment: 0, forcing: 3.0, amplitude: "3".into(), branch: "isola 2".into() };
    let points = [(4.0, None), (2.0, Some("birth")), (4.0, None)].map(point).to_vec();
    let curves = [CurveRow { points, crossings: vec![crossing], ..CurveRow::default() }];
    let level = level(vec![main(1, 1.0, ""), isola(1), isola(2), isola(3)]);
    let told = |lowest| {
        let mut told = Rows { lowest, curves: &curves, ..rows(&[]) };
        (told.of(&level)[2].clone(), told.notes.lines(200))
    };
    let (text, notes) = told(Some("3"));
    let ends: Vec<&str> = text.lines().map(|line| &line[line.len() - 2..]).collect();
    assert_eq!(ends, ["¹", "²", "¹"]);
    assert_eq!(
        notes,
        [
            "¹ is there below the lowest level as well; where it begins is not known",
            "² is there below the lowest level as well; a fold curve of it comes from a birth (isola 2: A = 2, not confirmed with twice the \
             harmonics)"
        ]
    );
    assert!(told(Some("2")).1.is_empty());
    // Where it is told from its birth to its end that is enough.
    let whole = [(5.0, None), (2.0, Some("birth")), (4.0, Some("merge")), (1.0, None)].map(point).to_vec();
    let curves = [CurveRow { points: whole, ..curves[0].clone() }];
    let mut told = Rows { lowest: Some("3"), curves: &curves, ..rows(&[]) };
    assert!(!told.of(&level)[2].contains('²') && told.notes.lines(200).len() == 1);
}

#[test]
fn of_very_many_cut_branches_some_have_rows() {
    let cut = |number| BranchRow {
        kind: "cut".into(),
        number,
        status: "open: linear range to frequency bound".into(),
        ..BranchRow::default()
    };
    let text = rows(&[]).of(&level((1..=85).map(cut).collect()))[2].clone();
    assert_eq!(text.lines().count(), 5, "{text}");
    assert!(text.ends_with("\ncut: 81 more, see summary.csv"), "{text}");
}

#[test]
fn copies_have_one_kind_and_the_same_frequencies() {
    let row = |kind: &str, omega| BranchRow { kind: kind.into(), omega, ..BranchRow::default() };
    let isola = row("isola", (1.0, 2.0));
    assert!(is_copy(&isola, &row("isola", (1.0 + 1e-8, 2.0))));
    for other in [row("branched", (1.0, 2.0)), row("isola", (1.0, 2.001)), row("isola", (f64::NAN, 2.0))] {
        assert!(!is_copy(&isola, &other));
    }
}
