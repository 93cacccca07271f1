//! Wrong model files are refused with one message that names the file, the key, the value and a remedy.

use crate::support::messages::says;
use proptest::prelude::*;
use solver::files;
use std::fs;
use tempfile::TempDir;

/// Two masses, every key that the tests break.
const GOOD: &str = r#"
dofs = ["blade.r", "blade.theta"]
monitors = ["blade.r"]
[matrices]
mass = [[1, 0], [0, 1]]
stiffness = "K.mtx"
[damping]
ratios = [{ modes = "1-2", ratio = 1e-3 }]
[forcing]
shape = { mode = 1 }
harmonic = 1
[contact]
gap = 0.1
friction = 0.2
[[contact.nodes]]
name = "tip"
normal = "blade.r"
tangential = ["blade.theta"]
radius = 0.25
[[laws]]
dof = "blade.r"
law = { polynomial_spring = { terms = [{ power = 3, coefficient = 1.0 }] } }
"#;

const K: &str = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n";

fn folder(settings: &str, stiffness: &str) -> TempDir {
    let dir = TempDir::new().unwrap();
    fs::write(dir.path().join("model.toml"), settings).unwrap();
    fs::write(dir.path().join("K.mtx"), stiffness).unwrap();
    dir
}

/// Replaces `from` in the good settings by `to` and checks the message, which must name model.toml.
#[track_caller]
fn refused(from: &str, to: &str, parts: &[&str]) {
    assert!(GOOD.contains(from), "the good settings do not contain {from:?}");
    let error = files::load(folder(&GOOD.replacen(from, to, 1), K).path()).unwrap_err().to_string();
    says(&error, &["model.toml"]);
    says(&error, parts);
}

/// Checks the message about a stiffness file, which must name it.
#[track_caller]
fn stiffness_refused(text: &str, parts: &[&str]) {
    let error = files::load(folder(GOOD, text).path()).unwrap_err().to_string();
    says(&error, &["K.mtx"]);
    says(&error, parts);
}

#[test]
fn the_good_settings_load() {
    let model = files::load(folder(GOOD, K).path()).unwrap();
    assert_eq!(model.elements()[0].channels, [vec![(0, 1.0)], vec![(1, 1.0)], vec![]]);
    assert_eq!(model.elements()[1].name, "law1");
}

#[test]
fn missing_files() {
    let dir = TempDir::new().unwrap();
    let error = files::load(dir.path()).unwrap_err().to_string();
    says(&error, &["model.toml", "cannot be read", "give a folder"]);
    let dir = folder(&GOOD.replace("K.mtx", "stiff.mtx"), K);
    let error = files::load(dir.path()).unwrap_err().to_string();
    says(&error, &["stiff.mtx", "`matrices.stiffness`", "cannot be read", "beside model.toml"]);
}

#[test]
fn settings_that_are_not_toml() {
    let error = files::load(folder("dofs = [", K).path()).unwrap_err().to_string();
    assert!(error.contains("model.toml") && error.contains("TOML") && error.contains("line 1"), "{error}");
}

#[test]
fn unknown_keys_and_names() {
    refused("gap = 0.1", "gapp = 0.1", &["`contact", "`gapp`", "did you mean `gap`"]);
    refused("dofs =", "dof =", &["`dof`", "did you mean `dofs`"]);
    refused("radius =", "radios =", &["contact.nodes[0]", "`radios`", "did you mean `radius`"]);
    let known = ["laws[0].law", "`cubic_spring`", "`polynomial_spring`", "`jenkins`", "`penalty_spring`"];
    refused("polynomial_spring", "cubic_spring", &known);
    refused(
        "[forcing]",
        "[frequency]\nmin = 1\n[forcing]",
        &["`frequency`: this belongs to a study: move it to study.toml"],
    );
    let below = "dof = \"blade.r\"\namplitudes = [1]";
    refused("dof = \"blade.r\"", below, &["`laws[0].amplitudes`: this belongs to a study: move it to study.toml"]);
    refused("polynomial_spring", "cubic", &["there is no law `cubic`; did you mean `polynomial_spring`?"]);
    refused("polynomial_spring", "penality_spring", &["no law `penality_spring`; did you mean `penalty_spring`?"]);
    refused("polynomial_spring", "jenkisn", &["there is no law `jenkisn`; did you mean `jenkins`?"]);
    refused("{ mode = 1 }", "{ node = 1 }", &["forcing.shape", "`node`", "did you mean `mode`", "`constant`"]);
    refused("coefficient = 1.0", "coeficient = 1.0", &["laws[0].law", "`coeficient`", "did you mean `coefficient`"]);
}

#[test]
fn wrong_types_and_missing_keys() {
    refused("gap = 0.1", "gap = \"wide\"", &["`contact.gap`", "\"wide\"", "expected a number"]);
    refused("normal = \"blade.r\"", "", &["`contact.nodes[0]`", "missing", "`normal`"]);
    refused("mass = [[1, 0], [0, 1]]", "mass = 1", &["`matrices.mass`", "Matrix Market file", "its rows, like"]);
    refused("harmonic = 1", "harmonic = -1", &["`forcing.harmonic`", "-1", "whole number"]);
    refused("[damping]", "[[damping]]", &["`damping`", "a section", "[damping]"]);
    refused("[[laws]]", "[laws]", &["`laws`", "a list of them", "begins with `[[laws]]`"]);
    let list = ["`monitors`", "\"blade.r\"", "expected a list", "brackets"];
    refused("monitors = [\"blade.r\"]", "monitors = \"blade.r\"", &list);
    refused(
        "{ terms = [{ power = 3, coefficient = 1.0 }] }",
        "[[]]",
        &["`laws[0].law.polynomial_spring`", "by their names"],
    );
    let choices = ["`forcing.shape` = 3: choose `mode` or `", "`constant`"];
    refused("{ mode = 1 }", "3", &choices);
    refused("normal = \"blade.r\"", "normal = 1", &["`contact.nodes[0].normal`", "dof name", "coefficients"]);
}

#[test]
fn sizes() {
    let three = "%%MatrixMarket matrix coordinate real symmetric\n3 3 0\n";
    stiffness_refused(three, &["`matrices.stiffness`", "3 × 3", "mass matrix is 2 × 2", "same size"]);
    let oblong = "%%MatrixMarket matrix array real general\n2 1\n1\n1\n";
    stiffness_refused(oblong, &["`matrices.stiffness`", "2 × 1"]);
    refused("[[1, 0], [0, 1]]", "[[1, 0]]", &["`matrices.mass`", "1 × 2", "square"]);
    refused("[[1, 0], [0, 1]]", "[]", &["`matrices.mass`", "0 × 0", "at least one dof"]);
    refused(
        "[[1, 0], [0, 1]]",
        "[[1, 0], [1]]",
        &["`matrices.mass`: row 2 has 1 entry, but row 1 has 2 entries", "same length"],
    );
    refused("\"blade.theta\"]", "\"blade.theta\", \"z\"]", &["`dofs`", "3 names for 2 dofs", "one name per row"]);
    let with_c = "stiffness = \"K.mtx\"\ndamping = [[1]]";
    let dir = folder(&GOOD.replace("stiffness = \"K.mtx\"", with_c).replace("ratios =", "#"), K);
    says(&files::load(dir.path()).unwrap_err().to_string(), &["model.toml", "`matrices.damping`", "1 × 1", "2 × 2"]);
}

#[test]
fn entries() {
    let skew = "%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1.5\n2\n";
    stiffness_refused(skew, &["`matrices.stiffness`", "not symmetric", "(2, 1) is -1.0", "(1, 2) is -1.5", "1e-8"]);
    stiffness_refused(&K.replace("-1\n", "inf\n"), &["line 4", "`inf`", "finite"]);
    refused("[[1, 0], [0, 1]]", "[[1, 0], [0, nan]]", &["`matrices.mass`", "(2, 2) is NaN", "finite"]);
    stiffness_refused(&K.replace("2 2 3", "2 2 4"), &["3 of 4 entries"]);
}

#[test]
fn tiny_asymmetry_is_removed() {
    let nearly = "%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1.000000001\n2\n";
    let model = files::load(folder(GOOD, nearly).path()).unwrap();
    assert_eq!(model.stiffness()[(0, 1)], model.stiffness()[(1, 0)]);
}

#[test]
fn definiteness() {
    let parts = ["`matrices.mass`", "positive definite", "`blade.theta`", "-1.0 kg", "massless dofs"];
    refused("[[1, 0], [0, 1]]", "[[1, 0], [0, -1]]", &parts);
    stiffness_refused(
        &K.replace("-1\n", "-3\n"),
        &["`matrices.stiffness`", "negative eigenvalue", "-1", "5", "stable"],
    );
}

#[test]
fn rigid_body_modes_are_welcome() {
    let free = K.replace("1 1 2", "1 1 1").replace("2 2 2", "2 2 1");
    let model = files::load(folder(GOOD, &free).path()).unwrap();
    assert!(model.modes().frequencies[0] < 1e-7);
    assert!((model.modes().frequencies[1] - 2.0_f64.sqrt()).abs() < 1e-14);
}

#[test]
fn contact_ranges() {
    refused(
        "gap = 0.1",
        "gap = -0.1",
        &["`contact.gap` = -0.1", "finite and positive", "in m; where a contact just touches at rest"],
    );
    refused("gap = 0.1", "epsilon = 0", &["`contact.epsilon` = 0", "positive", "N/m", "order of the stiffness"]);
    refused("friction = 0.2", "friction = -0.2", &["`contact.friction` = -0.2", "zero or positive"]);
    refused("friction = 0.2", "friction = inf", &["`contact.friction` = inf"]);
    refused("friction = 0.2", "sense = 0.5", &["`contact.sense` = 0.5", "1 or -1"]);
    refused("radius = 0.25", "radius = 0", &["`contact.nodes[0].radius` = 0", "positive", "in m"]);
    refused("radius = 0.25", "", &["`contact.nodes[0].radius`", "friction is 0.2", "set friction = 0"]);
    refused("tangential = [\"blade.theta\"]", "", &["`contact.nodes[0].tangential`", "friction is 0.2", "is needed"]);
    refused("radius = 0.25", "radius = 0.25\ngap = -1", &["first entry of contact.nodes: `contact.nodes[0].gap` = -1"]);
}

#[test]
fn damping_ranges() {
    refused("1e-3", "1.0", &["`damping.ratios[0].ratio` = 1", "at least 0 and below 1"]);
    refused("1e-3", "-0.01", &["`damping.ratios[0].ratio` = -0.01"]);
    refused("ratios =", "default_ratio = nan #", &["`damping.default_ratio` = NaN"]);
    refused("\"1-2\"", "\"1-3\"", &["`damping.ratios[0].modes` = 1-3", "within 1 to 2"]);
    refused("\"1-2\"", "0", &["`damping.ratios[0].modes` = 0", "within 1 to 2"]);
    refused("\"1-2\"", "\"all\"", &["`damping.ratios[0].modes` = all", "range \"a-b\""]);
    refused("1e-3 }]", "1e-3 }, { modes = 2, ratio = 0 }]", &["`damping.ratios[1].modes` = 2", "mode 2", "once"]);
    refused("ratios =", "rayleigh = { mass = -1 } #", &["`damping.rayleigh.mass` = -1", "1/s"]);
    let both = &["`damping.rayleigh`", "`damping.ratios`", "remove one"];
    refused("[forcing]", "rayleigh = { mass = 1 }\n[forcing]", both);
    let twice = &["`damping.ratios`", "`matrices.damping`", "remove one"];
    refused("[damping]", "damping = [[1, 0], [0, 1]]\n[damping]", twice);
}

#[test]
fn forcing() {
    refused(
        "{ mode = 1 }",
        "{ constant = 0 }",
        &["`forcing.shape` = 0 on every dof", "does nothing", "at least one dof"],
    );
    refused("{ mode = 1 }", "{ dofs = {} }", &["`forcing.shape`", "does nothing"]);
    refused("{ mode = 1 }", "{ mode = 3 }", &["`forcing.shape.mode` = 3", "no such mode", "1 to 2"]);
    refused("{ mode = 1 }", "{ mode_shape = 0 }", &["`forcing.shape.mode_shape` = 0", "1 to 2"]);
    refused("{ mode = 1 }", "{ constant = inf }", &["`forcing.shape` = inf on dof `blade.r`", "finite"]);
    refused("{ mode = 1 }", "{ mode = 1, constant = 1 }", &["`forcing.shape`", "exactly one choice"]);
    refused("harmonic = 1", "harmonic = 0", &["`forcing.harmonic` = 0", "1 or more"]);
}

#[test]
fn dof_names() {
    refused("\"blade.theta\"]", "\"blade.r\"]", &["`dofs`", "`blade.r`", "twice", "its own name"]);
    refused("monitors = [\"blade.r\"]", "monitors = [\"blade.x\"]", &["`monitors[0]`", "`blade.x`", "`blade.r`"]);
    refused("monitors = [\"blade.r\"]", "monitors = []", &["`monitors`", "name at least one dof"]);
    refused("normal = \"blade.r\"", "normal = \"blade.rr\"", &["contact.nodes[0].normal", "did you mean `blade.r`"]);
    refused("normal = \"blade.r\"", "normal = { blade = 1 }", &["contact.nodes[0].normal.blade", "`blade.r`"]);
    refused("{ mode = 1 }", "{ dofs = { blader = 1 } }", &["forcing.shape.dofs.blader", "did you mean `blade.r`"]);
    refused("dof = \"blade.r\"", "dof = \"x1\"", &["`laws[0].dof`", "`x1`", "known here: `blade.r`, `blade.theta`"]);
    let unnamed = "known here: `x1`, `x2`; `dofs` is not given: it names them";
    refused("dofs = [\"blade.r\", \"blade.theta\"]", "", &["`blade.r`", unnamed]);
}

#[test]
fn what_stands_for_a_matrix_that_is_not_given() {
    let settings = GOOD.replace("mass = [[1, 0], [0, 1]]", "");
    let error = files::load(folder(&settings, K).path()).unwrap_err().to_string();
    says(&error, &["M.mtx", "matrices.mass is not given, and this is its default", "give its rows"]);
}

#[test]
fn a_decimal_comma() {
    for (wrong, is_told) in [("gap = 0,1", true), ("gap = -1,5", true), ("gap = [1,2", false)] {
        let error = files::load(folder(&GOOD.replace("gap = 0.1", wrong), K).path()).unwrap_err().to_string();
        assert_eq!(error.contains("numbers have a decimal point, as in 0.1"), is_told, "{error}");
    }
    let inline = GOOD.replace("coefficient = 1.0", "coefficient = 1,0");
    let error = files::load(folder(&inline, K).path()).unwrap_err().to_string();
    assert!(error.contains("numbers have a decimal point"), "{error}");
}

#[test]
fn laws() {
    refused(
        "coefficient = 1.0",
        "coefficient = inf",
        &["`laws[0].law.polynomial_spring.terms[0].coefficient` = inf", "finite"],
    );
    let second = "coefficient = 1.0 }, { power = 16, coefficient = 1.0";
    refused("coefficient = 1.0", second, &["`laws[0].law.polynomial_spring.terms[1].power` = 16", "1 to 15"]);
    refused("dof = \"blade.r\"", "", &["`laws[0].dof` is not given", "by `dof`, `between` or `coefficients`"]);
    let twice = "dof = \"blade.r\"\ncoefficients = { \"blade.r\" = 1 }";
    refused("dof = \"blade.r\"", twice, &["`laws[0].coefficients` is given as well", "`dof` says", "remove one"]);
    refused("power = 3", "power = 2.5", &["`laws[0].law", "2.5", "a whole number"]);
    refused("power = 3, ", "", &["`laws[0].law", "`power` is missing"]);
    refused(
        "terms = [{ power = 3, coefficient = 1.0 }]",
        "terms = []",
        &["`laws[0].law.polynomial_spring.terms` = []", "at least one"],
    );
    refused("polynomial_spring", "cubic_spring", &["`cubic_spring`", "known here: `penalty_spring`"]);
    let same = "between = [\"blade.r\", \"blade.r\"]";
    refused("dof = \"blade.r\"", same, &["`laws[0].between`", "[blade.r, blade.r]", "two different dofs"]);
    let alone = "between = [\"blade.r\"]";
    refused("dof = \"blade.r\"", alone, &["`laws[0].between`: a list of 1, where one of 2 is expected"]);
    let ground = "between = [\"blade.r\", \"ground\"]";
    refused("dof = \"blade.r\"", ground, &["there is no dof `ground`", "against the ground has `dof = \"blade.r\"`"]);
    refused("dof = \"blade.r\"", "coefficients = {}", &["`laws[0].coefficients`", "at least one dof"]);
    let zero = "coefficients = { \"blade.r\" = 0 }";
    refused("dof = \"blade.r\"", zero, &["`laws[0].coefficients.blade.r` = 0", "other than zero"]);
    let contact = "{ contact = { gap = 0.0, epsilon = 1.0 } } #";
    refused("{ polynomial_spring", contact, &["`laws[0].law`", "contact", "[[contact.nodes]]"]);
    refused("[[laws]]", "[[laws]]\nname = \"tip\"", &["`laws[0].name`", "`tip`", "twice", "nonlinear element"]);
}

#[test]
fn overrides() {
    let refused = |key: &str, value: &str, parts: &[&str]| {
        let error = files::load_with(folder(GOOD, K).path(), &[(key, value)]).unwrap_err().to_string();
        says(&error, &["override"]);
        says(&error, parts);
    };
    refused("contact.fricton", "0", &["`fricton`", "did you mean `friction`"]);
    refused("contact.friction", "-1", &["override contact.friction=-1: `contact.friction` = -1", "zero or positive"]);
    refused("contact.gap", "1,5", &["`contact.gap`", "\"1,5\"", "a number"]);
    refused("matrices.stiffness", "soft.mtx", &["soft.mtx", "`matrices.stiffness`", "beside model.toml"]);
    refused("contact.nodes.7.gap", "0", &["`contact.nodes.7.gap`", "list of 1"]);
    refused("contact..gap", "0", &["`contact..gap`", "not a dotted key"]);
    refused("contact.nodes.0.radius", "-1", &["`contact.nodes[0].radius`", "= -1"]);
}

proptest! {
    /// Whatever is typed into the files, the answer is a model or an error.
    #[test]
    fn nothing_panics(
        at in 0.0..1.0_f64,
        length in 0..20_usize,
        text in "[-a-z0-9 .=\\[\\]{}\"\n]{0,12}",
        in_matrix: bool,
    ) {
        let splice = |whole: &str| {
            let start = (at * whole.len() as f64) as usize;
            format!("{}{text}{}", &whole[..start], &whole[(start + length).min(whole.len())..])
        };
        let (settings, matrix) = if in_matrix { (GOOD.into(), splice(K)) } else { (splice(GOOD), K.into()) };
        if let Err(error) = files::load(folder(&settings, &matrix).path()) {
            prop_assert!(!error.to_string().is_empty());
        }
        let _ = files::load_with(folder(GOOD, K).path(), &[(&text, "1"), ("contact.gap", &text)]);
    }
}
