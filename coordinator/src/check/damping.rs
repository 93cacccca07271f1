//! Modes with so much damping that they do not vibrate, and with none.

use crate::study::Study;
use results::words::{self, digits, number};
use solver::response::modes::{LeftOut, ModesFollowed};
use solver::settings::{BackboneEquation, Settings};
use solver::structure::laws::{Law, LawKind};
use solver::structure::{DampedMode, Model};

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

/// A damping ratio that structures hardly have, and that may be one in percent.
const HEAVY: f64 = 0.2;

/// Share by which damping moves a frequency that is told.
const MOVED: f64 = 0.01;

/// How the modes of a study's model are damped.
pub(super) struct Oscillations<'m> {
    model: &'m Model,
    settings: &'m Settings,
}

impl<'m> Oscillations<'m> {
    /// Those of a model.
    pub(super) fn of(model: &'m Model, settings: &'m Settings) -> Self {
        Self { model, settings }
    }

    fn motion(&self, mode: usize) -> Option<&'m DampedMode> {
        self.model.damped_modes()[mode].as_ref()
    }

    /// Share of its critical damping that a mode has.
    fn ratio(&self, mode: usize) -> f64 {
        let alone = || self.model.damping().rates()[mode] / (2.0 * self.model.modes().frequencies[mode]);
        self.motion(mode).map_or_else(alone, DampedMode::ratio)
    }

    /// How a mode that is no rigid-body mode is damped, and where it oscillates if damping moves that.
    pub(super) fn told(&self, mode: usize) -> String {
        let ratio = format!("damping ratio {}", number(self.ratio(mode)));
        let frequency = self.model.modes().frequencies[mode];
        let natural = self.motion(mode).map(DampedMode::natural);
        match natural {
            Some(natural) if (natural / frequency - 1.0).abs() > MOVED => {
                format!("{ratio}; it oscillates at {} rad/s, since the damping couples modes", number(natural))
            }
            None if self.ratio(mode) < 1.0 => "does not oscillate".into(),
            _ => ratio,
        }
    }

    fn followed(&self) -> Vec<usize> {
        ModesFollowed::choose(self.model, self.settings).followed
    }

    /// Of each mode that would be followed along its damped free motion, and has none: so much damping is often one in other units.
    pub(super) fn overdamped(&self) -> Vec<String> {
        let ModesFollowed { followed, left_out } = ModesFollowed::choose(self.model, self.settings);
        let left_out = left_out.into_iter().filter(|(_, why)| *why == LeftOut::Overdamped).map(|(mode, _)| mode);
        followed.into_iter().chain(left_out).filter_map(|mode| self.without_oscillation(mode)).collect()
    }

    /// Of the modes that are followed the most damped one, if it is damped more than structures are: a sentence.
    pub(super) fn heavy(&self) -> Option<String> {
        let oscillating = self.followed().into_iter().filter(|&mode| self.motion(mode).is_some());
        let ratios = oscillating.map(|mode| (mode, self.ratio(mode))).filter(|(_, ratio)| *ratio >= HEAVY);
        let (mode, ratio) = ratios.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(format!(
            "mode {} has a damping ratio of {}, which is a lot: ratios are shares of 1, not percent",
            mode + 1,
            digits(ratio, 3)
        ))
    }

    /// Of the primary mode, without which there is no sweep, if it does not oscillate: a sentence.
    pub(super) fn overdamped_primary(&self) -> Option<String> {
        self.without_oscillation(self.settings.tracked(self.model))
    }

    fn without_oscillation(&self, mode: usize) -> Option<String> {
        let is_free = self.settings.backbone.equation == BackboneEquation::DampedMode;
        let oscillates = self.motion(mode).is_some() || self.model.modes().is_rigid(mode);
        (is_free && !oscillates).then(|| {
            let why = match self.ratio(mode) {
                ratio if ratio >= 1.0 => format!("is overdamped (ratio {})", digits(ratio, 3)),
                ratio if ratio <= -1.0 => {
                    format!("does not oscillate, since its damping is negative (ratio {})", digits(ratio, 3))
                }
                _ => "does not oscillate, since damping couples it with others".into(),
            };
            format!("mode {} {why}: no resonance, no backbone; are the units of the damping right?", mode + 1)
        })
    }
}
