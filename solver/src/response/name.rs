//! Names of the branches of a level.

use crate::response::branch::BranchKind;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

/// Names a branch of a level. Messages say `"main"` for the first main branch, and `{"isola": 0}` for any other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BranchId {
    /// Kind.
    pub kind: BranchKind,
    /// Number within level and kind, from 0.
    pub number: usize,
}

impl BranchId {
    /// The first main branch, usually the only one.
    pub const MAIN: Self = Self::new(BranchKind::Main, 0);

    /// The branch of this kind and this number, from 0.
    pub const fn new(kind: BranchKind, number: usize) -> Self {
        Self { kind, number }
    }

    /// The isola of this number, from 0.
    pub const fn isola(number: usize) -> Self {
        Self::new(BranchKind::Isola, number)
    }

    /// Whether it is a main branch.
    pub fn is_main(self) -> bool {
        self.kind == BranchKind::Main
    }
}

impl std::fmt::Display for BranchId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::MAIN => write!(f, "main"),
            Self { kind, number } => write!(f, "{kind} {}", number + 1),
        }
    }
}

impl Serialize for BranchId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if *self == Self::MAIN {
            return self.kind.serialize(serializer);
        }
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(&self.kind, &self.number)?;
        map.end()
    }
}

impl<'de> Deserialize<'de> for BranchId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NameVisitor)
    }
}

struct NameVisitor;

impl<'de> Visitor<'de> for NameVisitor {
    type Value = BranchId;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"main\", or a map of one kind of branches and a number")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<BranchId, E> {
        if text == BranchKind::Main.name() { Ok(BranchId::MAIN) } else { Err(E::unknown_variant(text, &["main"])) }
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<BranchId, M::Error> {
        let Some((kind, number)) = map.next_entry()? else { return Err(M::Error::invalid_length(0, &self)) };
        if map.next_key::<IgnoredAny>()?.is_some() {
            return Err(M::Error::invalid_length(2, &self));
        }
        Ok(BranchId { kind, number })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_before_read_and_are_written_as_before() {
        let names = [
            (BranchId::MAIN, r#""main""#, "main"),
            (BranchId::new(BranchKind::Main, 1), r#"{"main":1}"#, "main 2"),
            (BranchId::isola(0), r#"{"isola":0}"#, "isola 1"),
            (BranchId::new(BranchKind::Open, 2), r#"{"open":2}"#, "open 3"),
            (BranchId::new(BranchKind::Cut, 0), r#"{"cut":0}"#, "cut 1"),
            (BranchId::new(BranchKind::Unfinished, 11), r#"{"unfinished":11}"#, "unfinished 12"),
        ];
        for (id, form, text) in names {
            assert_eq!(serde_json::to_string(&id).unwrap(), form);
            assert_eq!(serde_json::from_str::<BranchId>(form).unwrap(), id);
            assert_eq!(id.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_name_is_an_error() {
        for form in [r#""isola""#, "{}", r#"{"isola":0,"open":1}"#, r#"{"loop":1}"#, r#"{"isola":-1}"#, "1"] {
            assert!(serde_json::from_str::<BranchId>(form).is_err(), "{form}");
        }
    }
}
