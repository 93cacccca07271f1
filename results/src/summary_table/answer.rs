//! What is said above the table: what its reader has to know first, what is doubtful, whether there are isolas, and the largest response.

use super::known::Known;
use super::monitors::of_first;
use super::units::Units;
use super::{search, stability};
use crate::overview::{
    Doubts, Level, amplitude_bound, around_largest, asks_for_harmonics, cut_mains, damage_sentence, highest, in_words,
    largest_stable_sentence, near_largest, passed_over_sentence, truncation_of, turned_sliding, undecided_kinds,
    unfinished, unstable_peak_sentence,
};
use crate::words::{capitalised, listed};
use solver::response::branch::BranchKind;

/// Levels with isolas that are named one by one.
const NAMED: usize = 6;

/// A relative difference of amplitudes that is told of what time marching has beside a response.
const TOLD: f64 = 1e-3;

/// All of it, sentence by sentence.
pub(super) fn answer(known: &Known, units: Units) -> Vec<String> {
    let levels = known.levels();
    (damage_sentence(known.damaged).into_iter())
        .chain(search::excitation(known, units))
        .chain(unfinished(levels, !known.awaits_backbones))
        .chain(
            truncation_of(known.model.as_ref(), levels, known.settings.as_ref(), known.is_further, |omega| {
                units.frequency.told(omega)
            })
            .filter(|said| asks_for_harmonics(said)),
        )
        .chain(known.doubts.as_deref().map(|doubts| format!("{}.", capitalised(doubts))))
        .chain(amplitude_bound(
            levels,
            &known.mains,
            &known.curves,
            known.settings.as_ref().and_then(|settings| settings.branch.max_amplitude),
            |size| format!("{} {}", units.length.digits(size), units.length),
            |omega| units.frequency.told(omega),
        ))
        .chain(
            undecided_kinds(levels, |size| format!("{} {}", units.length.digits(size), units.length))
                .into_iter()
                .map(|(_, sentence)| sentence),
        )
        .chain(cut_mains(levels, known.given).map(|(_, sentence)| sentence))
        .chain(
            isolas(levels, known.settings.as_ref().map_or("", search::only_windows))
                .map(|found| found + &beside(known, units))
                .or_else(|| search::no_isola(known, units))
                .map(|found| found + &detached(levels)),
        )
        .chain(largest(levels, &known.monitors, units))
        .chain(stability::sentence(levels, units, is_told(levels)))
        .chain(unstable_peak_sentence(levels, !known.motions.is_empty()))
        .chain(turned_sliding(levels))
        .collect()
}

/// At which levels isolas were found, and whether something speaks against them. `None` if there are none.
fn isolas(levels: &[Level], only: &str) -> Option<String> {
    let with: Vec<&Level> = levels.iter().filter(|level| level.isolas().next().is_some()).collect();
    let list = match &with[..] {
        [] => return None,
        few if few.len() <= NAMED => {
            let number = |level: &Level| match level.isolas().count() {
                1 => level.amplitude.clone(),
                several => format!("{} ({several} there)", level.amplitude),
            };
            listed(&few.iter().map(|level| number(level)).collect::<Vec<_>>())
        }
        many => format!("{} to {}", many[0].amplitude, many[many.len() - 1].amplitude),
    };
    let branches = || with.iter().flat_map(|level| level.isolas());
    let (all, doubt) = (branches().count(), Doubts::about(branches()).sentence());
    let doubt = doubt.map(|doubt| format!(" {doubt}")).unwrap_or_default();
    let found = if all == 1 { "An isola was found" } else { "Isolas were found" };
    let is_final = |level: &Level| level.is_complete() || (level.is_damaged && level.pending == 0);
    let so_far = if levels.iter().all(is_final) { "" } else { " so far" };
    let share = match levels.len() {
        1 => String::new(),
        count => format!("{} of {count} levels, ", with.len()),
    };
    let is_undecided = |level: &Level| level.isolas().next().is_none() && level.has_undecided();
    let others = match levels.iter().filter(|level| is_undecided(level)).count() {
        0 => "",
        _ => " What is cut or unfinished at others may be one.",
    };
    let only = if only.is_empty() { String::new() } else { format!(",{only}") };
    Some(format!("{found}{so_far} at {share}A = {list}{only}.{doubt}{others}"))
}

/// What fold curves have at levels at which no isola was found, though at others there are some.
fn beside(known: &Known, units: Units) -> String {
    let there = search::overlooked_isola(known, units);
    there.map_or_else(String::new, |there| format!(" Along fold curves {there}, where none was found."))
}

/// That what is detached need not be closed.
fn detached(levels: &[Level]) -> String {
    let open = levels.iter().flat_map(Level::others).filter(|row| row.kind == BranchKind::Open.name()).count();
    match open {
        0 => String::new(),
        1 => " One branch that is not closed is detached from the main branch as well (open).".into(),
        several => format!(" {several} branches that are not closed are detached from the main branch as well (open)."),
    }
}

/// Whether the largest response is on an isola, and stable: nothing larger can be.
fn is_told(levels: &[Level]) -> bool {
    let row = highest(levels.iter().filter_map(Level::peak)).filter(|row| row.is_isola());
    let peak = row.and_then(|row| row.stability.as_ref()?.peak.as_ref());
    peak.is_some_and(|peak| peak.verdict == "stable")
}

/// The largest response, and whether it is stable.
fn largest(levels: &[Level], monitors: &[String], units: Units) -> Option<String> {
    let size = |amplitude| format!("{} {}", units.length.digits(amplitude), units.length);
    let rate = |omega| units.frequency.told(omega);
    let rows = levels.iter().flat_map(|level| level.peak().map(|row| (level, row)));
    let (level, row) = rows.max_by(|a, b| a.1.amplitude_max.total_cmp(&b.1.amplitude_max))?;
    let [before, behind] = around_largest(row);
    let place = format!(
        "{before}{}{behind} at {}, on {} at A = {}",
        size(row.amplitude_max),
        rate(row.omega_at_max),
        in_words(row),
        level.amplitude
    );
    let peak = row.stability.as_ref().and_then(|known| known.peak.as_ref());
    let is_as_marched = |amplitude: f64| (amplitude / row.amplitude_max - 1.0).abs() < TOLD;
    let stability = match peak {
        None if levels.iter().any(|level| level.pending > 0) => ". Whether it is stable is not verified yet.".into(),
        None => ". Whether it is stable was not verified (isola verify RUN does).".to_string(),
        Some(peak) if peak.verdict == "stable" && peak.at.is_some_and(|(_, amplitude)| is_as_marched(amplitude)) => {
            ", stable by time marching.".into()
        }
        Some(peak) => format!(". {}", near_largest(peak, row.amplitude_max, size, rate)),
    };
    let stable =
        largest_stable_sentence(levels, size, rate).map_or_else(String::new, |sentence| format!(" {sentence}"));
    let larger = passed_over_sentence(levels, size).map_or_else(String::new, |sentence| format!(" {sentence}"));
    let of = of_first(monitors);
    Some(format!("Largest computed response{of}: {place}{stability}{stable}{larger}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overview::BranchRow;
    use crate::store::{PeakOrbit, Stability};
    use solver::response::certificate::{Certificate, Change, Standing};

    fn row(kind: &str, amplitude: f64, verdict: Option<&str>) -> BranchRow {
        let at = Some((2.0, 1.01 * amplitude));
        let stability = verdict.map(|verdict| Stability {
            peak: Some(PeakOrbit { verdict: verdict.into(), at: if verdict == "none" { None } else { at } }),
            ..Stability::default()
        });
        BranchRow {
            kind: kind.into(),
            number: 1,
            closed: kind == "isola",
            amplitude_max: amplitude,
            omega_at_max: 2.0,
            stability,
            ..BranchRow::default()
        }
    }

    fn level(amplitude: &str, branches: Vec<BranchRow>) -> Level {
        Level { amplitude: amplitude.into(), branches, ..Level::default() }
    }

    #[test]
    fn levels_with_isolas_are_named() {
        let main = || row("main", 1.0, None);
        let isola = || row("isola", 2.0, None);
        let mut levels = vec![level("1", vec![main()]), level("2", vec![main(), isola()])];
        assert_eq!(isolas(&levels[..1], ""), None);
        assert_eq!(isolas(&levels, "").unwrap(), "An isola was found at 1 of 2 levels, A = 2.");
        assert_eq!(isolas(&levels[1..], "").unwrap(), "An isola was found at A = 2.");
        levels.push(level("3", vec![main(), isola(), isola()]));
        assert_eq!(isolas(&levels, "").unwrap(), "Isolas were found at 2 of 3 levels, A = 2 and 3 (2 there).");
        levels[0].pending = 1;
        assert!(isolas(&levels, "").unwrap().starts_with("Isolas were found so far at 2 of 3"));
        levels.extend((4..9).map(|a| level(&a.to_string(), vec![main(), isola()])));
        assert!(isolas(&levels, "").unwrap().ends_with("at 7 of 8 levels, A = 2 to 8."));
        assert_eq!(detached(&levels), "");
        let open = level("9", vec![main(), row("open", 3.0, None)]);
        assert!(detached(&[open]).contains("One branch that is not closed"));
    }

    /// What neither more harmonics nor time marching confirm is said to be doubtful where isolas are told.
    #[test]
    fn isolas_that_nothing_confirms() {
        let unconfirmed = || row("isola", 2.0, Some("none"));
        let confirmed = || row("isola", 2.0, Some("stable"));
        let told = |branches| isolas(&[level("1", branches)], "").unwrap();
        assert!(told(vec![unconfirmed()]).ends_with(" It may be an artefact of too few harmonics."));
        assert!(
            told(vec![unconfirmed(), unconfirmed()])
                .ends_with(" All of these isolas may be artefacts of too few harmonics.")
        );
        assert!(told(vec![unconfirmed(), confirmed()]).contains(" Some of these isolas may be artefacts"));
    }

    /// Where time marching cannot tell, or was not asked, that twice the harmonics have no such isola is said where it is told.
    #[test]
    fn isolas_that_twice_the_harmonics_do_not_have() {
        let lost = |verdict| BranchRow { peak_standing: Some(Standing::At), ..row("isola", 2.0, verdict) };
        let told = |branches| isolas(&[level("1", branches)], "").unwrap();
        for verdict in [None, Some("not_comparable")] {
            assert!(told(vec![lost(verdict)]).ends_with(" Twice the harmonics do not confirm it."));
        }
        assert!(told(vec![lost(None), lost(None)]).ends_with(" Twice the harmonics confirm none of these isolas."));
        assert!(
            told(vec![lost(None), row("isola", 2.0, None)])
                .contains(" Twice the harmonics do not confirm all of these isolas.")
        );
    }

    /// A largest response where a branch ends is a lower bound only of what has converged; and where another branch goes on, one there may
    /// be larger.
    #[test]
    fn what_goes_on_may_be_larger() {
        let ends = |elsewhere| {
            let certificate = Certificate { elsewhere, ..Certificate::default() };
            BranchRow { peak_standing: Some(Standing::AtLeast), certificate, ..row("main", 1.0, None) }
        };
        let told = |branches| largest(&[level("1", branches)], &[], Units::default()).unwrap();
        let moved = |share| Some(Change { omega: 1.0, share });
        for converged in [None, moved(Some(1e-3))] {
            assert!(
                told(vec![ends(converged)])
                    .starts_with("Largest computed response: at least 1.0000 m at 2.00000 rad/s")
            );
        }
        for (change, doubt) in
            [(moved(None), "not known to have converged in H"), (moved(Some(0.05)), "not converged in H")]
        {
            let begins = format!("Largest computed response: 1.0000 m ({doubt}) at 2.00000 rad/s");
            assert!(told(vec![ends(change)]).starts_with(&begins));
        }
        let said = told(vec![ends(None), row("main", 2.0, None)]);
        assert!(said.starts_with("Largest computed response: 2.0000 m at"), "{said}");
    }

    #[test]
    fn the_largest_response_and_whether_it_is_stable() {
        let told = |verdict| {
            largest(
                &[level("1", vec![row("main", 1.0, Some("stable")), row("isola", 2.0, verdict)])],
                &[],
                Units::default(),
            )
        };
        let begins = "Largest computed response: 2.0000 m at 2.00000 rad/s, on isola 1 at A = 1";
        assert_eq!(
            told(None).unwrap(),
            format!("{begins}. Whether it is stable was not verified (isola verify RUN does).")
        );
        let said = told(Some("stable")).unwrap();
        assert!(said.starts_with(&format!("{begins}. The periodic motion")) && said.contains("(1.0 % more)"), "{said}");
        assert!(
            told(Some("unstable")).unwrap().ends_with("is unstable, which the largest response itself need not be.")
        );
        assert!(told(Some("none")).unwrap().contains("time marching came to no periodic motion near it"));
        let mut exact = row("isola", 2.0, Some("stable"));
        exact.stability.as_mut().unwrap().peak.as_mut().unwrap().at = Some((2.0, 2.0001));
        let said = largest(&[level("1", vec![exact])], &[], Units::default()).unwrap();
        assert_eq!(said, format!("{begins}, stable by time marching."));
        assert_eq!(largest(&[Level::default()], &[], Units::default()), None);
    }

    /// Nobody meets what is pressed together for ever, and falls apart at a touch.
    #[test]
    fn open_branches_that_are_unstable_all_along_do_not_come_first() {
        let open = |is_whole, stable| {
            let known = Stability { is_whole, stable, unstable: 0.5, ..Stability::default() };
            BranchRow { stability: Some(known), ..row("open", 9.0, None) }
        };
        let told = |branches| largest(&[level("1", branches)], &[], Units::default()).unwrap();
        let main = || row("main", 1.0, Some("stable"));
        let said = told(vec![main(), open(true, 0.0)]);
        assert!(said.starts_with("Largest computed response: 1.0000 m at"), "{said}");
        let larger = " Larger is an open branch, which is unstable wherever time marching could tell: up to 9.0000 m.";
        assert!(said.ends_with(larger), "{said}");
        let several = told(vec![main(), open(true, 0.0), open(true, 0.0)]);
        assert!(several.contains(" Larger are open branches alone, which are unstable wherever"), "{several}");
        for open in [open(false, 0.0), open(true, 0.1)] {
            let said = told(vec![main(), open]);
            assert!(said.starts_with("Largest computed response: 9.0000 m at") && !said.contains("Larger"), "{said}");
        }
    }
}
