//! Branches of which not every point was marched.

use super::level::Level;

/// How many points of a branch were marched, where these were not all: what happens between them may be unseen. `None` if they were.
pub fn sampled(levels: &[Level]) -> Option<String> {
    let rows = levels.iter().flat_map(|level| &level.branches);
    let numbers: Vec<usize> = rows.filter_map(|row| row.stability.as_ref()?.sampled).collect();
    let (least, most) = numbers.iter().min().zip(numbers.iter().max())?;
    let points = if least == most { format!("{least}") } else { format!("{least} to {most}") };
    Some(format!(
        "{points} points of a branch were marched, not all: two changes between neighbours that undo each other are not seen."
    ))
}
