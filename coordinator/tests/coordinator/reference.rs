//! What is documented of keys is what the program reads: every key exists and the other way round, defaults are defaults, and
//! `REFERENCE.md` says the same. `tests/schema` compares what the schema and the program refuse.

use coordinator::reference::{Absent, File, Key, Kind, document, file};
use coordinator::study::Study;
use protocol::codec::encode;
use protocol::model::ModelMessage;
use solver::settings::Settings;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use toml::{Table, Value};

/// A model with whatever keys may reach into.
const MODEL: &str = r#"
dofs = ["x1", "x2"]
matrices = { mass = [[1, 0], [0, 1]], stiffness = [[2, -1], [-1, 2]] }
damping.ratios = [{ modes = 2, ratio = 0.02 }]
[[contact.nodes]]
normal = "x1"
tangential = ["x2"]
radius = 0.5
gap = 1e-3
[[laws]]
dof = "x1"
law = { polynomial_spring = { terms = [{ power = 3, coefficient = 0.5 }] } }
"#;

fn folder(model: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.toml"), model).unwrap();
    fs::write(folder.path().join("study.toml"), "amplitudes = 1\n").unwrap();
    folder
}

/// The study with one more key: the model as it travels, and the study as it is kept.
fn with(folder: &TempDir, key: &str, value: &str) -> Result<(Vec<u8>, Table), String> {
    let study = Study::load(folder.path(), &[(key.into(), value.into())], None).map_err(|error| error.to_string())?;
    Ok((encode(&ModelMessage::from(&study.model)), study.resolved.parse().unwrap()))
}

/// A key as it is typed for the model above: the first entry of each list.
fn typed(file: File, key: &Key) -> String {
    let mut path = String::new();
    let mut typed = String::new();
    for part in key.path.split('.') {
        let above = file.keys().find(|known| known.path == path);
        if above.is_some_and(|above| matches!(above.kind, Kind::Tables(_))) {
            typed += "0.";
        }
        path = if path.is_empty() { part.into() } else { format!("{path}.{part}") };
        typed += part;
        typed += ".";
    }
    typed.trim_end_matches('.').into()
}

/// Names that the program says it knows in a table, asked for one that it does not.
fn known(key: &Key) -> BTreeSet<String> {
    let (at, value) = match (key.kind, key.path.strip_prefix("laws.law.")) {
        (_, Some(law)) => match law.strip_suffix(".terms") {
            Some(law) => ("laws.0.law".into(), format!("{{ {law} = {{ terms = [{{ no_such_key = 1 }}] }} }}")),
            None => ("laws.0.law".into(), format!("{{ {law} = {{ no_such_key = 1 }} }}")),
        },
        (Kind::Choice, None) => (typed(File::Study, key), "{ no_such_key = 1 }".into()),
        (Kind::Tables(_), None) => (format!("{}.0.no_such_key", typed(File::Study, key)), "1".into()),
        (_, None) => (format!("{}.no_such_key", typed(File::Study, key)), "1".into()),
    };
    let message = with(&folder(MODEL), &at, &value).unwrap_err();
    let (_, list) = message.split_once("known here: ").unwrap_or_else(|| panic!("{at} = {value}: {message}"));
    list.split('`').skip(1).step_by(2).map(String::from).collect()
}

fn documented(file: File, table: Option<&str>) -> BTreeSet<String> {
    file.keys().filter(|key| key.parent() == table).map(|key| key.name().to_string()).collect()
}

#[test]
fn every_key_of_a_table_is_documented_and_the_other_way_round() {
    let mut tables = 0;
    for key in File::Study.keys().filter(|key| key.has_keys()) {
        assert_eq!(documented(File::Study, Some(key.path)), known(key), "{}", key.path);
        tables += 1;
    }
    assert!(tables > 20, "{tables}");
    // At the top.
    let top: BTreeSet<String> = solver::files::config::KEYS.map(String::from).into();
    assert_eq!(documented(File::Model, None), top);
    let numerics = Table::try_from(Settings::default()).unwrap();
    let own = ["name", "model", "amplitudes", "units"].map(String::from);
    let all: BTreeSet<String> = top.into_iter().chain(numerics.keys().cloned()).chain(own).collect();
    assert_eq!(documented(File::Study, None), all);
}

#[test]
fn the_example_of_every_key_is_accepted_and_nothing_else_of_that_name() {
    for key in File::Study.keys().filter(|key| !key.has_keys() && !key.path.starts_with("laws.law.")) {
        let model = match key.path {
            // One way to give damping, to say what a law acts on, to force.
            path if path.starts_with("matrices.damping") || path.starts_with("damping.rayleigh") => {
                MODEL.replace("damping.ratios = [{ modes = 2, ratio = 0.02 }]\n", "")
            }
            "laws.between" | "laws.coefficients" => MODEL.replace("dof = \"x1\"\n", ""),
            _ => MODEL.to_string(),
        };
        let (folder, path) = (folder(&model), typed(File::Study, key));
        let accepted = with(&folder, &path, key.example);
        assert!(accepted.is_ok(), "{path} = {}: {}", key.example, accepted.unwrap_err());
        let message = with(&folder, &format!("{path}x"), key.example).expect_err(&path);
        assert!(message.contains("there is no"), "{path}x: {message}");
    }
    // Lists of tables, as far as they have one.
    for key in File::Study.keys().filter(|key| key.has_keys() && !key.example.is_empty()) {
        if let Err(refused) = with(&folder(MODEL), &typed(File::Study, key), key.example) {
            panic!("{} = {}: {refused}", key.path, key.example);
        }
    }
    // Laws, each as a whole.
    for law in File::Model.keys().filter(|key| key.parent() == Some("laws.law")) {
        let parameters: Vec<String> = File::Model
            .keys()
            .filter(|key| key.parent() == Some(law.path))
            .map(|key| match key.kind {
                Kind::Tables(_) => format!("{} = [{{ power = 3, coefficient = 0.5 }}]", key.name()),
                _ => format!("{} = {}", key.name(), key.example),
            })
            .collect();
        let value = format!("{{ {} = {{ {} }} }}", law.name(), parameters.join(", "));
        let accepted = with(&folder(MODEL), "laws.0.law", &value);
        assert!(accepted.is_ok(), "{value}: {}", accepted.unwrap_err());
    }
}

#[test]
fn a_default_that_is_written_changes_nothing() {
    let mut count = 0;
    for key in File::Study.keys() {
        let Absent::Value(default) = key.default else { continue };
        let model = MODEL.replace(
            "damping.ratios = [{ modes = 2, ratio = 0.02 }]\n",
            match key.path {
                "damping.rayleigh.mass" => "damping.rayleigh = { stiffness = 1e-3 }\n",
                "damping.rayleigh.stiffness" => "damping.rayleigh = { mass = 1e-3 }\n",
                _ => "",
            },
        );
        let folder = folder(&model);
        if key.path.starts_with("matrices.") {
            // Files of these names are looked for.
            let without = MODEL.replace("matrices = { mass = [[1, 0], [0, 1]], stiffness = [[2, -1], [-1, 2]] }\n", "");
            fs::write(folder.path().join("model.toml"), without).unwrap();
            for (file, off) in [("M.mtx", 0), ("K.mtx", -1)] {
                let head = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n";
                fs::write(folder.path().join(file), format!("{head}1 1 2\n2 1 {off}\n2 2 2\n")).unwrap();
            }
        }
        let name = ("name".to_string(), "as it was".to_string());
        let load =
            |set: Vec<(String, String)>| Study::load(folder.path(), &set, None).unwrap_or_else(|e| panic!("{e}"));
        let plain = load(vec![name.clone()]);
        let stated = load(vec![name, (typed(File::Study, key), default.into())]);
        assert_eq!(plain.settings, stated.settings, "{}", key.path);
        assert_eq!(
            encode(&ModelMessage::from(&plain.model)),
            encode(&ModelMessage::from(&stated.model)),
            "{}",
            key.path
        );
        count += 1;
    }
    assert!(count > 20, "{count}");
    // And every setting that has a default has it documented.
    let settings = Table::try_from(Settings::default()).unwrap();
    for (section, values) in settings {
        let Value::Table(values) = values else { panic!("{section} is a section") };
        for name in values.iter().filter(|(_, value)| !value.is_table()).map(|(name, _)| name) {
            let path = format!("{section}.{name}");
            let key = File::Study.keys().find(|key| key.path == path).unwrap_or_else(|| panic!("{path}"));
            assert!(matches!(key.default, Absent::Value(_)), "{path} has a default: {:?}", key.default);
        }
    }
}

#[test]
fn documents_are_those_of_the_keys() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../REFERENCE.md");
    let expected = file();
    assert!(expected.starts_with(&document()) && !document().contains("cargo"), "it is for users");
    if std::env::var("UPDATE_DOCUMENTS").is_ok_and(|value| value == "always") {
        fs::write(&path, &expected).unwrap();
    } else {
        let text = fs::read_to_string(&path).unwrap_or_default();
        assert!(text == expected, "REFERENCE.md is not what the keys say: UPDATE_DOCUMENTS=always writes it");
    }
}
