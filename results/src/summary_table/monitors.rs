//! The monitored dofs beside the first, whose amplitudes the table does not show.

use super::units::Units;
use crate::overview::{Level, in_words};
use crate::store::{BranchRow, Reader, Result};

/// Monitored dofs that are named.
const NAMED: usize = 4;

/// Whose amplitudes are meant where no dof is named: of one alone there is nothing to tell it from.
pub(super) fn of_first(names: &[String]) -> String {
    match names {
        [first, _, ..] => format!(" of {first}"),
        _ => String::new(),
    }
}

/// How far one of them moves at most.
pub(super) struct Largest {
    name: String,
    /// Whether it may move farther where the branch is not known.
    at_least: &'static str,
    /// m.
    amplitude: f64,
    /// rad/s.
    omega: f64,
    /// The branch, and its level.
    at: String,
}

/// The largest motions of the monitored dofs but the first, over all branches of these levels.
///
/// # Errors
/// If the store cannot be read.
pub(super) fn others(reader: &Reader, levels: &[Level], names: &[String]) -> Result<Vec<Largest>> {
    let mut highest: Vec<Option<(f64, usize, &Level, &BranchRow)>> = vec![None; names.len()];
    let rows = levels.iter().flat_map(|level| level.branches.iter().map(move |row| (level, row)));
    for (level, row) in rows.filter(|_| names.len() > 1) {
        for (known, (amplitude, point)) in highest.iter_mut().zip(reader.monitor_peaks(row)?) {
            if amplitude.is_finite() && known.is_none_or(|known| amplitude > known.0) {
                *known = Some((amplitude, point, level, row));
            }
        }
    }
    let mut list = Vec::new();
    for (name, largest) in names.iter().zip(highest).skip(1) {
        let Some((amplitude, point, level, row)) = largest else { continue };
        let Some(omega) = reader.omega_at(row, point)? else { continue };
        let at = format!("{} at A = {}", in_words(row), level.amplitude);
        list.push(Largest { name: name.clone(), at_least: row.at_least(), amplitude, omega, at });
    }
    Ok(list)
}

/// All of them in a sentence.
pub(super) fn sentence(others: &[Largest], Units { length, frequency }: Units) -> Option<String> {
    let of = |Largest { name, at_least, amplitude, omega, at }: &Largest| {
        format!(
            "{name} {at_least}{} {length} at {} {frequency}, on {at}",
            length.digits(*amplitude),
            frequency.digits(*omega)
        )
    };
    let named: Vec<String> = others.iter().take(NAMED).map(of).collect();
    let more = others.len().saturating_sub(NAMED);
    let more =
        if more > 0 { format!("; and {more} more: the page and branches/*.csv have them") } else { String::new() };
    (!named.is_empty()).then(|| format!("Largest amplitudes of other monitored dofs: {}{more}.", named.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_move_farther_is_told_as_such() {
        let told = |at_least| {
            let at = "cut 1 at A = 2".into();
            sentence(&[Largest { name: "a".into(), at_least, amplitude: 0.5, omega: 2.0, at }], Units::default())
                .unwrap()
        };
        let ends = "0.50000 m at 2.00000 rad/s, on cut 1 at A = 2.";
        assert_eq!(told(""), format!("Largest amplitudes of other monitored dofs: a {ends}"));
        assert_eq!(told("≥ "), format!("Largest amplitudes of other monitored dofs: a ≥ {ends}"));
    }
}
