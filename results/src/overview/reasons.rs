//! Why windows led to nothing, in few words.

/// How the reason of seeds begins none of which converged, and what is said of them beside others that did.
const NONE: &str = "nothing converged";
const OTHERS: &str = "other seeds did not converge";

/// Reasons, each once and without the numbers in brackets, which are in `windows.csv`: so windows have the same reason that differ in these
/// alone.
pub fn briefly(reasons: &str) -> String {
    let mut kept: Vec<String> = Vec::new();
    for reason in reasons.split("; ").map(without_brackets) {
        if !kept.contains(&reason) {
            kept.push(reason);
        }
    }
    let is_none = |reason: &String| reason.starts_with(NONE);
    if kept.iter().any(is_none) && !kept.iter().all(is_none) {
        kept.retain(|reason| !is_none(reason));
        kept.push(OTHERS.into());
    }
    kept.join("; ")
}

/// A reason up to what it has in brackets, and from there on.
fn without_brackets(reason: &str) -> String {
    match (reason.find(" ("), reason.rfind(')')) {
        (Some(open), Some(close)) if open < close => format!("{}{}", &reason[..open], &reason[close + 1..]),
        _ => reason.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::briefly;

    #[test]
    fn reasons_that_differ_in_a_number_are_one() {
        let far = |distance| format!("what converged lies on a known branch (relative distance {distance} or more)");
        let none = |residual| format!("nothing converged: no convergence (scaled residual {residual})");
        let all = [far("0.78"), none("4.8e2"), far("0.75"), none("6.0e-1")];
        assert_eq!(briefly(&all.join("; ")), "what converged lies on a known branch; other seeds did not converge");
        assert_eq!(briefly(&all[1]), "nothing converged: no convergence");
        let two = [none("1"), "nothing converged: the iteration diverged".into()].join("; ");
        assert_eq!(briefly(&two), "nothing converged: no convergence; nothing converged: the iteration diverged");
        assert_eq!(briefly(""), "");
        let passed =
            "no seed landed near it, but main passes by (relative distance 0.27): an isola nearby is not excluded";
        assert_eq!(briefly(passed), "no seed landed near it, but main passes by: an isola nearby is not excluded");
    }
}
