//! Motions of several orders in one run: those of order m last m periods of the force.

use crate::BRIEF;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::{TempDir, tempdir};
use tests::{complaint, isola, repository, results};

const STUDY: &str = "models/duffing_subharmonic/study.toml";

/// Bounds of the force, of which a third is that of the motion in the study.
const BOUNDS: &[&str] = &["--set", "frequency.min=0.6", "--set", "frequency.max=7.5"];

fn sweep(folder: &TempDir, name: &str, more: &[&str]) -> (PathBuf, Output) {
    let run = folder.path().join(name);
    let (study, out) = (repository(STUDY), run.to_str().unwrap());
    let output = isola(&[&["sweep", study.to_str().unwrap(), "--out", out, "--workers", "2"], BRIEF, more].concat());
    (run, output)
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", complaint(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Rows of `summary.csv` that are of isolas.
fn isolas(folder: &Path) -> Vec<String> {
    let summary = std::fs::read_to_string(folder.join("summary.csv")).unwrap();
    summary.lines().filter(|line| line.contains(",isola,")).map(String::from).collect()
}

#[test]
fn an_order_has_what_the_structure_forced_on_its_harmonic_has() {
    let folder = tempdir().unwrap();
    let (alone, output) = sweep(&folder, "alone", &["--amplitudes", "1.5,2"]);
    let of_response = "frequencies in rad/s (of the response: the force has 3 times as much)";
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&text(&output)).contains(of_response));
    let (run, output) = sweep(
        &folder,
        "orders",
        &[&["--amplitudes", "1.5", "--orders", "1,3", "--set", "forcing.harmonic=1"], BOUNDS].concat(),
    );
    let table = text(&output);
    assert!(table.contains("Motions that last 3 periods of the force"), "{table}");
    // Main branches are of the first order alone, and so is what heads their column.
    assert!(table.matches("┆ main peak").count() == 1 && !words(&table).contains("of the response:"), "{table}");
    // One window, one isola, to the last bit; none of the force's own period.
    assert_eq!(isolas(&run.join("m3")), isolas(&alone)[..1]);
    assert!(isolas(&run).is_empty(), "{:?}", isolas(&run));
    assert!(run.join("m3/branches/1.5-isola-1.csv").exists() && run.join("branches/1.5-main-1.csv").exists());
    let mains = std::fs::read_to_string(run.join("m3/summary.csv")).unwrap().matches(",main,").count();
    assert_eq!(mains, 0);

    // A level that is added is one of every order.
    let run_text = run.to_str().unwrap();
    text(&isola(&["extend", run_text, "--amplitudes", "2", "--workers", "2"]));
    assert_eq!(isolas(&run.join("m3")), isolas(&alone));

    for (format, files) in
        [("npz", ["run.npz", "m3/branches/2-isola-1.npz"]), ("mat", ["m3/run.mat", "branches/2-main-1.mat"])]
    {
        let to = folder.path().join(format);
        let exported = isola(&["export", run_text, "--format", format, "--to", to.to_str().unwrap()]);
        let named = text(&exported);
        let further = format!("run.{format} and branches/ of motions of order 3 are in {}", to.join("m3").display());
        assert!(named.contains(&further), "{named}");
        assert!(!complaint(&exported).contains("left out"), "{}", complaint(&exported));
        assert!(files.iter().all(|file| to.join(file).exists()), "{format}");
    }

    // Lines are broken between words.
    let report = text(&isola(&["report", run_text])).replace('\n', " ");
    let told = "Of motions that last 3 periods of the force isolas were found at 2 levels, from A = 1.5 to 2";
    assert!(report.contains(told), "{report}");
    assert!(run.join("report.html").exists() && run.join("m3/report.html").exists());
    let own = "This is of motions of the force's own period.";
    assert!(
        report.contains(own) && report.contains("This is of motions that last 3 periods of the force; frequencies are theirs, the force has 3 times as much."),
        "{report}"
    );
    // Pages lead to each other where they were written together.
    text(&isola(&["report", run_text, "--order", "3"]));
    let single = folder.path().join("single.html");
    text(&isola(&["report", run_text, "--order", "3", "-o", single.to_str().unwrap()]));
    let both = folder.path().join("both.html");
    text(&isola(&["report", run_text, "-o", both.to_str().unwrap()]));
    for (file, pages) in [
        (both, [(1, true, None), (3, false, Some("./both-m3.html"))].as_slice()),
        (folder.path().join("both-m3.html"), &[(1, true, Some("./both.html")), (3, false, None)]),
        (run.join("report.html"), &[(1, true, None), (3, false, Some("m3/report.html"))]),
        (run.join("m3/report.html"), &[(1, true, Some("../report.html")), (3, false, None)]),
        (single, &[(3, false, None)]),
    ] {
        let page = |(order, is_first, file): &(usize, bool, Option<&str>)| {
            let file = file.map_or("null".into(), |file| format!("{file:?}"));
            format!(r#"{{"order":{order},"is_first":{is_first},"file":{file}}}"#)
        };
        let pages = format!(r#""orders":[{}]"#, pages.iter().map(page).collect::<Vec<_>>().join(","));
        assert!(fs::read_to_string(&file).unwrap().contains(&pages), "{}: {pages}", file.display());
    }
    // What is compared is of one order.
    let alone_text = alone.to_str().unwrap();
    let compared = isola(&["report", run_text, alone_text]);
    assert_eq!(compared.status.code(), Some(2), "{}", complaint(&compared));
    let said = complaint(&compared);
    assert!(said.contains("`alone` has motions of order 3 (forcing.harmonic = 3)"), "{said}");
    assert!(said.contains("with --order 3 they can be compared"), "{said}");
    // Only a folder that is one has a status.
    let outer = isola(&["status", folder.path().to_str().unwrap()]);
    assert_eq!(outer.status.code(), Some(2), "{}", complaint(&outer));
    assert!(complaint(&outer).contains("is no run, but holds some: ") && complaint(&outer).contains(run_text));
    let nowhere = folder.path().join("nowhere/report.html");
    let lost = isola(&["report", run_text, "-o", nowhere.to_str().unwrap()]);
    assert!(complaint(&lost).contains("there is no folder "), "{}", complaint(&lost));
    text(&isola(&["report", run_text, alone_text, "--order", "3"]));
    let picture = folder.path().join("response.svg");
    let plot = |order: &str| {
        isola(&["plot", run_text, "--figure", "response", "--order", order, "-o", picture.to_str().unwrap()])
    };
    text(&plot("3"));
    let drawn = std::fs::read_to_string(&picture).unwrap();
    text(&plot("1"));
    assert_ne!(drawn, std::fs::read_to_string(&picture).unwrap());
    // A branch that another order has is found there.
    let picture_text = picture.to_str().unwrap();
    let motion = |more: &[&str]| {
        isola(&[&["plot", run_text, "--figure", "motion", "--at", "2/isola 1", "-o", picture_text], more].concat())
    };
    let said = complaint(&motion(&[]));
    assert!(said.contains("A = 2 has no such branch, but main; there is one of order 3: --order 3"), "{said}");
    text(&motion(&["--order", "3"]));
    let refused = plot("2");
    assert_eq!(refused.status.code(), Some(2), "{}", complaint(&refused));
    assert!(complaint(&refused).contains("the run looks for motions of order 1, 3"), "{}", complaint(&refused));
}

/// An order may have no motion at all, and a bound that is given alone is one of all orders.
#[test]
fn an_order_without_motions() {
    let folder = tempdir().unwrap();
    let more = ["--amplitudes", "0.1", "--orders", "1,2", "--set", "forcing.harmonic=1", "--set", "frequency.max=2"];
    let (run, output) = sweep(&folder, "nothing", &more);
    let table = text(&output);
    assert!(table.starts_with("Motions of the period of the force\n"), "{table}");
    let run_text = run.to_str().unwrap();
    let left_out = || results::text(&run, "SELECT hex(value) FROM meta WHERE key = 'orders'");
    let before = left_out();
    let report = text(&isola(&["report", run_text, "--order", "2"])).replace('\n', " ");
    let said = "No such motion was found where it was looked for";
    assert_eq!(report.matches(said).count(), 3, "{report}");
    assert!(report.contains("Looked for: "), "{report}");
    text(&isola(&["extend", run_text, "--amplitudes", "0.2", "--workers", "1"]));
    assert!(left_out().len() > before.len() / 2, "what is known of the order is gone");
}

#[test]
fn orders_that_cannot_be_are_refused() {
    let folder = tempdir().unwrap();
    for (orders, why) in [
        ("0,1", "motions last 1 period of the force or more"),
        ("3,1", "in ascending order"),
        ("1,1", "in ascending order"),
        ("1,22", "harmonics.count = 21 is too few"),
        ("one", "a list of numbers like [1, 2]"),
    ] {
        let (run, output) = sweep(&folder, "refused", &["--orders", orders]);
        assert_eq!(output.status.code(), Some(2), "{orders}: {}", complaint(&output));
        assert!(complaint(&output).contains("search.harmonics"), "{orders}: {}", complaint(&output));
        assert!(complaint(&output).contains(why), "{orders}: {}", complaint(&output));
        assert!(!run.exists());
    }
}
