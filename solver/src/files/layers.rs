//! Settings of several sources, one over the other, that remember who set what.
//!
//! A section is merged key by key; what stands at a key of a section, list and inline table too, is replaced as a whole.

use super::keys::{dotted, positions, segments, set};
use crate::structure::{ModelError, Place};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Ways to give the same thing: one of them replaces the others that stand in files below.
const WAYS: [&[&[&str]]; 2] = [
    &[&["damping.ratios", "damping.default_ratio"], &["damping.rayleigh"], &["matrices.damping"]],
    &[&["backbone.modes"], &["backbone.mode"]],
];

/// Who set a key.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Source {
    File(PathBuf),
    /// As typed: `--set contact.friction=0`.
    Typed(String),
}

/// Settings of a file with others over them.
#[derive(Debug, Clone, Default)]
pub struct Layers {
    /// The file below all, if there is one.
    file: Option<PathBuf>,
    table: Table,
    /// Dotted keys in the order they were set: the last one counts.
    set: Vec<(String, Source)>,
    /// Dotted keys that gave something in another way and were left out, each behind the key that replaced it.
    replaced: Vec<(String, String)>,
}

impl Layers {
    /// Reads a file of settings; `remedy` says what to do if it cannot be read.
    pub(super) fn read(file: &Path, remedy: &str) -> Result<Self, ModelError> {
        let text = std::fs::read_to_string(file).map_err(|source| ModelError::Read {
            place: Place { file: Some(file.to_path_buf()), key: String::new(), set_by: None },
            source,
            remedy: remedy.into(),
        })?;
        Self::parse(file, &text)
    }

    /// Settings from the text of a file.
    ///
    /// # Errors
    /// A text that is not TOML.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ModelError> {
        let syntax = |e: toml::de::Error| {
            let line = e.span().and_then(|span| Some(text.get(..span.start)?.matches('\n').count()));
            let has_comma = line.and_then(|line| text.lines().nth(line)).is_some_and(has_decimal_comma);
            let hint = if has_comma { "\nnumbers have a decimal point, as in 0.1" } else { "" };
            let account = e.to_string();
            // It begins with where it is.
            let account = account.trim_end().trim_start_matches("TOML parse error ");
            ModelError::Syntax { file: file.into(), message: format!("{account}{hint}") }
        };
        let table: Table = text.parse().map_err(syntax)?;
        let source = Source::File(file.to_path_buf());
        let set = leaves(&table).into_iter().map(|key| (key, source.clone())).collect();
        Ok(Self { file: Some(file.to_path_buf()), table, set, ..Self::default() })
    }

    /// The settings as they stand.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Takes those top-level keys away that `belongs` accepts.
    pub fn split(&mut self, belongs: impl Fn(&str) -> bool) -> Self {
        let first = |key: &str| key.split('.').next().is_some_and(&belongs);
        let (table, rest) = std::mem::take(&mut self.table).into_iter().partition(|(key, _)| belongs(key));
        let (set, others) = std::mem::take(&mut self.set).into_iter().partition(|(key, _)| first(key));
        (self.table, self.set) = (rest, others);
        Self { file: self.file.clone(), table, set, ..Self::default() }
    }

    /// What files say that was left out, since something over it gives the same in another way: pairs of the key that replaced it, and
    /// of its own.
    pub fn replaced(&self) -> &[(String, String)] {
        &self.replaced
    }

    /// Puts the settings of another file over these.
    pub fn merge(&mut self, over: Self) {
        for (key, _) in &over.set {
            self.supersede(key);
        }
        for (key, value) in over.table {
            match (self.table.get_mut(&key), value) {
                (Some(Value::Table(section)), Value::Table(entries)) => section.extend(entries),
                (_, value) => drop(self.table.insert(key, value)),
            }
        }
        self.set.extend(over.set);
    }

    /// Puts one value over these settings: a dotted key (entries of lists by their `name`, or counted from 0) and a TOML
    /// value as typed after `option`. A bare word that is not a TOML value is a string.
    ///
    /// # Errors
    /// A key that is not dotted, or that reaches into a value without keys or entries.
    pub fn set(&mut self, option: &str, key: &str, typed: &str) -> Result<(), ModelError> {
        let by = format!("{option} {key}={typed}");
        let refused = |message| {
            let place = Place { file: None, key: key.to_string(), set_by: Some(by.as_str().into()) };
            ModelError::Type { place, message }
        };
        let segments = positions(&self.table, segments(key).map_err(refused)?);
        let dotted = segments.join(".");
        self.supersede(&dotted);
        set(&mut self.table, &segments, value(typed)).map_err(refused)?;
        self.set.push((dotted, Source::Typed(by)));
        Ok(())
    }

    /// The value of a dotted key without entries of lists, as it stands.
    pub fn value(&self, key: &str) -> Option<&Value> {
        let (sections, name) = key.rsplit_once('.').unwrap_or(("", key));
        let mut sections = sections.split('.').filter(|section| !section.is_empty());
        sections.try_fold(&self.table, |table, section| table.get(section)?.as_table())?.get(name)
    }

    /// Puts what a value of such a key means in its place. Who set it stays as it is.
    pub fn replace(&mut self, key: &str, meant: Value) {
        let (sections, name) = key.rsplit_once('.').unwrap_or(("", key));
        let mut sections = sections.split('.').filter(|section| !section.is_empty());
        let table = sections.try_fold(&mut self.table, |table, section| table.get_mut(section)?.as_table_mut());
        if let Some(value) = table.and_then(|table| table.get_mut(name)) {
            *value = meant;
        }
    }

    /// Whether anybody set this key, one above or one below.
    pub fn given(&self, key: &str) -> bool {
        self.source(key).is_some()
    }

    /// Place of a key, for messages.
    pub fn place(&self, key: impl Into<String>) -> Place {
        let key = key.into();
        match self.source(&key) {
            Some(Source::Typed(by)) => Place { file: None, set_by: Some(by.as_str().into()), key },
            Some(Source::File(file)) => Place { file: Some(file.clone()), set_by: None, key },
            None => Place { file: self.file.clone(), set_by: None, key },
        }
    }

    /// Place of the contents of another file that this key names.
    pub(super) fn place_in(&self, file: PathBuf, key: &str) -> Place {
        let set_by = match self.source(key) {
            Some(Source::Typed(by)) => Some(by.as_str().into()),
            Some(Source::File(by)) if self.file.as_ref() != Some(by) => Some(by.display().to_string().into()),
            _ => None,
        };
        Place { file: Some(file), key: key.to_string(), set_by }
    }

    /// Refuses a section, by its dotted key, that is given as something else: serde would take a list for its keys in order.
    ///
    /// # Errors
    /// A section of these that is no table.
    pub fn check_sections(&self, sections: &[&str]) -> Result<(), ModelError> {
        for key in sections {
            let mut parts = key.split('.');
            let top = parts.next().and_then(|part| self.table.get(part));
            let given = parts.try_fold(top, |value, part| value.map(|value| value.get(part)));
            if let Some(value) = given.flatten().filter(|value| !value.is_table()) {
                let usual = if *key == "harmonics" && value.is_integer() { "count" } else { "key" };
                let written = if usual == "count" { value.to_string() } else { "value".into() };
                let remedy =
                    format!("this is a section: write [{key}] and its keys below, or {key}.{usual} = {written}");
                return Err(ModelError::value(self.place(*key), value, remedy));
            }
        }
        Ok(())
    }

    /// What the law of this number, from 0, is called.
    pub(super) fn law(&self, i: usize) -> Option<&str> {
        let entry = self.table.get("laws")?.get(i)?;
        entry.get("law")?.as_table()?.keys().next().map(String::as_str)
    }

    /// Refuses a law whose parameters are given without their names.
    ///
    /// # Errors
    /// A law of the list that is no table of parameters.
    pub(super) fn check_laws(&self) -> Result<(), ModelError> {
        let list = self.table.get("laws").and_then(Value::as_array).into_iter().flatten().enumerate();
        for (i, law) in list.filter_map(|(i, entry)| Some((i, entry.get("law")?.as_table()?))) {
            if let Some((name, value)) = law.iter().find(|(_, parameters)| !parameters.is_table()) {
                let remedy = "give the parameters of the law by their names, like {stiffness = 1, limit = 0.1}";
                return Err(ModelError::value(self.place(format!("laws[{i}].law.{name}")), value, remedy));
            }
        }
        Ok(())
    }

    /// The last one who set this key, one above or one below.
    fn source(&self, key: &str) -> Option<&Source> {
        let dotted = dotted(key);
        let related = |set: &str| below(&dotted, set) || below(set, &dotted);
        self.set.iter().rev().find(|(set, _)| related(set)).map(|(_, source)| source)
    }

    /// Removes what files say about something if `key` gives it in another way.
    fn supersede(&mut self, key: &str) {
        let gives = |keys: &[&str]| keys.iter().any(|k| below(key, k));
        let Some(ways) = WAYS.into_iter().find(|ways| ways.iter().any(|keys| gives(keys))) else { return };
        for other in ways.iter().filter(|keys| !gives(keys)).flat_map(|keys| *keys) {
            if let Some((section, entry)) = other.split_once('.')
                && matches!(self.source(other), Some(Source::File(_)))
                && let Some(Value::Table(section)) = self.table.get_mut(section)
            {
                if section.remove(entry).is_some() {
                    self.replaced.push((key.to_string(), (*other).to_string()));
                }
                self.set.retain(|(set, _)| !below(set, other));
            }
        }
    }
}

/// Dotted keys of a file: those of sections, and of values outside of sections.
fn leaves(table: &Table) -> Vec<String> {
    let mut keys = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(section) => keys.extend(section.keys().map(|entry| format!("{key}.{entry}"))),
            _ => keys.push(key.clone()),
        }
    }
    keys
}

/// Whether a line of a file gives a key a number with a decimal comma.
fn has_decimal_comma(line: &str) -> bool {
    line.split('=').skip(1).any(|value| {
        let rest = value.trim_start().trim_start_matches(['+', '-']).trim_start_matches(|c: char| c.is_ascii_digit());
        let begins = value.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
        begins && rest.strip_prefix(',').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    })
}

/// Whether a dotted key is `root` or below it.
fn below(key: &str, root: &str) -> bool {
    key.strip_prefix(root).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// A value as typed on a command line: TOML, or else a bare word.
fn value(text: &str) -> Value {
    text.parse().unwrap_or_else(|_| Value::String(text.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_lists_have_names() {
        let text =
            "[[laws]]\nname = \"joint\"\nlaw.jenkins.limit = 1\n[[laws]]\nname = \"upper stop\"\n[[laws]]\ndof = \"x\"";
        let mut layers = parse("model.toml", text);
        layers.set("--set", "laws.\"upper stop\".law.penalty_spring.gap", "3").unwrap();
        layers.set("--set", "laws.joint.law.jenkins.limit", "2").unwrap();
        layers.set("--set", "laws.2.dof", "y").unwrap();
        let laws = &layers.table()["laws"];
        assert_eq!(laws[0]["law"]["jenkins"]["limit"].as_integer(), Some(2));
        assert_eq!(laws[1]["law"]["penalty_spring"]["gap"].as_integer(), Some(3));
        assert_eq!(laws[2]["dof"].as_str(), Some("y"));
        // Messages know who set it.
        let place = layers.place("laws[0].law.jenkins.limit").to_string();
        assert_eq!(place, "--set laws.joint.law.jenkins.limit=2: `laws[0].law.jenkins.limit`");
        let refused = layers.set("--set", "laws.lower.dof", "x").unwrap_err().to_string();
        let said = "`lower` is not an entry of a list of 3, counted from 0, nor the name of one: `joint`, `upper stop`";
        assert!(refused.contains(said), "{refused}");
    }

    fn parse(file: &str, text: &str) -> Layers {
        Layers::parse(Path::new(file), text).unwrap()
    }

    #[test]
    fn a_place_knows_who_set_it() {
        let mut layers =
            parse("model.toml", "dofs = [\"a\"]\n[contact]\ngap = 1\nfriction = 2\n[[contact.nodes]]\ngap = 3");
        layers.merge(parse("study.toml", "[contact]\nfriction = 0"));
        layers.set("--set", "contact.nodes.0.gap", "5").unwrap();
        let place = |key: &str| layers.place(key).to_string();
        assert_eq!(place("contact.gap"), "model.toml: `contact.gap`");
        assert_eq!(place("contact.friction"), "study.toml: `contact.friction`");
        assert_eq!(place("contact.nodes[0].gap"), "--set contact.nodes.0.gap=5: `contact.nodes[0].gap`");
        assert_eq!(place("contact.nodes[1].gap"), "model.toml: second entry of contact.nodes: `contact.nodes[1].gap`");
        assert_eq!(place("contact.epsilon"), "model.toml: `contact.epsilon`");
        assert!(layers.given("contact") && !layers.given("contact.epsilon") && !layers.given("cont"));
        layers.set("--set", "matrices", "{mass = \"m.mtx\"}").unwrap();
        let matrix = layers.place_in("m.mtx".into(), "matrices.mass").to_string();
        assert_eq!(matrix, "m.mtx: `matrices.mass` (set by --set matrices={mass = \"m.mtx\"})");
    }

    #[test]
    fn sections_merge_by_key_and_values_are_replaced() {
        let mut layers = parse("a", "x = [1, 2]\n[s]\nkept = 1\nshape = {mode = 1}\n[t]\nu = 1");
        layers.merge(parse("b", "x = [3]\n[s]\nshape = {constant = 2}\n[v]\nw = 2"));
        let expected = "x = [3]\n[s]\nkept = 1\nshape = {constant = 2}\n[t]\nu = 1\n[v]\nw = 2";
        assert_eq!(layers.table(), parse("c", expected).table());
        let taken = layers.split(|key| key == "s");
        assert_eq!(taken.table(), parse("c", "s = {kept = 1, shape = {constant = 2}}").table());
        assert!(taken.given("s.kept") && !layers.given("s") && layers.given("x"));
    }

    #[test]
    fn modes_that_are_typed_replace_those_of_a_file() {
        for (written, typed, expected) in
            [("mode = 2", "backbone.modes", "modes = [1]"), ("modes = [2, 3]", "backbone.mode", "mode = [1]")]
        {
            let mut layers = parse("study.toml", &format!("[backbone]\n{written}\nmax_points = 9"));
            layers.set("--set", typed, "[1]").unwrap();
            let expected = format!("[backbone]\nmax_points = 9\n{expected}");
            assert_eq!(layers.table(), parse("x", &expected).table());
        }
    }

    #[test]
    fn one_way_to_give_the_damping_replaces_the_others() {
        let below = "[matrices]\ndamping = [[1]]\nmass = [[1]]\n[damping]\nratios = []\ndefault_ratio = 0.1";
        let mut layers = parse("model.toml", below);
        layers.merge(parse("study.toml", "[damping]\nrayleigh = {mass = 1}"));
        let expected = "[matrices]\nmass = [[1]]\n[damping]\nrayleigh = {mass = 1}";
        assert_eq!(layers.table(), parse("x", expected).table());
        layers.set("--set", "damping.default_ratio", "0.2").unwrap();
        assert_eq!(layers.table(), parse("x", "[matrices]\nmass = [[1]]\n[damping]\ndefault_ratio = 0.2").table());
        // What was left out is known.
        let replaced: Vec<String> = layers.replaced().iter().map(|(by, other)| format!("{by}: {other}")).collect();
        let by_study = ["damping.ratios", "damping.default_ratio", "matrices.damping"];
        let mut expected: Vec<String> = by_study.iter().map(|other| format!("damping.rayleigh: {other}")).collect();
        expected.push("damping.default_ratio: damping.rayleigh".into());
        assert_eq!(replaced, expected);
        // Two that were typed contradict each other.
        layers.set("--set", "damping.rayleigh.mass", "1").unwrap();
        assert_eq!(layers.table()["damping"].as_table().unwrap().len(), 2);
    }
}
