//! `REFERENCE.md`: every key in tables.

use super::File;
use super::key::{Absent, Key, Kind};
use std::fmt::Write as _;

const HEAD: &str = "\
# Keys of model.toml and study.toml

`isola schema --all` prints this text, `isola schema --explain KEY` explains one key; `isola schema model` and `isola schema study` print
the same for editors.

SI units. Unknown keys are refused. Every key can be typed after `--set`, entries of lists counted from 0:
`--set contact.nodes.0.gap=1e-4`.

A study may have all keys of a model but `name`; they come over those of `model.toml`. Sections are merged key by key; a list
or an inline table is replaced as a whole. Values typed on the command line come last and reach into lists.
";

/// At the end of the file alone, for whoever changes it.
const WRITTEN: &str = "
<!-- Written by the program: `UPDATE_DOCUMENTS=always cargo test -p coordinator --test coordinator reference`. -->
";

/// The file: what `isola schema --all` prints, and where it comes from.
pub fn file() -> String {
    document() + WRITTEN
}

/// What `isola schema --all` prints.
pub fn document() -> String {
    let mut text = String::from(HEAD);
    let shared = |key: &&Key| File::Model.keys().any(|other| std::ptr::eq(other, *key));
    let chapters: [(&str, Vec<&Key>); 2] = [
        ("model.toml, and study.toml over it", File::Model.keys().collect()),
        ("study.toml alone", File::Study.keys().filter(|key| !shared(key)).collect()),
    ];
    for (title, keys) in chapters {
        let _ = write!(
            text,
            "\n## {title}\n\n| key | value | default | unit | meaning |\n| --- | --- | --- | --- | --- |\n"
        );
        for key in keys {
            let _ = writeln!(text, "{}", row(key));
        }
    }
    text
}

fn row(key: &Key) -> String {
    let default = match key.default {
        Absent::Value(value) => format!("`{value}`"),
        Absent::Words(words) => words.into(),
        Absent::Nothing => String::new(),
        Absent::Required => "required".into(),
    };
    let mut meaning = key.meaning.to_string();
    if let Kind::Word(words) = key.kind {
        let list: Vec<String> = words.iter().map(|(word, what)| format!("`{word}`: {what}")).collect();
        meaning += &format!(" {}.", list.join("; "));
    }
    let cells = [format!("`{}`", key.path), key.kind.words(), default, key.unit.into(), meaning];
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', r"\|")).collect();
    format!("| {} |", cells.join(" | "))
}
