//! Forcing amplitudes, as written and as numbers.
//!
//! A study gives them as a list, `[20, 60, 100]`, or as a text, `"20, 60, 100"`. An entry that is a text may be a range
//! `"start:stop:step"`, which includes both ends: `"20:140:20"`, its amplitudes named by the shortest decimals that are
//! their values. The order is kept.

use super::entry::{EXAMPLE, Refusal, number};
use super::range;
use crate::reference::MAX_LEVELS;
use protocol::to_everyone::Amplitude;
use solver::structure::{ModelError, Place};
use std::collections::HashMap;
use toml::de::{DeTable, DeValue};

/// Amplitudes as typed after an option.
///
/// # Errors
/// If they are none, with what would be right.
pub fn typed(option: &str, text: &str) -> Result<Vec<Amplitude>, ModelError> {
    let place = || Place { file: None, key: "amplitudes".into(), set_by: Some(option.into()) };
    let entries = match text.trim() {
        text if text.starts_with(['[', '"', '\'']) => DeValue::parse(text)
            .map_err(|e| Refusal::new(text, format!("not a TOML value ({}); {EXAMPLE}", e.message())))
            .and_then(|value| entries(value.get_ref())),
        text => Ok(pieces(text)),
    };
    entries.and_then(levels).map_err(|refusal| ModelError::value(place(), refusal.value, refusal.remedy))
}

/// Amplitudes in the text of a study file.
pub(super) fn written(text: &str, place: impl Fn() -> Place) -> Result<Vec<Amplitude>, ModelError> {
    // Parsed once more, because a TOML value does not know how a number was written.
    let (table, _) = DeTable::parse_recoverable(text);
    let value = table.get_ref().iter().find(|(key, _)| key.get_ref() == "amplitudes");
    let Some((_, value)) = value else {
        let is_there =
            |value: &DeValue<'_>| value.as_table().is_some_and(|section| section.get("amplitudes").is_some());
        let section = table.get_ref().iter().find(|(_, value)| is_there(value.get_ref()));
        let remedy = match section {
            Some((section, _)) => {
                format!(
                    "one stands in the section [{}]: move it above the first section of the file",
                    section.get_ref()
                )
            }
            None => format!("which forcing amplitudes? {EXAMPLE}; or type --amplitudes 20:140:20"),
        };
        return Err(ModelError::missing(place(), remedy));
    };
    entries(value.get_ref())
        .and_then(levels)
        .map_err(|refusal| ModelError::value(place(), refusal.value, refusal.remedy))
}

/// Numbers and ranges of a TOML value, as written.
fn entries(value: &DeValue<'_>) -> Result<Vec<String>, Refusal> {
    let DeValue::Array(list) = value else { return scalar(value) };
    let nested: Result<Vec<_>, _> = list.iter().map(|entry| scalar(entry.get_ref())).collect();
    Ok(nested?.concat())
}

fn scalar(value: &DeValue<'_>) -> Result<Vec<String>, Refusal> {
    match value {
        DeValue::String(text) => Ok(pieces(text)),
        DeValue::Integer(number) if number.radix() == 10 => Ok(vec![number.as_str().into()]),
        DeValue::Integer(number) => Err(Refusal::new(number.to_string(), "write the number in decimal")),
        DeValue::Float(number) => Ok(vec![number.as_str().into()]),
        other => Err(Refusal::new(format!("({})", other.type_str()), EXAMPLE)),
    }
}

fn pieces(text: &str) -> Vec<String> {
    text.split(',').map(|entry| entry.trim().to_string()).collect()
}

/// Amplitudes of numbers and ranges.
fn levels(entries: Vec<String>) -> Result<Vec<Amplitude>, Refusal> {
    let mut levels: Vec<Amplitude> = Vec::new();
    for entry in &entries {
        if entry.contains(':') {
            levels.extend(range::expand(entry)?);
        } else {
            let value = number(entry)?;
            levels.push(Amplitude { text: entry.strip_prefix('+').unwrap_or(entry).into(), value });
        }
        if levels.len() > MAX_LEVELS {
            return Err(Refusal::new(entry, format!("more than {MAX_LEVELS} levels; split the study")));
        }
    }
    if levels.is_empty() {
        return Err(Refusal::new("[]", format!("at least one forcing amplitude is needed: {EXAMPLE}")));
    }
    let mut seen = HashMap::with_capacity(levels.len());
    for Amplitude { text, value } in &levels {
        if let Some(first) = seen.insert(value.to_bits(), text) {
            return Err(Refusal::new(text, format!("this level is there already, as {first}; give every level once")));
        }
    }
    Ok(levels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<String> {
        typed("--amplitudes", text).unwrap().into_iter().map(|level| level.text).collect()
    }

    #[test]
    fn entries_keep_their_text_and_their_order() {
        assert_eq!(texts("60,20"), ["60", "20"]);
        assert_eq!(texts("20"), ["20"]);
        assert_eq!(texts("1e-3, 0.50,+7"), ["1e-3", "0.50", "7"]);
        assert_eq!(texts("[1_000, 1e-3, \"5:10:5\"]"), ["1000", "1e-3", "5", "10"]);
        assert_eq!(texts("200, 20:40:20"), ["200", "20", "40"]);
        assert_eq!(typed("--amplitudes", "1e-3").unwrap()[0].value, 1e-3);
    }

    #[test]
    fn a_file_gives_them_in_the_same_ways() {
        let texts = |text: &str| -> Vec<String> {
            let place = || Place { file: None, key: "amplitudes".into(), set_by: None };
            written(text, place).unwrap().into_iter().map(|level| level.text).collect()
        };
        assert_eq!(texts("name = \"x\"\namplitudes = [1e-3, 0.50, \"7\"]\n[harmonics]"), ["1e-3", "0.50", "7"]);
        assert_eq!(texts("amplitudes = \"20:60:20\""), ["20", "40", "60"]);
        assert_eq!(texts("amplitudes = 20.0"), ["20.0"]);
    }

    #[test]
    fn wrong_ones_are_refused() {
        let cases = [
            ("", "(nothing)", "empty"),
            ("20,,40", "(nothing)", "empty"),
            ("[]", "[]", "at least one"),
            ("0", "0", "above zero"),
            ("-5", "-5", "above zero"),
            ("nan", "nan", "finite"),
            ("1e999", "1e999", "finite"),
            ("twenty", "twenty", "not a number"),
            ("[true]", "(boolean)", "give a list"),
            ("[0x10]", "0x10", "decimal"),
            ("[[20]]", "(array)", "give a list"),
            ("[20", "[20", "not a TOML value"),
            ("20,40,2e1", "2e1", "already, as 20"),
            ("20:60:20,40", "40", "already, as 40"),
            ("1:60000:1,100001:160000:1", "100001:160000:1", "100000"),
        ];
        for (text, value, remedy) in cases {
            let message = typed("--amplitudes", text).unwrap_err().to_string();
            assert!(message.starts_with(&format!("--amplitudes: `amplitudes` = {value}: ")), "{text}: {message}");
            assert!(message.contains(remedy) && message.lines().count() == 1, "{text}: {message}");
        }
    }
}
