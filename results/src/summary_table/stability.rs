//! What time marching says of branches, in a sentence or two.

use super::Units;
use crate::overview::{
    BranchRow, Level, StableResponse, highest, largest_stable, largest_stable_sentence, near_largest, sampled,
};
use crate::store::Stability;
use crate::words::shares;

/// What may be known of a branch.
const CLASSES: [&str; 6] = [
    "stable wherever it could tell",
    "stable in parts",
    "unstable wherever it could tell",
    "unstable or marginal",
    "beyond what it could tell",
    "not verified",
];
const UNVERIFIED: usize = 5;

/// What is known of the stability of branches and of the largest response. `None` if nothing was verified.
pub(super) fn sentences(levels: &[Level], units: Units) -> Option<String> {
    let (length, frequency) = (units.length, units.frequency);
    let rows = || levels.iter().flat_map(|level| &level.branches);
    let isolas: Vec<&BranchRow> = rows().filter(|row| row.is_isola()).collect();
    let mains: Vec<&BranchRow> = rows().filter(|row| row.is_main()).collect();
    let others: Vec<&BranchRow> = rows().filter(|row| !row.is_main() && !row.is_isola()).collect();
    let size = |amplitude| format!("{} {length}", length.digits(amplitude));
    let rate = |omega| format!("{} {frequency}", frequency.digits(omega));
    let largest = largest_stable(levels, BranchRow::is_isola);
    let up_to = largest.map_or_else(String::new, |StableResponse { level, branch, omega, amplitude }| {
        let (up_to, at) = (size(amplitude), rate(omega));
        match isolas.len() {
            1 => format!(" (stable up to {up_to} at {at})"),
            _ => format!(" (stable on isolas up to {up_to}, {} at A = {} and {at})", branch.name(), level.amplitude),
        }
    });
    let is_part = |row: &&BranchRow| row.stability.as_ref().is_some_and(|stability| !stability.is_whole);
    let is_cut = mains.iter().any(|row| !row.at_least().is_empty());
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
        of(&isolas, ["isola", "isolas"], "").map(|found| found + &up_to),
        of(&mains, ["main branch", main_branches], around),
        of(&others, ["other branch", "other branches"], ""),
    ];
    let groups: Vec<String> = groups.into_iter().flatten().collect();
    if groups.is_empty() {
        return None;
    }
    let peak = highest(rows()).and_then(|row| Some((row.stability.as_ref()?.peak.as_ref()?, row.amplitude_max)));
    let peak = peak.map_or("Whether the largest response is stable was not verified.".into(), |(peak, amplitude)| {
        near_largest(peak, amplitude, size, rate)
    });
    let sampled = sampled(levels).map_or_else(String::new, |sentence| format!("{sentence} "));
    let stable =
        largest_stable_sentence(levels, size, rate).map_or_else(String::new, |sentence| format!(" {sentence}"));
    Some(format!("By time marching, {}. {sampled}{peak}{stable}", groups.join("; ")))
}

/// How many branches of a kind are stable and unstable, of those that were verified; `around`: what of them alone was.
fn of(rows: &[&BranchRow], [one, several]: [&str; 2], around: &str) -> Option<String> {
    let class = |row: &&BranchRow| {
        let Some(Stability { stable, unstable, is_marginal_in_parts, .. }) = row.stability.as_ref() else {
            return UNVERIFIED;
        };
        match (*stable > 0.0, *unstable > 0.0) {
            (true, false) => 0,
            (true, true) => 1,
            (false, true) if !is_marginal_in_parts => 2,
            (false, true) => 3,
            (false, false) => 4,
        }
    };
    let mut counts = [0; CLASSES.len()];
    rows.iter().for_each(|row| counts[class(row)] += 1);
    if counts[UNVERIFIED] == rows.len() {
        return None;
    }
    let found: Vec<(usize, &str)> = counts.into_iter().zip(CLASSES).filter(|(count, _)| *count > 0).collect();
    Some(match (rows, &found[..]) {
        ([_], [(_, class), ..]) => format!("the {one}{around} is {class}"),
        _ => shares(&format!("{several}{around}"), &found),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::PeakOrbit;
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

    fn told(branches: Vec<BranchRow>) -> Option<String> {
        sentences(&[Level { amplitude: "14".into(), branches, ..Level::default() }], Units::default())
    }

    #[test]
    fn what_was_sampled_is_said() {
        let sampled = |number| {
            let row = branch("isola", [0.5, 0.5], 2.0);
            BranchRow { stability: row.stability.map(|known| Stability { sampled: Some(number), ..known }), ..row }
        };
        let said = told(vec![sampled(22), branch("isola", [0.5, 0.5], 2.0), sampled(31)]).unwrap();
        assert!(
            said.contains("rad/s). Of 2 branches 22 to 31 points each were looked at, not all: two changes"),
            "{said}"
        );
        assert!(told(vec![sampled(22)]).unwrap().contains("Of one branch 22 points were"));
    }

    #[test]
    fn pieces_of_main_branches_are_called_so() {
        let cut = BranchRow { peak_standing: Some(Standing::AtLeast), ..branch("main", [0.2, 0.0], 1.0) };
        let said = told(vec![cut.clone(), cut.clone()]).unwrap();
        let expected =
            "both main branches or pieces of them, around their largest responses, are stable wherever it could tell";
        assert!(said.contains(expected), "{said}");
        assert!(told(vec![cut]).unwrap().contains("the main branch, around its largest response, is stable"), "{said}");
    }

    #[test]
    fn every_kind_has_its_counts() {
        let isolas = [branch("isola", [0.5, 0.5], 2.0), branch("isola", [0.0, 0.1], 3.0)];
        let others = vec![branch("main", [0.2, 0.0], 1.0), branch("cut", [0.0, 0.0], 0.5)];
        assert_eq!(
            told([isolas.to_vec(), others].concat()).unwrap(),
            "By time marching, of 2 isolas 1 is stable in parts, 1 is unstable wherever it could tell (stable on isolas up to 1.0000 m, \
             isola 1 at A = 14 and 2.00000 rad/s); the main branch, around its peak, is stable wherever it could tell; the other branch is beyond what it could \
             tell. The periodic motion that time marching has near the largest response, 3.0000 m at 2.50000 rad/s, is unstable."
        );
    }

    /// A structure that nothing holds goes on anywhere: a multiplier is 1 on all of it that its unstable part is not.
    #[test]
    fn what_is_marginal_is_not_unstable() {
        let row = branch("main", [0.0, 0.2], 1.0);
        let marginal = row.stability.clone().map(|known| Stability { is_marginal_in_parts: true, ..known });
        let said = told(vec![BranchRow { stability: marginal, ..row }]).unwrap();
        assert!(
            said.starts_with("By time marching, the main branch, around its peak, is unstable or marginal. "),
            "{said}"
        );
    }

    #[test]
    fn what_was_not_verified_is_told_beside_what_was() {
        let bare = |kind| BranchRow { stability: None, ..branch(kind, [0.0; 2], 4.0) };
        assert_eq!(told(vec![bare("main"), bare("isola")]), None);
        assert_eq!(
            told(vec![bare("main"), bare("isola"), branch("isola", [1.0, 0.0], 2.0)]).unwrap(),
            "By time marching, of 2 isolas 1 is stable wherever it could tell, 1 is not verified (stable on isolas up to 1.0000 m, \
             isola 1 at A = 14 and 2.00000 rad/s). Whether the largest response is stable was not verified."
        );
    }
}
