//! Columns are an interface; what is not finished is exported as far as it is.

mod damage;
mod documents;
mod kinds;
mod lists;
mod modes;
mod records;

use super::table::text;
use super::*;
use crate::fixture::{Study, worker};
use crate::journal::{AttemptEnd, Change, Holder};
use crate::overview::{Omissions, Overview, shift};
use crate::store::{Reader, verdict_name};
use protocol::ids::{Attempt, TaskId};
use solver::curve::problem::Failure;
use solver::response::columns::{Column, Csv, of_backbone, of_points};
use solver::response::task::{BranchId, SeedOutcome, TaskResult};
use solver::stability::multipliers::Verdict;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Names of the columns and rows of a file.
fn table(path: &Path) -> (String, Vec<HashMap<String, String>>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let rows = reader.deserialize().map(Result::unwrap).collect();
    (names.join(","), rows)
}

/// The columns of the first programs, and behind them what the list has been given since.
fn with_later(first: &str, list: impl Iterator<Item = &'static Column>, csv: fn(&Column) -> Csv) -> String {
    let later = list.filter(|column| column.is_later && csv(column) != Csv::No);
    later.fold(first.into(), |names, column| format!("{names},{}", column.name))
}

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_finished_run() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (store, results) = study.finished(&dir.path().join("run"));
    let out = dir.path().join("csv");
    csv(&store, &out).unwrap();
    csv(&Reader::open(store.dir()).unwrap(), &out).unwrap();
    let all = ["backbone.csv", "bifurcations.csv", "branches", "events.csv", "folds.csv", "summary.csv", "windows.csv"];
    assert_eq!(names(&out), all);
    assert_eq!(names(&out.join("branches")), ["0.006-isola-1.csv", "0.006-main-1.csv", "3e-3-main-1.csv"]);

    let (columns, rows) = table(&out.join("summary.csv"));
    assert_eq!(
        columns,
        "amplitude,branch,kind,status,points,omega_min,omega_max,amplitude_max,omega_at_max,contact_omega_min,\
         contact_omega_max,peak_standing,family,penetration,pressure_beyond,amplitude_2h,shift_2h,stable,omega_min_2h,omega_max_2h,\
         change_2h,change_omega_2h,slowest_sliding"
    );
    let keys: Vec<[&str; 3]> = rows.iter().map(|r| ["amplitude", "kind", "branch"].map(|c| r[c].as_str())).collect();
    assert_eq!(keys, [["3e-3", "main", "1"], ["0.006", "main", "1"], ["0.006", "isola", "1"]]);
    assert_eq!(rows[2]["status"], "closed");
    assert_eq!(rows.iter().map(|row| &*row["family"]).collect::<Vec<_>>(), ["", "", "1"]);
    assert_eq!(rows[2]["peak_standing"], "at");
    assert!(["penetration", "pressure_beyond", "stable"].iter().all(|c| rows[2][*c].is_empty()));
    let [peak, doubled, shift] =
        ["amplitude_max", "amplitude_2h", "shift_2h"].map(|c| rows[2][c].parse::<f64>().unwrap());
    assert!((doubled / peak - 1.0).abs() < 1e-2 && shift.abs() < 1e-2, "{doubled} for {peak}, {shift}");
    for [own, doubled] in [["omega_min", "omega_min_2h"], ["omega_max", "omega_max_2h"]] {
        let [own, doubled] = [own, doubled].map(|column| rows[2][column].parse::<f64>().unwrap());
        assert!((doubled / own - 1.0).abs() < 1e-2, "{doubled} for {own}");
    }
    assert_eq!([&rows[0]["omega_min_2h"], &rows[2]["contact_omega_min"]], ["", ""]);

    let (columns, rows) = table(&out.join("branches/0.006-isola-1.csv"));
    assert_eq!(
        columns,
        with_later("omega,amplitude,rms,contact,residual,high_harmonics", of_points(), |c| c.branch_csv)
            + ",stable,multiplier"
    );
    assert!(rows.iter().all(|row| row["stable"].is_empty() && row["multiplier"].is_empty()));

    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let isola = isola.branch.as_ref().unwrap();
    let omega = isola.points.motions.omega.values("omega", &[rows.len()]).unwrap();
    let read: Vec<f64> = rows.iter().map(|row| row["omega"].parse().unwrap()).collect();
    assert_eq!(read, omega);
    assert!(rows.iter().all(|row| row["contact"].is_empty()));

    let (columns, rows) = table(&out.join("backbone.csv"));
    let first = "omega,zeta,amplitude,r_lin,r_nl,work_per_amplitude,threshold,contribution_1";
    let later = with_later(first, of_points().chain(of_backbone()), |column| column.backbone_csv);
    assert_eq!(columns, format!("{later},mode"));
    assert_eq!(rows.len(), study.backbone.points.len());
    let threshold: Vec<f64> = rows.iter().map(|row| row["threshold"].parse().unwrap()).collect();
    assert!(threshold.iter().zip(&study.backbone.points).all(|(read, point)| *read == point.threshold()));
}

#[test]
fn what_marching_says_of_a_branch() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, results) = study.finished(&dir.path().join("run"));
    let isola = results.iter().find(|result| result.name == Some(BranchId::isola(0))).unwrap();
    let verification = study.verify(&mut store, isola);
    let out = dir.path().join("csv");
    csv(&store, &out).unwrap();
    let stable = table(&out.join("summary.csv")).1[2]["stable"].parse::<f64>().unwrap();
    assert_eq!(stable, verification.share(Verdict::Stable));
    let rows = table(&out.join("branches/0.006-isola-1.csv")).1;
    let verdicts = verification.verdicts().into_iter().map(|verdict| verdict.map_or("", verdict_name));
    assert!(rows.iter().map(|row| row["stable"].as_str()).eq(verdicts));
    let moduli = verification.moduli();
    assert!(rows.iter().map(|row| row["multiplier"].parse().ok()).eq(moduli));
    let (columns, rows) = table(&out.join("bifurcations.csv"));
    assert_eq!(columns, "forcing,branch,kind,omega,amplitude");
    let omegas: Vec<f64> = rows.iter().map(|row| row["omega"].parse().unwrap()).collect();
    assert_eq!(omegas, verification.bifurcations.iter().map(|found| found.omega).collect::<Vec<_>>());
    assert!(rows.iter().all(|row| row["kind"] == "fold" && row["branch"] == "isola 1" && row["forcing"] == "0.006"));
}

#[test]
fn windows_at_every_stage() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let run = dir.path().join("run");
    let (mut store, mut sweep) = study.begin(&run);
    let export = |store: &Reader| {
        csv(store, dir.path()).unwrap();
        table(&dir.path().join("windows.csv"))
    };
    let (columns, rows) = export(&store);
    assert_eq!(columns, "amplitude,window,omega_min,omega_max,omega_best,threshold,outcome,branch,reason,mode");
    let count = study.plans.iter().map(|plan| plan.windows.len()).sum::<usize>();
    assert_eq!(rows.len(), count);
    assert!(rows.iter().all(|row| row["outcome"] == "pending" && row["reason"].is_empty()));
    assert!(table(&dir.path().join("summary.csv")).1.is_empty());

    while sweep.step(&mut store) {}
    let rows = export(&store).1;
    let last = rows.last().unwrap();
    assert_eq!((last["outcome"].as_str(), last["branch"].as_str(), last["reason"].as_str()), ("found", "isola 1", ""));
    assert_eq!((last["amplitude"].as_str(), &last["window"]), ("0.006", &study.plans[1].windows.len().to_string()));
}

#[test]
fn before_the_backbone() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let store = crate::store::Store::create(&dir.path().join("run"), &study.header()).unwrap();
    csv(&store, dir.path()).unwrap();
    let (columns, rows) = table(&dir.path().join("backbone.csv"));
    let first = "omega,zeta,amplitude,r_lin,r_nl,work_per_amplitude,threshold";
    let later = with_later(first, of_points().chain(of_backbone()), |column| column.backbone_csv);
    assert_eq!(columns, format!("{later},mode"));
    assert!(rows.is_empty());
    let overview = Overview::read(&store, &mut Omissions::default()).unwrap();
    assert!(
        shift(&overview.levels).is_none()
            && overview.levels.iter().all(|level| level.main().is_none() && level.pending == 0)
    );
}

#[test]
fn contact_and_further_monitors() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.02"]), tempdir().unwrap());
    let (store, results) = study.finished(&dir.path().join("run"));
    csv(&store, dir.path()).unwrap();
    let (columns, rows) = table(&dir.path().join("branches/0.02-main-1.csv"));
    let first = "omega,amplitude,rms,contact,residual,high_harmonics,amplitude_x2";
    assert_eq!(columns, with_later(first, of_points(), |column| column.branch_csv) + ",stable,multiplier");
    let points = &results[0].branch.as_ref().unwrap().points;
    let amplitude = points.columns.get("amplitude").unwrap().values("amplitude", &[rows.len(), 2]).unwrap();
    for (row, pair) in rows.iter().zip(amplitude.chunks(2)) {
        assert_eq!([&row["amplitude"], &row["amplitude_x2"]].map(|t| t.parse::<f64>().unwrap()), pair);
    }
    let touching = rows.iter().filter(|row| row["contact"].parse::<f64>().unwrap() > 0.0);
    let omega: Vec<f64> = touching.map(|row| row["omega"].parse().unwrap()).collect();
    let summary = &table(&dir.path().join("summary.csv")).1[0];
    assert!(!omega.is_empty() && omega.len() < rows.len(), "{} of {}", omega.len(), rows.len());
    let range = |pick: fn(f64, f64) -> f64| omega.iter().copied().reduce(pick).unwrap();
    let told = ["contact_omega_min", "contact_omega_max"].map(|key| summary[key].parse::<f64>().unwrap());
    // It begins and ends between points.
    let (low, high) = (range(f64::min), range(f64::max));
    assert!(
        told[0] <= low && low < 1.05 * told[0] && told[1] >= high && high > 0.95 * told[1],
        "{told:?} {low} {high}"
    );
    assert_eq!(table(&dir.path().join("backbone.csv")).0.matches("contribution_").count(), 2);
}

#[test]
fn failures_are_rows() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let (mut store, mut sweep) = study.begin(&dir.path().join("run"));
    // Of the larger level the main branch does not start, of the smaller one it is given up.
    let granted = sweep.lease(&mut store, 0).unwrap();
    let changes = sweep.accept(&granted, TaskResult::Nothing(SeedOutcome::NotTraced(Failure::Diverged.into())));
    store.commit(&changes).unwrap();
    let (task, attempt): (TaskId, _) = ("3e-3-0".parse().unwrap(), Attempt(1));
    let end = AttemptEnd::Failed("worker-1: out of memory".into());
    let changes = [
        Change::Granted { task: task.clone(), attempt, holder: Holder { worker: worker(), slot: 1 } },
        Change::Ended { task: task.clone(), attempt, end },
        Change::Dead { task },
    ];
    store.commit(&changes).unwrap();

    csv(&store, dir.path()).unwrap();
    let rows = table(&dir.path().join("summary.csv")).1;
    let status: Vec<&str> = rows.iter().map(|row| row["status"].as_str()).collect();
    assert_eq!(
        status,
        ["given up: worker-1: out of memory", "landed, but no branch starts there: the iteration diverged"]
    );
    assert!(rows.iter().all(|row| row["kind"] == "main" && row["branch"] == "1" && row["points"].is_empty()));
    let overview = Overview::read(&store, &mut Omissions::default()).unwrap();
    assert_eq!((overview.levels[0].dead, overview.levels[1].dead), (1, 0));
    assert_eq!(overview.levels[1].main_failure.as_deref(), Some(status[1]));
}

#[test]
fn levels_in_numbers() {
    let (study, dir) = (Study::new("nonlinear_damper", 3, &["0.006", "0.0045", "0.007"]), tempdir().unwrap());
    let (store, _) = study.finished(dir.path());
    let overview = Overview::read(&store, &mut Omissions::default()).unwrap();
    let text: Vec<&str> = overview.levels.iter().map(|level| level.amplitude.as_str()).collect();
    assert_eq!(text, ["0.0045", "0.006", "0.007"]);
    for level in &overview.levels {
        assert!(level.main().is_some() && level.main_failure.is_none());
        assert_eq!((level.pending, level.dead), (0, 0));
    }
    assert_eq!(overview.levels.iter().map(|level| level.isolas().count()).collect::<Vec<_>>(), [0, 1, 1]);
    let peaks: Vec<f64> = overview.levels.iter().map(|level| level.peak().unwrap().omega_at_max).collect();
    let largest = peaks.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert_eq!(shift(&overview.levels).unwrap().size(), largest);
}

#[test]
fn numbers_are_short_and_exact() {
    assert_eq!(text(2533.38), "2533.38");
    assert_eq!(text(1.0490e-3), "0.001049");
    assert_eq!(text(1.5e-9), "1.5e-9");
    assert_eq!(text(f64::INFINITY), "inf");
    assert_eq!(text(1e300), "1e300");
}
