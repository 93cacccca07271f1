//! What is no study: one message that says what is wrong, where, and what would be right.

use super::*;
use proptest::prelude::*;

/// Where a message must put the blame.
#[derive(Clone, Copy)]
enum At {
    Study,
    CommandLine,
}

/// A text put into the good study, options, and what the message must say.
type Case<'a> = (At, &'a str, &'a [(&'a str, &'a str)], &'a [&'a str]);

#[test]
fn bad_input() {
    use At::{CommandLine, Study as File};
    let cases: &[Case] = &[
        // Unknown keys.
        (File, "amplitude = 3", &[], &["`amplitude`", "did you mean `amplitudes`"]),
        (File, "[harmonic]\ncount = 3", &[], &["`harmonic`", "did you mean `harmonics`"]),
        (File, "friction = 0", &[], &["`friction`", "did you mean `contact.friction`"]),
        (File, "[harmonics]\ncounts = 3", &[], &["`harmonics.counts`", "did you mean `count`", "`samples`"]),
        (File, "[continuation.newton]\ntol = 3", &[], &["`continuation.newton.tol`", "`tolerance`"]),
        (File, "[contact]\nfricton = 0", &[], &["`contact.fricton`", "did you mean `friction`"]),
        (File, "[backbone]\nequation = \"damped\"", &[], &["`backbone.equation`", "did you mean `damped_mode`"]),
        (CommandLine, "", &[("contact.fricton", "0")], &["--set contact.fricton=0: ", "did you mean `friction`"]),
        (CommandLine, "", &[("friction", "0")], &["--set friction=0: `friction`", "did you mean `contact.friction`"]),
        (CommandLine, "", &[("mass", "2")], &["--set mass=2: `mass`", "did you mean `matrices.mass`"]),
        (CommandLine, "", &[("effort", "2")], &["--set effort=2: `effort`", ".effort`?"]),
        (CommandLine, "", &[("harmonics.cuont", "3")], &["--set harmonics.cuont=3: ", "did you mean `count`"]),
        (CommandLine, LAW, &[("laws.s.limit", "3")], &["--set laws.s.limit=3: ", "did you mean `law.jenkins.limit`"]),
        (CommandLine, LAW, &[("laws.t.law", "3")], &["--set laws.t.law=3: ", "list of 1", "nor the name of one: `s`"]),
        (CommandLine, "", &[("contact..gap", "0")], &["--set contact..gap=0: ", "not a dotted key"]),
        (CommandLine, "", &[("", "0")], &["--set =0: ", "not a dotted key"]),
        (CommandLine, "", &[("contact.nodes.7.gap", "0")], &["--set contact.nodes.7.gap=0: ", "list of 1"]),
        // Wrong types.
        (File, "[harmonics]\ncount = \"ten\"", &[], &["`harmonics.count`", "\"ten\"", "whole number"]),
        (File, "[harmonics]\ncount = 10.5", &[], &["`harmonics.count`", "10.5", "whole number"]),
        (File, "[harmonics]\ncount = -1", &[], &["`harmonics.count`", "-1", "whole number that is not negative"]),
        (File, "harmonics = [20, 512]", &[], &["`harmonics` = [20, 512]", "a section", "[harmonics]"]),
        (File, "continuation.newton = [1e-9]", &[], &["`continuation.newton` = [", "a section"]),
        (File, "damping.rayleigh = [1]", &[], &["`damping.rayleigh` = [1]", "a section"]),
        (File, "contact = [1e-3]", &[], &["`contact` = [0.001]", "a section", "[contact]"]),
        (File, "[contact]\ngap = \"wide\"", &[], &["`contact.gap`", "\"wide\"", "a number"]),
        (File, "name = 67", &[], &["`name`", "67", "string"]),
        (File, "name = \" \"", &[], &["`name`", "give a name, or leave the key out"]),
        (CommandLine, "", &[("frequency.min", "low")], &["--set frequency.min=low: ", "\"low\"", "a number"]),
        (CommandLine, "", &[("contact", "0")], &["--set contact=0: ", "`contact` = 0", "a section"]),
        // Impossible values.
        (File, "[harmonics]\ncount = 0", &[], &["`harmonics.count` = 0", "1 to 400"]),
        (File, "[harmonics]\ncount = 200", &[], &["`harmonics.samples` (set by default) = 512", "at least 800"]),
        (File, "[frequency]\nmin = 3\nmax = 2", &[], &["`frequency.max` = 2", "above frequency.min = 3"]),
        (File, "[frequency]\nmin = nan", &[], &["`frequency.min` = NaN", "finite number above zero"]),
        (File, "[backbone]\nmode = 3", &[], &["`backbone.mode` = 3", "modes 1 to 2"]),
        (File, "[backbone]\nmodes = [1, 5]", &[], &["`backbone.modes` = [1, 5]", "modes 1 to 2"]),
        (File, "[backbone]\nmodes = [2, 2]", &[], &["`backbone.modes` = [2, 2]", "comes twice"]),
        (File, "[backbone]\nmodes = []", &[], &["`backbone.modes` = []", "at least one mode"]),
        (File, "[backbone]\nmodes = \"all\"", &[], &["`backbone.modes`", "\"auto\" or a list of mode numbers"]),
        (File, "[backbone]\nmode = 1\nmodes = [1]", &[], &["`backbone`", "backbone.modes", "only one of them"]),
        (CommandLine, "", &[("backbone.modes", "2,7")], &["--set backbone.modes=2,7: ", "modes 1 to 2"]),
        (File, "[contact]\nfriction = -1", &[], &["`contact.friction` = -1", "zero or positive"]),
        (File, "[contact]\ngap = nan", &[], &["`contact.gap` = NaN", "finite and positive", "in m"]),
        (File, "[contact]\nsense = 2", &[], &["`contact.sense` = 2", "1 or -1"]),
        (File, "[forcing]\nharmonic = 11", &[], &["`harmonics.count` (set by default) = 10", "at least 11"]),
        (File, "monitors = [\"tipp\"]", &[], &["`monitors[0]`", "`tipp`", "did you mean `tip`"]),
        (CommandLine, "", &[("contact.friction", "-1")], &["--set contact.friction=-1: ", "zero or positive"]),
        (CommandLine, "", &[("contact.epsilon", "0")], &["--set contact.epsilon=0: ", "`contact.epsilon` = 0", "N/m"]),
        (CommandLine, "", &[("harmonics.samples", "8")], &["--set harmonics.samples=8: ", "= 8", "at least 40"]),
        (CommandLine, "", &[("frequency.max", "-4")], &["--set frequency.max=-4: ", "= -4", "above zero"]),
        // The model and its files.
        (File, "model = \"../nowhere\"", &[], &["`model` = \"../nowhere\"", "no folder", "relative to"]),
        (File, "model = \"model.toml\"", &[], &["`model` = \"model.toml\"", "no folder", "that holds model.toml"]),
        (File, "model = \"empty\"", &[], &["`model` = \"empty\"", "no model.toml in", "that holds model.toml"]),
        (CommandLine, "", &[("model", "x")], &["--set model=x: ", "`model` = \"x\"", "no folder"]),
        (File, "[matrices]\nstiffness = \"soft.mtx\"", &[], &["soft.mtx: `matrices.stiffness` (set by ", "beside"]),
        (
            CommandLine,
            "",
            &[("matrices.stiffness", "soft.mtx")],
            &["soft.mtx: `matrices.stiffness` (set by --set matrices.stiffness=soft.mtx)", "beside model.toml"],
        ),
        (
            CommandLine,
            "",
            &[("damping.ratios.0.x", "1")],
            &["damping.ratios[0]", "`x`", "known here: `modes`, `ratio`"],
        ),
        // Amplitudes.
        (File, "amplitudes = \"20:150:20\"", &[], &["`amplitudes` = 20:150:20", "140 and 160", "20:140:20"]),
        (File, "amplitudes = [20, -1]", &[], &["`amplitudes` = -1", "above zero"]),
        (File, "amplitudes = [20, nan]", &[], &["`amplitudes` = nan", "finite"]),
        (File, "amplitudes = []", &[], &["`amplitudes` = []", "at least one"]),
        (File, "amplitudes = {a = 1}", &[], &["`amplitudes` = (table)", "give a list"]),
        (CommandLine, "", &[("amplitudes.0", "5")], &["--set amplitudes.0=5: ", "all amplitudes at once"]),
        (CommandLine, "", &[("amplitudes", "1:2")], &["--set amplitudes: `amplitudes` = 1:2", "start:stop:step"]),
    ];
    for &(at, extra, set, parts) in cases {
        let amplitudes = if extra.starts_with("amplitudes") { "" } else { "amplitudes = 20\n" };
        let dir = folder(&format!("{amplitudes}{extra}"));
        fs::create_dir(dir.path().join("empty")).unwrap();
        let message = Study::load(dir.path(), &pairs(set), None).expect_err(extra).to_string();
        says(&message, parts);
        match at {
            File => says(&message, &["study.toml"]),
            CommandLine => {
                says(&message, &["--set "]);
                assert!(!message.contains("study.toml"), "{message} blames the study");
            }
        }
    }
}

#[test]
fn more_bad_input() {
    let missing = Study::load(folder("").path(), &[], None).unwrap_err().to_string();
    says(&missing, &["study.toml", "`amplitudes` is not given", "20:140:20", "--amplitudes"]);
    let below =
        Study::load(folder("[frequency]\nmin = 1\namplitudes = [1, 2]").path(), &[], None).unwrap_err().to_string();
    says(&below, &["`amplitudes` is not given", "stands in the section [frequency]: move it above the first section"]);
    let typed = Study::load(folder(STUDY).path(), &[], Some("5:1:1")).unwrap_err().to_string();
    says(&typed, &["--amplitudes: `amplitudes` = 5:1:1", "5:1:-1"]);
    // What is wrong in the model is the model's fault, whatever the study sets beside it.
    let dir = folder("amplitudes = 20\n[contact]\ngap = 1e-3");
    fs::write(dir.path().join("model.toml"), MODEL.replace("friction = 0.2", "friction = -2")).unwrap();
    let error = Study::load(dir.path(), &pairs(&[("contact.sense", "1")]), None).unwrap_err().to_string();
    says(&error, &["model.toml: `contact.friction` = -2", "zero or positive"]);
    fs::write(dir.path().join("model.toml"), format!("harmonics = 3\n{MODEL}")).unwrap();
    says(
        &Study::load(dir.path(), &[], None).unwrap_err().to_string(),
        &["model.toml: `harmonics`: this belongs to a study: move it to study.toml"],
    );
    // Not TOML: the place is shown below the message.
    for text in ["amplitudes = [20,\n", "amplitudes = 20\n[contact\n", "amplitudes = 1\namplitudes = 2"] {
        let error = Study::load(folder(text).path(), &[], None).unwrap_err().to_string();
        let parts = ["study.toml: not valid TOML", "line ", "column "];
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

proptest! {
    /// Whatever is typed, the answer is a study or an error.
    #[test]
    fn nothing_panics(at in 0.0..1.0_f64, length in 0..20_usize, text in "[-a-z0-9 .=:\\[\\]{}\"\n]{0,12}", key in "[a-z. ]{0,16}") {
        let start = (at * STUDY.len() as f64) as usize;
        let study = format!("{}{text}{}", &STUDY[..start], &STUDY[(start + length).min(STUDY.len())..]);
        let refused = Study::load(folder(&study).path(), &[], None).err();
        prop_assert!(refused.is_none_or(|error| !error.to_string().is_empty()));
        let dir = folder(STUDY);
        let _ = Study::load(dir.path(), &pairs(&[(&key, &text), ("contact.gap", &text)]), Some(&text));
        let _ = Study::load(dir.path(), &pairs(&[("harmonics.count", &text), ("amplitudes", &text)]), None);
    }
}
