//! Ranges `start:stop:step` in exact decimal arithmetic.

use super::entry::{Refusal, number};
use crate::reference::MAX_LEVELS;
use protocol::to_everyone::Amplitude;

/// A decimal number, digits × 10^exponent.
#[derive(Debug, Clone, Copy)]
struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse().ok()?),
            None => (text, 0_i32),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
        Some(Self { digits, exponent: exponent.checked_sub(i32::try_from(fraction.len()).ok()?)? })
    }

    /// Digits with another, lower exponent.
    fn scaled(self, exponent: i32) -> Option<i128> {
        let places = u32::try_from(self.exponent.checked_sub(exponent)?).ok()?;
        self.digits.checked_mul(10_i128.checked_pow(places)?)
    }
}

/// Amplitudes of a range, both ends included.
pub(super) fn expand(text: &str) -> Result<Vec<Amplitude>, Refusal> {
    let refused = |remedy: String| Refusal::new(text, remedy);
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [first, last, step] = parts[..] else {
        return Err(refused("write a range as start:stop:step, like 20:140:20".into()));
    };
    for end in [first, last] {
        number(end).map_err(|refusal| refused(format!("its end {}: {}", refusal.value, refusal.remedy)))?;
    }
    match step.parse::<f64>() {
        Ok(value) if value != 0.0 && value.is_finite() => {}
        _ => return Err(refused(format!("the step `{step}` must be a finite number other than zero"))),
    }
    let decimals = [first, last, step].map(Decimal::parse);
    let steps = match decimals {
        [Some(first), Some(last), Some(step)] => Steps::new(first, last, step),
        _ => None,
    };
    let Some(steps) = steps else {
        return Err(refused("its numbers have too many digits or differ too much in size; give a list".into()));
    };
    steps.check(first, last, step).map_err(refused)?;
    Ok((0..=steps.count()).map(|i| steps.level(i)).collect())
}

/// A range in units of 10^exponent.
struct Steps {
    start: i128,
    span: i128,
    step: i128,
    exponent: i32,
}

impl Steps {
    fn new(first: Decimal, last: Decimal, step: Decimal) -> Option<Self> {
        let exponent = first.exponent.min(last.exponent).min(step.exponent);
        let start = first.scaled(exponent)?;
        let step = step.scaled(exponent).filter(|step| *step != 0)?;
        let span = last.scaled(exponent)?.checked_sub(start)?;
        // One step past the end must be a number too: messages propose it.
        start.checked_add(span)?.checked_add(step)?;
        Some(Self { start, span, step, exponent })
    }

    fn count(&self) -> i128 {
        self.span / self.step
    }

    fn level(&self, i: i128) -> Amplitude {
        // Parsing rounds correctly, so the value is the number nearest to the decimal.
        let value = format!("{}e{}", self.start + i * self.step, self.exponent).parse().unwrap_or(f64::NAN);
        Amplitude { text: shortest(value), value }
    }

    /// Refuses steps away from the end, past it, and too many; the parts are those of the text.
    fn check(&self, first: &str, last: &str, step: &str) -> Result<(), String> {
        if self.span != 0 && (self.span > 0) != (self.step > 0) {
            let turned = step.strip_prefix('-').map_or_else(|| format!("-{step}"), str::to_string);
            return Err(format!("the step leads away from {last}; write {first}:{last}:{turned}"));
        }
        if self.span % self.step != 0 {
            let (before, after) = (self.level(self.count()), self.level(self.count() + 1));
            let near: Vec<&Amplitude> = [&before, &after].into_iter().filter(|near| near.value > 0.0).collect();
            let reached: Vec<&str> = near.iter().map(|near| near.text.as_str()).collect();
            let written: Vec<String> = reached.iter().map(|near| format!("{first}:{near}:{step}")).collect();
            return Err(format!(
                "a range includes both ends, but from {first} steps of {step} reach {}, not {last}; write {}",
                reached.join(" and "),
                written.join(" or ")
            ));
        }
        if self.count() >= MAX_LEVELS as i128 {
            return Err(format!("{} levels; a study has at most {MAX_LEVELS}", self.count() + 1));
        }
        Ok(())
    }
}

/// Shortest decimal that is the value: `20`, `0.1`, `1e-7`.
fn shortest(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn texts(range: &str) -> Vec<String> {
        expand(range).unwrap().into_iter().map(|level| level.text).collect()
    }

    #[test]
    fn both_ends_are_included_without_dust() {
        assert_eq!(texts("20:140:20"), ["20", "40", "60", "80", "100", "120", "140"]);
        assert_eq!(texts("0.1:0.3:0.1"), ["0.1", "0.2", "0.3"]);
        assert_eq!(expand("0.1:0.3:0.1").unwrap()[2].value, 0.3);
        assert_eq!(texts("1e-7:3e-7:1e-7"), ["1e-7", "2e-7", "3e-7"]);
        assert_eq!(texts("1:1.5:.25"), ["1", "1.25", "1.5"]);
        assert_eq!(texts("60:20:-20"), ["60", "40", "20"]);
        assert_eq!(texts("5:5:1"), ["5"]);
        assert_eq!(texts(" 1e3 : 3E3 : +1e3 "), ["1000", "2000", "3000"]);
        assert_eq!(expand("1:100000:1").unwrap().len(), MAX_LEVELS);
    }

    #[test]
    fn wrong_ones_are_refused_with_what_would_be_right() {
        let cases = [
            ("20:140", "start:stop:step"),
            ("1:2:3:4", "start:stop:step"),
            ("20:150:20", "reach 140 and 160, not 150; write 20:140:20 or 20:160:20"),
            ("0.1:0.35:0.1", "reach 0.3 and 0.4, not 0.35; write 0.1:0.3:0.1 or 0.1:0.4:0.1"),
            ("50:15:-20", "reach 30 and 10, not 15; write 50:30:-20 or 50:10:-20"),
            ("50:5:-20", "reach 10, not 5; write 50:10:-20"),
            ("20:140:-20", "leads away from 140; write 20:140:20"),
            ("140:20:20", "leads away from 20; write 140:20:-20"),
            ("20:140:0", "step `0`"),
            ("20:140:nan", "step `nan`"),
            ("20:140:inf", "step `inf`"),
            ("20:140:x", "step `x`"),
            ("0:100:10", "end 0: a forcing amplitude is a finite number above zero"),
            ("20:-20:-10", "end -20: "),
            ("a:100:10", "end a: not a number"),
            (":100:10", "end (nothing): "),
            ("1:100001:1", "100001 levels"),
            ("1e-9:1e9:1e-9", "levels"),
            ("1e-300:1e300:1", "give a list"),
        ];
        for (range, remedy) in cases {
            let refusal = expand(range).unwrap_err();
            assert!(refusal.value == range && refusal.remedy.contains(remedy), "{range}: {}", refusal.remedy);
        }
    }

    proptest! {
        #[test]
        fn every_decimal_range_is_exact(start in 1..100_000_i64, step in 1..10_000_i64, count in 0..200_i64, e in -12..9_i32) {
            let stop = start + count * step;
            let levels = expand(&format!("{start}e{e}:{stop}e{e}:{step}e{e}")).unwrap();
            prop_assert_eq!(levels.len() as i64, count + 1);
            for (i, level) in (0..).zip(&levels) {
                let exact: f64 = format!("{}e{e}", start + i * step).parse().unwrap();
                prop_assert_eq!(level.value, exact);
                prop_assert_eq!(level.text.parse::<f64>().unwrap(), exact);
                // No more digits than the numbers typed have.
                let mantissa = level.text.split('e').next().unwrap_or("");
                let digits = mantissa.replace('.', "");
                prop_assert!(digits.trim_matches('0').len() <= stop.to_string().len(), "{}", level.text);
            }
        }

        #[test]
        fn nothing_panics(text in "[-+0-9.e:]{0,24}", other in "\\PC{0,12}") {
            let _ = (expand(&text), expand(&other));
        }
    }
}
