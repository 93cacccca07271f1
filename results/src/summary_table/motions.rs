//! What unstable motions turn into, in words: for every branch from whose unstable motions it was marched on.

use super::Units;
use crate::store::MotionRow;
use crate::words::{count, listed};

/// Of motions that no branch has.
const UNFOUND: &str = "is near no marched orbit of";

/// Most branches of which a sentence each is said.
const NAMED: usize = 2;

/// The same of few branches, and in one sentence of many: what motions turn into that was not found, which the search may have missed, is told
/// of every branch.
pub(crate) fn brief(motions: &[MotionRow], units: Units, is_further: bool) -> Vec<String> {
    let of_one = |a: &MotionRow, b: &MotionRow| a.forcing == b.forcing && a.branch == b.branch;
    let is_missed = |rows: &&[MotionRow]| rows.iter().any(|row| kind(row, is_further).contains(UNFOUND));
    let (missed, others): (Vec<&[MotionRow]>, Vec<&[MotionRow]>) = motions.chunk_by(of_one).partition(is_missed);
    let named = if others.len() > NAMED { &others[..0] } else { &others[..] };
    let told = missed.into_iter().chain(named.iter().copied()).map(|rows| sentence(rows, units, is_further));
    told.chain((others.len() > NAMED).then(|| of_many(&others, units, is_further))).collect()
}

/// What unstable motions of many branches turn into.
fn of_many(branches: &[&[MotionRow]], units: Units, is_further: bool) -> String {
    let rows = || branches.iter().copied().flatten();
    let repeats = |row: &MotionRow| row.repeats.filter(|repeats| row.motion == "periodic" && *repeats > 1);
    let mut kinds: Vec<String> = rows().filter(|row| repeats(row).is_none()).map(|row| kind(row, is_further)).collect();
    kinds.sort();
    kinds.dedup();
    let mut repeated: Vec<usize> = rows().filter_map(repeats).collect();
    repeated.sort_unstable();
    repeated.dedup();
    let periods: Vec<String> = repeated.iter().map(ToString::to_string).collect();
    kinds.extend((!periods.is_empty()).then(|| format!("motions that repeat after {} periods", listed(&periods))));
    let largest = rows().filter_map(|row| Some((row.amplitude?.1, row))).max_by(|a, b| a.0.total_cmp(&b.0));
    let largest = largest.map_or_else(String::new, |(amplitude, row)| {
        format!(
            "; the largest of all these has an amplitude of {} {} at A = {} and {} {} (motions.csv)",
            units.length.digits(amplitude),
            units.length,
            row.forcing,
            units.frequency.digits(row.omega),
            units.frequency
        )
    });
    let kinds = kinds.join(", to ");
    format!("From unstable motions of {} branches time marching came to {kinds}{largest}.", branches.len())
}

fn sentence(rows: &[MotionRow], units: Units, is_further: bool) -> String {
    let mut kinds: Vec<(String, Vec<&MotionRow>)> = Vec::new();
    for row in rows {
        let kind = kind(row, is_further);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, list)) => list.push(row),
            None => kinds.push((kind, vec![row])),
        }
    }
    let parts: Vec<String> = kinds.iter().map(|(kind, rows)| format!("{kind} {}", place(rows, units))).collect();
    format!(
        "From {} of {} at A = {} time marching came to {}.",
        count(rows.len(), "unstable motion"),
        rows[0].branch,
        rows[0].forcing,
        parts.join(", to ")
    )
}

/// What a motion is, as far as that is known.
pub(crate) fn kind(row: &MotionRow, is_further: bool) -> String {
    match (row.motion.as_str(), row.repeats, &row.onto) {
        ("periodic", Some(1), Some(branch)) if *branch == row.branch => {
            "a stable part of the branch that they are on".into()
        }
        ("periodic", Some(1), Some(branch)) => branch.clone(),
        ("periodic", Some(1), None) if is_further => {
            format!("a periodic motion that {UNFOUND} the branches of this order (it may be of an earlier one)")
        }
        ("periodic", Some(1), None) => {
            format!(
                "a periodic motion that {UNFOUND} the branches found (the search may have missed it, or more harmonics move the end of a \
                 branch there)"
            )
        }
        ("periodic", Some(repeats), _) => format!("motions that repeat after {repeats} periods"),
        ("quasi_periodic", ..) => "quasi-periodic motions".into(),
        ("chaotic", ..) => "chaotic motions".into(),
        _ if row.amplitude.is_none() => "nothing that could be marched".into(),
        _ => "motions of which it could not tell what they are".into(),
    }
}

/// At which frequencies, and how large.
fn place(rows: &[&MotionRow], units: Units) -> String {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let said = |(low, high): (String, String)| if low == high { low } else { format!("{low}–{high}") };
    let (low, high) = range(&mut rows.iter().map(|row| row.omega));
    let omega = said((units.frequency.digits(low), units.frequency.digits(high)));
    let at = format!("at {omega} {}", units.frequency);
    if rows.iter().all(|row| row.amplitude.is_none()) {
        return at;
    }
    let (low, high) = range(&mut rows.iter().filter_map(|row| row.amplitude).flat_map(|(low, high)| [low, high]));
    let amplitude = said((units.length.digits(low), units.length.digits(high)));
    let of = if rows.len() > 1 { "amplitudes of all of them" } else { "amplitudes" };
    format!("{at} ({of} {amplitude} {})", units.length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(omega: f64, motion: &str, repeats: Option<usize>, onto: Option<&str>, amplitude: (f64, f64)) -> MotionRow {
        MotionRow {
            forcing: "60".into(),
            branch: "isola 1".into(),
            point: 7,
            omega,
            motion: motion.into(),
            repeats,
            onto: onto.map(String::from),
            amplitude: Some(amplitude),
            growth: None,
            periods: 300,
        }
    }

    #[test]
    fn of_many_branches_what_was_not_found_is_told() {
        let of = |forcing: &str, onto| MotionRow {
            forcing: forcing.into(),
            ..row(2600.0, "periodic", Some(1), onto, (1e-3, 2e-3))
        };
        let told = |rows: &[MotionRow]| brief(rows, Units::default(), false);
        let few = [of("1", Some("main")), of("2", Some("main"))];
        let one = |row: &MotionRow| sentence(std::slice::from_ref(row), Units::default(), false);
        assert_eq!(told(&few), few.iter().map(one).collect::<Vec<_>>());
        let many = [of("1", Some("main")), of("2", None), of("3", Some("main")), of("4", Some("isola 1"))];
        let missed = one(&many[1]);
        let rest = "From unstable motions of 3 branches time marching came to a stable part of the branch that they are on, to main; the largest of all these has an \
                    amplitude of 2.0000e-3 m at A = 4 and 2600.00 rad/s (motions.csv).";
        assert_eq!(told(&many), [missed, rest.to_string()]);
    }

    #[test]
    fn motions_are_told_kind_by_kind() {
        let rows = [
            row(2600.0, "periodic", Some(2), None, (1e-3, 1.5e-3)),
            row(2602.5, "periodic", Some(2), None, (1.25e-3, 2e-3)),
            row(2595.0, "periodic", Some(1), Some("main"), (5e-4, 5e-4)),
            MotionRow { amplitude: None, ..row(2590.0, "unclear", None, None, (0.0, 0.0)) },
        ];
        assert_eq!(
            brief(&rows, Units::default(), false),
            [
                "From 4 unstable motions of isola 1 at A = 60 time marching came to motions that repeat after 2 periods at \
                 2600.00–2602.50 rad/s (amplitudes of all of them 1.0000e-3–2.0000e-3 m), to main at 2595.00 rad/s (amplitudes 5.0000e-4 m), \
                 to nothing that could be marched at 2590.00 rad/s."
            ]
        );
    }
}
