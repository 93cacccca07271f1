//! Branches of which not every point was marched.

use super::level::Level;
use crate::words::capitalised;

/// Of how many branches not every point was looked at that was to be, and how many were: what happens between them may be unseen. `None`
/// if there is no such branch.
pub fn sampled(levels: &[Level]) -> Option<String> {
    let known = || levels.iter().flat_map(|level| &level.branches).filter_map(|row| row.stability.as_ref());
    let numbers = |is_whole: bool| {
        let of_kind = known().filter(|known| known.is_whole == is_whole);
        of_kind.filter_map(|known| known.sampled).collect::<Vec<usize>>()
    };
    let (whole, peaks) = (numbers(true), numbers(false));
    let of_whole = points(&whole).map(|points| match whole.len() {
        1 => format!("of one branch {points}"),
        several => format!("of {several} branches {points} each"),
    });
    let of_peaks = points(&peaks).map(|points| match (peaks.len(), whole.is_empty()) {
        (1, true) => format!("around the largest response of one branch {points}"),
        (1, false) => format!("around the largest response of another branch, {points}"),
        (several, true) => format!("around the largest responses of {several} branches {points} each"),
        (several, false) => format!("around the largest responses of {several} others {points} each"),
    });
    let told: Vec<String> = of_whole.into_iter().chain(of_peaks).collect();
    (!told.is_empty()).then(|| {
        let told = capitalised(&told.join(", and "));
        format!("{told} were looked at, not all: where stability changes and changes back between two of these, that is not seen.")
    })
}

/// `22 points`, or `22 to 31 points`.
fn points(numbers: &[usize]) -> Option<String> {
    let (least, most) = numbers.iter().min().zip(numbers.iter().max())?;
    Some(if least == most { format!("{least} points") } else { format!("{least} to {most} points") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{BranchRow, Stability};

    #[test]
    fn how_many_points_were_looked_at() {
        let row = |(is_whole, sampled)| {
            let stability = Some(Stability { is_whole, sampled, ..Stability::default() });
            BranchRow { stability, ..BranchRow::default() }
        };
        let of = |list: &[(bool, Option<usize>)]| {
            sampled(&[Level { branches: list.iter().map(|known| row(*known)).collect(), ..Level::default() }])
        };
        let told = |list: &[Option<usize>]| of(&list.iter().map(|number| (true, *number)).collect::<Vec<_>>());
        let said = told(&[Some(22), None, Some(31)]).unwrap();
        assert!(
            said.starts_with("Of 2 branches 22 to 31 points each were looked at, not all: where stability changes"),
            "{said}"
        );
        assert!(told(&[Some(22)]).unwrap().starts_with("Of one branch 22 points were"));
        assert_eq!(told(&[None]), None);
        let (isola, main, none) = ((true, Some(22)), (false, Some(3)), (false, None));
        assert!(
            of(&[main, none])
                .unwrap()
                .starts_with("Around the largest response of one branch 3 points were looked at, not all")
        );
        assert!(
            of(&[main, main]).unwrap().starts_with("Around the largest responses of 2 branches 3 points each were")
        );
        let both = of(&[isola, main, main, main]).unwrap();
        assert!(
            both.starts_with(
                "Of one branch 22 points, and around the largest responses of 3 others 3 points each were"
            ),
            "{both}"
        );
    }
}
