//! Pushes in words: for every isola the one of least energy found that ends on it.

use super::Units;
use crate::store::{PushRow, least_energy};
use crate::words::digits;

/// Digits of energies, impulses and velocities: they are bisected to 1 %.
const DIGITS: i32 = 3;

/// A sentence for every isola that was pushed onto; `monitors`: names of the monitored dofs.
pub(crate) fn sentences(pushes: &[PushRow], monitors: &[String], units: Units) -> Vec<String> {
    let of_one = |a: &PushRow, b: &PushRow| a.forcing == b.forcing && a.branch == b.branch;
    pushes.chunk_by(of_one).map(|rows| sentence(rows, monitors, units)).collect()
}

fn sentence(rows: &[PushRow], monitors: &[String], units: Units) -> String {
    let at = format!("{} {}", units.frequency.digits(rows[0].omega), units.frequency);
    let onto = format!("{} at A = {} and {at}", rows[0].branch, rows[0].forcing);
    let tried: Vec<usize> = rows.iter().map(|row| row.mode.saturating_sub(1)).collect();
    let Some(least) = least_energy(rows) else {
        return match rows.iter().find_map(|row| row.reason.as_deref()) {
            Some(reason) => format!("No push onto {onto} was tried: {reason}."),
            None => {
                let of_mode = |row: &PushRow| {
                    let (largest, dof) = (digits(row.largest.unwrap_or_default(), DIGITS), dof(row, monitors));
                    format!("in mode {} (up to {largest} N s at {dof})", row.mode)
                };
                let modes: Vec<String> = rows.iter().map(of_mode).collect();
                format!("No push {} was found that ends on {onto}.", modes.join(" or "))
            }
        };
    };
    let when = match least.phase {
        Some(phase) if phase != 0.0 => format!(", {} of a period after the forcing is largest", digits(phase, DIGITS)),
        Some(_) => ", when the forcing is largest".into(),
        None => String::new(),
    };
    let doubt = if least.confirmed == Some(true) { "" } else { "; not confirmed by longer marching" };
    format!(
        "Smallest push found from the main motion that ends on {onto}: {}{when}; of pushes in {} at this frequency, the middle of \
         what is stable of it{doubt}.",
        strength(least, monitors),
        crate::words::modes(&tried)
    )
}

/// How strong a push is: its energy, and its impulse with the dof that it is given for.
pub(crate) fn strength(push: &PushRow, monitors: &[String]) -> String {
    let [energy, size, velocity] =
        [push.energy(), push.impulse, push.velocity].map(|value| digits(value.unwrap_or_default().abs(), DIGITS));
    let sense = if push.velocity.is_some_and(|velocity| velocity < 0.0) { "−" } else { "+" };
    format!(
        "{energy} J, all dofs at once in the shape of mode {}, {sense}{velocity} m/s at {} ({sense}{size} N s there for that mode alone)",
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
            "Smallest push found from the main motion that ends on isola 1 at A = 60 and 2665.46 rad/s: 5.43 J, all dofs at once in the shape \
             of mode 1, +2.33 m/s at tip (+4.66 N s there for that mode alone), 0.25 of a period after the forcing is largest; of pushes in modes 1 to 3 at this frequency, the \
             middle of what is stable of it."
        );
        let doubtful = PushRow { confirmed: Some(false), ..row(1, Some(4.66), None) };
        assert!(told(&[doubtful]).ends_with("the middle of what is stable of it; not confirmed by longer marching."));
    }

    #[test]
    fn energy_tells_which_is_the_smallest() {
        // A light dof takes a small impulse and much energy.
        let light = PushRow { velocity: Some(40.0), ..row(1, Some(0.5), None) };
        let heavy = PushRow { velocity: Some(0.2), ..row(2, Some(8.0), None) };
        let said = told(&[light, heavy]);
        assert!(
            said.contains(": 0.8 J, all dofs at once in the shape of mode 2, +0.2 m/s at tip (+8 N s there"),
            "{said}"
        );
    }

    #[test]
    fn what_was_not_found_or_not_tried_is_told() {
        let said = told(&[row(1, None, None), PushRow { largest: Some(4.0), ..row(2, None, None) }]);
        assert_eq!(
            said,
            "No push in mode 1 (up to 9 N s at tip) or in mode 2 (up to 4 N s at tip) was found that ends on isola 1 at A = 60 and \
             2665.46 rad/s."
        );
        let said = told(&[row(1, None, Some("no stable motion on the branch at this frequency"))]);
        let end = "was tried: no stable motion on the branch at this frequency.";
        assert!(said.starts_with("No push onto isola 1") && said.ends_with(end), "{said}");
    }
}
