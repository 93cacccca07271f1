//! What `isola check` says early: units that slipped, levels at which nothing touches, keys without effect.

use coordinator::check::{notes_of_sweep, report, warnings_of_sweep};
use coordinator::study::Study;
use std::fs;
use std::path::Path;

/// A mass before a stop: ω = 100 rad/s, ζ = 1e-2, 1 mm of clearance, so that A = 2 ζ √(1 − ζ²) k c touches, at ω √(1 − 2ζ²).
pub(crate) const MODEL: &str = r#"
name = "mass before a stop"
dofs = ["x"]
[matrices]
mass = [[1]]
stiffness = [[1e4]]
[damping]
ratios = [{ modes = "1", ratio = 1e-2 }]
[forcing]
shape = { dofs = { x = 1 } }
[contact]
gap = 1e-3
epsilon = 2e4
[[contact.nodes]]
name = "stop"
normal = "x"
"#;

const TOUCHES: &str = "touches     from A = 0.19999 on, stop first, at 99.99 rad/s, at the resonance of mode 1, in the linear response alone; \
                       isolas may be there, and touch, from far lower forcing on, or be born at several times it, or at tens of times: levels from a third \
                       of it to five times it are a start, and, where these show none, larger ones\n";

/// Warnings of a study of the mass with this changed, and everything that is said.
pub(crate) fn checked(model: &str, amplitudes: &str, set: &[(&str, &str)]) -> (Vec<String>, String) {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("model.toml"), model).unwrap();
    fs::write(dir.path().join("study.toml"), format!("amplitudes = \"{amplitudes}\"\n")).unwrap();
    let set: Vec<(String, String)> = set.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
    said(&Study::load(dir.path(), &set, None).unwrap_or_else(|error| panic!("{error}")))
}

fn said(study: &Study) -> (Vec<String>, String) {
    let text = report(study);
    let warnings = text.lines().filter_map(|line| line.strip_prefix("warning     "));
    (warnings.map(String::from).collect(), text)
}

#[test]
fn where_the_linear_structure_touches() {
    let (warnings, text) = checked(MODEL, "0.1,0.3", &[]);
    assert!(warnings.is_empty(), "{text}");
    assert!(text.contains(TOUCHES), "{text}");
    assert!(text.contains("epsilon     2 times the stiffness of the structure there\n"), "{text}");
    let (warnings, _) = checked(MODEL, "0.1,0.15", &[]);
    let nothing = "nothing touches in the linear response at the resonance of mode 1: 2 levels up to A = 0.15, the first touch at A = 0.19999; \
                   isolas may be there nevertheless";
    assert_eq!(warnings, [nothing]);
    // A gap in millimetres, typed as one in metres.
    let (warnings, _) = checked(MODEL, "0.0002", &[]);
    let [far] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(far.contains("the first touch at A = 0.19999 (lengths are in m: a gap of 2 mm is 0.002); isolas"), "{far}");
}

#[test]
fn forcing_far_beyond_the_first_touch() {
    assert_eq!(checked(MODEL, "0.3,59", &[]).0, [] as [&str; 0]);
    let far = "at A = 2e3 the linear response at the resonance of mode 1 is 10001 times as large as what it may be before stop touches: check the units \
               of forcing and gap";
    assert_eq!(checked(MODEL, "0.3,2e3", &[]).0, [far]);
    // A sweep, which would take minutes, says so before.
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    fs::write(dir.path().join("study.toml"), "amplitudes = \"0.3,2e3\"\n").unwrap();
    assert_eq!(warnings_of_sweep(&Study::load(dir.path(), &[], None).unwrap()), [far]);
}

/// An elastic stop touches where a rigid one does; beyond the resonance, at 200 rad/s, that is A = 3e4 c.
#[test]
fn where_an_elastic_stop_touches() {
    let elastic = MODEL.split("[contact]").next().unwrap().to_string()
        + "[[laws]]\nname = \"stop\"\ndof = \"x\"\nlaw = { penalty_spring = { stiffness = 1e4, gap = 1e-3 } }\n";
    let (warnings, text) = checked(&elastic, "0.1,0.3", &[]);
    assert!(warnings.is_empty(), "{text}");
    assert!(text.contains(TOUCHES), "{text}");
    let bounds = [("frequency.min", "200"), ("frequency.max", "400")];
    let (warnings, text) = checked(&elastic, "0.1,0.3", &bounds);
    assert!(warnings.is_empty(), "{text}");
    assert!(text.contains("touches     from A = 30.0027 on, stop first, at the bound 200 rad/s, in the"), "{text}");
    // One that is pressed at rest has nothing to touch.
    let pressed = elastic.replace("gap = 1e-3", "gap = -1e-3");
    let (warnings, text) = checked(&pressed, "0.1,0.3", &[]);
    assert!(!text.contains("touches"), "{text}");
    assert!(
        warnings.len() == 1
            && warnings[0].starts_with("`stop`: its gap is negative (-0.001 m), so that it presses at rest"),
        "{text}"
    );
}

/// All frequencies and lengths are in the units of the study, which --units replaces; keys keep theirs.
#[test]
fn frequencies_and_lengths_are_in_the_units_of_the_study() {
    let (_, text) = checked(MODEL, "0.1,0.3", &[("units", "\"um,Hz\"")]);
    assert!(text.contains("first, at 15.9139 Hz, at the resonance of mode 1, "), "{text}");
    assert!(text.contains("contact     gap 1000 µm, no friction"), "{text}");
    let bounds = [("units", "\"Hz\""), ("frequency.min", "200"), ("frequency.max", "400")];
    let (_, text) = checked(MODEL, "0.1,0.3", &bounds);
    assert!(text.contains("at the bound 31.831 Hz") && text.contains("is that of mode 1 at 15.9155 Hz\n"), "{text}");
    assert!(text.contains("gap 1 mm, "), "{text}");
    let exchanged = MODEL.replace("[[1]]", "[[1e4]]").replace("stiffness = [[1e4]]", "stiffness = [[1]]");
    let (warnings, _) = checked(&exchanged, "0.3", &[("contact.epsilon", "2"), ("units", "\"Hz\"")]);
    assert!(warnings[0].contains("The other way round they lie at 15.9155 to 15.9155 Hz"), "{warnings:?}");
    let orders = [("units", "\"Hz\""), ("search.harmonics", "[1, 2]"), ("harmonics.count", "20")];
    let (_, text) = checked(MODEL, "0.1", &orders);
    assert!(
        text.contains("10 % beyond its resonances, which the sweep computes; ") && !text.contains("rad/s; "),
        "{text}"
    );
    let (_, text) = checked(MODEL, "0.1", &[&orders[..], &[("frequency.max", "400")]].concat());
    assert!(text.contains(", to 63.662 Hz; ") && text.contains(", to 31.831 Hz; "), "{text}");
    let joint = MODEL.split("[contact]").next().unwrap().to_string()
        + "[[laws]]\nname = \"joint\"\ndof = \"x\"\nlaw = { jenkins = { stiffness = 3e4, limit = 1 } }\n";
    let (_, text) = checked(&joint, "0.1", &[("units", "\"Hz\"")]);
    assert!(text.contains("of small motions, with `joint` (30000 N/m): 31.831 Hz; those above"), "{text}");
    let stop =
        joint.replace("jenkins = { stiffness = 3e4, limit = 1 }", "penalty_spring = { stiffness = 1e4, gap = -1e-3 }");
    let (warnings, _) = checked(&stop, "0.1", &[("units", "\"mm\"")]);
    assert!(warnings[0].contains("its gap is negative (-1 mm), "), "{warnings:?}");
}

/// What a sweep of very many levels says before it begins.
#[test]
fn many_levels_are_told() {
    let notes = |amplitudes: &str| {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("model.toml"), MODEL).unwrap();
        fs::write(dir.path().join("study.toml"), format!("amplitudes = \"{amplitudes}\"\n")).unwrap();
        notes_of_sweep(&Study::load(dir.path(), &[], None).unwrap())
    };
    assert_eq!(notes("0.1:10:0.1"), [] as [&str; 0]);
    let [note] = &notes("0.001:10:0.001")[..] else { panic!("no note") };
    assert!(note.starts_with("10000 levels, each of which is searched: "), "{note}");
}

#[test]
fn gaps_in_millimetres() {
    // The mass of 1 kg in t, mm, N and s.
    let changes = [("[[1]]", "[[1e-3]]"), ("[[1e4]]", "[[10]]"), ("gap = 1e-3", "gap = 2"), ("2e4", "20")];
    let model = changes.iter().fold(MODEL.to_string(), |model, (old, new)| model.replacen(old, new, 1));
    let (warnings, text) = checked(&model, "0.5", &[]);
    let [question] = &warnings[..] else { panic!("{text}") };
    let said = "to close a gap of 2 m at the frequency of mode 1 takes a speed of 200 m/s, which hardly a structure bears: is the gap in mm?";
    assert!(question.starts_with(said), "{question}");
    assert!(checked(&model, "0.5", &[("contact.gap", "0.9")]).0.is_empty());
}

#[test]
fn matrices_exchanged() {
    let exchanged = MODEL.replace("[[1]]", "[[1e4]]").replace("stiffness = [[1e4]]", "stiffness = [[1]]");
    let (warnings, text) = checked(&exchanged, "0.3", &[("contact.epsilon", "2")]);
    assert_eq!(warnings.len(), 1, "{text}");
    assert!(warnings[0].contains("are K and M exchanged? The other way round they lie at 100 to 100 rad/s"), "{text}");
    // A sweep says so as well.
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("model.toml"), exchanged).unwrap();
    fs::write(dir.path().join("study.toml"), "amplitudes = [0.3]\n").unwrap();
    assert_eq!(warnings_of_sweep(&Study::load(dir.path(), &[], None).unwrap()), warnings);
    let tiny = MODEL.replace("mass = [[1]]", "mass = [[1e-16]]");
    let (warnings, text) = checked(&tiny, "0.3", &[]);
    assert!(warnings[0].contains("only modes from 1e10 to 1e10 rad/s"), "{text}");
}

#[test]
fn bounds_in_hertz() {
    let within = |low: &str, high: &str| checked(MODEL, "0.3", &[("frequency.min", low), ("frequency.max", high)]).0;
    let warnings = within("15", "17");
    let said = "no mode resonates between frequency.min = 15 and frequency.max = 17 rad/s, but one does at 15.9";
    assert!(warnings.len() == 1 && warnings[0].starts_with(said), "{warnings:?}");
    // The third of the resonance, in Hz, at 5.3.
    assert_eq!(within("5", "6").len(), 1);
    // The half and the third of it, in rad/s, lie in wide ones as well.
    let warnings = within("10", "60");
    assert!(warnings.len() == 1 && warnings[0].starts_with("no mode resonates with the force itself"), "{warnings:?}");
    // Around the resonance, around its third, and where nothing resonates in either unit.
    for (low, high) in [("90", "110"), ("30", "40"), ("200", "400")] {
        assert!(within(low, high).is_empty(), "{low} to {high}");
    }
}

/// What a sweep says of bounds without a resonance, `isola check` has below them.
#[test]
fn bounds_without_a_resonance() {
    let said = |min: Option<&str>, max: Option<&str>| {
        let given = [("frequency.min", min), ("frequency.max", max)];
        let set: Vec<(&str, &str)> = given.into_iter().filter_map(|(key, value)| Some((key, value?))).collect();
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("model.toml"), MODEL).unwrap();
        fs::write(dir.path().join("study.toml"), "amplitudes = \"0.3\"\n").unwrap();
        let set: Vec<(String, String)> = set.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
        let study = Study::load(dir.path(), &set, None).unwrap();
        // Such a study a sweep refuses.
        let is_refused = min.is_none() && max == Some("30");
        let warnings = warnings_of_sweep(&study);
        assert!(
            warnings.iter().all(|warning| warning.starts_with("frequency.max = 30 rad/s lies below the backbones"))
        );
        assert_eq!(warnings.len(), usize::from(is_refused));
        (
            report(&study).contains("no linear resonance that the force drives lies within the bounds: "),
            notes_of_sweep(&study),
        )
    };
    let none = "no linear resonance that the force drives lies within the bounds: the nearest one is that of mode 1 at 100 rad/s";
    for (min, max) in [(Some("200"), Some("400")), (Some("120"), None)] {
        assert_eq!(said(min, max), (true, vec![none.to_string()]), "{min:?} to {max:?}");
    }
    assert_eq!(said(None, Some("30")), (true, vec![]));
    // Where a harmonic of the response resonates a sweep has nothing to say.
    assert_eq!(said(Some("30"), Some("40")), (true, vec![]));
    assert_eq!(said(Some("90"), Some("110")), (false, vec![]));
    assert_eq!(said(None, Some("1000")), (false, vec![]));
    // A force on the second harmonic has twice the frequency of the response.
    let twice = MODEL.replace("[forcing]", "[forcing]\nharmonic = 2");
    let (_, text) = checked(&twice, "0.3", &[("frequency.min", "90"), ("frequency.max", "110")]);
    assert!(text.contains("mode 1 at 50 rad/s of the response, the force having twice that frequency\n"), "{text}");
}

/// What nobody gave is said, and that nothing damps.
#[test]
fn damping_and_forcing_that_are_not_given() {
    let damping = "[damping]\nratios = [{ modes = \"1\", ratio = 1e-2 }]\n";
    let shape = "shape = { dofs = { x = 1 } }\n";
    let (warnings, text) = checked(MODEL, "0.3", &[]);
    assert!(!text.contains("not given") && warnings.is_empty(), "{text}");
    for none in ["", "[damping]\n"] {
        let (_, text) = checked(&MODEL.replace(damping, none), "0.3", &[]);
        assert!(
            text.contains("\ndamping     not given: 1 % of critical in every mode; damping.default_ratio, among"),
            "{text}"
        );
    }
    let (_, text) = checked(&MODEL.replace(damping, ""), "0.3", &[("damping.default_ratio", "0.01")]);
    assert!(!text.contains("not given"), "{text}");
    // Of one dof there is no choice.
    assert!(!checked(&MODEL.replace(shape, ""), "0.3", &[]).1.contains("not given"));
    let pair = "name = 'pair'\n[matrices]\nmass = [[1, 0], [0, 1]]\nstiffness = [[2, -1], [-1, 2]]\ndamping = [[0.1, 0], [0, 0.1]]\n";
    let (_, text) = checked(pair, "0.3", &[]);
    assert!(
        text.contains("forcing.shape is not given: the force has the shape of mode 1, and does no work on others"),
        "{text}"
    );
    let undamped = MODEL.replace("1e-2 }]", "0 }]");
    let (warnings, text) = checked(&undamped, "0.3", &[]);
    assert!(
        warnings.iter().any(|warning| warning.starts_with("mode 1 has no damping, and no law takes energy: ")),
        "{text}"
    );
    let rubbing =
        undamped.replace("normal = \"x\"", "normal = \"x\"\ntangential = [\"x\"]\nradius = 1\nfriction = 0.1");
    let (warnings, text) = checked(&rubbing, "0.3", &[]);
    assert!(!warnings.iter().any(|warning| warning.contains("no damping")), "{text}");
}

/// The resonance at 100 rad/s has a half-width of ζω = 1 rad/s.
#[test]
fn bounds_on_the_flank_of_a_resonance() {
    let within = |low: &str, high: &str| checked(MODEL, "0.3", &[("frequency.min", low), ("frequency.max", high)]).0;
    let cut = |key: &str, bound: &str, widths: &str, others: [&str; 2]| {
        let [within, out] = others;
        format!(
            "{key} = {bound} rad/s cuts through the resonance of mode 1 at 100 rad/s, {widths} of its half-widths from it: branches end \
             on its flank, and their peaks may lie beyond; the bound at {within} rad/s takes it in, at {out} rad/s leaves it out"
        )
    };
    assert_eq!(within("50", "102"), [cut("frequency.max", "102", "2", ["105", "95"])]);
    assert_eq!(within("98.5", "150"), [cut("frequency.min", "98.5", "1.5", ["95", "105"])]);
    assert_eq!(within("101", "104.5").len(), 2);
    assert!(within("94.9", "105.1").is_empty());
    // Of a force on the second harmonic the response resonates at half of it.
    let twice = MODEL.replace("[forcing]", "[forcing]\nharmonic = 2");
    let (warnings, text) = checked(&twice, "0.3", &[("frequency.min", "40"), ("frequency.max", "50.25")]);
    assert!(warnings.len() == 1 && warnings[0].contains("of mode 1 at 50 rad/s, 0.5 of its half-widths"), "{text}");
    assert!(checked(&twice, "0.3", &[("frequency.min", "40"), ("frequency.max", "101")]).0.is_empty());
}

#[test]
fn damping_epsilon_and_keys_without_effect() {
    let damping = "[damping]\nratios = [{ modes = \"1\", ratio = 1e-2 }]";
    let negative = MODEL.replace(damping, "damping = [[-2]]");
    let (warnings, text) = checked(&negative, "0.3", &[]);
    assert!(warnings[0].starts_with("mode 1: negative linear damping"), "{text}");
    // Of two modes that are damped motions in between may not be.
    let pair = |coupling: &str| {
        format!(
            "name = 'pair'\n[matrices]\nmass = [[1, 0], [0, 1]]\nstiffness = [[200, -100], [-100, 200]]\n\
             damping = [[0.01, {coupling}], [{coupling}, 0.05]]\n[[laws]]\nname = 'spring'\ndof = 'x1'\n\
             law = {{ polynomial_spring = {{ terms = [{{ power = 3, coefficient = 1 }}] }} }}"
        )
    };
    assert!(checked(&pair("0.022"), "0.3", &[]).0.is_empty());
    let (warnings, text) = checked(&pair("0.025"), "0.3", &[]);
    assert!(warnings.len() == 1 && warnings[0].starts_with("the damping matrix is indefinite (its"), "{text}");
    assert!(warnings[0].ends_with("in some motions it drives the structure; is a sign wrong?"), "{text}");
    for (epsilon, what) in [("100", "soft: 0.01 times"), ("2e7", "stiff: 2000 times")] {
        let (warnings, text) = checked(MODEL, "0.3", &[("contact.epsilon", epsilon)]);
        assert!(warnings.len() == 1 && warnings[0].starts_with(&format!("contact.epsilon is {what}")), "{text}");
    }
    let (warnings, text) = checked(MODEL, "0.3", &[("branch.closure", "1e-3")]);
    assert!(warnings.len() == 1 && warnings[0].starts_with("branch.closure has no effect any more"), "{text}");
    assert!(checked(MODEL, "0.3", &[("branch.max_points", "100")]).0.is_empty());
}

#[test]
fn shipped_studies_are_meant_as_they_are() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut studies = 0;
    for folder in fs::read_dir(models).unwrap().map(|entry| entry.unwrap().path()) {
        if folder.join("study.toml").exists() {
            let study = Study::load(&folder, &[], None).unwrap();
            let (warnings, text) = said(&study);
            assert!(warnings.is_empty(), "{text}");
            assert_eq!(warnings_of_sweep(&study), [] as [&str; 0]);
            studies += 1;
        }
    }
    assert!(studies > 0);
}

/// Forced against each other, the masses only move in their second mode: q = A / 2ξω² = 100/3 A, of which √2 q is between them.
#[test]
fn what_touches_first_in_any_of_the_modes_followed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/two_masses_stop");
    let (warnings, text) = said(&Study::load(&folder, &[], None).unwrap());
    assert!(
        text.contains("touches     from A = 0.0021")
            && text.contains(" on, stop first, at ")
            && text.contains("rad/s, at the resonance of mode 2,"),
        "{text}"
    );
    assert!(warnings.is_empty(), "{text}");
}

/// Forced in the shape of its first mode, 100 rad/s, the mass between springs touches at the bound nearer to it, whatever resonates beside.
#[test]
fn what_touches_first_beside_a_resonance_that_nothing_drives() {
    let pair = "name = 'pair'\ndofs = ['x', 'y']\n[matrices]\nmass = [[1, 0], [0, 1]]\nstiffness = [[2e4, -1e4], [-1e4, 2e4]]\n\
                [damping]\ndefault_ratio = 1e-4\n[forcing]\nshape = { mode = 1 }\n[[laws]]\nname = 'stop'\ndof = 'x'\n\
                law = { penalty_spring = { stiffness = 1e4, gap = 1e-3 } }\n";
    let (_, text) = checked(pair, "0.3", &[("frequency.min", "110"), ("frequency.max", "200")]);
    // |x| = A Φ / |ω² − ω₁²| with Φ = 1/√2.
    let first = format!("touches     from A = {:.5}", 1e-3 * (110.0_f64.powi(2) - 1e4) * 2.0_f64.sqrt());
    assert!(text.contains(&first) && text.contains("on, stop first, at the bound 110 rad/s, in the"), "{text}");
    let none = "no linear resonance that the force drives lies within the bounds: the nearest one is that of mode 1 at 100 rad/s";
    assert!(text.contains(none), "{text}");
}

#[test]
fn nothing_to_find() {
    let (warnings, text) = checked(MODEL.split("[contact]").next().unwrap(), "0.3", &[]);
    assert_eq!(warnings.len(), 1, "{text}");
    assert!(warnings[0].starts_with("nothing is nonlinear"), "{text}");
}

#[test]
fn a_force_on_rigid_bodies_alone() {
    let free = MODEL
        .replace("[\"x\"]", "[\"x\", \"y\"]")
        .replace("[[1]]", "[[1, 0], [0, 1]]")
        .replace("[[1e4]]", "[[1e4, -1e4], [-1e4, 1e4]]")
        .replace("modes = \"1\"", "modes = \"2\"");
    let both = free.replace("{ x = 1 }", "{ x = 1, y = 1 }");
    for (model, is_driven) in [(&free, true), (&both, false)] {
        let (warnings, text) = checked(model, "0.3", &[("contact.epsilon", "2e4"), ("backbone.modes", "[2]")]);
        let told = warnings.iter().any(|warning| warning.starts_with("the force drives rigid-body motions alone"));
        assert_eq!(told, !is_driven, "{text}");
    }
}

#[test]
fn branches_too_large_to_be_sent() {
    let (warnings, text) = checked(MODEL, "0.3", &[("branch.max_points", "200000")]);
    assert_eq!(warnings.len(), 1, "{text}");
    assert!(
        warnings[0].starts_with(
            "a branch that used up branch.max_points = 200000 would be too large to be sent: a point has "
        ),
        "{text}"
    );
    let most = warnings[0].rsplit(' ').next().unwrap();
    assert!(checked(MODEL, "0.3", &[("branch.max_points", most)]).0.is_empty(), "{most}");
}

/// Two masses apart but for a soft spring, the force on the mode that is ten times as fast as the first: that one is looked at.
#[test]
fn a_force_on_a_higher_mode_alone() {
    let model = "name = \"pair\"\ndofs = [\"p\", \"q\"]\nmonitors = [\"q\"]\n[matrices]\nmass = [[1, 0], [0, 1]]\n\
                 stiffness = [[1, 0], [0, 100]]\n[damping]\nratios = [{ modes = \"1-2\", ratio = 1e-2 }]\n[forcing]\nshape = { mode = 2 }\n\
                 [[laws]]\nname = \"law\"\nbetween = [\"q\", \"p\"]\nlaw = { polynomial_spring = { terms = [{ power = 3, coefficient = 1e6 }] } }\n";
    let (warnings, text) = checked(model, "1", &[]);
    assert_eq!(warnings, [] as [&str; 0]);
    assert!(text.contains("followed    modes 2 and 1, as far as their backbones start"), "{text}");
}
