//! What a structure does of itself: it is excited without being forced, or nothing damps it.

use crate::words::{capitalised, modes};
use solver::response::backbone::Backbone;
use solver::structure::Model;

/// What the smallest motion of a mode loses in a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallestMotion {
    /// Mode, from 0.
    pub mode: usize,
    /// To the linear damping, J.
    pub linear: f64,
    /// To the laws, J.
    pub nonlinear: f64,
}

impl SmallestMotion {
    /// At the beginning of a backbone.
    pub fn of(backbone: &Backbone) -> Option<Self> {
        let lost = backbone.points.first()?.energies();
        Some(Self { mode: backbone.mode, linear: lost.linear, nonlinear: lost.nonlinear })
    }

    fn balance(&self) -> f64 {
        self.linear + self.nonlinear
    }
}

/// Modes that deform the structure and that no damping acts on, or one that feeds them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Excitation {
    /// Modes without damping, from 0.
    pub undamped: Vec<usize>,
    /// Modes of negative damping, from 0.
    pub excited: Vec<usize>,
}

impl Excitation {
    /// As the linear damping of a model tells it.
    pub fn of(model: &Model) -> Self {
        let rates = model.damping().rates();
        let damped = |is_wanted: fn(f64) -> bool| {
            let deforming = (0..model.size()).filter(|&mode| !model.modes().is_rigid(mode));
            deforming.filter(|&mode| is_wanted(rates[mode])).collect()
        };
        Self { undamped: damped(|rate| rate == 0.0), excited: damped(|rate| rate < 0.0) }
    }

    /// What vibrates without being forced, or without being damped; `known` is what backbones tell of the smallest motions.
    pub fn sentence(&self, known: &[SmallestMotion]) -> Option<String> {
        let Self { undamped, excited } = self;
        if !excited.is_empty() {
            let has = if excited.len() == 1 { "has" } else { "have" };
            // What the laws take of the smallest motions counts as well, as far as a backbone tells.
            let balance = |mode: &usize| known.iter().find(|motion| motion.mode == *mode).map(SmallestMotion::balance);
            let balances: Vec<Option<f64>> = excited.iter().map(balance).collect();
            let is_driven = balances.iter().any(|balance| balance.is_some_and(|balance| balance < 0.0));
            let is_held = balances.iter().all(|balance| balance.is_some_and(|balance| balance > 0.0));
            let so = match (is_driven, is_held) {
                (true, _) => ": the structure can vibrate by itself, from rest and without forcing",
                (_, true) => ", of which the laws take more at small amplitudes",
                _ => ": unless the laws take more, the structure can vibrate by itself, from rest and without forcing",
            };
            return Some(format!("{} {has} negative linear damping{so}.", capitalised(&modes(excited))));
        }
        if let Some(fed) = known.iter().find(|motion| motion.linear > 0.0 && motion.balance() < 0.0) {
            return Some(format!(
                "At small amplitudes the nonlinear forces feed more energy into mode {} than its damping takes: the \
                 structure can vibrate by itself, from rest and without forcing.",
                fed.mode + 1
            ));
        }
        let has = if undamped.len() == 1 { "has" } else { "have" };
        let modes = || capitalised(&modes(undamped));
        (!undamped.is_empty())
            .then(|| format!("{} {has} no linear damping: nothing but the laws limits the resonance.", modes()))
    }
}
