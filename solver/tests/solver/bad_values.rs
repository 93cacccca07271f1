//! Wrong values at hand, parts of models, settings and forcing amplitudes, are refused with one message that names key, value and a remedy.

use crate::support::messages::says;
use solver::linalg::Matrix;
use solver::response::backbone::Backbone;
use solver::response::level::Level;
use solver::settings::{FrequencySettings, ModeChoice, NumberList, Settings};
use solver::structure::laws::Contact;
use solver::structure::{Model, ModelBuilder};

/// Two masses without elements.
fn masses() -> ModelBuilder {
    let model = Model::builder("parts").mass(Matrix::diagonal(&[1.0, 2.0])).stiffness(Matrix::diagonal(&[1.0, 1.0]));
    model.damping_ratios([0.01, 0.01]).force_mode(1)
}

fn stop(gap: f64) -> Contact {
    Contact { gap, epsilon: 1.0, friction: None }
}

fn parts() -> ModelBuilder {
    masses().element("stop", stop(0.1), [0])
}

#[test]
fn matrices_that_overflow() {
    let error = |scale: f64| {
        let stiffness = Matrix::from_fn(2, 2, |i, j| if i == j { scale } else { -0.5 * scale });
        let model = parts().mass(Matrix::diagonal(&[1.0 / scale, 1.0])).stiffness(stiffness);
        model.build().unwrap_err().to_string()
    };
    says(&error(1e300), &["`matrices.stiffness`", "modes", "scaling"]);
}

#[test]
fn parts_at_hand_are_checked_too() {
    let model = parts().build().unwrap();
    assert_eq!((model.dofs(), model.monitors()), (&["x1".to_string(), "x2".to_string()][..], &[0][..]));
    let refused = |model: ModelBuilder, expected: &[&str]| says(&model.build().unwrap_err().to_string(), expected);
    refused(parts().stiffness(Matrix::zeros(3, 3)), &["`matrices.stiffness`", "3 × 3", "2 × 2"]);
    refused(parts().damping_ratios([0.1]), &["`damping.ratios`", "1 ratios for 2 modes"]);
    refused(parts().damping_ratios([0.1, 2.0]), &["`damping.ratios` = 2", "below 1"]);
    refused(parts().force_shape([1.0]), &["`forcing.shape` = 1 entries", "2, one per dof"]);
    refused(parts().force_shape([0.0; 2]), &["`forcing.shape`", "does nothing"]);
    refused(parts().harmonic(0), &["`forcing.harmonic` = 0"]);
    refused(parts().monitor(2), &["`monitors` = 2", "0 to 1"]);
    refused(masses().element("stop", stop(0.1), [5]), &["elements.stop.channels", "(5, 1)", "0 to 1"]);
    refused(masses().element("stop", stop(0.1), [0; 0]), &["elements.stop.channels", "no dof"]);
    refused(masses().element("stop", stop(0.1), [0, 1]), &["elements.stop.channels", "= 2", "1 displacements"]);
    refused(masses().element("stop", stop(-0.1), [0]), &["`elements.stop.gap` = -0.1", "zero or above"]);
}

fn change(set: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = Settings::default();
    set(&mut settings);
    settings
}

#[test]
fn numerical_settings() {
    let model = parts().build().unwrap();
    let these = |numbers: &[usize]| ModeChoice::These(NumberList::new(numbers).unwrap());
    let cases: [(Settings, &[&str]); 12] = [
        (change(|s| s.harmonics.samples = 32), &["harmonics.samples", "32", "10 harmonics", "at least 40"]),
        (change(|s| s.harmonics.count = 0), &["harmonics.count", "0", "1 to 400"]),
        (change(|s| s.backbone.modes = ModeChoice::one(3)), &["backbone.modes", "3", "modes 1 to 2"]),
        (change(|s| s.backbone.modes = ModeChoice::one(0)), &["backbone.modes", "0", "modes 1 to 2"]),
        (change(|s| s.backbone.modes = these(&[1, 5])), &["backbone.modes", "[1, 5]", "modes 1 to 2"]),
        (change(|s| s.backbone.modes = these(&[2, 2])), &["backbone.modes", "[2, 2]", "mode 2 comes twice"]),
        (change(|s| s.backbone.modes = these(&[])), &["backbone.modes", "[]", "at least one mode"]),
        (change(|s| s.frequency.min = Some(-1.0)), &["frequency.min", "-1", "above zero"]),
        (change(|s| s.frequency = FrequencySettings { min: Some(2.0), max: Some(1.0) }), &["frequency.max", "1", "2"]),
        (change(|s| s.continuation.max_step = f64::NAN), &["continuation.max_step", "NaN", "finite"]),
        (change(|s| s.continuation.min_cosine = 1.5), &["continuation.min_cosine", "1.5", "0 to below 1"]),
        (change(|s| s.search.starts = Some(1_000_001)), &["search.starts", "1000001", "at most 1000000"]),
    ];
    for (settings, parts) in cases {
        let refused = Backbone::compute(&model, &settings).unwrap_err();
        says(&refused.to_string(), parts);
    }
}

#[test]
fn settings_that_do_not_fit_the_model() {
    let model = parts().build().unwrap();
    let low = change(|s| s.backbone.max_frequency = Some(1e-3));
    let refused = Backbone::compute(&model, &low).unwrap_err();
    says(&refused.to_string(), &["backbone.max_frequency", "0.001", "mode 1 starts at"]);

    let backbone = Backbone::compute(&model, &change(|s| s.backbone.max_points = 10)).unwrap();
    let inverted = change(|s| s.frequency.min = Some(1e6));
    let refused = Level::compute(&model, &inverted, &backbone, 1.0).unwrap_err();
    says(&refused.to_string(), &["frequency.min = 1000000", "the backbones end at", "frequency.max"]);

    let model = parts().harmonic(11).build().unwrap();
    let refused = Backbone::compute(&model, &Settings::default()).unwrap_err();
    says(&refused.to_string(), &["harmonics.count", "10", "harmonic 11"]);

    let model = parts().stiffness(Matrix::diagonal(&[0.0, 1.0])).build().unwrap();
    let first = change(|s| s.backbone.modes = ModeChoice::one(1));
    let refused = Backbone::compute(&model, &first).unwrap_err();
    says(&refused.to_string(), &["backbone.modes = 1", "mode 1 is a rigid-body mode", "backbone.modes = [2]"]);
}

#[test]
fn unknown_numerical_settings() {
    let error = toml::from_str::<Settings>("[harmonics]\ncounts = 3\n").unwrap_err().to_string();
    assert!(error.contains("counts") && error.contains("count"), "{error}");
}

#[test]
fn forcing_amplitudes() {
    let model = parts().build().unwrap();
    let settings = change(|s| s.backbone.max_points = 10);
    let backbone = Backbone::compute(&model, &settings).unwrap();
    for amplitude in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Level::compute(&model, &settings, &backbone, amplitude).unwrap_err();
        says(&refused.to_string(), &[&amplitude.to_string(), "above zero"]);
    }
}

#[test]
fn a_structure_that_drifts() {
    let stiffness = Matrix::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 });
    let free = Model::builder("free").mass(Matrix::diagonal(&[1.0, 1.0])).stiffness(stiffness).force(0, 1.0);
    // Of its own accord it is the lowest mode that deforms the structure.
    let error = Backbone::compute(&free.build().unwrap(), &Settings::default()).unwrap_err().to_string();
    says(&error, &["backbone of mode 2", "nothing resists the rigid-body motion of mode 1", "soft spring"]);
}
