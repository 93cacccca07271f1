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
        set(&mut table, key, value(text)).map_err(|problem| ModelError::Override {
            key: key.to_string(),
            value: text.to_string(),
            problem,
        })?;
        origin.overridden.push(key.to_string());
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

fn set(table: &mut Table, key: &str, value: Value) -> Result<(), String> {
    let mut segments: Vec<&str> = key.split('.').collect();
    let last = segments.pop().unwrap_or_default();
    if last.is_empty() || segments.iter().any(|s| s.is_empty()) {
        return Err("the key is empty or has an empty part; write it like `contact.friction`".into());
    }
    let Some((first, rest)) = segments.split_first() else {
        table.insert(last.into(), value);
        return Ok(());
    };
    let mut current = table.entry(*first).or_insert_with(|| Value::Table(Table::new()));
    for segment in rest {
        current = child(current, segment)?;
    }
    *child(current, last)? = value;
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
    let place = origin.place(if path == "." { "model" } else { path });
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        let mut names = message.split('`').skip(1).step_by(2);
        if let Some(name) = names.next() {
            let known: Vec<&str> = names.collect();
            return ModelError::unknown(place, name, known);
        }
    }
    ModelError::Type { place, message: message.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn merged(text: &str, key: &str, typed: &str) -> Result<Table, String> {
        let mut table: Table = text.parse().unwrap();
        set(&mut table, key, value(typed)).map(|()| table)
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
        assert!(merged(text, "a..b", "5").unwrap_err().contains("empty part"));
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
