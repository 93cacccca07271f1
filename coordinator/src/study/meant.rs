//! What is refused in general words elsewhere, told as what was probably meant.

use solver::files::Layers;
use solver::structure::ModelError;
use toml::Value;

/// Refuses a unit of frequencies: each has its own beside it.
pub(super) fn unit_of_frequencies(numerics: &Layers) -> Result<(), ModelError> {
    let Some(Value::Table(section)) = numerics.table().get("frequency") else { return Ok(()) };
    let Some(unit) = section.get("unit") else { return Ok(()) };
    let is_hertz = unit.as_str().is_some_and(|unit| unit.trim().eq_ignore_ascii_case("hz"));
    let bounds =
        ["min", "max"].into_iter().filter_map(|bound| Some(format!("{bound} = \"{} Hz\"", section.get(bound)?)));
    let bounds: Vec<String> = bounds.filter(|_| is_hertz).collect();
    let remedy = match &bounds[..] {
        [] => "numbers are in rad/s, and a text has its unit with it, like min = \"150 Hz\"; leave the key out".into(),
        bounds => format!("write {}, and leave the key out", bounds.join(" and ")),
    };
    Err(ModelError::value(numerics.place("frequency.unit"), unit.to_string(), remedy))
}

/// Refuses a shape of the forcing that names dofs where the kind of shape is to be.
pub(super) fn shape_of_forcing(model: &Layers) -> Result<(), ModelError> {
    let table = model.table();
    let names: Vec<&str> = match table.get("dofs") {
        Some(Value::Array(list)) => list.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    let shape = table.get("forcing").and_then(|forcing| forcing.get("shape")).and_then(Value::as_table);
    let Some(shape) = shape.filter(|shape| !shape.is_empty() && shape.keys().all(|key| names.contains(&key.as_str())))
    else {
        return Ok(());
    };
    let forces: Vec<String> = shape.iter().map(|(dof, force)| format!("{dof} = {force}")).collect();
    let (forces, dofs) = (forces.join(", "), if shape.len() == 1 { "is a dof" } else { "are dofs" });
    let listed: Vec<String> = shape.keys().map(|key| format!("`{key}`")).collect();
    let message =
        format!("{} {dofs}, and no kind of shape: write shape = {{ dofs = {{ {forces} }} }}", listed.join(", "));
    Err(ModelError::Type { place: model.place("forcing.shape"), message })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn layers(text: &str) -> Layers {
        Layers::parse(Path::new("study.toml"), text).unwrap()
    }

    #[test]
    fn a_unit_stands_with_each_bound() {
        let refused = |text: &str| unit_of_frequencies(&layers(text)).map_err(|error| error.to_string());
        let said = refused("[frequency]\nunit = \"Hz\"\nmin = 0.5\nmax = 2").unwrap_err();
        let remedy = "write min = \"0.5 Hz\" and max = \"2 Hz\", and leave the key out";
        for part in ["study.toml", "`frequency.unit`", "\"Hz\"", remedy] {
            assert!(said.contains(part), "{said}");
        }
        let other = refused("[frequency]\nunit = \"rad/s\"\nmin = 0.5").unwrap_err();
        assert!(other.contains("numbers are in rad/s") && !other.contains("write min"), "{other}");
        assert_eq!(refused("[frequency]\nmin = 0.5"), Ok(()));
    }

    #[test]
    fn dofs_of_a_shape_stand_a_level_deeper() {
        let refused = |shape: &str| {
            let text = format!("dofs = [\"frame\", \"machine\"]\n[forcing]\nshape = {shape}");
            shape_of_forcing(&layers(&text)).map_err(|error| error.to_string())
        };
        let said = refused("{ machine = 1 }").unwrap_err();
        let expected = "`machine` is a dof, and no kind of shape: write shape = { dofs = { machine = 1 } }";
        assert!(said.contains(expected) && said.contains("`forcing.shape`") && said.contains("study.toml"), "{said}");
        let both = refused("{ frame = 0.5, machine = 1 }").unwrap_err();
        assert!(
            both.contains("`machine` are dofs") && both.contains("{ dofs = { frame = 0.5, machine = 1 } }"),
            "{both}"
        );
        for other in ["{ dofs = { machine = 1 } }", "{ mode = 1 }", "{ motor = 1 }", "{}"] {
            assert_eq!(refused(other), Ok(()), "{other}");
        }
    }
}
