//! Which modes were followed and which not, in words.

use crate::words::modes;
use solver::response::modes::{LeftOut, ModesFollowed};

/// The modes followed: `mode 1`, `modes 1 and 3`.
pub fn followed(choice: &ModesFollowed) -> String {
    modes(&choice.followed)
}

/// Which modes are meant, and why one or many of them are left out.
type Reason = (fn(&LeftOut) -> bool, [&'static str; 2]);

/// Why modes are left out, and what that is called.
const REASONS: [Reason; 6] = [
    (|why| *why == LeftOut::NotListed, ["not in the list of modes"; 2]),
    (
        |why| *why == LeftOut::RigidBody,
        ["a rigid body but for laws, without a backbone", "rigid bodies but for laws, without backbones"],
    ),
    (|why| *why == LeftOut::Overdamped, ["overdamped: it does not oscillate", "overdamped: they do not oscillate"]),
    (
        |why| *why == LeftOut::OutOfRange,
        [
            "far above the primary mode or beyond the reach of given bounds, and followed only if backbone.modes lists it",
            "far above the primary mode or beyond the reach of given bounds, and followed only if backbone.modes lists them",
        ],
    ),
    (|why| *why == LeftOut::TooMany, ["more than are followed unless backbone.modes lists them"; 2]),
    (|why| matches!(why, LeftOut::NotStarted(_)), ["its backbone does not start", "their backbones do not start"]),
];

/// The modes that were not followed, reason by reason: `modes 2 to 4 (not in the list of modes)`.
pub fn left_out(choice: &ModesFollowed) -> Vec<String> {
    for_reasons(choice, |_| true)
}

/// Those of them that a list of modes brings back.
pub fn brought_back_by_a_list(choice: &ModesFollowed) -> Vec<String> {
    for_reasons(choice, |why| matches!(why, LeftOut::OutOfRange | LeftOut::TooMany))
}

fn for_reasons(choice: &ModesFollowed, is_wanted: impl Fn(&LeftOut) -> bool) -> Vec<String> {
    let left_out = || choice.left_out.iter().filter(|(_, why)| is_wanted(why));
    let group = |(is_meant, [one, many]): Reason| {
        let list: Vec<usize> = left_out().filter(|(_, why)| is_meant(why)).map(|(mode, _)| *mode).collect();
        let reason = if list.len() == 1 { one } else { many };
        (!list.is_empty()).then(|| format!("{} ({reason})", modes(&list)))
    };
    REASONS.into_iter().filter_map(group).collect()
}

/// Modes whose backbones do not start, from 0, with the reasons.
pub fn not_started(choice: &ModesFollowed) -> impl Iterator<Item = (usize, &str)> {
    choice.left_out.iter().filter_map(|(mode, why)| match why {
        LeftOut::NotStarted(reason) => Some((*mode, reason.as_str())),
        _ => None,
    })
}

/// What was followed and what not, in a sentence, unless it is the primary mode alone as it should be; of a run that is not done
/// yet as well.
pub fn sentence(choice: &ModesFollowed, is_done: bool) -> Option<String> {
    let is_known = |why: &LeftOut| matches!(why, LeftOut::RigidBody | LeftOut::Overdamped | LeftOut::NotStarted(_));
    if choice.followed.len() < 2 && !choice.left_out.iter().any(|(_, why)| is_known(why)) {
        return None;
    }
    let rest = left_out(choice);
    let rest = if rest.is_empty() { String::new() } else { format!("; not {}", rest.join(", ")) };
    let were = if is_done { "were" } else { "are" };
    Some(format!("Windows of {} {were} looked for{rest}.", followed(choice)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_named_reason_by_reason() {
        let mut left_out: Vec<(usize, LeftOut)> = (3..39).map(|mode| (mode, LeftOut::TooMany)).collect();
        let alone = ModesFollowed { followed: vec![0], left_out: left_out.clone() };
        assert_eq!(sentence(&alone, true), None);
        left_out.extend([(1, LeftOut::OutOfRange), (39, LeftOut::RigidBody)]);
        let choice = ModesFollowed { followed: vec![0, 2], left_out };
        assert_eq!(
            sentence(&choice, true).unwrap(),
            "Windows of modes 1 and 3 were looked for; not mode 40 (a rigid body but for laws, without a backbone), mode 2 (far above the primary mode or beyond the reach of given bounds, and \
             followed only if backbone.modes lists it), modes 4 to 39 (more than are followed unless backbone.modes lists them)."
        );
        // Whatever holds it, its resonance may lie below what is looked at.
        let held = ModesFollowed { followed: vec![1], left_out: vec![(0, LeftOut::RigidBody)] };
        assert_eq!(
            sentence(&held, true).unwrap(),
            "Windows of mode 2 were looked for; not mode 1 (a rigid body but for laws, without a backbone)."
        );
        let damped = ModesFollowed { followed: vec![0], left_out: vec![(1, LeftOut::Overdamped)] };
        assert_eq!(
            sentence(&damped, true).unwrap(),
            "Windows of mode 1 were looked for; not mode 2 (overdamped: it does not oscillate)."
        );
        assert_eq!(not_started(&damped).count(), 0);
        let lost = ModesFollowed { followed: vec![1], left_out: vec![(0, LeftOut::NotStarted("singular".into()))] };
        assert_eq!(
            sentence(&lost, false).unwrap(),
            "Windows of mode 2 are looked for; not mode 1 (its backbone does not start)."
        );
        assert_eq!(not_started(&lost).collect::<Vec<_>>(), [(0, "singular")]);
    }
}
