//! Modes with so much damping that they do not vibrate, and with none.

use crate::study::Study;
use results::words::{self, digits};
use solver::response::modes::ModesFollowed;
use solver::settings::{BackboneEquation, Settings};
use solver::structure::Model;
use solver::structure::laws::{Law, LawKind};

/// How much energy a law takes in a period, as its motion grows.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Takes {
    Nothing,
    /// As much as its largest force does: in proportion to the motion, as what a force of the size of A brings.
    Bounded,
    More,
}

impl Takes {
    fn of(law: &LawKind) -> Self {
        match (law, law.rigid()) {
            (_, Some(contact)) if contact.friction.is_none() => Self::Nothing,
            (LawKind::PenaltySpring(_) | LawKind::PolynomialSpring(_), _) => Self::Nothing,
            (LawKind::Jenkins(_) | LawKind::TanhFriction(_), _) => Self::Bounded,
            _ => Self::More,
        }
    }
}

/// Of modes without any damping that the force drives, where no law takes energy either, or only as much as dry friction does: responses
/// at resonance have no bound, or none from some forcing on.
pub(super) fn without(study: &Study) -> Option<String> {
    let model = &study.model;
    let most = model.elements().iter().map(|element| Takes::of(&element.law)).max().unwrap_or(Takes::Nothing);
    let why = match most {
        Takes::Nothing => "no law takes energy: the linear response at RESONANCE has no bound",
        Takes::Bounded => {
            "dry friction takes no more than its limit lets it: from some forcing on the response at RESONANCE may have no bound"
        }
        Takes::More => return None,
    };
    let bare: Vec<usize> = model.driven().into_iter().filter(|&mode| model.damping().rates()[mode] == 0.0).collect();
    let (have, their) = if bare.len() == 1 { ("has", "its") } else { ("have", "their") };
    (!bare.is_empty()).then(|| {
        format!(
            "{} {have} no damping, and {}, and the search may not end; give some, as with damping.default_ratio = 1e-3",
            words::modes(&bare),
            why.replace("RESONANCE", &format!("{their} resonance"))
        )
    })
}

/// Of each mode that is followed along its damped free motion, and has none: so much damping is often one in other units.
pub(super) fn overdamped(model: &Model, settings: &Settings) -> Vec<String> {
    let followed = ModesFollowed::choose(model, settings).followed;
    followed.into_iter().filter_map(|mode| of_mode(model, settings, mode)).collect()
}

/// A damping ratio that structures hardly have, and that may be one in percent.
const HEAVY: f64 = 0.2;

/// Of the modes that are followed the most damped one, if it is damped more than structures are: a sentence.
pub(super) fn heavy(model: &Model, settings: &Settings) -> Option<String> {
    let ratios = ModesFollowed::choose(model, settings).followed.into_iter().map(|mode| (mode, ratio(model, mode)));
    let (mode, ratio) = ratios.filter(|(_, ratio)| (HEAVY..1.0).contains(ratio)).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "mode {} has a damping ratio of {}, which is a lot: ratios are shares of 1, not percent",
        mode + 1,
        digits(ratio, 3)
    ))
}

/// The same of the primary mode, without which there is no sweep.
pub(super) fn overdamped_primary(model: &Model, settings: &Settings) -> Option<String> {
    of_mode(model, settings, settings.tracked(model))
}

/// Share of its critical damping that a mode has.
fn ratio(model: &Model, mode: usize) -> f64 {
    model.damping().rates()[mode] / (2.0 * model.modes().frequencies[mode])
}

fn of_mode(model: &Model, settings: &Settings, mode: usize) -> Option<String> {
    let is_free = settings.backbone.equation == BackboneEquation::DampedMode && !model.modes().is_rigid(mode);
    let ratio = ratio(model, mode);
    (is_free && ratio >= 1.0).then(|| {
        format!(
            "mode {} is overdamped (ratio {}): no resonance, no backbone; are the units of the damping right?",
            mode + 1,
            digits(ratio, 3)
        )
    })
}
