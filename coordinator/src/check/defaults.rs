//! Physics that nobody gave: a default is said where results depend on it.

use crate::study::Study;
use solver::structure::DEFAULT_RATIO;

/// Keys that give the damping; a section `damping` without any of its own gives none.
const DAMPING: [&str; 4] = ["damping.ratios", "damping.default_ratio", "damping.rayleigh", "matrices.damping"];

/// The damping, if the study gives none.
pub(super) fn damping(study: &Study) -> Option<String> {
    let is_given = DAMPING.into_iter().any(|key| study.gives(key));
    (!is_given).then(|| {
        format!(
            "not given: {} % of critical in every mode; damping.default_ratio, among others, gives another",
            100.0 * DEFAULT_RATIO
        )
    })
}

/// The damping of the model, if another one is given over it.
pub(super) fn replaced(study: &Study) -> Option<String> {
    let mut of_damping = study.replaced.iter().filter(|(_, key)| DAMPING.contains(&key.as_str()));
    let (by, key) = of_damping.next_back()?;
    Some(format!("{by} replaces {key} of the model, which is left out"))
}

/// Where the force acts, if the study does not give it and there is a choice.
pub(super) fn forcing(study: &Study) -> Option<String> {
    (study.model.size() > 1 && !study.gives("forcing.shape"))
        .then(|| "forcing.shape is not given: the force has the shape of mode 1, and does no work on others".into())
}
