//! From the text of `model.toml` and overrides to raw settings.

use super::config::Config;
use super::error::{ModelError, Place};
use std::path::PathBuf;
use toml::{Table, Value};

/// Where settings come from, for messages.
#[derive(Debug, Default)]
pub(super) struct Origin {
    /// `model.toml`; none for a model built from matrices at hand.
    pub file: Option<PathBuf>,
    /// Keys that overrides set.
    pub overridden: Vec<String>,
}

impl Origin {
    /// Place of a key. An override of a table counts for the keys below it and the other way round.
    pub fn place(&self, key: impl Into<String>) -> Place {
        let key = key.into();
        let dotted = key.replace('[', ".").replace(']', "");
        let below = |a: &str, b: &str| a.strip_prefix(b).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        let overridden = self.overridden.iter().any(|set| below(&dotted, set) || below(set, &dotted));
        Place { file: self.file.clone(), key, overridden }
    }
}

/// Parses settings, merges overrides and checks that every key is known.
pub(super) fn read(file: PathBuf, text: &str, overrides: &[(&str, &str)]) -> Result<(Config, Origin), ModelError> {
    let mut table: Table =
        text.parse().map_err(|e: toml::de::Error| ModelError::Syntax { file: file.clone(), message: e.to_string() })?;
    let mut origin = Origin { file: Some(file), overridden: Vec::new() };
    for (key, text) in overrides {
        let refused = |problem| ModelError::Override { key: key.to_string(), value: text.to_string(), problem };
        let segments = segments(key).map_err(refused)?;
        set(&mut table, &segments, value(text)).map_err(refused)?;
        origin.overridden.push(segments.join("."));
    }
    match serde_path_to_error::deserialize(Value::Table(table)) {
        Ok(config) => Ok((config, origin)),
        Err(error) => Err(explain(&origin, &error.path().to_string(), error.inner().message())),
    }
}

/// A value as typed on a command line: TOML, or else a bare word.
fn value(text: &str) -> Value {
    text.parse().unwrap_or_else(|_| Value::String(text.to_string()))
}

/// Parts of a dotted key; quotes protect a dot inside of a part, as in TOML.
fn segments(key: &str) -> Result<Vec<String>, String> {
    let malformed =
        || "not a dotted key; write it like `contact.friction`, a dof name with a dot in quotes".to_string();
    let mut current = Value::Table(format!("{key} = 0").parse().map_err(|_| malformed())?);
    let mut segments = Vec::new();
    while let Value::Table(table) = current {
        let mut entries = table.into_iter();
        let (Some((segment, inner)), None) = (entries.next(), entries.next()) else { return Err(malformed()) };
        segments.push(segment);
        current = inner;
    }
    if current.as_integer() == Some(0) { Ok(segments) } else { Err(malformed()) }
}

fn set(table: &mut Table, segments: &[String], value: Value) -> Result<(), String> {
    let Some((first, rest)) = segments.split_first() else { return Ok(()) };
    let empty = || Value::Table(Table::new());
    let mut current = table.entry(first.as_str()).or_insert_with(empty);
    for segment in rest {
        current = child(current, segment)?;
    }
    *current = value;
    Ok(())
}

/// Entry of a table, created when missing, or of a list.
fn child<'v>(parent: &'v mut Value, segment: &str) -> Result<&'v mut Value, String> {
    match parent {
        Value::Table(table) => Ok(table.entry(segment).or_insert_with(|| Value::Table(Table::new()))),
        Value::Array(list) => {
            let length = list.len();
            let entry = segment.parse().ok().and_then(|i: usize| list.get_mut(i));
            entry.ok_or_else(|| format!("`{segment}` is not an entry of a list of {length}, counted from 0"))
        }
        other => Err(format!("`{segment}` is looked for inside of `{other}`, which is neither a section nor a list")),
    }
}

/// Turns serde's account of a refused key into ours: "unknown field `a`, expected one of `b`, `c`".
fn explain(origin: &Origin, path: &str, message: &str) -> ModelError {
    let message = message.trim_end();
    let place = origin.place(if path == "." { "" } else { path });
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        let mut names = message.split('`').skip(1).step_by(2);
        if let Some(name) = names.next() {
            let known: Vec<&str> = names.collect();
            return ModelError::unknown(place, name, known);
        }
    }
    let message = if message.starts_with("wanted exactly 1 element") {
        "give exactly one choice, like `{mode = 1}` for a forcing shape".to_string()
    } else {
        message
            .replace("expected f64", "expected a number")
            .replace("expected usize", "expected a whole number, 0 or more")
    };
    ModelError::Type { place, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn merged(text: &str, key: &str, typed: &str) -> Result<Table, String> {
        let mut table: Table = text.parse().unwrap();
        set(&mut table, &segments(key)?, value(typed)).map(|()| table)
    }

    #[test]
    fn overrides_replace_create_and_reach_into_lists() {
        let text = "[a]\nb = 1\n[[c.d]]\ne = 1\n[[c.d]]\ne = 2";
        assert_eq!(merged(text, "a.b", "-1").unwrap()["a"]["b"].as_integer(), Some(-1));
        assert_eq!(merged(text, "a.b", "1e7").unwrap()["a"]["b"].as_float(), Some(1e7));
        assert_eq!(merged(text, "a.b", "K_tuned.mtx").unwrap()["a"]["b"].as_str(), Some("K_tuned.mtx"));
        assert_eq!(merged(text, "a.b", "\"quoted\"").unwrap()["a"]["b"].as_str(), Some("quoted"));
        assert_eq!(merged(text, "new.key", "{x = 1}").unwrap()["new"]["key"]["x"].as_integer(), Some(1));
        assert_eq!(merged(text, "top", "true").unwrap()["top"].as_bool(), Some(true));
        assert_eq!(merged(text, "c.d.1.e", "5").unwrap()["c"]["d"][1]["e"].as_integer(), Some(5));
        assert!(merged(text, "c.d.2.e", "5").unwrap_err().contains("list of 2"));
        assert!(merged(text, "a.b.c", "5").unwrap_err().contains("neither a section nor a list"));
        assert!(merged(text, "a..b", "5").unwrap_err().contains("not a dotted key"));
        assert!(merged(text, "a = 1 #", "5").unwrap_err().contains("not a dotted key"));
        assert_eq!(merged(text, "new.\"b0.r\"", "5").unwrap()["new"]["b0.r"].as_integer(), Some(5));
    }

    #[test]
    fn a_place_knows_whether_it_was_overridden() {
        let origin = Origin { file: None, overridden: vec!["contact.nodes.0.gap".into(), "forcing".into()] };
        assert!(origin.place("contact.nodes[0].gap").overridden);
        assert!(origin.place("forcing.harmonic").overridden);
        assert!(!origin.place("contact.nodes[1].gap").overridden);
        assert!(!origin.place("forc").overridden);
    }
}
