//! Dotted keys: their parts, and where they lead in a table.

use toml::{Table, Value};

/// A path with its positions in lists as parts like others.
pub(super) fn dotted(path: &str) -> String {
    path.replace('[', ".").replace(']', "")
}

/// Parts of a dotted key; quotes protect a dot inside of a part, as in TOML.
pub(super) fn segments(key: &str) -> Result<Vec<String>, String> {
    let malformed = || {
        r#"not a dotted key; write it like `contact.friction`, a name with a space or a dot in quotes: `laws."upper stop".name`"#.to_string()
    };
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

/// A key with the positions of entries of lists in place of their names.
pub(super) fn positions(table: &Table, mut segments: Vec<String>) -> Vec<String> {
    let mut parent = segments.first().and_then(|first| table.get(first));
    for segment in segments.iter_mut().skip(1) {
        if let Some(Value::Array(list)) = parent
            && let Some(position) = names(list).position(|name| name == Some(segment.as_str()))
        {
            *segment = position.to_string();
        }
        parent = parent.and_then(|parent| match parent {
            Value::Array(list) => list.get(segment.parse::<usize>().ok()?),
            other => other.get(segment.as_str()),
        });
    }
    segments
}

/// What the entries of a list are called.
fn names(list: &[Value]) -> impl Iterator<Item = Option<&str>> {
    list.iter().map(|entry| entry.get("name").and_then(Value::as_str))
}

pub(super) fn set(table: &mut Table, segments: &[String], value: Value) -> Result<(), String> {
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
            let named: Vec<String> = names(list).flatten().map(String::from).collect();
            let entry = segment.parse().ok().and_then(|i: usize| list.get_mut(i));
            let named: Vec<String> = named.into_iter().map(|name| format!("`{name}`")).collect();
            let named =
                if named.is_empty() { String::new() } else { format!(", nor the name of one: {}", named.join(", ")) };
            entry.ok_or_else(|| format!("`{segment}` is not an entry of a list of {length}, counted from 0{named}"))
        }
        other => Err(format!("`{segment}` is looked for inside of `{other}`, which is neither a section nor a list")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn merged(text: &str, key: &str, typed: &str) -> Result<Table, String> {
        let mut table: Table = text.parse().unwrap();
        set(&mut table, &segments(key)?, typed.parse().unwrap_or_else(|_| Value::String(typed.into()))).map(|()| table)
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
}
