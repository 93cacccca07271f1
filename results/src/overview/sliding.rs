//! Whether tips slide on as the law of permanent sliding takes for granted.

use super::level::Level;
use crate::store::BranchRow;

/// The branches on which the sliding stops or turns round while a tip presses: what their friction does there is not what the law is made for,
/// and the integrals over contact arcs, which take it for smooth, are not exact.
pub fn turned_sliding(levels: &[Level]) -> Option<String> {
    let rows = levels.iter().flat_map(|level| level.branches.iter().map(move |row| (level, row)));
    let slowest = |row: &BranchRow| row.certificate.slowest_sliding.filter(|slowest| *slowest <= 0.0);
    let turned: Vec<(&Level, &BranchRow, f64)> =
        rows.filter_map(|(level, row)| Some((level, row, slowest(row)?))).collect();
    let (level, row, _) = turned.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
    let more = match turned.len() - 1 {
        0 => String::new(),
        1 => " and 1 more branch".into(),
        more => format!(" and {more} more branches"),
    };
    Some(format!(
        "Sliding stops or turns round while a contact presses on {} at A = {}{more}: the law of friction knows no \
         sticking, and is summed up less exactly there, so that what is said of {} is not certain.",
        super::in_words(row),
        level.amplitude,
        if turned.len() == 1 { "it" } else { "them" }
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::certificate::Certificate;

    #[test]
    fn branches_on_which_sliding_turns_round() {
        let said = |slowest: &[Option<f64>]| {
            let row = |(number, slowest_sliding): (usize, &Option<f64>)| BranchRow {
                kind: "isola".into(),
                number: number + 1,
                certificate: Certificate { slowest_sliding: *slowest_sliding, ..Certificate::default() },
                ..BranchRow::default()
            };
            let branches = slowest.iter().enumerate().map(row).collect();
            turned_sliding(&[Level { amplitude: "2".into(), branches, ..Level::default() }])
        };
        assert_eq!(said(&[None, Some(0.2)]), None);
        assert_eq!(
            said(&[None, Some(0.2), Some(-0.1)]).unwrap(),
            "Sliding stops or turns round while a contact presses on isola 3 at A = 2: the law of friction knows no \
             sticking, and is summed up less exactly there, so that what is said of it is not certain."
        );
        let said = said(&[Some(0.0), Some(-0.2), Some(-0.1)]).unwrap();
        assert!(said.contains("on isola 2 at A = 2 and 2 more branches:") && said.contains("of them"), "{said}");
    }
}
