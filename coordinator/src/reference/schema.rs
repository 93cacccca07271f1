//! The JSON Schema of a file, as editors read it.

use super::File;
use super::key::{Absent, Key, Kind, List, Range, Tables};
use serde_json::{Map, Value, json};

/// Schema (draft 7) of a file; without one, of whatever is either of them.
pub fn schema(file: Option<File>) -> Value {
    let mut schema = match file {
        Some(file) => of_table(file, None),
        None => {
            let [model, study] = File::ALL.map(|file| of_table(file, None));
            object([("anyOf", json!([model, study]))])
        }
    };
    schema.insert("$schema".into(), "http://json-schema.org/draft-07/schema#".into());
    let title = file.map_or_else(|| File::ALL.map(File::name).join(" or "), |file| file.name().into());
    schema.insert("title".into(), title.into());
    Value::Object(schema)
}

fn object<const N: usize>(entries: [(&str, Value); N]) -> Map<String, Value> {
    entries.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

/// A table; without a path the whole file.
fn of_table(file: File, path: Option<&str>) -> Map<String, Value> {
    let keys: Vec<&Key> = file.keys_of(path).collect();
    let properties: Map<String, Value> =
        keys.iter().map(|key| (key.name().to_string(), Value::Object(of_key(file, key)))).collect();
    // Amplitudes may be typed instead.
    let required = keys.iter().filter(|key| key.default == Absent::Required && key.path != "amplitudes");
    let required: Vec<&str> = required.map(|key| key.name()).collect();
    let mut table = object([
        ("type", "object".into()),
        ("properties", Value::Object(properties)),
        ("additionalProperties", false.into()),
    ]);
    if !required.is_empty() {
        table.insert("required".into(), required.into());
    }
    table
}

fn of_key(file: File, key: &Key) -> Map<String, Value> {
    let mut schema = match key.kind {
        Kind::Table => of_table(file, Some(key.path)),
        Kind::Choice => {
            let mut table = of_table(file, Some(key.path));
            table.extend(object([("minProperties", 1.into()), ("maxProperties", 1.into())]));
            table
        }
        Kind::Tables(Tables { exactly_one, fewest }) => {
            let mut entry = of_table(file, Some(key.path));
            if !exactly_one.is_empty() {
                let only = |name: &&str| json!({ "required": [name] });
                entry.insert("oneOf".into(), exactly_one.iter().map(only).collect());
            }
            let mut list = object([("type", "array".into()), ("items", Value::Object(entry))]);
            if fewest > 0 {
                list.insert("minItems".into(), fewest.into());
            }
            list
        }
        kind => of_kind(&kind),
    };
    schema.insert("description".into(), description(key).into());
    if let Absent::Value(text) = key.default
        && let Some(value) = value(text)
    {
        schema.insert("default".into(), value);
    }
    if let Some(value) = value(key.example) {
        schema.insert("examples".into(), json!([value]));
    }
    schema
}

fn of_kind(kind: &Kind) -> Map<String, Value> {
    match kind {
        Kind::Text => object([("type", "string".into())]),
        Kind::Pattern(pattern) => object([("type", "string".into()), ("pattern", (*pattern).into())]),
        Kind::Word(words) => object([("enum", words.iter().map(|(word, _)| *word).collect())]),
        Kind::Truth => object([("type", "boolean".into())]),
        Kind::Whole(range) => numbers("integer", range),
        Kind::Number(range) => numbers("number", range),
        Kind::OneOf(values) => object([("enum", values.iter().copied().map(number).collect())]),
        Kind::List(list) => of_list(list),
        Kind::ByDof(range) => object([
            ("type", "object".into()),
            ("additionalProperties", Value::Object(numbers("number", range))),
            ("minProperties", 1.into()),
        ]),
        Kind::Either(kinds) => object([("anyOf", kinds.iter().map(|kind| Value::Object(of_kind(kind))).collect())]),
        Kind::Table | Kind::Choice | Kind::Tables(_) => object([]),
    }
}

fn of_list(list: &List) -> Map<String, Value> {
    let mut schema = object([("type", "array".into()), ("items", Value::Object(of_kind(&list.of)))]);
    if list.fewest > 0 {
        schema.insert("minItems".into(), list.fewest.into());
    }
    if let Some(most) = list.most {
        schema.insert("maxItems".into(), most.into());
    }
    if list.distinct {
        schema.insert("uniqueItems".into(), true.into());
    }
    schema
}

fn numbers(kind: &str, range: &Range) -> Map<String, Value> {
    let mut schema = object([("type", kind.into())]);
    let bounds = [(range.low, ["exclusiveMinimum", "minimum"]), (range.high, ["exclusiveMaximum", "maximum"])];
    for (bound, words) in bounds {
        if let Some((value, included)) = bound {
            schema.insert(words[usize::from(included)].into(), number(value));
        }
    }
    if !range.zero {
        schema.insert("not".into(), json!({ "const": 0 }));
    }
    schema
}

/// A number as people write it: whole ones without a point.
fn number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 { (value as i64).into() } else { value.into() }
}

/// Everything that is known of the key, as an editor shows it.
fn description(key: &Key) -> String {
    let mut text = key.meaning.to_string();
    if let Kind::Word(words) = key.kind {
        let list: Vec<String> = words.iter().map(|(word, meaning)| format!("{word}: {meaning}")).collect();
        text += &format!(" {}.", list.join("; "));
    }
    if !key.unit.is_empty() {
        text += &format!(" Unit: {}.", key.unit);
    }
    if let Absent::Words(words) = key.default {
        text += &format!(" Default: {words}.");
    }
    text
}

/// A value of a file as JSON has it.
fn value(text: &str) -> Option<Value> {
    let value: toml::Value = text.parse().ok()?;
    serde_json::to_value(value).ok()
}
