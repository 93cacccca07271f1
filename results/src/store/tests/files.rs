//! Files that are no runs, runs that are in use.

use super::super::database::open_immutable;
use super::*;
use crate::overview::{Omissions, Overview};
use rusqlite::Connection;
use solver::response::branch::Certificate;
use std::io::{Seek, SeekFrom, Write};

fn header() -> RunHeader {
    Study::new("duffing", 1, &["0.1"]).header()
}

/// Both ways of opening a run fail with this message.
fn assert_refused(dir: &Path, message: &str) {
    for error in [Store::open(dir).err(), Reader::open(dir).err()] {
        let error = error.unwrap().to_string();
        assert!(error.contains(message) && error.contains(FILE), "{error}");
    }
}

#[test]
fn what_is_no_run_is_refused() {
    let dir = tempdir().unwrap();
    let file = dir.path().join(FILE);
    assert_refused(dir.path(), "there is no such file; name the folder of a run");
    assert!(!dir.path().join(LOCK).exists());

    fs::write(&file, vec![7; 5000]).unwrap();
    assert_refused(dir.path(), "not a run of Isola (not an SQLite file)");
    fs::remove_file(&file).unwrap();
    Connection::open(&file).unwrap().execute_batch("CREATE TABLE t (a); PRAGMA application_id = 5").unwrap();
    assert_refused(dir.path(), "not a run of Isola (an SQLite file of another program)");
    fs::remove_file(&file).unwrap();

    drop(Store::create(dir.path(), &header()).unwrap());
    Connection::open(&file).unwrap().execute_batch("PRAGMA user_version = 99").unwrap();
    assert_refused(dir.path(), "version 99 of the format, this program knows version 13; use a newer `isola`");
}

#[test]
fn a_run_of_the_first_programs_is_read_but_does_not_go_on() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    let db = Connection::open(dir.path().join(FILE)).unwrap();
    for column in [
        "peak_standing",
        "penetration",
        "pressure_beyond",
        "amplitude_2h",
        "shift_2h",
        "omega_min_2h",
        "omega_max_2h",
        "change_2h",
        "change_omega_2h",
        "slowest_sliding",
    ] {
        db.execute(&format!("ALTER TABLE branches DROP COLUMN {column}"), []).unwrap();
    }
    // Nor did they know several modes, or verify anything.
    let one_mode = "ALTER TABLE windows DROP COLUMN mode; DROP TABLE modes; DROP TABLE bifurcations; DROP TABLE verified_points; \
                    DROP TABLE verifications; CREATE TABLE one AS SELECT * FROM backbone; \
                    ALTER TABLE one DROP COLUMN mode; DROP TABLE backbone; ALTER TABLE one RENAME TO backbone; \
                    PRAGMA user_version = 1";
    db.execute_batch(one_mode).unwrap();
    drop(db);
    let error = Store::open(dir.path()).unwrap_err();
    assert!(matches!(error, StoreError::Older { found: 1, known: 13, .. }), "{error}");
    assert!(error.to_string().contains("`isola sweep` computes the study again"), "{error}");

    let reader = Reader::open(dir.path()).unwrap();
    let mut omissions = Omissions::default();
    let overview = Overview::read(&reader, &mut omissions).unwrap();
    let rows: Vec<&BranchRow> = overview.branches().map(|(_, row)| row).collect();
    assert_eq!(rows.iter().map(|row| row.name()).collect::<Vec<_>>(), ["main", "main", "isola 1"]);
    for row in rows {
        assert_eq!((row.peak_standing, row.certificate), (None, Certificate::default()));
        assert_eq!(row.family, (!row.is_main()).then_some(1));
    }
    assert_eq!(reader.backbone().unwrap(), Some(study.plan().backbone));
    assert!(reader.further_backbones().unwrap().is_empty());
    assert_eq!(reader.modes().unwrap().unwrap().followed, [0]);
    assert!(overview.levels.iter().flat_map(|level| &level.windows).all(|window| window.mode == 1));
    let exported = dir.path().join("exported");
    assert!(crate::export::csv(&reader, &exported).unwrap().damaged.is_empty());
    assert!(omissions.damaged.is_empty() && exported.join("summary.csv").exists());
}

#[test]
fn damage_is_found_when_a_run_goes_on() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    let path = dir.path().join(FILE);
    let length = fs::metadata(&path).unwrap().len();
    let mut file = fs::OpenOptions::new().write(true).open(&path).unwrap();
    for page in 2..length / 8192 {
        file.seek(SeekFrom::Start(page * 8192)).unwrap();
        file.write_all(&[0xA5; 512]).unwrap();
    }
    drop(file);
    let error = Store::open(dir.path()).unwrap_err();
    assert!(matches!(error, StoreError::Corrupt { .. }), "{error}");
    assert!(error.to_string().contains("restore a copy"), "{error}");
}

#[test]
fn a_changed_number_is_found() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let (db, task) = (Connection::open(dir.path().join(FILE)).unwrap(), &results[0].task);
    db.execute("UPDATE points SET omega = omega * 1.000001 WHERE branch = 1 AND i = 3", []).unwrap();
    assert!(matches!(store.result(task), Err(StoreError::Corrupt { .. })));
}

#[test]
fn a_run_is_not_created_twice() {
    let (dir, header) = (tempdir().unwrap(), header());
    let store = Store::create(dir.path(), &header).unwrap();
    let error = Store::create(dir.path(), &header).unwrap_err();
    assert!(matches!(error, StoreError::Exists { .. }), "{error}");
    drop(store);
    assert!(matches!(Store::create(dir.path(), &header), Err(StoreError::Exists { .. })));
}

#[test]
fn a_file_is_no_folder_for_a_run() {
    let dir = tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "x").unwrap();
    for folder in [file.clone(), file.join("deeper/run")] {
        let error = Store::create(&folder, &header()).unwrap_err();
        assert!(matches!(&error, StoreError::NotAFolder { file: named } if *named == file), "{error}");
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "x");
}

#[test]
fn a_run_that_cannot_be_created_leaves_nothing() {
    let (dir, mut header) = (tempdir().unwrap(), header());
    let new = dir.path().join("new");
    header.amplitudes = vec![header.amplitudes[0].clone(); 2];
    assert!(Store::create(&new, &header).is_err());
    assert!(!new.exists());
    assert!(Store::create(dir.path(), &header).is_err());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn one_coordinator_at_a_time() {
    let dir = tempdir().unwrap();
    let store = Store::create(dir.path(), &header()).unwrap();
    let error = Store::open(dir.path()).unwrap_err().to_string();
    assert!(error.contains(&format!("another coordinator (process {}) uses this run", std::process::id())), "{error}");
    assert!(Reader::open(dir.path()).is_ok());
    drop(store);
    assert!(Store::open(dir.path()).is_ok());
}

#[test]
fn a_run_of_version_8_is_read() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    let db = Connection::open(dir.path().join(FILE)).unwrap();
    let older = "ALTER TABLE curve_points DROP COLUMN forcing_2h; ALTER TABLE curve_points DROP COLUMN omega_2h; \
                 UPDATE tasks SET origin = 'fold'; INSERT INTO curves SELECT 1, min(id), 'fold', 'closed', 0, 0, 0 FROM tasks; \
                 INSERT INTO curve_points VALUES (1, 0, 0.5, 1.5, 2.5, 'birth'); PRAGMA user_version = 8";
    db.execute_batch(older).unwrap();
    drop(db);
    let curves = Reader::open(dir.path()).unwrap().curves().unwrap();
    let event = Some("birth".into());
    assert_eq!(curves[0].points, [CurvePoint { forcing: 0.5, omega: 1.5, amplitude: 2.5, event, doubled: None }]);
}

#[test]
fn a_folder_without_write_permission_can_be_read() {
    let dir = tempdir().unwrap();
    let odd = dir.path().join("50% of #1?");
    let header = header();
    drop(Store::create(&odd, &header).unwrap());
    let reader = Reader::new(open_immutable(&odd.join(FILE)).unwrap(), &odd);
    assert_eq!(reader.header().unwrap(), header);
    assert!(!odd.join("run.sqlite-shm").exists());
}
