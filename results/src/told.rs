//! Lengths, and texts with frequencies in them, in the unit that whoever reads them chooses.

use crate::summary_table::{FrequencyUnit, LengthUnit};
use crate::words::{digits, frequency, further_digits, in_both_units, length, range};
use serde::Serialize;

/// A length with four digits in a unit that was chosen or, without one, in that in which it is read best.
pub fn length_in(metres: f64, chosen: Option<LengthUnit>) -> String {
    chosen.map_or_else(|| length(metres), |unit| format!("{} {unit}", digits(unit.factor() * metres, 4)))
}

/// A frequency in both units, this one first: `397.15 Hz (2495.4 rad/s)`.
pub fn frequency_first_in(omega: f64, first: FrequencyUnit) -> String {
    match first {
        FrequencyUnit::RadianPerSecond => frequency(omega),
        FrequencyUnit::Hertz => format!("{} Hz ({} rad/s)", hertz(omega), digits(omega, 4)),
    }
}

/// The same within parentheses: `397.15 Hz, 2495 rad/s`.
pub fn in_both_units_from(omega: f64, first: FrequencyUnit) -> String {
    match first {
        FrequencyUnit::RadianPerSecond => in_both_units(omega),
        FrequencyUnit::Hertz => format!("{} Hz, {} rad/s", hertz(omega), digits(omega, 4)),
    }
}

/// Two frequencies: `390.12 and 397.34 Hz (2451 and 2497 rad/s)`.
pub fn range_first_in((low, high): (f64, f64), first: FrequencyUnit) -> String {
    match first {
        FrequencyUnit::RadianPerSecond => range((low, high)),
        FrequencyUnit::Hertz => {
            let [first, last] = [low, high].map(|omega| FrequencyUnit::Hertz.factor() * omega);
            let more = further_digits(low, high, 4).max(further_digits(first, last, 5));
            let [a, b] = [low, high].map(|omega| digits(omega, 4 + more));
            let [first, last] = [first, last].map(|hertz| digits(hertz, 5 + more));
            format!("{first} and {last} Hz ({a} and {b} rad/s)")
        }
    }
}

/// A number as text with its sign in front.
pub(crate) fn with_sign(value: f64, text: &str) -> String {
    if value > 0.0 { format!("+{text}") } else { text.replacen('-', "−", 1) }
}

fn hertz(omega: f64) -> String {
    digits(FrequencyUnit::Hertz.factor() * omega, 5)
}

/// A text in which frequencies are numbers until it is shown.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(transparent)]
pub struct Told(Vec<Part>);

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
enum Part {
    /// What is the same in all units.
    Text(String),
    /// A frequency, rad/s.
    Frequency { omega: f64, digits: u8, signed: bool },
    /// The name of the unit.
    Unit { unit: () },
}

impl Told {
    /// Followed by a text.
    pub fn text(mut self, text: impl Into<String>) -> Self {
        self.0.push(Part::Text(text.into()));
        self
    }

    /// Followed by a frequency, rad/s, with so many digits at most and without its unit.
    pub fn frequency(mut self, omega: f64, digits: u8) -> Self {
        self.0.push(Part::Frequency { omega, digits, signed: false });
        self
    }

    /// Followed by the difference of two frequencies, rad/s, with its sign.
    pub fn difference(mut self, omega: f64, digits: u8) -> Self {
        self.0.push(Part::Frequency { omega, digits, signed: true });
        self
    }

    /// Followed by a space and the name of the unit.
    pub fn unit(self) -> Self {
        let mut parts = self.text(" ").0;
        parts.push(Part::Unit { unit: () });
        Self(parts)
    }

    /// Followed by another one.
    pub fn then(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }

    /// As it is read in a unit.
    pub fn read_in(&self, unit: FrequencyUnit) -> String {
        let read = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Frequency { omega, digits: count, signed } => {
                let text = digits(unit.factor() * omega, i32::from(*count));
                if *signed { with_sign(*omega, &text) } else { text }
            }
            Part::Unit { .. } => unit.to_string(),
        };
        self.0.iter().map(read).collect()
    }
}

impl From<String> for Told {
    fn from(text: String) -> Self {
        Self::default().text(text)
    }
}

impl From<&str> for Told {
    fn from(text: &str) -> Self {
        text.to_string().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_the_run_comes_first() {
        let told = |unit| {
            [
                frequency_first_in(2495.39, unit),
                in_both_units_from(2495.39, unit),
                range_first_in((2451.2, 2496.6), unit),
            ]
        };
        let expected =
            ["397.15 Hz (2495 rad/s)", "397.15 Hz, 2495 rad/s", "390.12 and 397.35 Hz (2451 and 2497 rad/s)"];
        assert_eq!(told(FrequencyUnit::Hertz), expected);
        let expected =
            ["2495.4 rad/s (397.2 Hz)", "2495.4 rad/s, 397.2 Hz", "2451.2 and 2496.6 rad/s (390.1 and 397.3 Hz)"];
        assert_eq!(told(FrequencyUnit::RadianPerSecond), expected);
    }

    #[test]
    fn frequencies_are_read_in_any_unit() {
        let told = Told::from("isola: ").frequency(2495.39, 5).text(" to ").frequency(2500.0, 5).unit();
        let told = told.then(Told::from(" (").difference(std::f64::consts::TAU, 3).unit().text(")"));
        assert_eq!(told.read_in(FrequencyUnit::RadianPerSecond), "isola: 2495.4 to 2500 rad/s (+6.28 rad/s)");
        assert_eq!(told.read_in(FrequencyUnit::Hertz), "isola: 397.15 to 397.89 Hz (+1 Hz)");
        let json = serde_json::to_value(Told::from("at ").frequency(2.0, 3).unit()).unwrap();
        let omega = serde_json::json!({ "omega": 2.0, "digits": 3, "signed": false });
        assert_eq!(json, serde_json::json!(["at ", omega, " ", { "unit": null }]));
    }
}
