//! Pushes in words: for every isola the smallest found that ends on it.

use super::Units;
use crate::store::PushRow;
use crate::words::digits;

/// Digits of impulses: they are bisected to 1 %.
const DIGITS: i32 = 3;

/// A sentence for every isola that was pushed onto; `monitors`: names of the monitored dofs.
pub(crate) fn sentences(pushes: &[PushRow], monitors: &[String], units: Units) -> Vec<String> {
    let of_one = |a: &PushRow, b: &PushRow| a.forcing == b.forcing && a.branch == b.branch;
    pushes.chunk_by(of_one).map(|rows| sentence(rows, monitors, units)).collect()
}

fn sentence(rows: &[PushRow], monitors: &[String], units: Units) -> String {
    let at = format!("{} {}", units.frequency.digits(rows[0].omega), units.frequency);
    let onto = format!("{} at A = {} and {at}", rows[0].branch, rows[0].forcing);
    let tried = |rows: &[&PushRow]| {
        let modes: Vec<usize> = rows.iter().map(|row| row.mode.saturating_sub(1)).collect();
        crate::words::modes(&modes)
    };
    let all: Vec<&PushRow> = rows.iter().collect();
    let impulse = |row: &&&PushRow| row.impulse;
    let found = all.iter().filter(|row| row.impulse.is_some());
    let Some(least) =
        found.min_by(|a, b| impulse(a).unwrap_or(f64::INFINITY).total_cmp(&impulse(b).unwrap_or(f64::INFINITY)))
    else {
        let reasons: Vec<&str> = all.iter().filter_map(|row| row.reason.as_deref()).collect();
        return match reasons.first() {
            Some(reason) => format!("No push onto {onto} was tried: {reason}."),
            None => {
                let largest = all.iter().filter_map(|row| row.largest).fold(0.0, f64::max);
                format!(
                    "No push of up to {} N s in {} was found that ends on {onto}.",
                    digits(largest, DIGITS),
                    tried(&all)
                )
            }
        };
    };
    let monitor = monitors.get(least.monitor).map_or("the monitored dof", String::as_str);
    let [size, velocity] = [least.impulse, least.velocity].map(|value| digits(value.unwrap_or_default(), DIGITS));
    let when = match least.phase {
        Some(phase) if phase != 0.0 => format!(", {} of a period after the forcing is largest", digits(phase, DIGITS)),
        Some(_) => ", when the forcing is largest".into(),
        None => String::new(),
    };
    let doubt = if least.confirmed == Some(true) { "" } else { "; not confirmed by longer marching" };
    format!(
        "Smallest push found from the main motion that ends on {onto}: all dofs at once in the shape of mode {}, {velocity} m/s at \
         {monitor} ({size} N s for that mode alone){when}; of pushes in {}{doubt}.",
        least.mode,
        tried(&all)
    )
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
            "Smallest push found from the main motion that ends on isola 1 at A = 60 and 2665.46 rad/s: all dofs at once in the shape \
             of mode 1, 2.33 m/s at tip (4.66 N s for that mode alone), 0.25 of a period after the forcing is largest; of pushes in modes 1 to 3."
        );
        let doubtful = PushRow { confirmed: Some(false), ..row(1, Some(4.66), None) };
        assert!(told(&[doubtful]).ends_with("of pushes in mode 1; not confirmed by longer marching."));
    }

    #[test]
    fn what_was_not_found_or_not_tried_is_told() {
        let said = told(&[row(1, None, None), row(2, None, None)]);
        assert_eq!(
            said,
            "No push of up to 9 N s in modes 1 and 2 was found that ends on isola 1 at A = 60 and 2665.46 rad/s."
        );
        let said = told(&[row(1, None, Some("no stable motion on the branch at this frequency"))]);
        let end = "was tried: no stable motion on the branch at this frequency.";
        assert!(said.starts_with("No push onto isola 1") && said.ends_with(end), "{said}");
    }
}
