//! How what was typed is told: the option that is to blame, the unit of frequencies, what is replaced without being typed away.

use super::check::{MODEL, checked};
use coordinator::check::notes_of_sweep;
use coordinator::study::Study;
use std::fs;

/// Of bounds that are given in Hz, without units of the study.
#[test]
fn frequencies_are_told_in_the_unit_of_their_bounds() {
    let bounds = |unit: &str| {
        let [min, max] = [8.0, 16.24].map(|value| format!("\"{value} {unit}\""));
        checked(MODEL, "0.3", &[("frequency.min", &min), ("frequency.max", &max)])
    };
    let (warnings, text) = bounds("Hz");
    let cut = "frequency.max = 16.24 Hz cuts through the resonance of mode 1 at 15.9155 Hz, ";
    assert!(warnings.len() == 1 && warnings[0].starts_with(cut), "{text}");
    assert!(text.contains(" first, at 15.9139 Hz, at the resonance of mode 1"), "{text}");
    // Units of the study go before.
    let (_, text) = checked(MODEL, "0.3", &[("frequency.max", "\"30 Hz\""), ("units", "\"rad/s\"")]);
    assert!(text.contains(" first, at 99.99 rad/s"), "{text}");
    let exchanged = [("frequency.min", "\"200 Hz\""), ("frequency.max", "\"150 Hz\"")];
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    fs::write(dir.path().join("study.toml"), "amplitudes = [0.3]\n").unwrap();
    let set = exchanged.map(|(key, value)| (key.to_string(), value.to_string()));
    let refused = Study::load(dir.path(), &set, None).unwrap_err().to_string();
    assert!(
        refused.contains(
            "`frequency.max` = 942.4778 rad/s (150 Hz): use a value above frequency.min = 1256.637 rad/s (200 Hz), "
        ),
        "{refused}"
    );
}

/// A sweep refuses what lies below where its backbones begin.
#[test]
fn an_upper_bound_below_the_backbones() {
    let said = |given: &[(&str, &str)]| checked(MODEL, "0.3", given).0;
    let below =
        "frequency.max = 80 rad/s lies below the backbones, which begin at 100 rad/s (mode 1), and a sweep refuses it";
    let [warning] = &said(&[("frequency.max", "80")])[..] else { panic!("no warning") };
    assert!(
        warning.starts_with(below) && warning.ends_with("give a higher one, or frequency.min as well"),
        "{warning}"
    );
    assert!(said(&[("frequency.max", "120")]).is_empty());
    assert!(said(&[("frequency.min", "60"), ("frequency.max", "80")]).is_empty());
}

#[test]
fn a_damping_that_is_replaced() {
    let ratios = "[damping]\nratios = [{ modes = \"1\", ratio = 1e-2 }]\n";
    let matrix = MODEL.replace(ratios, "damping = [[2]]\n");
    let (_, text) = checked(&matrix, "0.3", &[("damping.default_ratio", "0.02")]);
    let told = "damping.default_ratio replaces matrices.damping of the model, which is left out";
    assert!(text.contains(&format!("\ndamping     {told}\n")), "{text}");
    assert!(!checked(&matrix, "0.3", &[]).1.contains("replaces"));
    // A sweep notes it as well.
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("model.toml"), matrix).unwrap();
    fs::write(dir.path().join("study.toml"), "amplitudes = [0.3]\n[damping]\ndefault_ratio = 0.02\n").unwrap();
    let notes = notes_of_sweep(&Study::load(dir.path(), &[], None).unwrap());
    assert_eq!(notes, [told]);
}
