//! Several backbones, from the store to files, tables and answers.

use super::table;
use crate::export::{Format, csv, export};
use crate::fixture::Study;
use crate::overview::modes;
use crate::report::{Report, Selection};
use crate::store::Store;
use crate::summary_table::{self, Layout};
use protocol::codec::encode;
use solver::response::modes::ModesFollowed;
use std::fs::File;
use tempfile::tempdir;
use zip::ZipArchive;

fn study() -> Study {
    Study::of_modes("two_masses_stop", 3, &["0.01", "0.02"], 2)
}

#[test]
fn backbones_come_back_with_their_windows() {
    let (study, dir) = (study(), tempdir().unwrap());
    drop(study.finished(dir.path()));
    let store = Store::open(dir.path()).unwrap();
    let plan = study.plan();
    assert_eq!(encode(&store.backbone().unwrap().unwrap()), encode(&plan.backbone));
    let further: Vec<Vec<u8>> = store.further_backbones().unwrap().iter().map(encode).collect();
    assert_eq!(further, plan.further.iter().map(encode).collect::<Vec<_>>());
    assert_eq!(store.modes().unwrap(), Some(plan.modes()));
    assert_eq!(plan.modes(), ModesFollowed { followed: vec![1, 0], left_out: vec![] });
    assert_eq!(store.plans().unwrap(), study.plans);
    assert!(study.plans[0].windows.iter().any(|window| window.mode == 1));

    csv(&store, dir.path()).unwrap();
    let (_, rows) = table(&dir.path().join("backbone.csv"));
    let modes: Vec<&str> = rows.iter().map(|row| row["mode"].as_str()).collect();
    let count = |backbone: usize| study.backbones()[backbone].points.len();
    assert_eq!(modes, [vec!["2"; count(0)], vec!["1"; count(1)]].concat());
    let (_, rows) = table(&dir.path().join("windows.csv"));
    let written: Vec<usize> = rows.iter().map(|row| row["mode"].parse().unwrap()).collect();
    let planned = study.plans.iter().flat_map(|plan| &plan.windows).map(|window| window.mode + 1);
    assert_eq!(written, planned.collect::<Vec<_>>());

    export(&store, Format::Npz, dir.path()).unwrap();
    let archive = ZipArchive::new(File::open(dir.path().join("run.npz")).unwrap()).unwrap();
    for name in ["backbone.omega", "backbone_1.omega", "backbone_1.displacement", "modes.followed", "windows.mode"] {
        assert!(archive.index_for_name(&format!("{name}.npy")).is_some(), "{name}");
    }
}

#[test]
fn what_was_searched_is_said_by_modes() {
    let (study, dir) = (study(), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let report = Report::read(&store, &Selection::Fitting).unwrap();
    assert!(report.run.missing.is_empty(), "{:?}", report.run.missing);
    assert!(report.verdict.iter().any(|part| part.whole().contains("the windows of mode 2 at 2 levels (")));
    // The other mode has a backbone, and no window at these levels.
    let none = "none of mode 1 at these levels and frequencies)";
    assert!(report.verdict.iter().any(|part| part.whole().contains(none)), "{:?}", report.verdict);
    let said = summary_table::table(&store, Layout::default()).unwrap();
    let said = said.replace('\n', " ");
    assert!(said.contains(&format!("Looked for: windows of mode 2 ({none}")), "{said}");
    let choice = store.modes().unwrap().unwrap();
    assert_eq!(modes::sentence(&choice, true).unwrap(), "Windows of modes 2 and 1 were looked for.");
}
