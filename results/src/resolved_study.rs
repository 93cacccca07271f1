//! The keys of a resolved study, and what changed between two.

use std::collections::BTreeMap;
use std::fmt;
use toml::{Table, Value};

/// Key of the units in which a run is shown.
pub const UNITS: &str = "units";

/// A key whose values differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Dotted key; entries of lists are called by their names, or counted from 0.
    pub key: String,
    /// The value before, as TOML; long lists are shortened. `not given` if the key was missing.
    pub old: String,
    /// The value after, likewise.
    pub new: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} → {}", self.key, self.old, self.new)
    }
}

/// Keys whose values differ between two texts of resolved studies, in alphabetical order. A
/// text that is not TOML differs as a whole. In which units tables are shown is no difference.
pub fn differences(old_resolved: &str, new_resolved: &str) -> Vec<Difference> {
    let (old, new) = match (old_resolved.parse::<Table>(), new_resolved.parse::<Table>()) {
        (Ok(old), Ok(new)) => (flatten(old), flatten(new)),
        _ if old_resolved == new_resolved => return Vec::new(),
        (old, new) => {
            let what = |readable| if readable { "a study" } else { "not readable as a study" }.to_string();
            return vec![Difference { key: "study".into(), old: what(old.is_ok()), new: what(new.is_ok()) }];
        }
    };
    let mut keys: Vec<&String> = old.keys().chain(new.keys()).collect();
    keys.retain(|key| *key != UNITS);
    keys.sort();
    keys.dedup();
    let pairs = keys.into_iter().map(|key| (key, old.get(key), new.get(key)));
    pairs
        .filter(|(_, old, new)| match (old, new) {
            (Some(old), Some(new)) => !same(old, new),
            _ => true,
        })
        .map(|(key, old, new)| {
            let (old, new) = shown(old, new);
            Difference { key: key.clone(), old, new }
        })
        .collect()
}

/// A text of a resolved study with other forcing amplitudes, each as typed.
///
/// # Errors
/// If the text is not TOML.
pub fn with_amplitudes(resolved: &str, amplitudes: &[&str]) -> Result<String, toml::de::Error> {
    let mut table: Table = resolved.parse()?;
    let list = amplitudes.iter().map(|&amplitude| Value::from(amplitude)).collect();
    table.insert("amplitudes".into(), Value::Array(list));
    Ok(table.to_string())
}

/// Dotted keys with their values as TOML, in alphabetical order, of a text of
/// resolved studies; none of a text that is not TOML. Long lists are shortened.
pub fn settings(resolved: &str) -> Vec<(String, String)> {
    let flat = resolved.parse::<Table>().map(flatten).unwrap_or_default();
    flat.iter().map(|(key, value)| (key.clone(), shown(Some(value), None).0)).collect()
}

/// Dotted keys with their values; lists of tables are taken apart, their entries by their names where each has one of its own, others
/// are values.
fn flatten(table: Table) -> BTreeMap<String, Value> {
    let mut flat = BTreeMap::new();
    let mut open: Vec<(String, Value)> = table.into_iter().collect();
    while let Some((key, value)) = open.pop() {
        match value {
            Value::Table(table) => {
                open.extend(table.into_iter().map(|(name, value)| (format!("{key}.{name}"), value)));
            }
            Value::Array(list) if !list.is_empty() && list.iter().all(Value::is_table) => {
                let places = places(&list);
                open.extend(places.into_iter().zip(list).map(|(place, value)| (format!("{key}.{place}"), value)));
            }
            value => drop(flat.insert(key, value)),
        }
    }
    flat
}

/// What the entries of a list of tables are called: as they name themselves if each does, in a name of its own, else by their places.
fn places(list: &[Value]) -> Vec<String> {
    let names: Vec<&str> = list.iter().filter_map(|entry| entry.get("name")?.as_str()).collect();
    let is_alone = |name: &&&str| names.iter().filter(|other| other == name).count() == 1;
    match names.len() == list.len() && names.iter().all(|name| is_alone(&name)) {
        true => names.into_iter().map(String::from).collect(),
        false => (0..list.len()).map(|i| i.to_string()).collect(),
    }
}

/// Equal values; 1 and 1.0 are the same number.
fn same(a: &Value, b: &Value) -> bool {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|i| i as f64));
    match (a, b) {
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        _ => a == b || number(a).is_some_and(|a| number(b).is_some_and(|b| a.total_cmp(&b).is_eq())),
    }
}

/// Two values as texts; of long lists the part that differs.
fn shown(old: Option<&Value>, new: Option<&Value>) -> (String, String) {
    let text = |value: Option<&Value>| value.map_or("not given".to_string(), Value::to_string);
    let (Some(Value::Array(a)), Some(Value::Array(b))) = (old, new) else {
        let list = |value: Option<&Value>| match value {
            Some(Value::Array(entries)) => part(entries, 0, entries.len()),
            other => text(other),
        };
        return (list(old), list(new));
    };
    let head = a.iter().zip(b).take_while(|(a, b)| same(a, b)).count();
    let rest = a.len().min(b.len()) - head;
    let tail = a.iter().rev().zip(b.iter().rev()).take(rest).take_while(|(a, b)| same(a, b)).count();
    (part(a, head, a.len() - tail), part(b, head, b.len() - tail))
}

/// A list, or of a long one the entries from `start` to `end` with a neighbour.
fn part(list: &[Value], start: usize, end: usize) -> String {
    /// Entries that are shown.
    const SHOWN: usize = 8;
    // Forcing amplitudes are kept as they were typed.
    let text = |entry: &Value| match entry.as_str() {
        Some(number) if number.parse::<f64>().is_ok() => number.to_string(),
        _ => entry.to_string(),
    };
    let texts = |entries: &[Value]| entries.iter().map(text).collect::<Vec<_>>();
    if list.len() <= SHOWN {
        return format!("[{}]", texts(list).join(", "));
    }
    let (start, end) = (start.saturating_sub(1), (end + 1).min(list.len()));
    let mut entries = texts(&list[start..end]);
    if entries.len() > SHOWN {
        entries.splice(SHOWN - 1..entries.len() - 1, ["…".to_string()]);
    }
    let (before, after) = (if start > 0 { "…, " } else { "" }, if end < list.len() { ", …" } else { "" });
    format!("[{before}{}{after}] ({} entries)", entries.join(", "), list.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_show_what_differs() {
        let list = |levels: &[&str]| format!("amplitudes = [{}]", levels.join(", "));
        let old: Vec<String> = (1..=100).map(|i| i.to_string()).collect();
        let old: Vec<&str> = old.iter().map(String::as_str).collect();
        let mut new = old.clone();
        new[50] = "51.5";
        let all = differences(&list(&old), &list(&new));
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].old, "[…, 50, 51, 52, …] (100 entries)");
        assert_eq!(all[0].new, "[…, 50, 51.5, 52, …] (100 entries)");
        let shorter = differences(&list(&old), &list(&old[..99]));
        assert_eq!((&*shorter[0].old, &*shorter[0].new), ("[…, 99, 100] (100 entries)", "[…, 99] (99 entries)"));
        let other = differences(&list(&old), &list(&["1"]));
        assert_eq!((&*other[0].old, &*other[0].new), ("[1, 2, 3, 4, 5, 6, 7, …, 100] (100 entries)", "[1]"));
        assert!(differences("units = 'Hz'", "units = 'mm'").is_empty());
        let typed = differences("amplitudes = ['1e-3', '2']", "amplitudes = ['1e-3']");
        assert_eq!((&*typed[0].old, &*typed[0].new), ("[1e-3, 2]", "[1e-3]"));
        // 1 and 1.0 are the same; a text that is not TOML differs from everything but itself.
        assert!(differences("a = 1\nb = [2]", "a = 1.0\nb = [2.0]").is_empty());
        assert_eq!(differences("a = [", "a = 1")[0].old, "not readable as a study");
        assert!(differences("a = [", "a = [").is_empty());
    }
    #[test]
    fn laws_are_called_by_their_names() {
        let law = |name: &str, gap: f64| {
            format!("[[laws]]\nname = '{name}'\nlaw = {{ penalty_spring = {{ gap = {gap} }} }}\n")
        };
        let laws = |list: &[(&str, f64)]| list.iter().map(|&(name, gap)| law(name, gap)).collect::<String>();
        let keys = |old: &[(&str, f64)], new: &[(&str, f64)]| -> Vec<String> {
            differences(&laws(old), &laws(new)).into_iter().map(|one| one.key).collect()
        };
        let (low, high) = (("lower stop", 0.1), ("upper stop", 0.2));
        let gap = "laws.upper stop.law.penalty_spring.gap";
        assert_eq!(keys(&[low, high], &[low, ("upper stop", 0.3)]), [gap]);
        // Their order says nothing.
        assert_eq!(keys(&[low, high], &[high, low]), Vec::<String>::new());
        assert_eq!(keys(&[low, low], &[low, ("lower stop", 0.3)]), ["laws.1.law.penalty_spring.gap"]);
    }
}
