//! Branches of which not every point was marched.

use super::level::Level;

/// Of how many branches that were verified as a whole not every point was looked at, and how many were: what happens between them may
/// be unseen. `None` if there is no such branch.
pub fn sampled(levels: &[Level]) -> Option<String> {
    let rows = levels.iter().flat_map(|level| &level.branches);
    let numbers: Vec<usize> = rows.filter_map(|row| row.stability.as_ref()?.sampled).collect();
    let (least, most) = numbers.iter().min().zip(numbers.iter().max())?;
    let points = if least == most { format!("{least}") } else { format!("{least} to {most}") };
    let branches = match numbers.len() {
        1 => format!("Of one branch {points} points"),
        several => format!("Of {several} branches {points} points each"),
    };
    Some(format!(
        "{branches} were looked at, not all: two changes between neighbours that undo each other are not seen."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{BranchRow, Stability};

    #[test]
    fn how_many_points_were_looked_at() {
        let row = |sampled| {
            let stability = Some(Stability { sampled, ..Stability::default() });
            BranchRow { stability, ..BranchRow::default() }
        };
        let told = |list: &[Option<usize>]| {
            sampled(&[Level { branches: list.iter().map(|number| row(*number)).collect(), ..Level::default() }])
        };
        let said = told(&[Some(22), None, Some(31)]).unwrap();
        assert!(said.starts_with("Of 2 branches 22 to 31 points each were looked at, not all: two changes"), "{said}");
        assert!(told(&[Some(22)]).unwrap().starts_with("Of one branch 22 points were"));
        assert_eq!(told(&[None]), None);
    }
}
