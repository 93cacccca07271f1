//! How what happens along fold curves is worded: in sentences, legends and labels, and in `COLUMNS.md`.

use solver::response::critical::CriticalKind;

/// A kind of events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EventWords {
    /// In files: `birth`, `death`, `merge`.
    pub kind: CriticalKind,
    /// Several of them, in legends.
    pub many: &'static str,
    /// What happens, on labels.
    pub verb: &'static str,
    /// What happens to an isola or to branches of which no more is known, in sentences.
    pub one: &'static str,
    /// The same of several.
    pub several: &'static str,
}

/// An isola grows from a point.
pub const BIRTH: EventWords = EventWords {
    kind: CriticalKind::Birth,
    many: "births",
    verb: "born",
    one: "an isola is born",
    several: "isolas are born",
};

/// An isola shrinks to a point.
pub const DEATH: EventWords =
    EventWords { kind: CriticalKind::Death, many: "deaths", verb: "dies", one: "an isola dies", several: "isolas die" };

/// Branches touch.
pub const MERGE: EventWords = EventWords {
    kind: CriticalKind::Merge,
    many: "merges or partings",
    verb: "merge or part",
    one: "two branches merge or part",
    several: "branches merge or part",
};

/// All of them.
pub const EVENTS: [EventWords; 3] = [BIRTH, DEATH, MERGE];

/// What is known to happen at a merge, or at a parting, as the forcing grows.
pub const MERGES: &str = "merge";
/// The other one.
pub const PARTS: &str = "part";
