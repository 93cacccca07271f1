//! Settings as types; what serde refuses of them is told in the words of whoever writes such files.

use super::MODEL;
use super::keys::{dotted, set};
use super::layers::Layers;
use crate::settings::SECTIONS;
use crate::structure::ModelError;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

impl Layers {
    /// These settings as a type; refuses keys that it does not know.
    ///
    /// # Errors
    /// Keys that the type does not know, and values of the wrong type.
    pub fn parsed<T: DeserializeOwned>(&self) -> Result<T, ModelError> {
        deserialized(self.table().clone())
            .map_err(|(path, message)| self.no_choice::<T>(&path).unwrap_or_else(|| self.explain(&path, &message)))
    }

    /// If a choice is wanted at a path and what stands there names none: the choices. Serde tells them only of a wrong name.
    fn no_choice<T: DeserializeOwned>(&self, path: &str) -> Option<ModelError> {
        let segments: Vec<String> = dotted(path).split('.').map(str::to_string).collect();
        let found =
            segments.iter().skip(1).try_fold(self.table().get(&segments[0])?, |value, segment| match value {
                Value::Array(list) => list.get(segment.parse::<usize>().ok()?),
                value => value.get(segment),
            })?;
        if found.is_str() || found.is_table() {
            return None;
        }
        let mut table = self.table().clone();
        set(&mut table, &segments, Value::String(String::new())).ok()?;
        let (of, message) = deserialized::<T>(table).err()?;
        let choices = message.trim_end().strip_prefix("unknown variant ``, expected ").filter(|_| of == path)?;
        let remedy = format!("choose {}", choices.replace(", ", " or ").replace("one of ", ""));
        Some(ModelError::value(self.place(path), found, remedy))
    }

    /// Turns serde's account of a refused key into ours: "unknown field `a`, expected one of `b`, `c`".
    fn explain(&self, path: &str, message: &str) -> ModelError {
        let message = message.trim_end();
        let place = self.place(if path == "." { "" } else { path });
        if message.starts_with("unknown field") || message.starts_with("unknown variant") {
            let mut names = message.split('`').skip(1).step_by(2);
            if let Some(name) = names.next() {
                let is_of_model = place.file.as_ref().is_some_and(|file| file.ends_with(MODEL));
                let is_at_top = !path.contains(['.', '[']);
                if is_of_model && (name == "amplitudes" || is_at_top && SECTIONS.contains(&name)) {
                    return ModelError::Type {
                        place,
                        message: "this belongs to a study: move it to study.toml".into(),
                    };
                }
                // Contacts are laws that have a section of their own.
                let known: Vec<&str> = names.filter(|known| *known != "contact" || !path.starts_with("laws")).collect();
                // A choice is called by its key: there is no law, shape, effort of this name.
                let choice = path.rsplit('.').next().unwrap_or(path);
                let what = if message.starts_with("unknown field") { "key" } else { choice };
                let parameter = self.parameter(path, name);
                return ModelError::unknown(place, what, name, known.into_iter().chain(parameter.as_deref()));
            }
        }
        ModelError::Type { place, message: in_words(path, message) }
    }

    /// Where the law of an entry has a parameter that stands beside it, but for a letter more or less: `law.penalty_spring.gap`.
    fn parameter(&self, path: &str, name: &str) -> Option<String> {
        let (position, key) = path.strip_prefix("laws[")?.split_once("].")?;
        let position = position.parse().ok()?;
        let law = self.law(position).filter(|_| key == name)?;
        let parameters = self.table().get("laws")?.get(position)?.get("law")?.get(law)?;
        let is_it = |known: &&String| {
            *known == name || name.len() > 1 && known.len() > 1 && strsim::levenshtein(known, name) == 1
        };
        let meant = parameters.as_table()?.keys().find(is_it)?;
        Some(format!("law.{law}.{meant}"))
    }
}

/// Serde's account of a value that does not fit, in words of the file.
fn in_words(path: &str, message: &str) -> String {
    if let Some(key) = message.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
        return format!("`{key}` is missing, and it has no default");
    }
    if message.starts_with("wanted exactly 1 element") {
        let example = if path.starts_with("laws") {
            "`{penalty_spring = {stiffness = 1, gap = 0.1}}` for a law"
        } else {
            "`{mode = 1}` for a forcing shape"
        };
        return format!("give exactly one choice, like {example}");
    }
    if message == "invalid type: map, expected a sequence" {
        return format!(
            "a single table, where a list of them is expected: each begins with `[[{path}]]`, in double brackets"
        );
    }
    let lengths =
        message.strip_prefix("invalid length ").and_then(|rest| rest.split_once(", expected an array of length "));
    if let Some((found, expected)) = lengths {
        return format!("a list of {found}, where one of {expected} is expected");
    }
    let described = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
    let Some((found, expected)) = described.and_then(|described| described.rsplit_once(", expected ")) else {
        return message.into();
    };
    let found = match found.split_once(' ') {
        Some(("string", text)) => format!("the text {text}"),
        Some(("integer" | "boolean", value)) => value.into(),
        Some(("floating", value)) => value.trim_start_matches("point ").into(),
        _ => found.replace("map", "a table").replace("sequence", "a list"),
    };
    let expected = match expected {
        "f64" if found.contains('%') => "a number: a share of one, 0.02 for 2 %",
        "f64" if has_unit(&found) => "a number without a unit, in SI units (kg, m, s, N, rad): 0.001 for 1 mm",
        "f64" => "a number",
        // An unsigned integer whose sign is wrong is told apart from no integer.
        "usize" | "u32" if found.starts_with("`-") => "a whole number that is not negative",
        "usize" | "u32" => "a whole number",
        "a sequence" => "a list; write it in brackets, `[…]`",
        expected if expected.starts_with("struct ") => "a section or a table of keys",
        expected => expected,
    };
    format!("found {found}, expected {expected}")
}

/// Whether a text is a number with something behind it.
fn has_unit(found: &str) -> bool {
    found.trim_start_matches("the text \"").starts_with(|c: char| c.is_ascii_digit())
}

/// Settings as a type, or the path of what does not fit, with serde's account of it.
fn deserialized<T: DeserializeOwned>(table: Table) -> Result<T, (String, String)> {
    serde_path_to_error::deserialize(Value::Table(table))
        .map_err(|error| (error.path().to_string(), error.inner().message().to_string()))
}
