//! What a run left on disk.

use rusqlite::types::Value;
use rusqlite::{Connection, OptionalExtension, Row};
use std::path::Path;

/// A row of summary.csv.
#[derive(Debug, Clone, PartialEq)]
pub struct SummaryRow {
    /// Forcing amplitude as typed, kind and number.
    pub name: (String, String, String),
    /// omega_min, omega_max, amplitude_max, omega_at_max.
    pub numbers: Vec<f64>,
}

/// summary.csv of a run.
pub fn summary(directory: &Path) -> Vec<SummaryRow> {
    let mut reader = csv::Reader::from_path(directory.join("summary.csv")).expect("the run wrote summary.csv");
    let columns = reader.headers().expect("it has a header").clone();
    let column = |name: &str| columns.iter().position(|c| c == name).expect("its columns are fixed");
    let name = ["amplitude", "kind", "branch"].map(column);
    let numbers = ["omega_min", "omega_max", "amplitude_max", "omega_at_max"].map(column);
    reader
        .records()
        .map(|record| {
            let record = record.expect("it is whole");
            let text = |index: usize| record[index].to_string();
            SummaryRow {
                name: (text(name[0]), text(name[1]), text(name[2])),
                numbers: numbers.iter().map(|&i| record[i].parse().unwrap_or(f64::NAN)).collect(),
            }
        })
        .collect()
}

/// The same branches, with ranges and peaks within 1e-6.
pub fn assert_same(one: &[SummaryRow], other: &[SummaryRow]) {
    let names = |rows: &[SummaryRow]| rows.iter().map(|row| row.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(one), names(other));
    for (a, b) in one.iter().zip(other) {
        for (x, y) in a.numbers.iter().zip(&b.numbers) {
            assert!((x - y).abs() <= 1e-6 * x.abs(), "{:?}: {x} and {y}", a.name);
        }
    }
}

/// Events that were computed: kind and forcing amplitude.
pub fn events(directory: &Path) -> Vec<(String, f64)> {
    let rows = records(directory, "events.csv").into_iter().filter(|row| &row[1] == "computed");
    rows.map(|row| (row[0].to_string(), row[2].parse().expect("it is a number"))).collect()
}

/// Number of points of fold curves.
pub fn folds(directory: &Path) -> usize {
    records(directory, "folds.csv").len()
}

fn records(directory: &Path, file: &str) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(directory.join(file)).expect("the run wrote it");
    reader.records().map(|record| record.expect("it is whole")).collect()
}

fn store(directory: &Path) -> Connection {
    Connection::open(directory.join("run.sqlite")).expect("there is a store")
}

/// A number from the store.
pub fn number(directory: &Path, sql: &str) -> i64 {
    store(directory).query_row(sql, [], |row| row.get(0)).unwrap_or_else(|error| panic!("{sql}: {error}"))
}

/// A text from the store.
pub fn text(directory: &Path, sql: &str) -> String {
    store(directory).query_row(sql, [], |row| row.get(0)).unwrap_or_else(|error| panic!("{sql}: {error}"))
}

/// A task that was handed out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attempt {
    /// Task.
    pub task: String,
    /// Counts from 1 for each task.
    pub number: i64,
}

/// What a worker process has under way.
pub fn attempt_of(directory: &Path, process: u32) -> Option<Attempt> {
    let sql = "SELECT task, attempt FROM attempts WHERE ended_at IS NULL AND worker LIKE ?1";
    // Workers are named after host and process.
    let attempt = |row: &Row<'_>| Ok(Attempt { task: row.get(0)?, number: row.get(1)? });
    store(directory).query_row(sql, [format!("%-{process}-%")], attempt).optional().expect("documented")
}

/// How an attempt ended, if it has.
pub fn end_of(directory: &Path, attempt: &Attempt) -> Option<String> {
    let sql = "SELECT \"end\" FROM attempts WHERE task = ?1 AND attempt = ?2";
    store(directory).query_row(sql, (&attempt.task, attempt.number), |row| row.get(0)).expect("it was handed out")
}

/// Tasks that are done, in the order of their announcements.
pub fn done(directory: &Path) -> Vec<String> {
    let store = store(directory);
    let mut query = store.prepare("SELECT task FROM results ORDER BY sequence").expect("documented");
    let rows = query.query_map([], |row| row.get(0)).expect("documented");
    rows.collect::<Result<_, _>>().expect("documented")
}

/// Every task that was needed has one result, and every branch its points, once.
pub fn assert_stored_once(directory: &Path) {
    let number = |sql: &str| number(directory, sql);
    assert_eq!(number("SELECT count(*) FROM tasks WHERE state NOT IN ('done', 'skipped')"), 0, "tasks left");
    assert!(number("SELECT count(*) FROM branches") > 0, "no branch");
    let twice = "SELECT count(*) FROM branches a JOIN branches b ON a.level = b.level AND a.id < b.id
                 WHERE abs(a.omega_min - b.omega_min) + abs(a.omega_max - b.omega_max) < 1e-6 * a.omega_max
                 AND abs(a.amplitude_max - b.amplitude_max) < 1e-6 * a.amplitude_max";
    assert_eq!(number(twice), 0, "a branch is stored twice");
    assert_eq!(
        number("SELECT (SELECT count(*) FROM points) - (SELECT sum(points) FROM branches)"),
        0,
        "points do not belong to branches"
    );
}

/// Every number that is stored of the branch of a task, to the last bit.
pub fn numbers_of(directory: &Path, task: &str) -> Vec<String> {
    let store = store(directory);
    let mut rows = Vec::new();
    // Which number a branch has in the file depends on when it came.
    for (sql, first) in [
        ("SELECT points.* FROM points JOIN branches ON branches.id = points.branch WHERE task = ?1 ORDER BY i", 1),
        ("SELECT name, shape, data FROM arrays WHERE owner = ?1 ORDER BY name", 0),
        ("SELECT kind, number, status, points, rejections, special FROM branches WHERE task = ?1", 0),
    ] {
        let mut query = store.prepare(sql).expect("documented");
        let columns = first..query.column_count();
        let row = |row: &Row<'_>| columns.clone().map(|i| row.get::<_, Value>(i)).collect::<Result<Vec<_>, _>>();
        let found = query.query_map([task], row).expect("documented");
        rows.extend(found.map(|row| format!("{:?}", row.expect("documented"))));
    }
    rows
}

/// Time from the first grant to the last acceptance.
pub fn first_grant_to_last_acceptance(directory: &Path) -> std::time::Duration {
    let sql = "SELECT unixepoch(max(ended_at), 'subsec') - unixepoch(min(granted_at), 'subsec') FROM attempts";
    let seconds: f64 = store(directory).query_row(sql, [], |row| row.get(0)).expect("the schema is documented");
    std::time::Duration::from_secs_f64(seconds)
}
