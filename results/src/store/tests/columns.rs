//! Columns come and go with the programs: files of earlier and of later ones are read and written.

use super::*;
use protocol::columns::Columns;
use solver::response::columns::{Axis, of_backbone_in_files, of_points};

#[test]
fn tables_have_the_columns_of_the_list() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let store = Store::create(dir.path(), &study.header()).unwrap();
    let names = |table: &str| -> Vec<String> {
        store.all("SELECT name FROM pragma_table_info(?1)", [table], |row| row.get(0)).unwrap()
    };
    let points: Vec<&str> = of_points().map(|column| column.name).collect();
    // What time marching says stands beside them.
    assert_eq!(names("points"), [&["branch", "i", "omega"], &points[..], &["stable", "multiplier"]].concat());
    let backbone = of_backbone_in_files().filter(|column| column.axis != Axis::Modes).map(|column| column.name);
    assert_eq!(
        names("backbone"),
        [&["mode", "i", "omega", "zeta"], &points[..], &backbone.collect::<Vec<_>>()].concat()
    );
    let sql = "SELECT group_concat(sql) FROM sqlite_master";
    let text: String = store.one(sql, [], |row| row.get(0)).unwrap().unwrap();
    for meaning in ["-- Largest |x| over the period, m, of the first monitored dof", "-- Newton iterations.\n"] {
        assert_eq!(text.matches(meaning).count(), 2, "{meaning}");
    }
}

/// Level by level, or task by task, no table is read from end to end: of many levels that would take their number squared.
#[test]
fn levels_are_looked_up() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let store = Store::create(dir.path(), &study.header()).unwrap();
    for of_level in [
        "tasks WHERE level = ?1 AND kind NOT IN ('verify', 'disturb', 'march')",
        "attempts JOIN results USING (task) JOIN tasks ON tasks.id = task WHERE level = ?1",
        "branches LEFT JOIN tasks ON tasks.id = branches.task WHERE branches.level = ?1",
        "verifications JOIN branches ON branches.id = branch WHERE level = ?1",
    ] {
        let sql = format!("EXPLAIN QUERY PLAN SELECT count(*) FROM {of_level}");
        let steps: Vec<String> = store.all(&sql, [1], |row| row.get(3)).unwrap();
        assert!(!steps.is_empty() && steps.iter().all(|step| !step.starts_with("SCAN")), "{of_level}: {steps:?}");
    }
}

#[test]
fn a_file_without_some_columns_is_written_and_read() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let mut store = Store::create(dir.path(), &study.header()).unwrap();
    let sql = "ALTER TABLE points DROP COLUMN residual; ALTER TABLE points DROP COLUMN rms; \
               ALTER TABLE backbone DROP COLUMN certificate; ALTER TABLE backbone DROP COLUMN contact";
    store.reader.parts_mut().0.execute_batch(sql).unwrap();
    store.commit(&[Change::Planned(Arc::new(study.plan())), Change::Stage(Stage::Sweep)]).unwrap();
    let (_, results) = study.finished(&dir.path().join("whole"));
    assert_eq!(store.backbone().unwrap(), Some(study.plan().backbone));
    let result = results[0].clone();
    let (task, attempt, outcome) = (result.task.clone(), result.attempt, result.outcome);
    let done = Change::Done { task: task.clone(), attempt, outcome, sequence: 1 };
    store.commit(&[done, Change::Result(accepted(result.clone(), 1))]).unwrap();
    assert_eq!(store.result(&task).unwrap(), Some(result));
}

#[test]
fn a_column_of_a_later_program_comes_back_from_its_place() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (_, results) = study.finished(&dir.path().join("a"));
    let (mut store, mut sweep) = study.begin(&dir.path().join("b"));
    let granted = sweep.lease(&mut store, 0).unwrap();
    let mut result = results.iter().find(|result| result.task == granted.task).unwrap().clone();
    let points = &mut result.branch.as_mut().unwrap().points;
    let count = points.len();
    let known = of_points().map(|column| (column.name, points.columns.get(column.name).unwrap().clone()));
    let later = ("of tomorrow", Array::new([count], vec![1.5; count]));
    points.columns = Columns::from_iter(known.chain([later]).collect::<Vec<_>>());
    let (task, attempt, outcome) = (result.task.clone(), result.attempt, result.outcome);
    let done = Change::Done { task: task.clone(), attempt, outcome, sequence: 1 };
    let bytes = encode(&result);
    store.commit(&[done, Change::Result(accepted(result, 1))]).unwrap();
    assert_eq!(store.encoded_result(&task).unwrap().unwrap(), bytes);
    // As the later program stores it.
    let sql = "DELETE FROM arrays WHERE name = 'of tomorrow'; ALTER TABLE points ADD COLUMN \"of tomorrow\" REAL; \
               UPDATE points SET \"of tomorrow\" = 1.5";
    store.reader.parts_mut().0.execute_batch(sql).unwrap();
    assert_eq!(store.encoded_result(&task).unwrap().unwrap(), bytes);
}
