//! Of a run that is incomplete or damaged everything that is left is exported, and the rest is named.

use super::*;
use crate::store::{FILE, Store};
use rusqlite::Connection;

const FORMATS: [(Format, &str); 3] = [(Format::Csv, "csv"), (Format::Mat, "mat"), (Format::Npz, "npz")];

/// Exports a damaged run in all formats; returns what the last one calls damaged, and the files of branches.
fn exported(run: &Path) -> Vec<(Vec<String>, Vec<String>)> {
    let reader = Reader::open(run).unwrap();
    let of = |(format, extension)| {
        let dir = tempdir().unwrap();
        let omissions = export(&reader, format, dir.path()).unwrap().omissions;
        let rest = [".csv", ".mat", ".npz"].iter().filter(|&other| !other.ends_with(extension));
        let files = names(&dir.path().join("branches"));
        assert!(rest.into_iter().all(|other| !files.iter().any(|file| file.ends_with(other))));
        let stem = |file: &String| Path::new(file).file_stem().unwrap().to_str().unwrap().to_string();
        (omissions.damaged, files.iter().map(stem).collect())
    };
    FORMATS.into_iter().map(of).collect()
}

fn damaged_run(statement: &str) -> tempfile::TempDir {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    Connection::open(dir.path().join(FILE)).unwrap().execute_batch(statement).unwrap();
    dir
}

#[test]
fn a_branch_that_is_not_what_was_stored() {
    for statement in [
        "UPDATE points SET omega = omega * 1.000001 WHERE branch = 2 AND i = 3",
        "DELETE FROM points WHERE branch = 2 AND i = 3",
        "UPDATE arrays SET data = zeroblob(length(data)) \
         WHERE name = 'modal' AND owner = (SELECT task FROM branches WHERE id = 2)",
        "UPDATE results SET record = x'00' WHERE task = (SELECT task FROM branches WHERE id = 2)",
    ] {
        let dir = damaged_run(statement);
        let name: String = Connection::open(dir.path().join(FILE))
            .unwrap()
            .query_row("SELECT amplitude || '-' || kind || '-' || number FROM branches WHERE id = 2", [], |row| {
                row.get(0)
            })
            .unwrap();
        for (damaged, files) in exported(dir.path()) {
            assert_eq!(damaged.len(), 1, "{damaged:?}");
            assert!(damaged[0].starts_with(&format!("Branch {name} is left out: ")), "{damaged:?}");
            assert_eq!(files.len(), 2);
            assert!(!files.contains(&name));
        }
    }
}

#[test]
fn displacements_that_are_not_those_of_the_branch() {
    for statement in [
        "DELETE FROM arrays WHERE name = 'displacement' AND owner = '0.006-0'",
        "UPDATE arrays SET data = zeroblob(length(data)) WHERE name = 'displacement' AND owner = '0.006-0'",
    ] {
        let dir = damaged_run(statement);
        let (csv, rest) = exported(dir.path()).split_first().map(|(csv, rest)| (csv.clone(), rest.to_vec())).unwrap();
        assert!(csv.0.is_empty());
        for (damaged, files) in rest {
            assert_eq!((damaged.len(), files.len()), (1, 3));
            assert!(
                damaged[0].starts_with("The displacements of branch 0.006-main-1 are left out: they "),
                "{damaged:?}"
            );
        }
    }
}

#[test]
fn a_backbone_or_a_model_that_is_damaged() {
    for (statement, what) in [
        ("DELETE FROM backbone WHERE i = 2", "The backbone is"),
        ("UPDATE model SET payload = x'00'", "The model is"),
        ("UPDATE meta SET value = 'x' WHERE key = 'model_sha256'", "The model is"),
        ("DROP TABLE windows", "The windows at A = 3e-3 are"),
    ] {
        let dir = damaged_run(statement);
        for (damaged, files) in exported(dir.path()) {
            assert!(damaged.iter().any(|sentence| sentence.starts_with(what)), "{statement}: {damaged:?}");
            assert_eq!(files.len(), 3, "{statement}");
        }
    }
}

/// Whatever page is overwritten: a run that can be opened is exported or refused with a message, and every branch that
/// is exported is what was stored, or it is named.
#[test]
fn pages_that_are_overwritten() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    let (path, whole) = (dir.path().join(FILE), tempdir().unwrap());
    let good = fs::read(&path).unwrap();
    for (format, extension) in FORMATS {
        export(&Reader::open(dir.path()).unwrap(), format, &whole.path().join(extension)).unwrap();
    }
    let (mut opened, mut noticed) = (0, 0);
    for page in 1..good.len() / 8192 {
        let mut bytes = good.clone();
        bytes[page * 8192..][..512].fill(0xA5);
        fs::write(&path, &bytes).unwrap();
        let Ok(reader) = Reader::open(dir.path()) else { continue };
        opened += 1;
        for (format, extension) in FORMATS {
            let to = tempdir().unwrap();
            let Ok(Exported { omissions, .. }) = export(&reader, format, to.path()) else { continue };
            noticed += usize::from(!omissions.damaged.is_empty());
            for file in names(&to.path().join("branches")) {
                let same = [whole.path().join(extension), to.path().into()]
                    .map(|dir| fs::read(dir.join("branches").join(&file)).unwrap());
                let name = file.strip_suffix(&format!(".{extension}")).unwrap();
                let is_named =
                    omissions.damaged.iter().any(|sentence| sentence.contains(name) || sentence.contains("model"));
                assert!(same[0] == same[1] || is_named, "page {page}: {file}: {omissions:?}");
            }
        }
    }
    assert!(opened > 20 && noticed > opened, "{opened} opened, {noticed} noticed");
}

#[test]
fn what_is_not_there_yet() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let store = Store::create(&dir.path().join("new"), &study.header()).unwrap();
    for (format, _) in FORMATS {
        let omissions = export(&store, format, &dir.path().join("files")).unwrap().omissions;
        assert!(omissions.damaged.is_empty());
        assert_eq!(omissions.missing, ["There is no backbone yet, and so there are no windows and no branches."]);
    }
    let (mut store, mut sweep) = study.begin(&dir.path().join("begun"));
    assert!(sweep.step(&mut store));
    for (format, _) in FORMATS {
        let omissions = export(&store, format, &dir.path().join("files")).unwrap().omissions;
        assert!(omissions.damaged.is_empty());
        let tasks = store.counts().unwrap();
        assert_eq!(
            omissions.missing[0],
            format!(
                "{} tasks are still to be done, at A = 3e-3, 0.006, verifications and what follows from results not counted.",
                tasks.waiting
            )
        );
        assert!(omissions.missing[1].starts_with("No branch is known at A = "), "{omissions:?}");
    }
}

/// What cannot be read of a level is neither missing nor not there.
#[test]
fn the_closing_table_begins_with_the_damage() {
    let dir = damaged_run("UPDATE windows SET mode = 'x' WHERE level = (SELECT max(level) FROM levels)");
    let table = crate::summary_table::table(&Reader::open(dir.path()).unwrap(), Default::default()).unwrap();
    let said = "The file of the run is damaged: 1 part of it is left out, and what was found may\nbe missing.\n";
    assert!(table.starts_with(said), "{table}");
    assert_eq!(table.matches("damaged¹").count(), 1, "{table}");
    assert!(table.contains("¹ not all of the level can be read") && !table.contains("no window"), "{table}");
    // A level none of whose branches can be read is not one without branches.
    let dir = damaged_run("UPDATE branches SET points = 'x' WHERE level = (SELECT max(level) FROM levels)");
    let reader = Reader::open(dir.path()).unwrap();
    let table = crate::summary_table::table(&reader, Default::default()).unwrap();
    assert!(table.contains("│ 0.006 ┆ damaged"), "{table}");
    assert!(!table.contains("to come") && !table.contains("No branch is known"), "{table}");
}
