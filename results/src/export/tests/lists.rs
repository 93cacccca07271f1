//! Lists: text in CSV files, numbers in files for MATLAB and NumPy.

use super::table;
use crate::export::list::List;
use crate::export::listed::{motions, pushes};
use crate::export::value::{Record, Value};
use crate::store::{MotionRow, PushRow};
use protocol::array::Array;
use solver::stability::endings::Ending;
use std::collections::HashMap;
use tempfile::tempdir;

fn values(list: &List) -> HashMap<String, Value> {
    let mut record = Record::default();
    list.add(&mut record.group(list.name));
    record.0.into_iter().collect()
}

/// Modes count from 1 in CSV files and from 0 elsewhere; what is not there is empty here and not a number there; columns that CSV
/// files do not have are there.
#[test]
fn pushes_are_text_and_numbers() {
    let found = PushRow {
        forcing: "1e2".into(),
        branch: "isola 1".into(),
        mode: 2,
        omega: 3.5,
        monitor: 1,
        motions: 64,
        largest: Some(8.0),
        impulse: Some(4.0),
        below: Some(3.75),
        velocity: Some(0.5),
        phase: Some(0.25),
        confirmed: Some(true),
        reason: None,
        from_rest: Some(Ending::Onto),
    };
    let reason = Some("too far".into());
    let missed = PushRow { impulse: None, below: None, confirmed: None, reason, from_rest: None, ..found.clone() };
    let rows = [found, missed];
    let list = pushes(&rows, |forcing| forcing.parse().unwrap(), &["x".into(), "y".into()]);

    let dir = tempdir().unwrap();
    assert_eq!(list.write(dir.path()).unwrap(), "pushes.csv");
    let (names, text) = table(&dir.path().join("pushes.csv"));
    assert!(
        names.starts_with("forcing,branch,mode,omega,monitor") && names.ends_with("confirmed,energy,from_rest"),
        "{names}"
    );
    let cells = ["forcing", "mode", "monitor", "impulse", "confirmed", "from_rest"]
        .map(|column| [0, 1].map(|i| &*text[i][column]));
    assert_eq!(cells, [["1e2"; 2], ["2"; 2], ["y"; 2], ["4", ""], ["true", ""], ["onto", ""]]);

    let values = values(&list);
    assert_eq!(values["pushes.mode"], Value::from(vec![1_usize, 1]));
    assert_eq!(values["pushes.value"], Value::from(vec![100.0, 100.0]));
    assert_eq!(values["pushes.confirmed"], Value::from(vec![true, false]));
    assert_eq!(values["pushes.reason"], Value::from(vec![String::new(), "too far".into()]));
    let Value::Real(impulse) = &values["pushes.impulse"] else { panic!("{:?}", values["pushes.impulse"]) };
    let impulse = impulse.values("impulse", &[2]).unwrap();
    assert!(impulse[0] == 4.0 && impulse[1].is_nan(), "{impulse:?}");
}

#[test]
fn lists_without_rows_have_their_columns() {
    let list = motions(&[] as &[MotionRow], |_| f64::NAN);
    assert!(list.is_empty());
    let values = values(&list);
    assert_eq!(values["motions.omega"], Value::from(Array::new([0], [])));
    assert_eq!(values["motions.point"], Value::from(Vec::<usize>::new()));
    assert_eq!(values["motions.onto"], Value::from(Vec::<String>::new()));
}
