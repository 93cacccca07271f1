//! Which modes a study follows.

use super::numbers::{NumberList, Numbers};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

/// Modes whose backbones are followed: `"auto"` or a list of numbers, from 1, as `[1, 2]`. The first one is the primary one:
/// scales and phase conditions of forced responses are made of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModeChoice {
    /// The lowest mode that the force drives, and every other one that frequency range and forcing can reach: see [`crate::response::modes`].
    #[default]
    Auto,
    /// These.
    These(NumberList),
}

impl ModeChoice {
    /// This mode alone, by its number from 1.
    pub fn one(number: usize) -> Self {
        Self::These(NumberList::one(number))
    }
}

impl std::fmt::Display for ModeChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::These(list) => list.fmt(f),
        }
    }
}

impl Serialize for ModeChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::These(list) => list.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ModeChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ChoiceVisitor)
    }
}

struct ChoiceVisitor;

const LISTED: Numbers = Numbers { expected: "\"auto\" or a list of mode numbers like [1, 2]" };

impl<'de> Visitor<'de> for ChoiceVisitor {
    type Value = ModeChoice;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(LISTED.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<ModeChoice, E> {
        match text {
            "auto" => Ok(ModeChoice::Auto),
            _ => LISTED.visit_str(text).map(ModeChoice::These),
        }
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<ModeChoice, E> {
        LISTED.visit_u64(number).map(ModeChoice::These)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<ModeChoice, E> {
        LISTED.visit_i64(number).map(ModeChoice::These)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<ModeChoice, A::Error> {
        LISTED.visit_seq(sequence).map(ModeChoice::These)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_a_word_or_a_list() {
        let these = |numbers: &[usize]| ModeChoice::These(NumberList::new(numbers).unwrap());
        for (choice, form, words) in [
            (ModeChoice::Auto, r#""auto""#, "auto"),
            (ModeChoice::one(2), "[2]", "2"),
            (these(&[2, 1]), "[2,1]", "[2, 1]"),
            (these(&[]), "[]", "[]"),
        ] {
            assert_eq!(serde_json::to_string(&choice).unwrap(), form);
            assert_eq!(serde_json::from_str::<ModeChoice>(form).unwrap(), choice);
            assert_eq!(choice.to_string(), words);
        }
        for (form, numbers) in [("2", &[2][..]), (r#""2""#, &[2]), (r#""3, 1""#, &[3, 1])] {
            assert_eq!(serde_json::from_str::<ModeChoice>(form).unwrap(), these(numbers));
        }
        for (form, why) in
            [(r#""all""#, "\"auto\" or a list"), ("-2", "\"auto\" or a list"), ("[-1]", "expected usize")]
        {
            let error = serde_json::from_str::<ModeChoice>(form).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
        let many = format!("{:?}", [1; 17]);
        assert!(
            serde_json::from_str::<ModeChoice>(&many).unwrap_err().to_string().contains("17 numbers: give at most 16")
        );
    }
}
