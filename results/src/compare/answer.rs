//! What a later run has that the first one has not, in a sentence.

use super::{AMPLITUDES, SettingRow, is_one, monitor};
use crate::overview::Level;
use crate::report::Report;
use crate::words::{count, digits, listed, listed_first};

/// Levels that are named one by one.
const NAMED: usize = 3;

/// Relative changes up to this are none.
const SAME: f64 = 1e-3;

/// The largest response at a level, in the first run and in another one.
struct Pair<'r> {
    amplitude: &'r str,
    /// What the other's is relative to that of the first, less one.
    change: f64,
    /// Whether both are known, not only that they are no smaller.
    is_known: bool,
}

impl<'r> Pair<'r> {
    fn of([ours, theirs]: &[&'r Level; 2]) -> Option<Self> {
        let [first, other] = [ours.peak()?, theirs.peak()?];
        let change = other.amplitude_max / first.amplitude_max - 1.0;
        let is_known = [first, other].iter().all(|row| row.at_least().is_empty());
        change.is_finite().then_some(Self { amplitude: &ours.amplitude, change, is_known })
    }
}

/// Of each later run by how much its largest responses differ from those of the first, and whether it has isolas at as many levels.
pub(super) fn sentences(names: &[String], reports: &[Report], settings: &[SettingRow]) -> Vec<String> {
    let Some((first, others)) = reports.split_first() else { return Vec::new() };
    let of_other = |(place, other): (usize, &Report)| {
        let levels = shared(first, other);
        let sizes = is_one(&[monitor(first), monitor(other)]).then(|| sizes(&levels)).flatten();
        let alone = [(first, other, 0), (other, first, place)];
        let alone = alone.into_iter().filter_map(|(run, against, i)| isolas_alone(&names[i], run, against));
        let parts: Vec<String> = sizes.into_iter().chain(isolas(&levels)).chain(alone).collect();
        let by = by(settings, place);
        (!parts.is_empty()).then(|| format!("`{}` beside `{}`{by}: {}.", names[place], names[0], parts.join("; ")))
    };
    (1..).zip(others).filter_map(of_other).collect()
}

/// Levels that two runs have and of which nothing is still to be computed.
fn shared<'r>(first: &'r Report, other: &'r Report) -> Vec<[&'r Level; 2]> {
    let [ours, theirs] = [first, other].map(|report| &report.overview.levels);
    let of = |level: &'r Level| Some([level, theirs.iter().find(|there| there.value == level.value)?]);
    ours.iter().filter_map(of).filter(|pair| pair.iter().all(|level| level.is_complete())).collect()
}

/// The only setting that differs, in brackets. Which levels there are is no reason for what differs at one that both have.
fn by(settings: &[SettingRow], place: usize) -> String {
    let settings: Vec<&SettingRow> = settings.iter().filter(|row| row.key != AMPLITUDES).collect();
    match settings[..] {
        [SettingRow { key, values }] if values[0] != values[place] => {
            format!(" ({key} = {} instead of {})", values[place], values[0])
        }
        _ => String::new(),
    }
}

/// By how much the largest responses differ.
fn sizes(levels: &[[&Level; 2]]) -> Option<String> {
    let all: Vec<Pair<'_>> = levels.iter().filter_map(Pair::of).collect();
    let known: Vec<&Pair<'_>> = all.iter().filter(|pair| pair.is_known).collect();
    let bounds = match all.len() - known.len() {
        0 => String::new(),
        1 => " (at 1 level not both are known to their largest)".into(),
        some => format!(" (at {some} levels not both are known to their largest)"),
    };
    let told = match &known[..] {
        [] => return (!all.is_empty()).then(|| "by how much the largest responses differ is not known".into()),
        few if few.iter().all(|pair| pair.change.abs() <= SAME) => {
            "the largest responses are the same, within 0.1 %".to_string()
        }
        few if few.len() <= NAMED => {
            let each = few.iter().map(|pair| format!("{} at A = {}", changed(pair.change), pair.amplitude));
            format!("the largest response is {}", listed(&each.collect::<Vec<_>>()))
        }
        many => {
            let mut sorted = many.to_vec();
            sorted.sort_by(|a, b| a.change.total_cmp(&b.change));
            let [low, high] = [sorted[0], sorted[sorted.len() - 1]]
                .map(|pair| format!("{} (A = {})", changed(pair.change), pair.amplitude));
            format!("the largest responses are between {low} and {high}")
        }
    };
    Some(told + &bounds)
}

/// `40 % smaller`.
fn changed(change: f64) -> String {
    match change {
        same if same.abs() <= SAME => "the same".into(),
        less if less < 0.0 => format!("{} % smaller", digits(-100.0 * less, 3)),
        more if more < 9.0 => format!("{} % larger", digits(100.0 * more, 3)),
        more => format!("{} times as large", digits(1.0 + more, 3)),
    }
}

/// At how many levels either has isolas.
fn isolas(levels: &[[&Level; 2]]) -> Option<String> {
    let [ours, theirs] = [0, 1].map(|run| levels.iter().filter(|pair| pair[run].isolas().next().is_some()).count());
    let all = levels.len();
    match (ours, theirs) {
        _ if all == 0 => None,
        (0, 0) => Some(format!("isolas in neither at the {} that both have", count(all, "level"))),
        (1, 0) if all == 1 => Some("no isola, where the other has some".into()),
        (0, 1) if all == 1 => Some("isolas, where the other has none".into()),
        (1, 1) if all == 1 => Some("isolas in both".into()),
        (ours, theirs) if ours == theirs => Some(format!("isolas at {ours} of {all} levels in both")),
        (ours, theirs) => Some(format!("isolas at {theirs} of {all} levels instead of {ours}")),
    }
}

/// Isolas that a run has at levels that the other has not.
fn isolas_alone(name: &str, run: &Report, against: &Report) -> Option<String> {
    let has = |level: &Level| against.overview.levels.iter().any(|other| other.value == level.value);
    let alone = run.overview.levels.iter().filter(|level| level.isolas().next().is_some() && !has(level));
    let list: Vec<String> = alone.map(|level| level.amplitude.clone()).collect();
    let levels = if list.len() == 1 { "a level that the other has not" } else { "levels that the other has not" };
    (!list.is_empty()).then(|| format!("`{name}` has isolas at A = {} too, {levels}", listed_first(list, NAMED)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;
    use solver::response::certificate::Standing;

    fn level(amplitude: &str, peak: f64, standing: Standing, isolas: usize) -> Level {
        let main = BranchRow {
            kind: "main".into(),
            amplitude_max: peak,
            peak_standing: Some(standing),
            ..BranchRow::default()
        };
        let isola = |number| BranchRow { kind: "isola".into(), closed: true, number, ..BranchRow::default() };
        let branches = [main].into_iter().chain((1..=isolas).map(isola)).collect();
        Level { amplitude: amplitude.into(), branches, ..Level::default() }
    }

    #[test]
    fn how_much_larger_or_smaller() {
        let told = |pairs: &[(f64, f64, Standing)]| {
            let levels: Vec<[Level; 2]> = (1..)
                .zip(pairs)
                .map(|(k, &(a, b, standing)): (usize, _)| {
                    [level(&k.to_string(), a, Standing::At, 0), level("", b, standing, 0)]
                })
                .collect();
            sizes(&levels.iter().map(|pair| pair.each_ref()).collect::<Vec<_>>())
        };
        let (at, least) = (Standing::At, Standing::AtLeast);
        assert_eq!(told(&[]), None);
        assert_eq!(told(&[(1.0, 1.0005, at)]).unwrap(), "the largest responses are the same, within 0.1 %");
        assert_eq!(
            told(&[(1.0, 0.6, at), (1.0, 1.25, at), (2.0, 2.0, at)]).unwrap(),
            "the largest response is 40 % smaller at A = 1, 25 % larger at A = 2 and the same at A = 3"
        );
        assert_eq!(
            told(&[(1.0, 0.6, at), (1.0, 12.5, at), (1.0, 0.7, at), (1.0, 1.0, at)]).unwrap(),
            "the largest responses are between 40 % smaller (A = 1) and 12.5 times as large (A = 2)"
        );
        assert_eq!(
            told(&[(1.0, 0.6, at), (1.0, 3.0, least)]).unwrap(),
            "the largest response is 40 % smaller at A = 1 (at 1 level not both are known to their largest)"
        );
        assert_eq!(told(&[(1.0, 3.0, least)]).unwrap(), "by how much the largest responses differ is not known");
    }

    #[test]
    fn at_how_many_levels_there_are_isolas() {
        let told = |counts: &[[usize; 2]]| {
            let levels: Vec<[Level; 2]> =
                counts.iter().map(|pair| pair.map(|isolas| level("1", 1.0, Standing::At, isolas))).collect();
            isolas(&levels.iter().map(|pair| pair.each_ref()).collect::<Vec<_>>())
        };
        assert_eq!(told(&[]), None);
        assert_eq!(told(&[[0, 0], [0, 0]]).unwrap(), "isolas in neither at the 2 levels that both have");
        assert_eq!(told(&[[0, 2]]).unwrap(), "isolas, where the other has none");
        assert_eq!(told(&[[1, 0], [1, 1]]).unwrap(), "isolas at 1 of 2 levels instead of 2");
        assert_eq!(told(&[[1, 2], [0, 0]]).unwrap(), "isolas at 1 of 2 levels in both");
    }

    #[test]
    fn the_only_setting_that_differs_is_named() {
        let row =
            |key: &str, values: [&str; 2]| SettingRow { key: key.into(), values: values.map(String::from).into() };
        let one = row("contact.friction", ["0.1", "0"]);
        assert_eq!(by(std::slice::from_ref(&one), 1), " (contact.friction = 0 instead of 0.1)");
        let levels = row("amplitudes", ["[1]", "[1, 2]"]);
        assert_eq!(by(std::slice::from_ref(&levels), 1), "");
        assert_eq!(by(&[levels, one.clone()], 1), " (contact.friction = 0 instead of 0.1)");
        assert_eq!(by(&[one, row("harmonics.count", ["3", "5"])], 1), "");
    }
}
