//! The room in which branches are looked for.

use crate::response::backbone::Backbone;
use crate::response::modes::driven_resonances;
use crate::response::windows::windows;
use crate::settings::{Settings, SettingsError, told_frequency};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// Within which frequencies and amplitudes branches are followed: settings, completed by the backbones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SearchRange {
    /// Lowest and highest frequency of the study, rad/s.
    pub frequency: (f64, f64),
    /// Amplitude of the first monitored dof up to which responses are expected, m; a bound only if the settings give one.
    pub amplitude: f64,
    /// Lowest and highest frequency that the backbones suggest, rad/s: 10 % beyond those of the primary mode's, and beyond
    /// the windows of further modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub natural: Option<(f64, f64)>,
    /// Lowest and highest forcing amplitude to which folds are followed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forcing: Option<(f64, f64)>,
}

impl SearchRange {
    /// Folds are followed by this factor beyond the forcing amplitudes of a study.
    pub const BEYOND: f64 = 2.0;

    /// By what share of their frequency bounds that nobody gave lie beyond backbones and resonances.
    pub const MARGIN: f64 = 0.1;

    /// As set; where nothing is set, 10 % beyond the backbone's frequencies and three times its largest amplitude.
    ///
    /// # Errors
    /// If a bound that is set lies on the wrong side of one that the backbone gives.
    pub fn new(settings: &Settings, backbone: &Backbone) -> Result<Self, SettingsError> {
        Self::over(settings, backbone, &[], 0.0)
    }

    /// The same; where nothing is set, also 10 % beyond the windows that backbones of further modes have at a forcing
    /// amplitude.
    ///
    /// # Errors
    /// Those of [`SearchRange::new`].
    pub fn over(
        settings: &Settings,
        backbone: &Backbone,
        further: &[Backbone],
        forcing: f64,
    ) -> Result<Self, SettingsError> {
        let (low, high) = backbone.frequency_range();
        // Nobody knows where a backbone that ends early would have gone.
        let end = match settings.backbone.max_frequency {
            _ if !backbone.outcome.is_unfinished() => high,
            Some(bound) => bound,
            None => high.max(FAR * low),
        };
        let windows = further
            .iter()
            .flat_map(|backbone| windows(backbone, forcing).into_iter().map(move |w| w.of_points(backbone)));
        let (low, end) = windows.fold((low, end), |(low, end), omega| (low.min(omega.0), end.max(omega.1)));
        let natural = ((1.0 - Self::MARGIN) * low, (1.0 + Self::MARGIN) * end);
        let (low, high) = (settings.frequency.min.unwrap_or(natural.0), settings.frequency.max.unwrap_or(natural.1));
        if low >= high {
            let (key, value, remedy) = match settings.frequency.max {
                Some(_) => (
                    "frequency.max",
                    high,
                    format!("the lower frequency bound is {}: use a higher one", told_frequency(low)),
                ),
                None => (
                    "frequency.min",
                    low,
                    format!("the backbones end at {}: use a lower one, or give frequency.max", told_frequency(end)),
                ),
            };
            return Err(SettingsError { key, value: told_frequency(value), remedy });
        }
        let amplitude = settings.branch.max_amplitude.unwrap_or(3.0 * backbone.max_amplitude());
        Ok(Self { frequency: (low, high), amplitude, natural: Some(natural), forcing: None })
    }

    /// The same; bounds that the settings leave open also 10 % beyond the resonances of the force with the modes followed. Main branches
    /// have them, and motions that last several periods of the force branch off there.
    #[must_use]
    pub fn with_resonances(self, model: &Model, settings: &Settings) -> Self {
        let (mut low, mut high) = self.frequency;
        for omega in driven_resonances(model, settings) {
            if settings.frequency.min.is_none() {
                low = low.min((1.0 - Self::MARGIN) * omega);
            }
            if settings.frequency.max.is_none() {
                high = high.max((1.0 + Self::MARGIN) * omega);
            }
        }
        Self { frequency: (low, high), ..self }
    }

    /// The same for a study of these forcing amplitudes: folds are followed a factor of two beyond them.
    pub fn with_folds_of(self, amplitudes: impl Iterator<Item = f64>) -> Self {
        let (low, high) = amplitudes.fold((f64::INFINITY, 0.0f64), |(low, high), a| (low.min(a), high.max(a)));
        Self { forcing: Some((low / Self::BEYOND, Self::BEYOND * high)).filter(|_| low.is_finite()), ..self }
    }

    /// Lowest and highest forcing amplitude to which folds of branches at one are followed.
    pub(super) fn forcing_around(&self, forcing: f64) -> (f64, f64) {
        self.forcing.unwrap_or((forcing / Self::BEYOND, Self::BEYOND * forcing))
    }

    /// Frequencies that main branches are walked through even if their response is linear at the study's bounds.
    pub(super) fn swept(&self) -> (f64, f64) {
        let (low, high) = self.natural.unwrap_or(self.frequency);
        (low.min(self.frequency.0), high.max(self.frequency.1))
    }
}

/// Where a backbone ends early, main branches are walked up to this multiple of its lowest frequency.
const FAR: f64 = 4.0;
