//! How far rigid contacts are penetrated, which only the truncation to so many harmonics lets them be.

use super::level::Level;
use crate::store::BranchRow;
use crate::words::digits;

/// A penetration, relative to the gap, that is told wherever it is.
const FAR_IN: f64 = 0.05;

/// How far rigid contacts are penetrated at most, if that is a lot; nothing if it was said.
pub(super) fn deepest<'l>(rows: impl Iterator<Item = (&'l Level, &'l BranchRow)>, said: &[String]) -> Option<String> {
    let depths = rows.filter_map(|(level, row)| Some((level, row, row.certificate.penetration?)));
    let (level, row, depth) = depths.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(.., depth)| *depth > FAR_IN)?;
    let percent = format!("{} % of the gap", digits(100.0 * depth, 2));
    let is_new = !said.iter().any(|sentence| sentence.contains(&percent));
    is_new.then(|| {
        format!(
            "Rigid contacts are penetrated by up to {percent}, on {} at A = {}.",
            super::in_words(row),
            level.amplitude
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::certificate::Certificate;

    /// The peak that changes most need not be where contacts are penetrated most.
    #[test]
    fn the_deepest_penetration_is_told_once() {
        let row = |kind: &str, share: f64| {
            let certificate = Certificate { penetration: Some(share), ..Certificate::default() };
            BranchRow { kind: kind.into(), number: 1, certificate, ..BranchRow::default() }
        };
        let level = Level { amplitude: "60".into(), ..Level::default() };
        let told = |rows: [BranchRow; 2], said: &[String]| deepest(rows.iter().map(|row| (&level, row)), said);
        let expected = "Rigid contacts are penetrated by up to 288 % of the gap, on the main branch at A = 60.";
        let both = || [row("main", 2.88), row("isola", 0.02)];
        assert_eq!(told(both(), &[]).unwrap(), expected);
        assert_eq!(told(both(), &["its contact penetrates by 288 % of the gap".into()]), None);
        assert_eq!(told([row("main", 0.03), row("isola", 0.04)], &[]), None);
    }
}
