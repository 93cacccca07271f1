//! How far twice the harmonics move branches where they are not largest.

use super::confirmed::doubled;
use super::level::Level;
use crate::store::BranchRow;
use crate::words::digits;

/// A peak of which neither amplitude nor frequency changes by more than this with twice the harmonics is taken to be converged, and a branch
/// that is not moved farther.
pub(super) const CONVERGED: f64 = 0.01;

/// A penetration, relative to the gap, from which it is told.
const DEEP: f64 = 0.01;

/// The branch that twice the harmonics move most at a point, if that is farther than `least`: where, how far, and the remedy. `frequency`
/// writes one, of rad/s.
pub(super) fn elsewhere<'l>(
    rows: impl Iterator<Item = (&'l Level, &'l BranchRow)>,
    least: f64,
    remedy: &str,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let changes = rows.filter_map(|(level, row)| {
        let change = row.certificate.elsewhere?;
        Some((level, row, change.omega, change.share?))
    });
    let largest = changes.max_by(|a, b| a.3.total_cmp(&b.3));
    let (level, row, omega, share) = largest.filter(|(.., share)| *share > least)?;
    Some(format!(
        "Not converged elsewhere: with twice the harmonics {} at A = {} moves by {} %, in frequency and amplitude together, near {}{remedy}.",
        super::in_words(row),
        level.amplitude,
        digits(100.0 * share, 2),
        frequency(omega)
    ))
}

/// The branches of which nothing is known with twice the harmonics, neither a peak nor most of their points, with how far contacts
/// penetrate, and the remedy.
pub(super) fn not_found<'l>(rows: impl Iterator<Item = (&'l Level, &'l BranchRow)>, remedy: &str) -> Option<String> {
    let is_lost = |row: &BranchRow| {
        doubled(row).is_none() && row.certificate.elsewhere.is_some_and(|change| change.share.is_none())
    };
    let lost: Vec<(&Level, &BranchRow)> = rows.filter(|(_, row)| is_lost(row)).collect();
    let (level, row) = lost.first()?;
    let more = match lost.len() - 1 {
        0 => String::new(),
        1 => " and 1 more branch".into(),
        more => format!(" and {more} more branches"),
    };
    let depth = lost.iter().filter_map(|(_, row)| row.certificate.penetration).fold(0.0, f64::max);
    let depth = match depth > DEEP {
        true => format!("; contacts penetrate by up to {} % of the gap", digits(100.0 * depth, 2)),
        false => String::new(),
    };
    Some(format!(
        "What more harmonics would change of {} at A = {}{more} is not known: with twice as many no motion was found near most points{depth}{remedy}.",
        super::in_words(row),
        level.amplitude
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::certificate::{Certificate, Change};

    fn row(kind: &str, number: usize, share: Option<f64>) -> BranchRow {
        let elsewhere = Some(Change { omega: 0.4, share });
        let certificate = Certificate { elsewhere, penetration: Some(0.098), ..Certificate::default() };
        BranchRow { kind: kind.into(), number, certificate, ..BranchRow::default() }
    }

    const REMEDY: &str = "; set harmonics.count = 6";

    #[test]
    fn the_largest_change_is_told_with_its_place() {
        let said = |rows: Vec<BranchRow>| {
            let level = Level { amplitude: "0.3".into(), ..Level::default() };
            elsewhere(rows.iter().map(|row| (&level, row)), 0.01, REMEDY, |omega| format!("{omega} rad/s"))
        };
        assert_eq!(
            said(vec![row("main", 1, Some(0.037)), row("isola", 1, Some(0.02))]).unwrap(),
            "Not converged elsewhere: with twice the harmonics the main branch at A = 0.3 moves by 3.7 %, in frequency and amplitude together, near 0.4 rad/s; \
             set harmonics.count = 6."
        );
        assert_eq!(said(vec![row("main", 1, Some(0.009)), row("isola", 1, None)]), None);
        assert_eq!(said(vec![BranchRow { kind: "main".into(), ..BranchRow::default() }]), None);
    }

    #[test]
    fn branches_that_are_not_found_again() {
        let said = |rows: Vec<BranchRow>| {
            let level = Level { amplitude: "0.3".into(), ..Level::default() };
            not_found(rows.iter().map(|row| (&level, row)), REMEDY)
        };
        assert_eq!(
            said(vec![row("main", 1, None), row("isola", 1, None), row("isola", 2, Some(0.0))]).unwrap(),
            "What more harmonics would change of the main branch at A = 0.3 and 1 more branch is not known: with twice as many no motion was \
             found near most points; contacts penetrate by up to 9.8 % of the gap; set harmonics.count = 6."
        );
        assert_eq!(said(vec![row("main", 1, Some(0.009))]), None);
    }
}
