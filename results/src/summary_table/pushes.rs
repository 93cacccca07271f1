//! Pushes in words: for every isola the one of least energy found that ends on it.

use super::Units;
use crate::overview::Level;
use crate::store::{BranchRow, PushRow, least_energy};
use crate::words::{digits, listed};
use solver::stability::endings::Ending;

/// Branches that are named of a long list.
const NAMED: usize = 4;

/// Digits of energies, impulses and velocities: they are bisected to 1 %.
const DIGITS: i32 = 3;

/// Where pushes begin.
const START: &str = "from the stable motion of the main branch or, where it has none, from that which rest leads to";

/// What is known of every isola that was pushed onto, alike ones in one sentence; `monitors`: names of the monitored dofs.
pub(crate) fn sentences(pushes: &[PushRow], monitors: &[String], units: Units) -> Vec<String> {
    let (mut found, mut unfound, mut untried) = (Vec::new(), Vec::new(), Vec::new());
    for rows in pushes.chunk_by(is_of_one) {
        let onto = place(&rows[0], units);
        match (least_energy(rows), rows.iter().find_map(|row| row.reason.as_deref())) {
            (Some(least), _) => found.push((rows, least, onto)),
            (None, Some(reason)) => untried.push(format!("No push onto {onto} was tried: {reason}.")),
            (None, None) => unfound.push((rows, onto)),
        }
    }
    let pushed = [smallest(&found, monitors), none(&unfound, monitors)].into_iter().flatten().chain(untried);
    pushed.chain(switched_on(pushes, units)).collect()
}

/// Where the motion ends that begins when the force is switched on at rest.
pub(crate) fn switched_on(pushes: &[PushRow], units: Units) -> Option<String> {
    let rows = pushes.chunk_by(is_of_one).filter_map(|rows| rows.iter().find(|row| row.from_rest.is_some()));
    let rows: Vec<&PushRow> = rows.collect();
    let ending = |ending: Ending| {
        let places = rows.iter().filter(|row| row.from_rest == Some(ending)).map(|row| place(row, units));
        some_of(&places.collect::<Vec<_>>())
    };
    let onto = ending(Ending::Onto).map(|places| format!("leads onto {places} without a push"));
    let back = ending(Ending::Back).map(|places| {
        format!("does not lead onto {places}, but to another stable motion, the one that pushes begin from")
    });
    let elsewhere = ending(Ending::Elsewhere).map(|places| {
        format!(
            "was seen to lead neither to the largest stable motion of {places} nor to the motion that pushes begin from"
        )
    });
    let all: Vec<String> = [onto, back, elsewhere].into_iter().flatten().collect();
    let (first, rest) = all.split_first()?;
    let rest: String = rest.iter().map(|what| format!("; it {what}")).collect();
    Some(format!("The force switched on at rest (at once, where it is largest) {first}{rest}."))
}

/// Whether two rows are of pushes onto one branch.
fn is_of_one(a: &PushRow, b: &PushRow) -> bool {
    a.forcing == b.forcing && a.branch == b.branch
}

/// The names of a list, of a long one the first few.
fn some_of(names: &[String]) -> Option<String> {
    match names {
        [] => None,
        few if few.len() <= NAMED => Some(listed(few)),
        many => Some(format!("{} and {} more", many[..NAMED].join(", "), many.len() - NAMED)),
    }
}

/// Other detached branches that are stable in parts: only isolas are pushed onto.
pub(crate) fn not_pushed_onto(levels: &[Level]) -> Option<String> {
    let is_stable =
        |row: &&BranchRow| !row.is_isola() && row.stability.as_ref().is_some_and(|known| known.stable > 0.0);
    let name = |level: &Level, row: &BranchRow| format!("{} at A = {}", row.name(), level.amplitude);
    let others: Vec<String> =
        levels.iter().flat_map(|level| level.others().filter(is_stable).map(move |row| name(level, row))).collect();
    let named = some_of(&others)?;
    let are = if others.len() == 1 { "which is" } else { "which are" };
    Some(format!("No push was tried onto {named}, {are} stable in parts too: only isolas are pushed onto."))
}

/// An isola, and the frequency at which it is pushed onto.
fn place(row: &PushRow, units: Units) -> String {
    let unit = units.frequency;
    format!("{} at A = {} and {} {unit}", row.branch, row.forcing, unit.digits(row.omega))
}

/// The smallest push onto each of these isolas.
fn smallest(found: &[(&[PushRow], &PushRow, String)], monitors: &[String]) -> Option<String> {
    let told = |(_, least, onto): &(&[PushRow], &PushRow, String)| format!("{onto}: {}", strength(least, monitors));
    let mut tried: Vec<usize> =
        found.iter().flat_map(|(rows, ..)| rows.iter().map(|row| row.mode.saturating_sub(1))).collect();
    tried.sort_unstable();
    tried.dedup();
    let list: Vec<String> = found.iter().map(told).collect();
    let begins = match list.len() {
        0 => return None,
        1 => "Smallest push found that ends on",
        _ => "Smallest pushes found, one isola each that they end on:",
    };
    Some(format!(
        "{begins} {}. Tried were pushes in {}, {START}, at one frequency an isola, the middle of its stable part.",
        list.join("; "),
        crate::words::modes(&tried)
    ))
}

/// The isolas onto which no push was found, with the largest ones that were tried.
fn none(unfound: &[(&[PushRow], String)], monitors: &[String]) -> Option<String> {
    let told = |(rows, onto): &(&[PushRow], String)| {
        let of_mode = |row: &PushRow| {
            let (largest, dof) = (digits(row.largest.unwrap_or_default(), DIGITS), dof(row, monitors));
            format!("mode {} up to {largest} N s at {dof}", row.mode)
        };
        let modes: Vec<String> = rows.iter().map(of_mode).collect();
        let motions: usize = rows.iter().map(|row| row.motions).sum();
        format!("{onto} ({}; {motions} pushed motions were marched)", modes.join(", "))
    };
    let list: Vec<String> = unfound.iter().map(told).collect();
    (!list.is_empty()).then(|| format!("No push was found that ends on {}. Others may.", listed(&list)))
}

/// How strong a push is, and when it acts: its energy, and its impulse with the dof that it is given for.
pub(crate) fn strength(push: &PushRow, monitors: &[String]) -> String {
    let [energy, size, velocity] =
        [push.energy(), push.impulse, push.velocity].map(|value| digits(value.unwrap_or_default().abs(), DIGITS));
    let when = match push.phase {
        Some(phase) if phase != 0.0 => format!(
            ", {} of a period of the isola's motion after an instant at which the force is largest",
            digits(phase, DIGITS)
        ),
        Some(_) => ", when the force is largest".into(),
        None => String::new(),
    };
    let doubt = if push.confirmed == Some(true) { "" } else { " (not confirmed by longer marching)" };
    let sense = if push.velocity.is_some_and(|velocity| velocity < 0.0) { "−" } else { "+" };
    format!(
        "{energy} J, all dofs at once in the shape of mode {}, {sense}{velocity} m/s at {} (what {sense}{size} N s at that dof put into the mode){when}{doubt}",
        push.mode,
        dof(push, monitors)
    )
}

/// The monitored dof that the mode of a push moves most.
fn dof<'m>(push: &PushRow, monitors: &'m [String]) -> &'m str {
    monitors.get(push.monitor).map_or("the monitored dof", String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Stability;

    fn row(mode: usize, impulse: Option<f64>, reason: Option<&str>) -> PushRow {
        PushRow {
            forcing: "60".into(),
            branch: "isola 1".into(),
            mode,
            omega: 2665.457,
            monitor: 0,
            motions: 192,
            largest: Some(9.0),
            impulse,
            below: impulse.map(|impulse| 0.99 * impulse),
            velocity: impulse.map(|impulse| 0.5 * impulse),
            phase: impulse.map(|_| 0.25),
            confirmed: impulse.map(|_| true),
            reason: reason.map(String::from),
            from_rest: None,
        }
    }

    fn told(rows: &[PushRow]) -> String {
        sentences(rows, &["tip".into()], Units::default()).join(" ")
    }

    #[test]
    fn the_smallest_is_told() {
        let said = told(&[row(1, Some(4.66), None), row(2, None, None), row(3, Some(8.0), None)]);
        assert_eq!(
            said,
            "Smallest push found that ends on isola 1 at A = 60 and 2665.46 rad/s: 5.43 J, all dofs at once in the shape \
             of mode 1, +2.33 m/s at tip (what +4.66 N s at that dof put into the mode), 0.25 of a period of the isola's motion after an instant at which the force is largest. Tried were pushes in \
             modes 1 to 3, from the stable motion of the main branch or, where it has none, from that which rest leads to, at one frequency an isola, the middle of its stable part."
        );
        let doubtful = PushRow { confirmed: Some(false), ..row(1, Some(4.66), None) };
        assert!(
            told(&[doubtful])
                .contains(" is largest (not confirmed by longer marching). Tried were pushes in mode 1, from")
        );
    }

    #[test]
    fn what_several_isolas_have_in_common_is_said_once() {
        let other = |row: PushRow| PushRow { forcing: "80".into(), ..row };
        let said = told(&[row(1, Some(4.66), None), other(row(1, Some(5.0), None)), other(row(2, None, None))]);
        let begins =
            "Smallest pushes found, one isola each that they end on: isola 1 at A = 60 and 2665.46 rad/s: 5.43 J, ";
        assert!(said.starts_with(begins) && said.contains("; isola 1 at A = 80 and 2665.46 rad/s: 6.25 J, "), "{said}");
        assert_eq!(said.matches("Tried were pushes in modes 1 and 2, from the stable motion").count(), 1, "{said}");
        assert_eq!(
            told(&[row(1, None, None), other(row(1, None, None))]),
            "No push was found that ends on isola 1 at A = 60 and 2665.46 rad/s (mode 1 up to 9 N s at tip; 192 pushed motions were marched) \
             and isola 1 at A = 80 and 2665.46 rad/s (mode 1 up to 9 N s at tip; 192 pushed motions were marched). Others may."
        );
    }

    #[test]
    fn where_rest_leads_is_told_once_an_isola() {
        let ends = |forcing: &str, mode, from_rest| PushRow {
            forcing: forcing.into(),
            from_rest: Some(from_rest),
            ..row(mode, None, Some("why"))
        };
        let said = |rows: &[PushRow]| switched_on(rows, Units::default()).unwrap_or_default();
        assert_eq!(said(&[row(1, Some(4.66), None)]), "");
        assert_eq!(
            said(&[ends("60", 1, Ending::Onto), ends("60", 2, Ending::Onto)]),
            "The force switched on at rest (at once, where it is largest) leads onto isola 1 at A = 60 and 2665.46 rad/s without a push."
        );
        assert_eq!(
            said(&[ends("60", 1, Ending::Back), ends("80", 1, Ending::Onto), ends("90", 1, Ending::Elsewhere)]),
            "The force switched on at rest (at once, where it is largest) leads onto isola 1 at A = 80 and 2665.46 rad/s without a push; it \
             does not lead onto isola 1 at A = 60 and 2665.46 rad/s, but to another stable motion, the one that pushes begin from; it was seen to lead \
             neither to the largest stable motion of isola 1 at A = 90 and 2665.46 rad/s nor to the motion that pushes begin from."
        );
        let many: Vec<_> = (1..7).map(|i| ends(&i.to_string(), 1, Ending::Back)).collect();
        assert!(said(&many).contains(" isola 1 at A = 4 and 2665.46 rad/s and 2 more, but to"), "{}", said(&many));
        assert!(told(&many[..1]).ends_with("was tried: why. The force switched on at rest (at once, where it is largest) does not lead onto isola 1 at A = 1 and 2665.46 rad/s, but to another stable motion, the one that pushes begin from."));
    }

    #[test]
    fn other_branches_that_are_stable_in_parts_are_named() {
        let row = |kind: &str, stable| BranchRow {
            kind: kind.into(),
            number: 1,
            closed: kind == "isola",
            stability: Some(Stability { stable, ..Stability::default() }),
            ..BranchRow::default()
        };
        let told = |branches| not_pushed_onto(&[Level { amplitude: "2".into(), branches, ..Level::default() }]);
        assert_eq!(told(vec![row("main", 1.0), row("isola", 1.0), row("branched", 0.0)]), None);
        let said =
            "No push was tried onto branched 1 at A = 2, which is stable in parts too: only isolas are pushed onto.";
        assert_eq!(told(vec![row("branched", 0.5)]).unwrap(), said);
        assert!(
            told(vec![row("branched", 0.5), row("open", 1.0)])
                .unwrap()
                .contains("at A = 2 and open 1 at A = 2, which are")
        );
    }

    #[test]
    fn energy_tells_which_is_the_smallest() {
        // A light dof takes a small impulse and much energy.
        let light = PushRow { velocity: Some(40.0), ..row(1, Some(0.5), None) };
        let heavy = PushRow { velocity: Some(0.2), ..row(2, Some(8.0), None) };
        let said = told(&[light, heavy]);
        assert!(
            said.contains(": 0.8 J, all dofs at once in the shape of mode 2, +0.2 m/s at tip (what +8 N s at"),
            "{said}"
        );
    }

    #[test]
    fn what_was_not_found_or_not_tried_is_told() {
        let said = told(&[row(1, None, None), PushRow { largest: Some(4.0), ..row(2, None, None) }]);
        assert_eq!(
            said,
            "No push was found that ends on isola 1 at A = 60 and 2665.46 rad/s (mode 1 up to 9 N s at tip, mode 2 up to 4 N s at tip; 384 \
             pushed motions were marched). Others may."
        );
        let said = told(&[row(1, None, Some("no stable motion on the branch at this frequency"))]);
        let end = "was tried: no stable motion on the branch at this frequency.";
        assert!(said.starts_with("No push onto isola 1") && said.ends_with(end), "{said}");
    }
}
