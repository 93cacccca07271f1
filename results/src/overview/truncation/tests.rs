//! What is said of the truncation to H harmonics.

use super::*;
use solver::Matrix;
use solver::response::certificate::{Certificate, Doubled};
use solver::structure::laws::{PolynomialSpring, Term};

fn row(kind: &str, amplitude_2h: Option<f64>) -> BranchRow {
    let doubled = amplitude_2h.map(|amplitude| Doubled { amplitude, shift: 0.0, range: None });
    let certificate = Certificate { penetration: Some(0.013), doubled, ..Certificate::default() };
    BranchRow {
        kind: kind.into(),
        number: 1,
        closed: kind == "isola",
        certificate,
        amplitude_max: 1.0,
        ..BranchRow::default()
    }
}

/// What is said of the levels with so many harmonics, whatever the lowest one is that motions can have beyond that of the force.
fn truncation(levels: &[Level], harmonics: usize, least: usize) -> Option<String> {
    super::truncation(levels, harmonics, least, None, |omega| format!("{omega} rad/s"))
}

fn levels(branches: Vec<BranchRow>) -> [Level; 1] {
    [Level { amplitude: "60".into(), value: 60.0, branches, ..Level::default() }]
}

#[test]
fn a_main_peak_that_is_not_there_with_more_harmonics() {
    let main = |standing| BranchRow { peak_standing: Some(standing), ..row("main", None) };
    let said = |standing| truncation(&levels(vec![main(standing), row("isola", Some(1.0))]), 10, 3).unwrap();
    assert!(
        said(Standing::At).contains("no peak is confirmed near that of the main branch at A = 60"),
        "{}",
        said(Standing::At)
    );
    let expected = format!(
        "Largest peaks that were compared, of 1 of 2 branches, change by less than 0.01 % with twice the harmonics (H = 20). {UNKNOWN_ENDS}"
    );
    assert_eq!(said(Standing::AtLeast), expected);
}

#[test]
fn peaks_that_move_with_more_harmonics() {
    let at = |row| has_moved(&BranchRow { peak_standing: Some(Standing::At), ..row });
    assert!(at(row("main", None)) && at(row("isola", Some(1.02))) && !at(row("main", Some(1.001))));
    assert!(!has_moved(&BranchRow { peak_standing: Some(Standing::AtLeast), ..row("main", None) }));
}

/// Where a branch meets a known one it may be largest, and nothing is looked for there.
#[test]
fn where_a_branch_runs_on_to_a_known_one_no_peak_is_missed() {
    let with = |status: &str| {
        let open = BranchRow { peak_standing: Some(Standing::At), status: status.into(), ..row("open", None) };
        truncation(&levels(vec![open, row("isola", Some(1.0))]), 10, 3).unwrap()
    };
    assert!(with("open: frequency bound to frequency bound").contains("no peak is confirmed near that of open 1"));
    assert!(with("open: known branch to known branch").starts_with("Largest peaks change by less than"));
}

/// The worse the truncation the more is lost: what nothing at all was found of is told as well.
#[test]
fn no_peak_at_all_is_there_with_more_harmonics() {
    let main = BranchRow { peak_standing: Some(Standing::At), ..row("main", None) };
    let said = truncation(&levels(vec![main]), 10, 3).unwrap();
    assert!(
        said.starts_with(
            "Not converged in H: with twice the harmonics no peak is confirmed near that of the main branch at"
        ),
        "{said}"
    );
}

#[test]
fn what_more_harmonics_would_change() {
    assert_eq!(truncation(&levels(vec![row("main", None), row("isola", None)]), 10, 3), None);
    let converged = levels(vec![row("main", Some(1.004)), row("isola", Some(0.9999))]);
    assert_eq!(
        truncation(&converged, 10, 3).unwrap(),
        format!("Largest peaks change by 0.4 % at most with twice the harmonics (H = 20). {UNKNOWN_ENDS}")
    );
    let of_valve = super::truncation(&converged, 10, 3, Some("valve"), |omega| omega.to_string());
    assert!(of_valve.unwrap().starts_with("Largest peaks of valve change by 0.4 %"));
    let moved = levels(vec![row("main", Some(1.004)), row("isola", Some(0.8))]);
    assert_eq!(
        truncation(&moved, 10, 3).unwrap(),
        format!(
            "Not converged in H: with twice the harmonics the peak of isola 1 at A = 60 changes by -20 %, and its contact \
             penetrates by 1.3 % of the gap; set harmonics.count = 20. {UNKNOWN_ENDS}"
        )
    );
    let lost = levels(vec![row("main", Some(1.0)), row("isola", None)]);
    assert!(truncation(&lost, 10, 3).unwrap().contains("no peak is confirmed near that of isola 1"));
    let many = (1..=5).map(|number| BranchRow { number, ..row("isola", None) });
    let many = levels(many.chain([row("main", Some(1.0))]).collect());
    assert_eq!(
        truncation(&many, 10, 3).unwrap(),
        "Not converged in H: with twice the harmonics no peak is confirmed near those of isola 1 at A = 60, isola 2 at A = 60, \
         isola 3 at A = 60 and 2 more branches; set harmonics.count = 20."
    );
    let mut shifted = row("isola", Some(1.001));
    shifted.certificate.doubled.as_mut().unwrap().shift = 0.017;
    assert_eq!(
        truncation(&levels(vec![shifted]), 10, 3).unwrap(),
        format!(
            "Not converged in H: with twice the harmonics the peak of isola 1 at A = 60 changes by 0.1 % and its frequency by \
             1.7 %, and its contact penetrates by 1.3 % of the gap; set harmonics.count = 20. {UNKNOWN_ENDS}"
        )
    );
}

/// One harmonic and two have the same odd motions; those that the force's third harmonic drives have none between 3 and 9.
#[test]
fn harmonics_that_no_motion_has_confirm_nothing() {
    let converged = levels(vec![row("main", Some(1.0)), row("isola", Some(1.0))]);
    for (harmonics, least) in [(1, 3), (4, 9)] {
        let said = truncation(&converged, harmonics, least).unwrap();
        assert!(said.starts_with("What more harmonics would change of ordinary responses is not known"), "{said}");
        assert!(said.ends_with(&format!("set harmonics.count = {least}.")), "{said}");
    }
    // What does change is told nevertheless.
    let changed = levels(vec![row("main", Some(1.0)), row("isola", Some(0.8))]);
    let said = truncation(&changed, 4, 9).unwrap();
    assert!(said.starts_with("Not converged in H: with twice the harmonics the peak of isola 1"), "{said}");
    assert!(
        said.contains(
            "set harmonics.count = 9. Ordinary responses have none of the harmonics that twice as many (H = 8) add"
        ),
        "{said}"
    );
    for (harmonics, least) in [(1, 2), (2, 3), (5, 9)] {
        assert!(
            truncation(&converged, harmonics, least).unwrap().starts_with("Largest peaks change by less"),
            "{least}"
        );
    }
    let model = |power, harmonic| {
        let one = Matrix::diagonal(&[1.0]);
        let law = PolynomialSpring { terms: vec![Term { power, coefficient: 1.0 }] };
        let model = Model::builder("mass").mass(one.clone()).stiffness(one).force(0, 1.0).harmonic(harmonic);
        model.damping_ratio(0.01).element("spring", law, [vec![(0, 1.0)]]).build().unwrap()
    };
    let least = |power, harmonic, is_without_mains| least_added(&model(power, harmonic), is_without_mains);
    assert_eq!([least(3, 1, false), least(2, 1, false), least(3, 3, false), least(3, 3, true)], [3, 2, 9, 3]);
}

#[test]
fn where_a_flat_branch_is_largest_says_nothing() {
    let mut pressed = row("open", Some(1.0 + 2e-13));
    pressed.certificate.doubled.as_mut().unwrap().shift = 0.076;
    let said = truncation(&levels(vec![pressed]), 10, 3).unwrap();
    assert_eq!(said, "Largest peaks change by less than 0.01 % with twice the harmonics (H = 20).");
}

#[test]
fn what_more_harmonics_would_change_of_a_width() {
    let isola = |range| {
        let mut isola = BranchRow { omega: (2.0, 2.1), omega_at_max: 2.05, ..row("isola", Some(1.0)) };
        isola.certificate.doubled.as_mut().unwrap().range = Some(range);
        truncation(&levels(vec![isola]), 10, 3).unwrap()
    };
    // Where no end at all is found that is told as well.
    let lost = truncation(&levels(vec![row("isola", Some(1.0))]), 10, 3).unwrap();
    assert!(lost.ends_with(UNKNOWN_ENDS), "{lost}");
    let peaks = "Largest peaks change by less than 0.01 % with twice the harmonics (H = 20).";
    assert_eq!(
        isola((2.001, 2.101)),
        "Largest peaks and widths of isolas change by less than 0.01 % with twice the harmonics (H = 20)."
    );
    let narrower = "With twice the harmonics isola 1 at A = 60 is 40 % narrower; set harmonics.count = 20.";
    assert_eq!(isola((2.02, 2.08)), format!("{peaks} {narrower}"));
}
