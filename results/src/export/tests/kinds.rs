//! A branch that leaves through a bound, from the store to files and tables.

use super::{names, table};
use crate::export::csv;
use crate::export::listed::events;
use crate::fixture::Study;
use crate::overview::doubts;
use crate::store::{Crossing, CurvePoint, CurveRow};
use crate::summary_table::{self, Layout, LengthUnit, UnitChoice, Units};
use protocol::branch::BranchMessage;
use solver::response::branch::{BranchKind, Standing};
use solver::response::task::BranchId;
use tempfile::tempdir;

/// Which of both happens where branches merge or part is a column of its own, empty where it is not known.
#[test]
fn events_say_what_branches_do_where_they_touch() {
    let dir = tempdir().unwrap();
    let point = |(i, &forcing): (usize, &f64)| {
        let event = (i == 2).then(|| "merge".to_string());
        CurvePoint { forcing, omega: i as f64, event, ..CurvePoint::default() }
    };
    let points = [1.0, 3.0, 4.0, 3.0, 1.0].iter().enumerate().map(point).collect();
    let crossing = |(segment, branch): (usize, &str)| Crossing {
        segment,
        forcing: 2.0,
        amplitude: "2".into(),
        branch: branch.into(),
    };
    let crossings = [(0, "isola 1"), (3, "main")].map(crossing).to_vec();
    let known = CurveRow { points, crossings, ..CurveRow::default() };
    let told = |curve: &CurveRow| {
        events(std::slice::from_ref(curve), &[]).write(dir.path()).unwrap();
        table(&dir.path().join("events.csv")).1[0]["outcome"].clone()
    };
    assert_eq!(told(&known), "merge");
    assert_eq!(told(&CurveRow { crossings: Vec::new(), ..known }), "");
}

#[test]
fn a_cut_branch_is_called_so_everywhere() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished_with_cuts(&dir.path().join("run"));
    let cut = results.iter().find(|result| result.name == Some(BranchId::new(BranchKind::Cut, 0))).unwrap();
    let read = store.result(&cut.task).unwrap().unwrap();
    assert_eq!(&read, cut);
    assert_eq!(read.branch.unwrap().peak_standing, Some(Standing::AtLeast));
    assert!(store.done().unwrap().iter().any(|done| done.branch == cut.name && done.task == cut.task));

    csv(&store, dir.path()).unwrap();
    assert_eq!(names(&dir.path().join("branches"))[0], "0.006-cut-1.csv");
    let (_, rows) = table(&dir.path().join("summary.csv"));
    let (cuts, mains): (Vec<_>, Vec<_>) = rows.iter().partition(|row| row["kind"] != "main");
    let ([row, ..], 2) = (&cuts[..], mains.len()) else { panic!("{rows:?}") };
    let cells = ["kind", "branch", "status", "peak_standing", "family"].map(|column| row[column].as_str());
    assert_eq!(cells, ["cut", "1", "open: frequency bound to amplitude bound", "at_least", "1"]);
    let (_, windows) = table(&dir.path().join("windows.csv"));
    assert!(windows.iter().any(|window| window["branch"].starts_with("cut 1")), "{windows:?}");

    let layout = Layout { units: "mm,Hz".parse::<UnitChoice>().unwrap().of_table(), ..Layout::default() };
    for layout in [Layout::default(), layout, Layout { width: 60, ..layout }, Layout { width: 160, ..layout }] {
        let table = summary_table::table(&store, layout).unwrap();
        let widest = table.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= usize::from(layout.width), "{table}");
        assert!(table.contains("cut: ") && table.matches('≥').count() == cuts.len() + 1, "{table}");
        let words = table.split_whitespace().collect::<Vec<_>>().join(" ");
        let note = "¹ ends: frequency bound, amplitude bound; whether it is detached is not known ≥: the branch goes on beyond where it is known";
        assert!(words.contains(note), "{table}");
        assert!(table.contains(if layout.units == Units::default() { "in m, " } else { "in mm, " }), "{table}");
        assert!(words.contains("No isola was found; what is cut or unfinished may be one."), "{table}");
        // The frequency of a largest response that is not known does not rise.
        assert!(!table.contains("rises"), "{table}");
    }
    // A cut branch is no reason to doubt what hangs on main branches.
    assert_eq!(doubts(&store).unwrap(), None);
}

/// The table is of the first monitored dof; how far the others move stands below it.
#[test]
fn other_monitored_dofs_are_told_with_their_largest_amplitudes() {
    let (study, dir) = (Study::new("nltva", 3, &["0.11", "0.13"]), tempdir().unwrap());
    let (store, results) = study.finished(&dir.path().join("run"));
    let [first, second] = study.model.dofs() else { panic!("{:?}", study.model.dofs()) };
    let amplitudes = |branch: &BranchMessage| {
        let array = branch.points.columns.get("amplitude").unwrap();
        array.values("amplitude", &array.shape).unwrap().chunks(2).map(|pair| pair[1]).collect::<Vec<_>>()
    };
    let largest = results.iter().filter_map(|result| result.branch.as_ref()).flat_map(amplitudes).fold(0.0, f64::max);
    let table = summary_table::table(&store, Layout { width: 400, ..Layout::default() }).unwrap();
    assert!(table.contains(&format!("\nLargest amplitudes of {first} in m,")), "{table}");
    let told =
        format!("\nLargest amplitudes of other monitored dofs: {second} {} m at ", LengthUnit::Metre.digits(largest));
    assert!(table.contains(&told), "{told}: {table}");
}
