//! Units in which people want their tables.

use crate::resolved_study::UNITS;
use crate::words::fixed_digits;
use std::f64::consts::TAU;
use std::fmt::{Display, Formatter};
use std::str::FromStr;

/// Units of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Of amplitudes.
    pub length: LengthUnit,
    /// Of frequencies.
    pub frequency: FrequencyUnit,
}

/// Units that were chosen, and those that were not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnitChoice {
    /// Of amplitudes.
    pub length: Option<LengthUnit>,
    /// Of frequencies.
    pub frequency: Option<FrequencyUnit>,
}

/// Unit of amplitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// Metres.
    #[default]
    Metre,
    /// Millimetres.
    Millimetre,
    /// Micrometres.
    Micrometre,
}

/// Unit of frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FrequencyUnit {
    /// Radians a second.
    #[default]
    RadianPerSecond,
    /// Periods a second.
    Hertz,
}

impl LengthUnit {
    /// How many of it make a metre.
    pub fn factor(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 1e3,
            Self::Micrometre => 1e6,
        }
    }

    /// A length in metres, in this unit, with five digits.
    pub fn digits(self, metres: f64) -> String {
        let value = self.factor() * metres;
        // Beyond that zeros have to be counted.
        if (1e-2..1e6).contains(&value.abs()) { fixed_digits(value, 5) } else { format!("{value:.4e}") }
    }
}

impl FrequencyUnit {
    /// How many of it make a rad/s.
    pub fn factor(self) -> f64 {
        if self == Self::Hertz { 1.0 / TAU } else { 1.0 }
    }

    /// A frequency in rad/s, in this unit, with six digits.
    pub fn digits(self, omega: f64) -> String {
        fixed_digits(self.factor() * omega, 6)
    }

    /// The same with the unit.
    pub fn told(self, omega: f64) -> String {
        format!("{} {self}", self.digits(omega))
    }
}

impl Display for LengthUnit {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "µm",
        })
    }
}

impl Display for FrequencyUnit {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Hertz { "Hz" } else { "rad/s" })
    }
}

impl UnitChoice {
    /// What the text of a resolved study chooses (its key [`UNITS`]).
    pub fn of_study(resolved: &str) -> Self {
        let table: toml::Table = resolved.parse().unwrap_or_default();
        table.get(UNITS).and_then(|units| units.as_str()?.parse().ok()).unwrap_or_default()
    }

    /// These where they are chosen, else others.
    pub fn or(self, others: Self) -> Self {
        Self { length: self.length.or(others.length), frequency: self.frequency.or(others.frequency) }
    }

    /// m and rad/s where nothing is chosen.
    pub fn of_table(self) -> Units {
        Units { length: self.length.unwrap_or_default(), frequency: self.frequency.unwrap_or_default() }
    }

    /// A frequency in the unit that was chosen, in rad/s.
    pub fn rate(self, frequency: f64) -> f64 {
        frequency / self.frequency.unwrap_or_default().factor()
    }
}

impl Display for UnitChoice {
    /// As it is read.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let names =
            [self.length.map(|length| length.to_string()), self.frequency.map(|frequency| frequency.to_string())];
        f.write_str(&names.into_iter().flatten().collect::<Vec<_>>().join(","))
    }
}

impl FromStr for UnitChoice {
    type Err = String;

    /// `mm,Hz`: one unit of each quantity, or one of them only.
    fn from_str(text: &str) -> Result<Self, String> {
        let (mut length, mut frequency) = (None, None);
        for name in text.split(',') {
            let is_again = match name.trim() {
                "m" => length.replace(LengthUnit::Metre).is_some(),
                "mm" => length.replace(LengthUnit::Millimetre).is_some(),
                "um" | "µm" => length.replace(LengthUnit::Micrometre).is_some(),
                "rad/s" => frequency.replace(FrequencyUnit::RadianPerSecond).is_some(),
                "Hz" => frequency.replace(FrequencyUnit::Hertz).is_some(),
                other => return Err(format!("`{other}` is none of m, mm, um, rad/s and Hz")),
            };
            if is_again {
                return Err("give one unit of length and one of frequency, like mm,Hz".into());
            }
        }
        Ok(Self { length, frequency })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_and_written() {
        let units = "mm,Hz".parse::<UnitChoice>().unwrap().of_table();
        assert_eq!(
            (units.length.digits(9.4809e-4), units.frequency.digits(2495.39)),
            ("0.94809".into(), "397.154".into())
        );
        assert_eq!("Hz".parse::<UnitChoice>().unwrap().of_table().length.digits(9.4809e-4), "9.4809e-4");
        assert_eq!("um, rad/s".parse::<UnitChoice>().unwrap().of_table().length.digits(1e-12), "1.0000e-6");
        let choice: UnitChoice = "Hz".parse().unwrap();
        assert_eq!((choice.length, choice.rate(1.0)), (None, TAU));
        assert_eq!(UnitChoice::default().rate(2.0), 2.0);
        assert!("inch".parse::<UnitChoice>().unwrap_err().contains("inch"));
        assert!("mm,um".parse::<UnitChoice>().unwrap_err().contains("one unit"));
    }

    #[test]
    fn a_study_chooses_units_and_whoever_asks_others() {
        let of_study = UnitChoice::of_study("name = 'x'\nunits = 'Hz, mm'");
        assert_eq!(of_study.to_string(), "mm,Hz");
        assert_eq!("um".parse::<UnitChoice>().unwrap().or(of_study).to_string(), "µm,Hz");
        assert_eq!(UnitChoice::of_study("name = 'x'").of_table(), Units::default());
    }
}
