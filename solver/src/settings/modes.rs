//! Which modes a study follows.

use serde::de::{Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

/// Modes whose backbones are followed: `"auto"` or a list of numbers, from 1, as `[1, 2]`. The first one is the primary one:
/// scales and phase conditions of forced responses are made of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModeChoice {
    /// Mode 1, and every other one that frequency range and forcing can reach: see [`crate::response::modes`].
    #[default]
    Auto,
    /// These.
    These(ModeList),
}

/// Up to [`ModeList::MOST`] numbers of modes, from 1, in the order given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeList {
    count: usize,
    numbers: [usize; ModeList::MOST],
}

impl ModeList {
    /// Most modes of a list.
    pub const MOST: usize = 16;

    /// A list of these numbers, from 1; `None` of more than [`ModeList::MOST`].
    pub fn new(numbers: &[usize]) -> Option<Self> {
        let mut list = Self { count: numbers.len(), numbers: [0; Self::MOST] };
        list.numbers.get_mut(..numbers.len())?.copy_from_slice(numbers);
        Some(list)
    }

    /// The numbers, from 1.
    pub fn numbers(&self) -> &[usize] {
        &self.numbers[..self.count]
    }
}

impl ModeChoice {
    /// This mode alone, by its number from 1.
    pub fn one(number: usize) -> Self {
        let mut numbers = [0; ModeList::MOST];
        numbers[0] = number;
        Self::These(ModeList { count: 1, numbers })
    }

    /// Number, from 1, of the primary mode; 0 of an empty list.
    pub fn primary(&self) -> usize {
        match self {
            Self::Auto => 1,
            Self::These(list) => list.numbers[0],
        }
    }
}

impl std::fmt::Display for ModeChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::These(list) => match list.numbers() {
                [only] => write!(f, "{only}"),
                numbers => write!(f, "{numbers:?}"),
            },
        }
    }
}

impl Serialize for ModeChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::These(list) => list.numbers().serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ModeChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ChoiceVisitor)
    }
}

struct ChoiceVisitor;

impl<'de> Visitor<'de> for ChoiceVisitor {
    type Value = ModeChoice;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"auto\" or a list of mode numbers like [1, 2]")
    }

    /// A list as typed in a shell, too: `1,2`.
    fn visit_str<E: Error>(self, text: &str) -> Result<ModeChoice, E> {
        let typed = || text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<Vec<usize>>>();
        match text {
            "auto" => Ok(ModeChoice::Auto),
            _ => these(typed().ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))?),
        }
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<ModeChoice, E> {
        Ok(ModeChoice::one(usize::try_from(number).unwrap_or(usize::MAX)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<ModeChoice, E> {
        let number = usize::try_from(number).map_err(|_| E::invalid_value(Unexpected::Signed(number), &self))?;
        Ok(ModeChoice::one(number))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<ModeChoice, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = sequence.next_element()? {
            numbers.push(number);
        }
        these(numbers)
    }
}

fn these<E: Error>(numbers: Vec<usize>) -> Result<ModeChoice, E> {
    let too_many = || E::custom(format!("{} modes: give at most {}", numbers.len(), ModeList::MOST));
    ModeList::new(&numbers).map(ModeChoice::These).ok_or_else(too_many)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_a_word_or_a_list() {
        let these = |numbers: &[usize]| ModeChoice::These(ModeList::new(numbers).unwrap());
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
        assert_eq!([ModeChoice::Auto.primary(), these(&[3, 1]).primary(), these(&[]).primary()], [1, 3, 0]);
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
            serde_json::from_str::<ModeChoice>(&many).unwrap_err().to_string().contains("17 modes: give at most 16")
        );
    }
}
