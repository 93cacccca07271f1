//! Quantities in words, as people say them.

use std::f64::consts::TAU;

/// A length with four digits: `0.948 mm`.
pub fn length(metres: f64) -> String {
    length_among(metres, metres)
}

/// A length with four digits in the unit in which those up to `largest` are read best, m: so that what is compared has one unit.
pub fn length_among(metres: f64, largest: f64) -> String {
    let (factor, unit) = length_unit(largest);
    format!("{} {unit}", digits(metres * factor, 4))
}

/// Units of lengths, and how many of each make a metre.
pub const LENGTH_UNITS: [(f64, &str); 4] = [(1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")];

/// The unit in which lengths up to this one are read best, and how many of it make a metre.
pub fn length_unit(metres: f64) -> (f64, &'static str) {
    LENGTH_UNITS[match metres.abs() {
        size if size >= 1.0 || size == 0.0 || !size.is_finite() => 0,
        size if size >= 1e-4 => 1,
        size if size >= 1e-7 => 2,
        _ => 3,
    }]
}

/// A frequency: `2495 rad/s (397.2 Hz)`.
pub fn frequency(omega: f64) -> String {
    format!("{} rad/s ({} Hz)", digits(omega, 5), digits(omega / TAU, 4))
}

/// The same within parentheses: `2495 rad/s, 397.2 Hz`.
pub fn in_both_units(omega: f64) -> String {
    format!("{} rad/s, {} Hz", digits(omega, 5), digits(omega / TAU, 4))
}

/// Most digits that a narrow range gets beyond those of others.
const FURTHER: i32 = 6;

/// Two frequencies: `2451.2 and 2496.6 rad/s (390.1 and 397.3 Hz)`.
pub fn range((low, high): (f64, f64)) -> String {
    let more = further_digits(low, high, 5).max(further_digits(low / TAU, high / TAU, 4));
    let told = |omega| digits(omega, 5 + more);
    let hertz = |omega| digits(omega / TAU, 4 + more);
    format!("{} and {} rad/s ({} and {} Hz)", told(low), told(high), hertz(low), hertz(high))
}

/// How many digits more than so many tell two numbers apart, as far as that is sensible.
pub(crate) fn further_digits(low: f64, high: f64, count: i32) -> i32 {
    (0..FURTHER).find(|more| digits(low, count + more) != digits(high, count + more)).unwrap_or(0)
}

/// Modes, from 0, by their numbers from 1: `mode 1`, `modes 1 and 3`, `modes 1, 3 and 5 to 9`.
pub fn modes(list: &[usize]) -> String {
    let mut parts: Vec<String> = Vec::new();
    for run in list.chunk_by(|a, b| a + 1 == *b) {
        match run {
            [first, _, .., last] => parts.push(format!("{} to {}", first + 1, last + 1)),
            few => parts.extend(few.iter().map(|mode| (mode + 1).to_string())),
        }
    }
    let last = parts.pop().unwrap_or_default();
    let before = parts.join(", ");
    let numbers = if before.is_empty() { last } else { format!("{before} and {last}") };
    format!("{} {numbers}", if list.len() == 1 { "mode" } else { "modes" })
}

/// `1`, `1 and 2`, `1, 2 and 3`.
pub fn listed(list: &[String]) -> String {
    match list {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The same of the first of a long list, and how many more there are: `1, 2 and 3 more`.
pub fn listed_first(mut list: Vec<String>, most: usize) -> String {
    if list.len() > most {
        let more = list.len() - most;
        list.truncate(most);
        list.push(format!("{more} more"));
    }
    listed(&list)
}

/// So many levels are all named.
const ALL_NAMED: usize = 12;

/// Which forcing levels (values, and as they are written, ascending) there are instead of others: all of them or, of many, those beside the
/// others. Follows "the run has no such level".
pub fn instead(others: &[f64], levels: &[(f64, &str)]) -> String {
    let names = |levels: &[(f64, &str)]| levels.iter().map(|(_, name)| *name).collect::<Vec<_>>().join(", ");
    let [(_, first), .., (_, last)] = levels else { return format!("but {}", names(levels)) };
    if levels.len() <= ALL_NAMED {
        return format!("but {}", names(levels));
    }
    let mut places: Vec<usize> = Vec::new();
    for other in others {
        let above = levels.partition_point(|(value, _)| value < other);
        places.extend([above.checked_sub(1), (above < levels.len()).then_some(above)].into_iter().flatten());
    }
    places.sort_unstable();
    places.dedup();
    let near: Vec<(f64, &str)> = places.into_iter().map(|place| levels[place]).collect();
    format!("but {} nearby ({} levels from {first} to {last})", names(&near), levels.len())
}

/// So many ranges beside those that are named, if there are any.
pub fn more_ranges(more: usize) -> Option<String> {
    match more {
        0 => None,
        1 => Some("in 1 more range".into()),
        more => Some(format!("in {more} more ranges")),
    }
}

/// A number with so many digits, or as many more as keep it on its side of others.
pub fn digits_beside(value: f64, count: i32, others: impl Iterator<Item = f64> + Clone) -> String {
    let is_told = |text: &String| {
        let rounded: f64 = text.parse().unwrap_or(value);
        others.clone().all(|other| rounded.partial_cmp(&other) == value.partial_cmp(&other))
    };
    (count..=15).map(|count| digits(value, count)).find(is_told).unwrap_or_else(|| value.to_string())
}

/// A number with so many digits at most, without exponent unless it is very small.
pub fn digits(value: f64, count: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let before = value.abs().log10().floor() as i32 + 1;
    if before < -3 {
        return format!("{value:.*e}", (count - 1).max(0) as usize);
    }
    let text = format!("{value:.*}", (count - before).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// A number with so many digits, trailing zeros too: for columns of numbers.
pub fn fixed_digits(value: f64, count: i32) -> String {
    let before = value.abs().max(1e-300).log10().floor() as i32 + 1;
    format!("{value:.*}", (count - before).clamp(0, 12) as usize)
}

/// A number to six digits, without trailing zeros, with an exponent where it is read better so.
pub fn number(value: f64) -> String {
    let magnitude = value.abs().log10().floor();
    let (text, exponent) = if value == 0.0 || (-4.0..6.0).contains(&magnitude) {
        let decimals = if value == 0.0 { 0 } else { (5.0 - magnitude) as usize };
        (format!("{value:.decimals$}"), String::new())
    } else {
        let text = format!("{value:.5e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        (mantissa.to_string(), format!("e{exponent}"))
    };
    let digits = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{digits}{exponent}")
}

/// Seconds, minutes or hours, as coarse as people think of them.
pub fn duration(seconds: f64) -> String {
    if seconds < 100.0 {
        format!("{seconds:.0} s")
    } else if seconds < 6000.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

/// A power of ten, exactly the number that is written 1e…
pub fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// A number with one leading digit: 0.05, 200.
pub fn decimal(value: f64) -> String {
    let exponent = (value * 1.001).log10().floor() as i32;
    format!("{value:.*}", (-exponent).max(0) as usize)
}

/// A number with one leading digit: 10⁻⁶, 2·10⁷.
pub fn scientific(value: f64) -> String {
    let exponent = (value * 1.001).log10().floor() as i32;
    let leading = (value / power(exponent)).round();
    let digit = |c: char| {
        if c == '-' {
            '⁻'
        } else {
            ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c as usize - '0' as usize]
        }
    };
    let raised: String = exponent.to_string().chars().map(digit).collect();
    if leading == 1.0 { format!("10{raised}") } else { format!("{leading}·10{raised}") }
}

/// How often: `twice`, `3 times`.
pub fn times(number: usize) -> String {
    if number == 2 { "twice".into() } else { format!("{number} times") }
}

/// A sentence, or its beginning, with a capital letter.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// How many of several things are what: `both isolas are stable`, `of 3 isolas 1 is stable, 2 are unstable`.
pub fn shares<S: AsRef<str>>(things: &str, parts: &[(usize, S)]) -> String {
    let parts: Vec<(usize, &str)> = parts.iter().map(|(n, what)| (*n, what.as_ref())).filter(|(n, _)| *n > 0).collect();
    let all: usize = parts.iter().map(|(n, _)| n).sum();
    match &parts[..] {
        [(2, what)] => format!("both {things} are {what}"),
        [(_, what)] => format!("all {all} {things} are {what}"),
        parts => {
            let said = |(n, what): &(usize, &str)| format!("{n} {} {what}", if *n == 1 { "is" } else { "are" });
            format!("of {all} {things} {}", parts.iter().map(said).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A count with its noun: `1 window`, `3 windows`, `2 branches`.
pub fn count(number: usize, noun: &str) -> String {
    let ending = if noun.ends_with("ch") { "es" } else { "s" };
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}{ending}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_beside_others_are_named() {
        let names: Vec<String> = (1..=20).map(|k| format!("{k}0")).collect();
        let levels: Vec<(f64, &str)> = names.iter().map(|name| (name.parse().unwrap(), name.as_str())).collect();
        assert_eq!(instead(&[25.0, 999.0], &levels[..3]), "but 10, 20, 30");
        assert_eq!(instead(&[25.0], &levels), "but 20, 30 nearby (20 levels from 10 to 200)");
        let several = instead(&[1.0, 25.0, 35.0, 999.0], &levels);
        assert_eq!(several, "but 10, 20, 30, 40, 200 nearby (20 levels from 10 to 200)");
    }

    #[test]
    fn numbers_keep_to_their_side_of_others() {
        let beside = |value, others: &[f64]| digits_beside(value, 3, others.iter().copied());
        assert_eq!(beside(0.80046, &[0.79, 0.81]), "0.8");
        assert_eq!(beside(0.80046, &[0.79, 0.8]), "0.8005");
        assert_eq!(beside(0.7999, &[0.8]), "0.7999");
        assert_eq!(beside(0.8, &[0.8]), "0.8");
    }

    #[test]
    fn quantities() {
        assert_eq!(length(9.4809e-4), "0.9481 mm");
        assert_eq!(length(1.9817e-3), "1.982 mm");
        assert_eq!(length(2.5e-6), "2.5 µm");
        assert_eq!(frequency(2495.39), "2495.4 rad/s (397.2 Hz)");
        assert_eq!(range((0.9, 1.25)), "0.9 and 1.25 rad/s (0.1432 and 0.1989 Hz)");
        assert_eq!(digits(14.4252, 3), "14.4");
        assert_eq!([digits(0.0, 3), digits(140.0, 3), digits(2.0e-7, 3)], ["0", "140", "2.00e-7"]);
        assert_eq!([scientific(2e7), scientific(1e-6), decimal(300.0)], ["2·10⁷", "10⁻⁶", "300"]);
        assert_eq!([count(1, "window"), count(2, "window")], ["1 window", "2 windows"]);
    }

    #[test]
    fn numbers_have_six_digits() {
        let cases = [
            (2333.3301985, "2333.33"),
            (0.001, "0.001"),
            (1e7, "1e7"),
            (0.4, "0.4"),
            (0.0, "0"),
            (-1.0, "-1"),
            (123456.7, "123457"),
            (1.0 / 3.0, "0.333333"),
            (1.234567e-9, "1.23457e-9"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn durations_are_coarse() {
        assert_eq!([duration(2.4), duration(600.0), duration(7200.0)], ["2 s", "10 min", "2.0 h"]);
    }
}
