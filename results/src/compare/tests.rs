//! Two runs of the damper with one level in common.

use super::*;
use crate::curves::Touch;
use crate::fixture::Study;
use crate::report::Selection;
use crate::store::{CurvePoint, CurveRow};
use crate::summary_table::FrequencyUnit;
use tempfile::tempdir;

fn read(study: &Study, change: impl Fn(&mut Report)) -> Report {
    let dir = tempdir().unwrap();
    let (store, _) = study.finished(dir.path());
    let mut report = Report::read(&store, &Selection::Fitting).unwrap();
    change(&mut report);
    report
}

#[test]
fn amplitudes_of_different_dofs_are_told_apart() {
    let three = read(&Study::damper(), |_| {});
    let other = read(&Study::damper(), |report| report.monitors[0].name = "x2".into());
    let compared = Comparison::new(vec![("three".into(), three), ("other".into(), other)]);
    assert_eq!(compared.names, ["three (x1)", "other (x2)"]);
    let [response, resonance] = ["response", "resonance"].map(|name| &compared.figures.drawn[name]);
    assert_eq!(response.panels[0].y[0].title, "amplitude of x1, x2");
    assert_eq!(resonance.panels[1].y[0].title, "largest |x1|, |x2|");
    let names: Vec<&str> = response.legend.iter().take(2).map(|entry| entry.text.as_str()).collect();
    assert_eq!(names, compared.names);
    // By how much they differ means nothing; frequencies are those of motions.
    let row = compared.numbers.iter().find(|row| row.amplitude == "0.006").unwrap();
    let second = row.values[1].read_in(FrequencyUnit::default());
    assert!(!second.contains('%') && second.ends_with(" (0 rad/s)"), "{row:?}");
}

/// In the units of the first run, as figures are.
#[test]
fn numbers_are_in_the_units_of_the_first_run() {
    let study = |report: &mut Report| report.account.study = "units = 'mm,Hz'".into();
    let (one, other) = (read(&Study::damper(), study), read(&Study::damper(), |_| {}));
    let compared = Comparison::new(vec![("one".into(), one), ("other".into(), other)]);
    let table = table(&compared, 200);
    // What differs by rounding alone is the same.
    assert!(table.contains(" mm at 0.159143 Hz (the same)"), "{table}");
    assert!(table.contains(" mm at ") && !table.contains("rad/s"), "{table}");
}

fn compared() -> Comparison {
    let three = read(&Study::damper(), |_| {});
    let five = read(&Study::new("nonlinear_damper", 5, &["0.006", "0.007"]), |report| {
        report.account.study = "model = \"damper\"\nname = \"b\"\n[harmonics]\ncount = 5\n".into();
        report.run.program = "0.2.0".into();
    });
    Comparison::new(vec![("three".into(), three), ("five".into(), five)])
}

#[test]
fn what_differs() {
    let compared = compared();
    // Both studies have one name, so that folders tell them apart.
    assert_eq!(compared.names, ["three", "five"]);
    let levels: Vec<&str> = compared.levels.iter().map(|level| level.amplitude.as_str()).collect();
    assert_eq!(levels, ["3e-3", "0.006", "0.007"]);
    let keys: Vec<(&str, &str)> =
        compared.settings.iter().map(|row| (row.key.as_str(), row.values[1].as_str())).collect();
    assert_eq!(keys, [("harmonics.count", "5"), ("program", "0.2.0")]);
    assert_eq!(compared.settings[0].values[0], "not given");
}

/// A level that was added later stands behind the others in the study.
#[test]
fn amplitudes_are_compared_in_their_order() {
    let study = |list: &'static str| read(&Study::damper(), move |report| report.account.study = list.into());
    let settings = |other| {
        let runs = [("a", study("amplitudes = ['0.006', '3e-3']")), ("b", other)];
        Comparison::new(runs.map(|(name, report)| (name.to_string(), report)).to_vec()).settings
    };
    assert_eq!(settings(study("amplitudes = ['3e-3', '0.006']")), []);
    let more = read(&Study::new("nonlinear_damper", 3, &["0.006", "0.007"]), |report| {
        report.account.study = "amplitudes = ['0.007', '0.006']".into();
    });
    let row = &settings(more)[0];
    assert_eq!(
        (row.key.as_str(), &row.values[..]),
        ("amplitudes", &["[3e-3, 0.006]".into(), "[0.006, 0.007]".into()][..])
    );
}

/// Two isolas that share no frequency are not said to differ by so many per cent.
#[test]
fn isolas_at_other_frequencies() {
    let moved = read(&Study::damper(), |report| {
        let branches = report.overview.levels.iter_mut().flat_map(|level| &mut level.branches);
        branches.filter(|branch| branch.is_isola()).for_each(|isola| isola.omega = (2.0, 2.1));
    });
    let compared = Comparison::new(vec![("one".into(), read(&Study::damper(), |_| {})), ("other".into(), moved)]);
    let row = compared.numbers.iter().find(|row| row.what == "highest isola, peak").unwrap();
    let second = row.values[1].read_in(FrequencyUnit::default());
    assert!(second.ends_with(" rad/s (at other frequencies: it may be another isola)"), "{second}");
}

#[test]
fn numbers_differ_by_what_they_do() {
    let compared = compared();
    let row = |amplitude: &str, what: &str| {
        let row = compared.numbers.iter().find(|row| row.amplitude == amplitude && row.what == what);
        let values = &row.unwrap_or_else(|| panic!("{amplitude}, {what}")).values;
        values.iter().map(|value| value.read_in(FrequencyUnit::default())).collect::<Vec<String>>()
    };
    // The highest isola has a row where a run has one.
    assert_eq!(compared.numbers.len(), 4);
    let isola = &row("0.006", "highest isola, peak")[1];
    assert!(isola.contains(" %, ") && isola.ends_with(" rad/s)"), "{isola}");
    let isolas = row("0.006", "isolas and others");
    assert!(isolas.iter().all(|text| text.starts_with("1: ") && text.ends_with(" rad/s")), "{isolas:?}");
    let [first, second] = &row("0.006", "largest response")[..] else { panic!("two runs") };
    // The numbers themselves, from the levels.
    let peaks: Vec<f64> = compared
        .reports
        .iter()
        .map(|report| {
            let level = report.overview.levels.iter().find(|level| level.value == 0.006).unwrap();
            level.branches.iter().map(|branch| branch.amplitude_max).fold(0.0, f64::max)
        })
        .collect();
    assert!(first.starts_with(&crate::words::length(peaks[0])) && !first.contains('%'), "{first}");
    let share = 100.0 * (peaks[1] / peaks[0] - 1.0);
    let sign = if share > 0.0 { "+" } else { "" };
    let expected = format!("({sign}{} %, ", crate::words::digits(share, 3));
    assert!(second.starts_with(&crate::words::length(peaks[1])) && second.contains(&expected), "{second}: {expected}");
    let table = table(&compared, 200);
    assert!(table.contains("harmonics.count") && table.contains(second.as_str()), "{table}");
}

/// Which level a run does not have is said once, and not row by row.
#[test]
fn levels_that_one_run_does_not_have() {
    let compared = compared();
    let said: Vec<String> = compared.sentences.iter().map(|told| told.read_in(FrequencyUnit::default())).collect();
    let [three, five] = ["three", "five"].map(|run| format!("Forcing amplitudes that are no levels of `{run}`: "));
    assert!(said.contains(&format!("{three}0.007.")) && said.contains(&format!("{five}3e-3.")), "{said:?}");
    assert!(compared.numbers.iter().all(|row| row.amplitude == "0.006"), "{:?}", compared.numbers);
    // Of three runs two have it.
    let third = || read(&Study::damper(), |_| ());
    let runs = [("a", third()), ("b", third()), ("c", compared.reports[1].clone())];
    let three = Comparison::new(runs.map(|(name, report)| (name.to_string(), report)).to_vec());
    let row = three.numbers.iter().find(|row| row.amplitude == "3e-3" && row.what == "isolas and others").unwrap();
    let cells: Vec<String> = row.values.iter().map(|value| value.read_in(FrequencyUnit::default())).collect();
    assert_eq!(cells, ["none", "none", "–"]);
}

/// Isolas and births of one run alone are told in words, whichever it is.
#[test]
fn what_only_one_run_has() {
    let birth = CurvePoint { forcing: 0.0055, omega: 1.0, event: Some("birth".into()), ..CurvePoint::default() };
    let born = CurveRow { points: vec![birth], ..CurveRow::default() };
    let whole = || read(&Study::damper(), |report| report.curves.push(born.clone()));
    let bare = read(&Study::damper(), |report| {
        report.curves.clear();
        for level in &mut report.overview.levels {
            level.branches.retain(|branch| !branch.is_isola());
        }
    });
    assert_eq!(Comparison::new(vec![("a".into(), whole()), ("b".into(), whole())]).sentences, []);
    let both = Comparison::new(vec![("a".into(), whole()), ("b".into(), bare)]);
    let alone: Vec<String> = both.sentences.iter().map(|told| told.read_in(FrequencyUnit::RadianPerSecond)).collect();
    let isolas = &alone[0];
    assert!(
        isolas.starts_with("Isolas of `a` at whose frequencies `b` has none: isola 1 at A = 0.006 (")
            && isolas.ends_with(" rad/s)."),
        "{isolas}"
    );
    assert_eq!(alone.len(), 2, "{alone:?}");
    let begins = "Births along fold curves of `a` that are not found in `b`, which has no fold curves (within 10 % of A and 3 % of the frequency, \
                  or the only one of each run within 3 % of the frequency): A = ";
    assert!(alone[1].starts_with(begins), "{alone:?}");
    let table: String = table(&both, 200).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(table.ends_with(&alone[1]), "{table}");
}

/// The only birth of each run at a frequency is one that has moved; of several near one frequency that is not known.
#[test]
fn births_that_moved_are_paired() {
    let born = |places: &[(f64, f64)]| {
        let point = |&(forcing, omega): &(f64, f64)| CurvePoint {
            forcing,
            omega,
            event: Some("birth".into()),
            ..CurvePoint::default()
        };
        let curve = CurveRow { points: places.iter().map(point).collect(), ..CurveRow::default() };
        read(&Study::damper(), move |report| report.curves = vec![curve.clone()])
    };
    let told = |other: &[(f64, f64)]| {
        let runs = vec![("a".into(), born(&[(0.004, 1.0)])), ("b".into(), born(other))];
        let compared = Comparison::new(runs);
        let read = |told: &Told| told.read_in(FrequencyUnit::default());
        let row = compared.numbers.iter().find(|row| row.what == "an isola is born");
        let row = row.map(|row| row.values.iter().map(read).collect::<Vec<_>>());
        (row, compared.sentences.iter().map(read).collect::<Vec<_>>())
    };
    let moved = vec!["A = 0.004 at 1 rad/s".to_string(), "A = 0.006 at 1.01 rad/s (+50 %)".to_string()];
    assert_eq!(told(&[(0.006, 1.01)]), (Some(moved), vec![]));
    let (row, alone) = told(&[(0.006, 1.01), (0.009, 0.99)]);
    assert_eq!(row, None);
    assert!(alone[0].starts_with("Births along fold curves of `a`") && alone[0].contains(": A = 0.004 ("), "{alone:?}");
    assert!(
        alone[1].contains("of `b`") && alone[1].ends_with("A = 0.009 (0.99 rad/s, beyond its levels)."),
        "{alone:?}"
    );
}

#[test]
fn a_terminal_has_some_of_many_settings() {
    let study = |value: usize| {
        let keys: String = (0..40).map(|k| format!("key{k} = {value}\n")).collect();
        read(&Study::damper(), move |report| report.account.study.clone_from(&keys))
    };
    let compared = Comparison::new(vec![("a".into(), study(1)), ("b".into(), study(2))]);
    let table = table(&compared, 120);
    assert_eq!(table.matches("key").count(), 12 + 1, "{table}");
    assert!(table.contains("and 28 more keys"), "{table}");
}

#[test]
fn gaps_that_differ_have_a_line_each() {
    let labels = |gaps: [Option<f64>; 2]| {
        let touch = |gap: Option<f64>| gap.map(|at| Touch { at, is_gap: true });
        let run = |gap| read(&Study::damper(), |report| report.monitors[0].touch = touch(gap));
        let compared = Comparison::new(vec![("a".into(), run(gaps[0])), ("b".into(), run(gaps[1]))]);
        let panel = &compared.figures.drawn["response"].panels[0];
        let labels = panel.labels.iter().filter(|label| label.text.starts_with("gap")).map(|label| label.text.clone());
        (panel.spans.len(), labels.collect::<Vec<_>>())
    };
    assert_eq!(labels([Some(0.5), Some(0.5)]), (1, vec!["gap".to_string()]));
    assert_eq!(labels([Some(0.5), Some(0.6)]), (2, vec!["gap of a".to_string(), "gap of b".to_string()]));
    assert_eq!(labels([None, Some(0.6)]), (1, vec!["gap of b".to_string()]));
}

#[test]
fn motions_of_further_orders_are_not_compared() {
    let run = |asked: Vec<usize>| read(&Study::damper(), |report| report.asked = asked.clone());
    let told = |orders: [Vec<usize>; 2]| {
        let runs = orders.map(|asked| (format!("{asked:?}"), run(asked)));
        Comparison::new(runs.to_vec())
            .sentences
            .iter()
            .map(|told| told.read_in(FrequencyUnit::RadianPerSecond))
            .collect::<Vec<_>>()
    };
    assert_eq!(told([vec![1], vec![1]]), Vec::<String>::new());
    let expected = "Motions that last 2 and 3 periods of the force are not compared here: isola report with --order compares those of one of \
                    them.";
    assert_eq!(told([vec![1, 2], vec![1, 3]]), [expected]);
}

#[test]
fn curves_of_all_runs_are_over_each_other() {
    let compared = compared();
    let figure = &compared.figures.drawn["response"];
    let names: Vec<&str> = figure.panels[0].series.iter().flat_map(|series| &series.name).map(String::as_str).collect();
    let expected = [
        "three: A = 3e-3, main",
        "three: A = 0.006, main",
        "three: A = 0.006, isola 1",
        "five: A = 0.006, main",
        "five: A = 0.006, isola 1",
        "five: A = 0.007, main",
        "five: A = 0.007, isola 1",
    ];
    assert_eq!(names, expected);
    let levels: Vec<Option<usize>> =
        figure.panels[0].series.iter().filter(|series| !series.name.is_empty()).map(|series| series.level).collect();
    assert_eq!(levels, [0, 1, 1, 1, 1, 2, 2].map(Some));
    let styles: Vec<_> = figure.panels[0].series.iter().map(|series| series.style.color).collect();
    assert!(styles[0] != styles[styles.len() - 1]);
    let legend: Vec<&str> = figure.legend.iter().map(|entry| entry.text.as_str()).collect();
    assert_eq!(
        legend,
        ["three", "five", "main branch", "isola and others", "stability not known: nothing was verified"]
    );
    // The axis holds the largest of both.
    let [low, high] = [0, 1].map(|run| compared.reports[run].figures.drawn["response"].panels[0].y[0].range.1);
    assert_eq!(figure.panels[0].y[0].range.1, low.max(high));
    assert_eq!(compared.figures.drawn["resonance"].panels[0].series.len(), 2);
}
