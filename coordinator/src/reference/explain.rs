//! What `isola schema --explain` says of a key.

use super::File;
use super::key::{Absent, Key, Kind};
use results::export::COLUMNS;
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
    let found: Vec<_> = match whole {
        // The file's name before it, as messages of Python and of other tools have it.
        none if none.is_empty() => match File::ALL.into_iter().find_map(|file| file.within(&wanted)) {
            Some((file, path)) => files.iter().filter(|(key, of)| key.path == path && of.contains(&file)).collect(),
            None => files.iter().filter(|(key, _)| key.name() == wanted).collect(),
        },
        some => some,
    };
    if found.is_empty() {
        if is_word_of_results(asked) {
            let what = "no key of a model or a study, but a word of results or a column of theirs";
            return Err(format!("--explain: `{}`: {what}: `isola schema --columns` explains it", asked.trim()));
        }
        let told = meant_by(&wanted);
        if !told.is_empty() {
            let told: Vec<String> = told.iter().take(SHOWN).map(|path| format!("`{path}`")).collect();
            return Err(format!(
                "--explain: `{wanted}`: no key is called so; what is said of these has the word: {}",
                told.join(", ")
            ));
        }
        let place = solver::structure::Place { file: None, key: wanted.clone(), set_by: Some("--explain".into()) };
        let known = files.iter().map(|(key, _)| key.path);
        return Err(solver::structure::ModelError::unknown(place, "key", &wanted, known).to_string());
    }
    Ok(found.iter().map(|(key, files)| of_key(key, files)).collect::<Vec<_>>().join("\n"))
}

/// More keys than this are not named.
const SHOWN: usize = 8;

/// The keys in whose meanings a word stands.
fn meant_by(word: &str) -> Vec<&'static str> {
    let word = word.to_lowercase();
    let is_there = |text: &str| {
        text.to_lowercase()
            .split(|c: char| !c.is_alphanumeric())
            .any(|one| one == word || one.strip_suffix('s') == Some(&word))
    };
    let is_a_word = word.len() > 2 && word.chars().all(char::is_alphabetic);
    let mut found: Vec<&str> = keys()
        .into_iter()
        .map(|(key, _)| key)
        .filter(|key| is_a_word && is_there(key.meaning))
        .map(|key| key.path)
        .collect();
    found.sort_by_key(|path| path.matches('.').count());
    found.dedup();
    found
}

/// The keys whose last part is this word, or if there is none but for a letter, outside of lists: those with the fewest parts before it.
pub fn keys_called(word: &str) -> Vec<&'static str> {
    let all = keys();
    let is_in_list = |path: &str| {
        let lists = all.iter().filter(|(key, _)| matches!(key.kind, Kind::Tables(_)));
        lists.into_iter().any(|(list, _)| path.strip_prefix(list.path).is_some_and(|rest| rest.starts_with('.')))
    };
    let is_a_key = all.iter().any(|(key, _)| key.name() == word);
    let is_it = |name: &str| if is_a_key { name == word } else { is_but_for_a_letter(name, word) };
    let called = all.iter().map(|(key, _)| *key).filter(|key| is_it(key.name()) && !is_in_list(key.path));
    let depth = |path: &str| path.matches('.').count();
    let fewest = called.clone().map(|key| depth(key.path)).min();
    called.map(|key| key.path).filter(|path| Some(depth(path)) == fewest).collect()
}

/// Whether two words are the same, or would be with one letter more, less, exchanged with its neighbour or with another.
fn is_but_for_a_letter(one: &str, other: &str) -> bool {
    let (one, other): (Vec<char>, Vec<char>) = (one.chars().collect(), other.chars().collect());
    let head = one.iter().zip(&other).take_while(|(a, b)| a == b).count();
    let (a, b) = (&one[head..], &other[head..]);
    let rest = |word: &'_ [char], from: usize| word.get(from..).map(<[char]>::to_vec);
    let swapped = a.len() > 1 && b.len() > 1 && a[0] == b[1] && a[1] == b[0] && a[2..] == b[2..];
    a == b
        || swapped
        || rest(a, 1) == rest(b, 1)
        || rest(a, 1).as_deref() == Some(b)
        || rest(b, 1).as_deref() == Some(a)
}

/// How a key is written, for example; in whichever file.
pub fn example_of(asked: &str) -> Option<String> {
    let wanted = plain(asked);
    let (key, _) = keys().into_iter().find(|(key, _)| key.path == wanted)?;
    let unit = if key.unit.is_empty() { String::new() } else { format!(" ({})", key.unit) };
    Some(example(key)).filter(|text| !text.is_empty()).map(|text| text + &unit)
}

/// Whether the text about words and columns explains it: a word of its own, or a column or a value.
fn is_word_of_results(asked: &str) -> bool {
    let asked = asked.trim().trim_matches('`').to_lowercase();
    let words = COLUMNS.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let mut words = words.flat_map(|words| words.split(", ")).map(|word| word.trim().to_lowercase());
    let is_head = ["word", "column"].contains(&asked.as_str());
    !asked.is_empty() && !is_head && (words.any(|word| word == asked) || COLUMNS.contains(&format!("`{asked}`")))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_results_are_explained_elsewhere() {
        for word in ["status", "family", "main branch", "Fold", "merge", "branched", " omega_min "] {
            let said = explain(word).unwrap_err();
            assert!(said.ends_with("`isola schema --columns` explains it") && said.contains(word.trim()), "{said}");
        }
        let said = explain("stop").unwrap_err();
        assert!(said.contains("`laws.law.penalty_spring`") && said.contains("has the word"), "{said}");
        assert!(explain("gap").is_ok() && explain("harmonics.count").is_ok());
        assert_eq!(explain("study.units"), explain("units"));
        assert_eq!(example_of("contact.nodes.2.gap").unwrap(), "gap = 1e-3 (m)");
        assert_eq!(example_of("harmonics.count").unwrap(), "count = 20");
        assert!(explain("model.units").is_err() && explain("study.").is_err());
        for word in ["gpa", "", "what", "word"] {
            assert!(explain(word).is_err_and(|said| !said.contains("--columns")), "{word}");
        }
    }
}
