//! What time marching says of branches, in a sentence or two.

use super::Units;
use crate::overview::{BranchRow, Level, StableResponse, largest_stable, stability_of};

/// Share of the points of an isola above which it is told that time marching could not tell.
const UNTOLD: f64 = 0.2;

/// What is known of the stability of isolas, and of other branches where it is not that they are stable or so in parts. `None` if nothing
/// was verified, or there is nothing to be told; `is_told`: that the largest one is stable is known already.
pub(super) fn sentence(levels: &[Level], units: Units, is_told: bool) -> Option<String> {
    let (length, frequency) = (units.length, units.frequency);
    let isolas: Vec<(&str, &BranchRow)> =
        levels.iter().flat_map(|level| level.isolas().map(move |row| (level.amplitude.as_str(), row))).collect();
    let largest = largest_stable(levels, BranchRow::is_isola).filter(|_| !is_told);
    let up_to = largest.map_or_else(String::new, |StableResponse { level, branch, omega, amplitude }| {
        // A marched orbit has no truncation, and may be larger than what has.
        let marched = if amplitude > branch.amplitude_max { " (as marched, without truncation)" } else { "" };
        let (up_to, at) = (format!("{} {length}{marched}", length.digits(amplitude)), frequency.told(omega));
        match isolas.len() {
            1 => format!("; the largest of its responses found stable: {up_to} at {at}"),
            _ => {
                let on = format!("{} at A = {} and {at}", branch.name(), level.amplitude);
                format!("; the largest of their responses found stable: {up_to}, on {on}")
            }
        }
    });
    let untold = untold(levels).unwrap_or_default();
    let of_isolas = stability_of(&isolas, ["isola", "isolas"], "").map(|found| found.told + &up_to + &untold);
    let doubtful = beside_isolas(levels).filter(|(_, is_stable)| !is_stable).map(|(found, _)| found);
    let groups: Vec<String> = of_isolas.into_iter().chain(doubtful).collect();
    (!groups.is_empty()).then(|| format!("By time marching, {}.", groups.join("; ")))
}

/// The isola with most points of which time marching could not tell, if these are many: it may be stable there as well.
fn untold(levels: &[Level]) -> Option<String> {
    let share = |row: &BranchRow| {
        let known = row.stability.as_ref().filter(|known| known.is_whole && !known.is_marginal_in_parts)?;
        Some(1.0 - known.stable - known.unstable)
    };
    let isolas = levels.iter().flat_map(|level| level.isolas().filter_map(move |row| Some((level, row, share(row)?))));
    let (level, row, share) = isolas.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(.., share)| *share > UNTOLD)?;
    let percent = (100.0 * share).round();
    Some(format!("; at {percent} % of the points of {} at A = {} it could not tell", row.name(), level.amplitude))
}

/// What is known of the stability of branches that are no isolas. `None` if none of them was verified.
pub(crate) fn of_others(levels: &[Level]) -> Option<String> {
    let groups: Vec<String> = beside_isolas(levels).map(|(found, _)| found).collect();
    (!groups.is_empty()).then(|| format!("By time marching, {}.", groups.join("; ")))
}

/// The same of main branches and of others, and whether all of them are stable at least in parts.
fn beside_isolas(levels: &[Level]) -> impl Iterator<Item = (String, bool)> {
    let rows = || levels.iter().flat_map(|level| level.branches.iter().map(move |row| (level.amplitude.as_str(), row)));
    let mains: Vec<(&str, &BranchRow)> = rows().filter(|(_, row)| row.is_main()).collect();
    let others: Vec<(&str, &BranchRow)> = rows().filter(|(_, row)| !row.is_main() && !row.is_isola()).collect();
    let is_part = |(_, row): &(&str, &BranchRow)| row.stability.as_ref().is_some_and(|stability| !stability.is_whole);
    let is_cut = mains.iter().any(|(_, row)| !row.at_least().is_empty());
    let around = match (mains.iter().any(is_part), mains.len() == 1, is_cut) {
        (false, ..) => "",
        (_, true, false) => ", around its peak,",
        (_, true, true) => ", around its largest response,",
        (_, false, false) => ", around their peaks,",
        (_, false, true) => ", around their largest responses,",
    };
    // What comes from both sides and does not meet is one branch or two.
    let are_pieces = levels.iter().any(|level| level.mains().count() > 1);
    let main_branches = if are_pieces { "main branches or pieces of them" } else { "main branches" };
    let groups = [
        (stability_of(&mains, ["main branch", main_branches], around), mains.len()),
        (stability_of(&others, ["other branch", "other branches"], ""), others.len()),
    ];
    groups.into_iter().filter_map(|(found, all)| found.map(|found| (found.told, found.stable == all)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{PeakOrbit, Stability};
    use solver::response::branch::Standing;

    fn branch(kind: &str, [stable, unstable]: [f64; 2], amplitude: f64) -> BranchRow {
        let peak = Some(PeakOrbit { verdict: "unstable".into(), at: Some((2.5, amplitude)) });
        let largest = (stable > 0.0).then_some((2.0, 0.5 * amplitude));
        BranchRow {
            kind: kind.into(),
            number: 1,
            closed: kind == "isola",
            amplitude_max: amplitude,
            stability: Some(Stability {
                is_whole: kind != "main",
                stable,
                unstable,
                peak,
                largest,
                ..Stability::default()
            }),
            ..BranchRow::default()
        }
    }

    fn level(branches: Vec<BranchRow>) -> [Level; 1] {
        [Level { amplitude: "14".into(), branches, ..Level::default() }]
    }

    fn told(branches: Vec<BranchRow>) -> Option<String> {
        sentence(&level(branches), Units::default(), false)
    }

    #[test]
    fn pieces_of_main_branches_are_called_so() {
        let cut = BranchRow { peak_standing: Some(Standing::AtLeast), ..branch("main", [0.2, 0.0], 1.0) };
        let said = of_others(&level(vec![cut.clone(), cut.clone()])).unwrap();
        let expected =
            "both main branches or pieces of them, around their largest responses, are stable wherever it could tell";
        assert!(said.contains(expected), "{said}");
        let said = of_others(&level(vec![cut])).unwrap();
        assert!(said.contains("the main branch, around its largest response, is stable"), "{said}");
    }

    /// What is stable at least in parts is no doubt: of branches that are no isolas the report tells it, with all others.
    #[test]
    fn every_kind_has_its_counts() {
        let isolas = [branch("isola", [0.5, 0.5], 2.0), branch("isola", [0.0, 0.1], 3.0)];
        let others = vec![branch("main", [0.2, 0.0], 1.0), branch("cut", [0.0, 0.0], 0.5)];
        let all = [isolas.to_vec(), others].concat();
        let begins = "By time marching, of 2 isolas 1 is stable in parts, 1 is unstable wherever it could tell";
        let untold = "; at 90 % of the points of isola 1 at A = 14 it could not tell";
        assert_eq!(
            told(all.clone()).unwrap(),
            format!(
                "{begins}; the largest of their responses found stable: 1.0000 m, on isola 1 at A = 14 and 2.00000 rad/s{untold}; the other \
                 branch is not known to be stable or unstable."
            )
        );
        // Up to where they are stable need not be told twice.
        let briefly = sentence(&level(all.clone()), Units::default(), true).unwrap();
        assert_eq!(briefly, format!("{begins}{untold}; the other branch is not known to be stable or unstable."));
        assert_eq!(
            of_others(&level(all)).unwrap(),
            "By time marching, the main branch, around its peak, is stable wherever it could tell; the other branch is not known to be stable or \
             unstable."
        );
        assert_eq!(told(vec![branch("main", [0.2, 0.0], 1.0), branch("main", [0.2, 0.1], 1.0)]), None);
    }

    /// A structure that nothing holds goes on anywhere: a multiplier is 1 on all of it that its unstable part is not.
    #[test]
    fn what_is_marginal_is_not_unstable() {
        let row = branch("main", [0.0, 0.2], 1.0);
        let marginal = row.stability.clone().map(|known| Stability { is_marginal_in_parts: true, ..known });
        let said = told(vec![BranchRow { stability: marginal, ..row }]).unwrap();
        assert_eq!(said, "By time marching, the main branch, around its peak, is unstable or marginal.");
    }

    #[test]
    fn what_was_not_verified_is_told_beside_what_was() {
        let bare = |kind| BranchRow { stability: None, ..branch(kind, [0.0; 2], 4.0) };
        assert_eq!(told(vec![bare("main"), bare("isola")]), None);
        assert_eq!(
            told(vec![bare("main"), bare("isola"), branch("isola", [1.0, 0.0], 2.0)]).unwrap(),
            "By time marching, of 2 isolas 1 is stable wherever it could tell, 1 is not verified; the largest of their responses found \
             stable: 1.0000 m, on isola 1 at A = 14 and 2.00000 rad/s."
        );
        // Of some main branches alone it is a doubt.
        let said = told(vec![bare("main"), branch("main", [0.2, 0.0], 1.0)]).unwrap();
        assert!(said.contains("1 is not verified"), "{said}");
    }
}
