//! What a structure does of itself: it is excited without being forced, or nothing damps it.

use crate::words::{capitalised, modes};
use solver::formulation::harmonics::width;
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::structure::Model;

/// What a backbone tells of motions without forcing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Unforced {
    /// Mode, from 0.
    pub mode: usize,
    /// What its smallest motion loses to the linear damping in a period, J.
    pub linear: f64,
    /// To the laws, J.
    pub nonlinear: f64,
    /// Whether the laws feed in more than the damping takes from the smallest motions on of which that is known.
    pub is_fed_at_rest: bool,
    /// If that is damped: amplitude of the first monitored dof, m, and frequency, rad/s, from which on the laws feed in more than
    /// the damping takes.
    pub fed_from: Option<(f64, f64)>,
    /// Whether it is the linear damping that feeds in there.
    pub is_fed_by_damping: bool,
}

/// A balance of energies this much smaller than the dissipation is round-off.
const ROUND_OFF: f64 = 1e-6;
/// The same of the kinetic energy: conservative forces of large motions do some work by rounding, and by the harmonics that were left out.
const OF_KINETIC: f64 = 1e-8;

impl Unforced {
    /// Of a backbone.
    pub fn of(backbone: &Backbone) -> Option<Self> {
        let lost = backbone.points.first()?.energies();
        let balance = |at: &BackbonePoint| at.energies().linear + at.energies().nonlinear;
        let rounding = |at: &BackbonePoint| ROUND_OFF * at.energies().linear + OF_KINETIC * kinetic(at);
        let begins = |pair: &&[BackbonePoint]| {
            let (before, behind) = (balance(&pair[0]), balance(&pair[1]));
            // A point of the backbone may lie where the balance vanishes, to rounding.
            before >= -rounding(&pair[0]) && behind < -rounding(&pair[1])
        };
        let piece = backbone.pieces().next()?;
        let first = piece.windows(2).find(begins);
        let is_fed_by_damping = first.is_some_and(|pair| pair[1].energies().linear < 0.0);
        let fed_from = first.map(|pair| {
            let share = (balance(&pair[0]) / (balance(&pair[0]) - balance(&pair[1]))).max(0.0);
            let between = |of: fn(&BackbonePoint) -> f64| of(&pair[0]) + share * (of(&pair[1]) - of(&pair[0]));
            (between(|at| at.point.amplitude()), between(|at| at.point.omega()))
        });
        let known = piece.iter().find(|at| balance(at).abs() > rounding(at));
        let is_fed_at_rest = known.is_some_and(|at| balance(at) < 0.0);
        let fed_from = fed_from.filter(|_| lost.linear + lost.nonlinear >= 0.0 && !is_fed_at_rest);
        let (mode, linear, nonlinear) = (backbone.mode, lost.linear, lost.nonlinear);
        Some(Self { mode, linear, nonlinear, is_fed_at_rest, fed_from, is_fed_by_damping })
    }

    fn balance(&self) -> f64 {
        self.linear + self.nonlinear
    }
}

/// What is said of motions that no force drives.
const UNLISTED: &str = " Such motions have a period of their own and are not listed; where no periodic response is stable the structure may come to them.";

/// Mean kinetic energy of a motion, J.
fn kinetic(at: &BackbonePoint) -> f64 {
    let state = &at.point.state;
    let modes = state.modal.chunks(width(state.harmonics));
    let of = |(i, q): (usize, &f64)| (i.div_ceil(2) as f64 * state.omega * q).powi(2);
    0.25 * modes.flat_map(|series| series.iter().enumerate().map(of)).sum::<f64>()
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

    /// What vibrates without being forced, or without being damped; `known` is what backbones tell of motions without forcing.
    pub fn sentence(
        &self,
        known: &[Unforced],
        length: impl Fn(f64) -> String,
        rate: impl Fn(f64) -> String,
    ) -> Option<String> {
        let Self { undamped, excited } = self;
        if !excited.is_empty() {
            let has = if excited.len() == 1 { "has" } else { "have" };
            // What the laws take of the smallest motions counts as well, as far as a backbone tells.
            let balance = |mode: &usize| known.iter().find(|motion| motion.mode == *mode).map(Unforced::balance);
            let balances: Vec<Option<f64>> = excited.iter().map(balance).collect();
            let is_driven = balances.iter().any(|balance| balance.is_some_and(|balance| balance < 0.0));
            let is_held = balances.iter().all(|balance| balance.is_some_and(|balance| balance > 0.0));
            let (so, unlisted) = match (is_driven, is_held) {
                (true, _) => (": the structure can vibrate by itself, from rest and without forcing", UNLISTED),
                (_, true) => (", of which the laws take more at small amplitudes", ""),
                _ => (
                    ": unless the laws take more, the structure can vibrate by itself, from rest and without forcing",
                    UNLISTED,
                ),
            };
            return Some(format!("{} {has} negative linear damping{so}.{unlisted}", capitalised(&modes(excited))));
        }
        let fed: Vec<usize> = known.iter().filter(|motion| motion.is_fed_at_rest).map(|motion| motion.mode).collect();
        if !fed.is_empty() {
            let (into, their) = (modes(&fed), if fed.len() == 1 { "its" } else { "their" });
            return Some(format!(
                "At small amplitudes the nonlinear forces feed more energy into {into} than {their} damping takes: the \
                 structure can vibrate by itself, from rest and without forcing.{UNLISTED}"
            ));
        }
        let pushed = known.iter().filter_map(|motion| Some((motion, motion.fed_from?)));
        if let Some((motion, (amplitude, omega))) = pushed.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0)) {
            let why = match motion.is_fed_by_damping {
                true => "the linear damping, which drives some motions, feeds energy in",
                false => "the nonlinear forces feed in more energy than the damping takes",
            };
            return Some(format!(
                "Pushed just beyond motions of mode {} of about {} at {}, the structure can vibrate by itself, without forcing: there {why}.{UNLISTED}",
                motion.mode + 1,
                length(amplitude),
                rate(omega)
            ));
        }
        let has = if undamped.len() == 1 { "has" } else { "have" };
        let modes = || capitalised(&modes(undamped));
        (!undamped.is_empty())
            .then(|| format!("{} {has} no linear damping: nothing but the laws limits the resonance.", modes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::Backbones;
    use solver::Settings;
    use solver::laws::{PolynomialDamper, PolynomialSpring, Term};

    /// With one harmonic of velocity V the damper takes 0.02 − 0.045 V² + 0.01875 V⁴ of V² π: nothing at V² = 0.5890 and 1.8110.
    #[test]
    fn where_what_is_fed_in_exceeds_the_damping() {
        let of = |damping: f64, cubic: f64, fifth: f64| {
            let terms = [(3, cubic), (5, fifth)].map(|(power, coefficient)| Term { power, coefficient });
            let model = Model::builder("mass")
                .mass([[1.0]])
                .stiffness([[1.0]])
                .damping_matrix([[damping]])
                .force("x1", 1.0)
                .element("damper", PolynomialDamper { terms: terms.to_vec() }, ["x1"])
                .build()
                .unwrap();
            Unforced::of(&Backbone::compute(&model, &Settings::default()).unwrap()).unwrap()
        };
        let unforced = |damping: f64, cubic: f64| of(damping, cubic, 0.03);
        let (amplitude, omega) = unforced(0.02, -0.06).fed_from.unwrap();
        let exact = f64::sqrt((0.045 - f64::sqrt(0.045_f64.powi(2) - 4.0 * 0.02 * 0.01875)) / (2.0 * 0.01875));
        assert!((amplitude * omega / exact - 1.0).abs() < 5e-3, "{amplitude} {omega}, not {exact}");
        assert_eq!(unforced(0.02, -0.05).fed_from, None);
        // A point of this backbone lies where nothing is taken, a little beyond by rounding.
        let (amplitude, omega) = of(0.02, -0.05, 0.01).fed_from.unwrap();
        let exact = f64::sqrt((0.0375 - f64::sqrt(0.0375_f64.powi(2) - 4.0 * 0.02 * 0.00625)) / (2.0 * 0.00625));
        assert!((amplitude * omega / exact - 1.0).abs() < 5e-3, "{amplitude} {omega}, not {exact}");
        // Nothing but the damper acts against it: from rest on.
        let undamped = unforced(0.0, -0.06);
        assert!(undamped.is_fed_at_rest && undamped.fed_from.is_none(), "{undamped:?}");
        let held = [unforced(0.0, 0.06), unforced(0.02, -0.06)];
        assert!(held.iter().all(|held| !held.is_fed_at_rest), "{held:?}");
    }

    #[test]
    fn every_mode_that_is_fed_at_rest_is_told() {
        let motion = |mode, is_fed_at_rest| Unforced {
            mode,
            linear: 1.0,
            nonlinear: -2.0,
            is_fed_at_rest,
            ..Unforced::default()
        };
        let said = |known: &[Unforced]| {
            let told = Excitation::default().sentence(known, |x| x.to_string(), |omega| omega.to_string());
            told.unwrap_or_default()
        };
        let two = said(&[motion(0, true), motion(1, true), motion(2, false)]);
        assert!(two.contains("more energy into modes 1 and 2 than their damping takes"), "{two}");
        assert!(said(&[motion(1, true)]).contains("more energy into mode 2 than its damping takes"));
        // A damping matrix that damps each mode may drive motions of several.
        let pushed = |is_fed_by_damping| {
            said(&[Unforced { fed_from: Some((2.0, 3.0)), is_fed_by_damping, ..Unforced::default() }])
        };
        assert!(pushed(true).contains("there the linear damping, which drives some motions, feeds energy in"));
        assert!(pushed(false).contains("there the nonlinear forces feed in more energy than the damping takes"));
    }

    /// A spring gives back what it takes, however large the motion and whatever rounding says, damped or not.
    #[test]
    fn springs_feed_nothing_in() {
        for (power, coefficient, damping) in [(3, 1e10, 0.0), (5, 1.2e15, 0.0), (2, 1e6, 0.0), (5, 1.2e15, 1e-9)] {
            let terms = vec![Term { power, coefficient }];
            let model = Model::builder("masses")
                .mass([[200.0, 0.0], [0.0, 10.0]])
                .stiffness([[8.2e5, -3.9e4], [-3.9e4, 3.9e4]])
                .damping_matrix([[damping, 0.0], [0.0, damping]])
                .force("x1", 1.0)
                .element("mount", PolynomialSpring { terms }, ["x1"])
                .build()
                .unwrap();
            let mut settings = Settings::default();
            settings.backbone.max_amplitude = Some(0.01);
            for backbone in Backbones::compute(&model, &settings).unwrap().list {
                let unforced = Unforced::of(&backbone).unwrap();
                assert_eq!((unforced.fed_from, unforced.is_fed_at_rest), (None, false), "power {power}, {damping}");
            }
        }
    }
}
