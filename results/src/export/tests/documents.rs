//! The tables of columns in the documents follow from the list of the solver. `UPDATE_DOCUMENTS=always` writes them anew.

use solver::response::columns::{Axis, Column, Csv, of_backbone, of_backbone_in_files, of_points};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Shape of the array of a column.
fn shape(column: &Column, modes: &str) -> String {
    match column.axis {
        Axis::Point => "p".into(),
        Axis::Monitors => "p × monitors".into(),
        Axis::Contacts => "p × contacts".into(),
        Axis::Modes => format!("p × {modes}"),
    }
}

/// The meaning of a column in a cell of a table.
fn meaning(column: &Column) -> String {
    column.description().replace('|', r"\|")
}

/// Rows of `EXPORTS.md`, of a group.
fn exported(group: &str, list: impl Iterator<Item = &'static Column>) -> String {
    let row = |column: &Column| {
        format!("| `{group}{}` | real | {} | {} |\n", column.name, shape(column, "modes"), meaning(column))
    };
    list.map(row).collect()
}

/// Rows of `MESSAGES.md`.
fn sent(list: impl Iterator<Item = &'static Column>) -> String {
    let later = |column: &Column| if column.is_later { "; absent from earlier programs" } else { "" };
    let row = |column: &Column| {
        format!("| `{}` | array {} | {}{} |\n", column.name, shape(column, "n"), meaning(column), later(column))
    };
    list.map(row).collect()
}

/// The document with these rows after the line that begins with the first text, up to one that begins with the second, or
/// an empty one.
fn with_rows(document: &str, (after, before): (&str, &str), rows: &str) -> String {
    let lines: Vec<&str> = document.split_inclusive('\n').collect();
    let start = lines.iter().position(|line| line.starts_with(after)).unwrap_or_else(|| panic!("no line {after}")) + 1;
    let is_end = |line: &&str| line.starts_with(before) || line.trim().is_empty();
    let end = start + lines[start..].iter().position(is_end).unwrap();
    lines[..start].concat() + rows + &lines[end..].concat()
}

fn assert_rows(file: &str, expected: impl Fn(&str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let document = fs::read_to_string(&path).unwrap();
    let expected = expected(&document);
    if std::env::var("UPDATE_DOCUMENTS").is_ok_and(|value| value == "always") {
        fs::write(&path, &expected).unwrap();
    } else {
        assert!(document == expected, "{file} has other columns than the list: UPDATE_DOCUMENTS=always writes them");
    }
}

#[test]
fn tables_of_columns_are_those_of_the_list() {
    assert_rows("EXPORTS.md", |document| {
        let backbone = exported("backbone.", of_points().chain(of_backbone_in_files()));
        let document = with_rows(document, ("| `backbone.displacement`", "| `windows."), &backbone);
        with_rows(&document, ("| `displacement`", "| `displacement_dofs`"), &exported("", of_points()))
    });
    assert_rows("../protocol/MESSAGES.md", |document| {
        let document = with_rows(document, ("| `motions` | *motions* | |", "\n"), &sent(of_points()));
        with_rows(&document, ("| `points` | *points* | |", "\n"), &sent(of_backbone()))
    });
}

/// Names in the first column of the tables of a section of `COLUMNS.md`.
fn documented(section: &str) -> Vec<&'static str> {
    let text = crate::export::COLUMNS.split("\n## ").find(|text| text.starts_with(section));
    let rows = text.unwrap_or_else(|| panic!("no section {section}")).lines().filter(|line| line.starts_with("| `"));
    rows.flat_map(|row| row.split('|').nth(1).unwrap_or_default().split('`').skip(1).step_by(2)).collect()
}

#[test]
fn words_have_a_meaning() {
    let words: Vec<(&str, &str)> = crate::export::words().collect();
    assert!(words.len() > 15 && words.iter().all(|(word, what)| !word.is_empty() && what.len() > 10), "{words:?}");
    assert!(words.iter().any(|(word, _)| *word == "main branch"));
}

/// What is said of stability and of events elsewhere is explained under the same words.
#[test]
fn words_of_stability_and_events_are_explained() {
    use crate::overview::{EVENTS, NOT_KNOWN, VERDICTS};
    let words: Vec<(&str, &str)> = crate::export::words().collect();
    let meaning = |word: &str| words.iter().find(|(known, _)| *known == word).map(|(_, what)| *what);
    for verdict in VERDICTS {
        let told = meaning(verdict.word).unwrap_or_else(|| panic!("{} is not explained", verdict.word));
        assert!(told.starts_with(verdict.meaning), "{told}");
        let column = crate::export::COLUMNS.lines().find(|line| line.starts_with("| `stable` | `stable`")).unwrap();
        let name = if verdict.name.is_empty() { "empty: not verified".into() } else { format!("`{}`", verdict.name) };
        assert!(column.contains(&name), "{name}: {column}");
    }
    assert!(meaning(NOT_KNOWN).is_some());
    let events = meaning("birth, death, merge").unwrap();
    assert!(EVENTS.iter().all(|event| events.contains(event.verb)), "{events}");
}

#[test]
fn columns_of_files_are_explained() {
    use crate::export::files::{SUMMARY, WINDOWS};
    use crate::export::listed::{bifurcations, events, folds, motions, pushes};
    let found = [folds(&[]), events(&[], &[]), bifurcations(&[], |_| 0.0)];
    let beyond = [motions(&[], |_| 0.0), pushes(&[], |_| 0.0, &[])];
    let sections: [(&str, Vec<Vec<&str>>); 4] = [
        ("`summary.csv`", vec![SUMMARY.to_vec()]),
        ("`windows.csv`", vec![WINDOWS.to_vec()]),
        ("`folds.csv`, `events.csv`, `bifurcations.csv`", found.map(|list| list.names()).to_vec()),
        ("`motions.csv`, `pushes.csv`", beyond.map(|list| list.names()).to_vec()),
    ];
    for (section, files) in sections {
        let mut told = documented(section);
        let mut written = files.concat();
        for list in [&mut told, &mut written] {
            list.sort_unstable();
            list.dedup();
        }
        assert_eq!(told, written, "{section}");
    }
    let csv = |name: &str, csv: Csv| match csv {
        Csv::No => None,
        Csv::Every("contribution") => Some("contribution_J".to_string()),
        Csv::Every(_) | Csv::One => Some(name.to_string()),
    };
    let of_branch = of_points().filter_map(|column| csv(column.name, column.branch_csv));
    let of_backbone = of_backbone_in_files().filter_map(|column| csv(column.name, column.backbone_csv));
    let others = ["omega", "zeta", "amplitude_NAME", "stable", "multiplier", "mode"].map(String::from);
    let written: BTreeSet<String> = of_branch.chain(of_backbone).chain(others).collect();
    let told = documented("`branches/A-KIND-N.csv`, `backbone.csv`").into_iter().map(String::from);
    assert_eq!(told.collect::<BTreeSet<String>>(), written);
}
