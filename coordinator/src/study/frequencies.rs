//! Frequencies with their unit: `"150 Hz"` for a number of rad/s.

use solver::files::Layers;
use solver::structure::ModelError;
use std::f64::consts::TAU;
use toml::Value;

/// Numerical settings that are frequencies.
const FREQUENCIES: [&str; 4] = ["frequency.min", "frequency.max", "backbone.min_frequency", "backbone.max_frequency"];

/// Puts numbers of rad/s in place of texts with a unit; says whether one was in Hz.
///
/// # Errors
/// A text that is none: its key, and what is one.
pub(super) fn to_radians(numerics: &mut Layers) -> Result<bool, ModelError> {
    let mut has_hertz = false;
    for key in FREQUENCIES {
        let Some(text) = numerics.value(key).and_then(Value::as_str) else { continue };
        let Some(omega) = omega(text) else {
            let remedy = "write a number of rad/s, or a text with its unit, like \"150 Hz\" (units: Hz, rad/s)";
            return Err(ModelError::value(numerics.place(key), format!("\"{text}\""), remedy));
        };
        has_hertz |= text.trim().to_ascii_lowercase().ends_with("hz");
        numerics.replace(key, omega.into());
    }
    Ok(has_hertz)
}

/// What a text says, rad/s.
fn omega(text: &str) -> Option<f64> {
    let units = [("Hz", TAU), ("hz", TAU), ("rad/s", 1.0)];
    let (number, factor) =
        units.into_iter().find_map(|(unit, factor)| Some((text.trim().strip_suffix(unit)?, factor)))?;
    Some(factor * number.trim().parse::<f64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn hertz_become_radians_a_second() {
        let text = "[frequency]\nmin = \"0.5 Hz\"\nmax = 9\n[backbone]\nmax_frequency = \"12rad/s\"";
        let mut layers = Layers::parse(Path::new("study.toml"), text).unwrap();
        layers.set("--set", "backbone.min_frequency", "1e-1 Hz").unwrap();
        assert!(to_radians(&mut layers).unwrap());
        assert!(!to_radians(&mut layers).unwrap());
        let values = FREQUENCIES.map(|key| layers.value(key).cloned());
        let expected = [0.5 * TAU, 0.0, 0.1 * TAU, 12.0].map(|omega| Some(Value::from(omega)));
        assert_eq!((&values[0], &values[2..]), (&expected[0], &expected[2..]));
        assert_eq!(values[1], Some(Value::from(9)));
    }

    #[test]
    fn other_texts_are_refused() {
        for wrong in ["Hz", "fast", "5 kHz", "5 rpm", "1,5 Hz", "5"] {
            let mut layers = Layers::parse(Path::new("study.toml"), "").unwrap();
            layers.set("--set", "frequency.min", &format!("\"{wrong}\"")).unwrap();
            let said = to_radians(&mut layers).unwrap_err().to_string();
            assert!(
                said.contains("`frequency.min`") && said.contains(wrong) && said.contains("like \"150 Hz\""),
                "{said}"
            );
        }
    }
}
