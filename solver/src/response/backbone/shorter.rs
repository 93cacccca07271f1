//! Motions of shorter periods beside a backbone: where the force acts on harmonic m, it also drives motions that repeat themselves k times
//! within m periods of the force, k a divisor of m; those with the period of the force most of all. Each mode has a backbone of such motions
//! as well, at a k-th of its frequency: that of the order m/k.

use super::{Backbone, BackbonePoint};
use crate::formulation::Formulation;
use crate::formulation::pressure::PressureForm;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop};
use crate::response::columns::{OnBackbone, Row};
use crate::response::in_reach::is_in_reach;
use crate::response::melnikov::Energies;
use crate::response::orders::Shorter;
use crate::settings::{
    BackboneEquation, BackboneSettings, FrequencySettings, HarmonicSettings, SearchSettings, Settings,
};
use crate::structure::Model;

impl Backbone {
    /// The same with the backbones of the same mode's shorter motions as further pieces, as far as these are in reach of the frequencies
    /// and not looked for as motions of an order of their own. One that does not start is not there.
    pub(super) fn with_shorter(
        mut self,
        model: &Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Self {
        let m = model.forcing().harmonic;
        // A backbone in quadrature with the force begins with these motions.
        if settings.backbone.equation == BackboneEquation::PhaseResonance {
            return self;
        }
        let listed = Shorter::of(model, settings.search.harmonics.as_ref());
        for times in (2..=m).filter(|times| m.is_multiple_of(*times) && !listed.has_multiples_of(*times)) {
            let is_cancelled = |outcome: &Outcome| matches!(outcome, Outcome::Open(_, Stop::Cancelled));
            if is_cancelled(&self.outcome) || self.crossing.iter().any(is_cancelled) {
                break;
            }
            let (model_of, settings_of) = (model.with_force_on(m / times), shorter(settings, times));
            if is_in_reach(&model_of, &settings_of, self.mode)
                && let Ok(of_shorter) = Self::of_own_order(&model_of, &settings_of, forcing, observer)
            {
                self.add_repeated(model, settings, of_shorter, times);
            }
        }
        self
    }

    /// Adds the pieces of a backbone as motions that last so many times as long.
    fn add_repeated(&mut self, model: &Model, settings: &Settings, shorter: Self, times: usize) {
        let equation = settings.backbone.equation;
        let Ok(mut problem) = super::compute::system::<PressureForm<'_>>(model, settings, equation) else { return };
        let (criterion, harmonics) = (settings.backbone.criterion, settings.harmonics.count);
        let (pieces, before) = self.points.last().map_or((0, 0.0), |last| (last.piece() + 1, last.arc()));
        self.points.extend(shorter.points.into_iter().map(|at| {
            let state = at.point.state.repeated(times, harmonics);
            let y = problem.encode(&state);
            let energies = Energies::evaluate(&mut problem, &y, &state);
            let (arc, piece) = (before + at.arc(), pieces + at.piece());
            let values =
                Row::of_backbone(OnBackbone { aft: problem.aft(), state: &state, energies, criterion, arc, piece });
            BackbonePoint { point: BranchPoint { state, ..at.point }, values }
        }));
        self.crossing.push(shorter.outcome);
        self.crossing.extend(shorter.crossing);
        self.rejections += shorter.rejections;
    }
}

/// The settings for motions that last a `times`-th as long.
fn shorter(settings: &Settings, times: usize) -> Settings {
    let higher = |omega: Option<f64>| omega.map(|omega| omega * times as f64);
    let HarmonicSettings { count, samples, .. } = settings.harmonics;
    let (frequency, backbone) = (&settings.frequency, settings.backbone);
    Settings {
        harmonics: HarmonicSettings { count: count / times, samples: samples.div_ceil(times), ..settings.harmonics },
        frequency: FrequencySettings { min: higher(frequency.min), max: higher(frequency.max) },
        backbone: BackboneSettings {
            min_frequency: higher(backbone.min_frequency),
            max_frequency: higher(backbone.max_frequency),
            ..backbone
        },
        search: SearchSettings { harmonics: None, ..settings.search },
        ..*settings
    }
}
