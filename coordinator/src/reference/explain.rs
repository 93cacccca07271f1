//! What `isola schema --explain` says of a key.

use super::File;
use super::key::{Absent, Key, Kind};
use std::fmt::Write as _;

/// What a key means: its place, kind, unit, range and default, and the keys below it. Positions in lists are passed over.
/// The last part of a key alone will do, where several end so all of them are explained.
///
/// # Errors
/// A key that is not there, with those that look like it.
pub fn explain(asked: &str) -> Result<String, String> {
    let wanted = plain(asked);
    let files: Vec<(&Key, Vec<File>)> = keys();
    let whole: Vec<_> = files.iter().filter(|(key, _)| key.path == wanted).collect();
    let found = if whole.is_empty() { files.iter().filter(|(key, _)| key.name() == wanted).collect() } else { whole };
    if found.is_empty() {
        let place = solver::structure::Place { file: None, key: wanted.clone(), set_by: Some("--explain".into()) };
        let known = files.iter().map(|(key, _)| key.path);
        return Err(solver::structure::ModelError::unknown(place, &wanted, known).to_string());
    }
    Ok(found.iter().map(|(key, files)| of_key(key, files)).collect::<Vec<_>>().join("\n"))
}

/// Without positions in lists, in whichever way they are written, and without quotes.
fn plain(asked: &str) -> String {
    let asked = asked.replace('[', ".").replace([']', '"', '\'', ' '], "");
    let parts = asked.split('.').filter(|part| !part.is_empty() && part.parse::<usize>().is_err());
    parts.collect::<Vec<_>>().join(".")
}

/// All keys, each with the files that it may stand in. The same path may mean something else in the other file.
fn keys() -> Vec<(&'static Key, Vec<File>)> {
    let mut list: Vec<(&Key, Vec<File>)> = Vec::new();
    for file in File::ALL {
        for key in file.keys() {
            match list.iter_mut().find(|(known, _)| std::ptr::eq(*known, key)) {
                Some((_, files)) => files.push(file),
                None => list.push((key, vec![file])),
            }
        }
    }
    list
}

fn of_key(key: &Key, files: &[File]) -> String {
    let names: Vec<&str> = files.iter().map(|file| file.name()).collect();
    let mut text = format!("{}    ({})\n  {}\n", key.path, names.join(", "), key.meaning);
    let mut line = |what: &str, words: &str| {
        if !words.is_empty() {
            let _ = writeln!(text, "  {what:<9}{words}");
        }
    };
    line("value", &key.kind.words());
    line("unit", key.unit);
    line(
        "default",
        match key.default {
            Absent::Value(text) | Absent::Words(text) => text,
            Absent::Nothing => "",
            Absent::Required => "none: it must be given",
        },
    );
    line("example", &example(key));
    if let Kind::Word(words) = key.kind {
        words.iter().for_each(|(word, meaning)| line("", &format!("{word}: {meaning}")));
    }
    if let Some(file) = files.first().filter(|_| key.has_keys()) {
        let below: Vec<&str> = file.keys_of(Some(key.path)).map(Key::name).collect();
        line("keys", &below.join(", "));
    }
    text
}

fn example(key: &Key) -> String {
    if key.example.is_empty() { String::new() } else { format!("{} = {}", key.name(), key.example) }
}
