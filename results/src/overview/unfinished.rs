//! Which levels are not finished, in sentences.

use super::level::Level;

/// How many levels a sentence names.
const NAMED: usize = 8;

/// What the levels of a run still lack.
pub fn unfinished(levels: &[Level], has_backbone: bool) -> Vec<String> {
    if !has_backbone {
        return vec!["There is no backbone yet, and so there are no windows and no branches.".into()];
    }
    let pending = count(levels, |level| level.pending);
    let dead = count(levels, |level| level.dead);
    let refuted = count(levels, |level| level.refuted);
    let disputed = count(levels, |level| level.disputed);
    let bare = count(levels, |level| usize::from(level.is_bare()));
    let sentences = [
        pending
            .map(|(tasks, list)| {
                let tasks = number(tasks, "task is", "tasks are");
                format!("{tasks} still to be done, at A = {list}, verifications and what follows from results not counted.")
            }),
        dead.map(|(tasks, list)| {
            format!("{} given up, at A = {list}: `isola retry-dead RUN` tries them again.", number(tasks, "task was", "tasks were"))
        }),
        refuted.map(|(results, list)| {
            let results = number(results, "result is", "results are");
            format!(
                "{results} wrong, at A = {list}: two other workers came to something else, and what follows from it is in the run. \
                 Compute these levels again in a run of their own."
            )
        }),
        disputed.map(|(results, list)| {
            let results = number(results, "result is", "results are");
            format!(
                "{results} doubtful, at A = {list}: another worker came to something else, and no third one decided: \
                 `isola resume RUN` asks one, if others are there."
            )
        }),
        bare.map(|(_, list)| format!("No branch is known at A = {list}.")),
    ];
    sentences.into_iter().flatten().collect()
}

/// Sum over the levels, and the levels that count; `None` if none does.
fn count(levels: &[Level], of: impl Fn(&Level) -> usize) -> Option<(usize, String)> {
    let counted: Vec<&Level> = levels.iter().filter(|level| of(level) > 0).collect();
    let named: Vec<&str> = counted.iter().take(NAMED).map(|level| level.amplitude.as_str()).collect();
    let list = match counted.len() {
        0 => return None,
        all if all > NAMED => format!("{} and {} more", named.join(", "), all - NAMED),
        _ => named.join(", "),
    };
    Some((counted.into_iter().map(of).sum(), list))
}

fn number(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
