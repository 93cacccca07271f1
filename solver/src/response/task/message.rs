//! Tasks as messages say them.

use super::Task;
use crate::response::branch::Side;
use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};

impl Serialize for Task {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Task::Main(Side::Below) => serializer.serialize_unit_variant("Task", 0, "main"),
            Task::Main(side) => serializer.serialize_newtype_variant("Task", 0, "main", side),
            Task::Land(place) => serializer.serialize_newtype_variant("Task", 1, "land", place),
            Task::Seed(place) => serializer.serialize_newtype_variant("Task", 2, "seed", place),
            Task::Fold(place) => serializer.serialize_newtype_variant("Task", 3, "fold", place),
            Task::Crossing(place) => serializer.serialize_newtype_variant("Task", 4, "crossing", place),
            Task::Start(place) => serializer.serialize_newtype_variant("Task", 5, "start", place),
            Task::Begin(place) => serializer.serialize_newtype_variant("Task", 6, "begin", place),
            Task::Scout(place) => serializer.serialize_newtype_variant("Task", 7, "scout", place),
            Task::Verify(place) => serializer.serialize_newtype_variant("Task", 8, "verify", place),
            Task::Disturb(place) => serializer.serialize_newtype_variant("Task", 9, "disturb", place),
            Task::March(place) => serializer.serialize_newtype_variant("Task", 10, "march", place),
            Task::Carry(place) => serializer.serialize_newtype_variant("Task", 11, "carry", place),
            Task::Switch(place) => serializer.serialize_newtype_variant("Task", 12, "switch", place),
        }
    }
}

impl<'de> Deserialize<'de> for Task {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TaskVisitor)
    }
}

struct TaskVisitor;

#[derive(serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum TaskKind {
    Main,
    Land,
    Seed,
    Fold,
    Crossing,
    Start,
    Begin,
    Scout,
    Verify,
    Disturb,
    March,
    Carry,
    Switch,
}

impl<'de> Visitor<'de> for TaskVisitor {
    type Value = Task;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(
            "\"main\", or a map of `main`, `land`, `seed`, `fold`, `crossing`, `start`, `begin`, `scout`, `verify`, \
                     `disturb`, `march`, `carry` or `switch`",
        )
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Task, E> {
        if text == "main" { Ok(Task::Main(Side::Below)) } else { Err(E::unknown_variant(text, &["main"])) }
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Task, M::Error> {
        let task = match map.next_key()? {
            Some(TaskKind::Main) => Task::Main(map.next_value()?),
            Some(TaskKind::Land) => Task::Land(map.next_value()?),
            Some(TaskKind::Seed) => Task::Seed(map.next_value()?),
            Some(TaskKind::Fold) => Task::Fold(map.next_value()?),
            Some(TaskKind::Crossing) => Task::Crossing(map.next_value()?),
            Some(TaskKind::Start) => Task::Start(map.next_value()?),
            Some(TaskKind::Begin) => Task::Begin(map.next_value()?),
            Some(TaskKind::Scout) => Task::Scout(map.next_value()?),
            Some(TaskKind::Verify) => Task::Verify(map.next_value()?),
            Some(TaskKind::Disturb) => Task::Disturb(map.next_value()?),
            Some(TaskKind::March) => Task::March(map.next_value()?),
            Some(TaskKind::Carry) => Task::Carry(map.next_value()?),
            Some(TaskKind::Switch) => Task::Switch(map.next_value()?),
            None => return Err(M::Error::invalid_length(0, &self)),
        };
        if map.next_key::<IgnoredAny>()?.is_some() {
            return Err(M::Error::invalid_length(2, &self));
        }
        Ok(task)
    }
}
