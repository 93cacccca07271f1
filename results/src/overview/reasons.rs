//! Why windows led to nothing, in few words.

/// Reasons, of those that differ in their last number alone the one where it is smallest.
pub fn briefly(reasons: &str) -> String {
    let number = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().ok();
    let mut kept: Vec<(String, f64, &str)> = Vec::new();
    for reason in reasons.split("; ") {
        let last = reason.split(' ').rev().find_map(|word| Some((word, number(word)?)));
        let (word, value) = last.unwrap_or(("", 0.0));
        let rest = if word.is_empty() { reason.into() } else { reason.replace(word, "") };
        match kept.iter_mut().find(|(known, ..)| *known == rest) {
            Some(known) if value < known.1 => *known = (rest, value, reason),
            Some(_) => {}
            None => kept.push((rest, value, reason)),
        }
    }
    kept.into_iter().map(|(_, _, reason)| reason).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::briefly;

    #[test]
    fn reasons_that_differ_in_a_number_are_one() {
        let far = |distance| format!("every seed ended far away (relative distance {distance} or more)");
        let none = |residual| format!("no convergence in 20 iterations (scaled residual {residual})");
        let all = [far("0.78"), none("4.8e2"), far("0.75"), none("6.0e-1"), "the iteration diverged".into()];
        assert_eq!(briefly(&all.join("; ")), [far("0.75"), none("6.0e-1"), "the iteration diverged".into()].join("; "));
        assert_eq!(briefly(""), "");
    }
}
