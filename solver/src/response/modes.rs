//! Which modes are followed, and their backbones: the primary one, and those of further modes that a study can reach.

use crate::response::backbone::{Backbone, BackboneError};
use crate::response::branch::{BranchPoint, Observer};
use crate::response::in_reach::{FAR, is_in_reach};
use crate::settings::{BackboneEquation, ModeChoice, Settings};
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// Most modes that are chosen unless a list is given.
const MOST: usize = 8;

/// Why the backbone of a mode is not followed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// The list of modes does not have it.
    NotListed,
    /// It does not deform the structure.
    RigidBody,
    /// Damping keeps its free motion from oscillating: it has no resonance where a backbone could begin.
    Overdamped,
    /// Its resonance is out of reach of the frequency range.
    OutOfRange,
    /// Modes enough are followed.
    TooMany,
    /// Its backbone does not start, for this reason.
    NotStarted(String),
}

impl std::fmt::Display for LeftOut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotListed => f.write_str("not in the list of modes"),
            Self::RigidBody => f.write_str("rigid body"),
            Self::Overdamped => f.write_str("it does not oscillate"),
            Self::OutOfRange => f.write_str("its resonance is out of reach of the frequency range"),
            Self::TooMany => write!(f, "{MOST} modes are followed already"),
            Self::NotStarted(why) => write!(f, "its backbone does not start: {why}"),
        }
    }
}

/// Which modes are followed, from 0, and why others are not.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ModesFollowed {
    /// The primary mode first, then the others in the order of their list or of their frequencies.
    pub followed: Vec<usize>,
    /// All other modes of the structure.
    pub left_out: Vec<(usize, LeftOut)>,
}

impl ModesFollowed {
    /// The choice of valid settings. With `"auto"` it is the lowest mode that the force drives and every other one whose
    /// resonance, in the motion's own harmonic or in one that the forced one is a multiple of, can reach the range of frequencies. The forcing need not work on the linear mode: nonlinear
    /// motion carries others along. Where there are too many, those on which it does come first.
    pub fn choose(model: &Model, settings: &Settings) -> Self {
        let primary = settings.tracked(model);
        let mut followed = vec![primary];
        let mut left_out = Vec::new();
        if let ModeChoice::These(list) = &settings.backbone.modes {
            followed.extend(list.numbers().iter().skip(1).map(|number| number - 1));
            let others = (0..model.size()).filter(|mode| !followed.contains(mode));
            left_out.extend(others.map(|mode| (mode, LeftOut::NotListed)));
            return Self { followed, left_out };
        }
        let is_free = settings.backbone.equation == BackboneEquation::DampedMode;
        for mode in (0..model.size()).filter(|&mode| mode != primary) {
            match () {
                () if model.modes().is_rigid(mode) => left_out.push((mode, LeftOut::RigidBody)),
                () if !is_in_reach(model, settings, mode) => left_out.push((mode, LeftOut::OutOfRange)),
                () if is_free && model.damped_modes()[mode].is_none() => left_out.push((mode, LeftOut::Overdamped)),
                () => followed.push(mode),
            }
        }
        if followed.len() > MOST {
            let driven = model.driven();
            followed[1..].sort_by_key(|mode| !driven.contains(mode));
            left_out.extend(followed.drain(MOST..).map(|mode| (mode, LeftOut::TooMany)));
            followed[1..].sort_unstable();
            left_out.sort_by_key(|(mode, _)| *mode);
        }
        Self { followed, left_out }
    }
}

/// Frequencies of the response at which the force resonates with the modes followed, rad/s: ω_j/m of those that it drives. Of a choice
/// without a list, as far as the force's frequency is in reach of the primary mode's.
pub(super) fn driven_resonances(model: &Model, settings: &Settings) -> Vec<f64> {
    let frequencies = &model.modes().frequencies;
    let followed = ModesFollowed::choose(model, settings).followed;
    let highest = match settings.backbone.modes {
        ModeChoice::Auto => FAR * frequencies[followed[0]],
        ModeChoice::These(_) => f64::INFINITY,
    };
    let resonances = model.driven().into_iter().filter(|mode| followed.contains(mode)).map(|mode| frequencies[mode]);
    resonances.filter(|omega| *omega <= highest).map(|omega| omega / model.forcing().harmonic as f64).collect()
}

/// The backbones of all modes followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Backbones {
    /// That of the primary mode first, if it starts; each of a mode of its own.
    pub list: Vec<Backbone>,
    /// Modes without a backbone, and why.
    pub left_out: Vec<(usize, LeftOut)>,
}

impl AsRef<[Backbone]> for Backbones {
    fn as_ref(&self) -> &[Backbone] {
        &self.list
    }
}

impl Backbones {
    /// Computes the backbone of every mode that the settings choose, not farther than they say whatever the forcing.
    ///
    /// # Errors
    /// If a setting is out of range, or no backbone starts. One that does not start is left out, but for that of a primary mode
    /// which is asked for.
    pub fn compute(model: &Model, settings: &Settings) -> Result<Self, BackboneError> {
        Self::reaching(model, settings, 0.0, &mut |_| ControlFlow::Continue(()), &AtomicBool::new(false))
    }

    /// The same as far as forcing amplitudes up to `forcing` need ([`Backbone::reaching`]), each in a thread of its own; `observer` is
    /// told of every point of the primary one, and `stop` cancels the others.
    ///
    /// # Errors
    /// Those of [`Backbones::compute`].
    pub fn reaching(
        model: &Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
        stop: &AtomicBool,
    ) -> Result<Self, BackboneError> {
        settings.validate(model)?;
        let ModesFollowed { followed, mut left_out } = ModesFollowed::choose(model, settings);
        let further = |mode: usize| {
            let mut observer = |_: &BranchPoint| match stop.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            Backbone::reaching(model, &settings.tracking(mode), forcing, &mut observer)
        };
        thread::scope(|scope| {
            let threads: Vec<_> = followed[1..].iter().map(|&mode| scope.spawn(move || further(mode))).collect();
            let primary = Backbone::reaching(model, settings, forcing, observer);
            let is_asked_for = matches!(settings.backbone.modes, ModeChoice::These(_));
            if primary.is_err() && is_asked_for {
                stop.store(true, Ordering::Relaxed);
            }
            let mut list: Vec<Backbone> = Vec::new();
            let primary = primary.map(|backbone| list.push(backbone));
            for (&mode, thread) in followed[1..].iter().zip(threads) {
                match thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)) {
                    Ok(backbone) => list.push(backbone),
                    Err(error) => left_out.push((mode, LeftOut::NotStarted(error.to_string()))),
                }
            }
            if let Err(error) = primary {
                if is_asked_for || list.is_empty() || !matches!(error, BackboneError::Start { .. }) {
                    return Err(error);
                }
                left_out.push((followed[0], LeftOut::NotStarted(error.to_string())));
            }
            left_out.sort_by_key(|(mode, _)| *mode);
            Ok(Self { list, left_out })
        })
    }

    /// That of the primary mode.
    pub fn primary(&self) -> &Backbone {
        &self.list[0]
    }

    /// Which modes have one, and which not.
    pub fn modes(&self) -> ModesFollowed {
        ModesFollowed { followed: self.list.iter().map(|b| b.mode).collect(), left_out: self.left_out.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::NumberList;
    use crate::structure::ModelBuilder;

    /// Masses of 1 kg on springs of their own: every dof is a mode.
    fn masses(omegas: &[f64], forces: &[f64]) -> ModelBuilder {
        let diagonal = |values: Vec<f64>| crate::linalg::Matrix::diagonal(&values);
        let squares = omegas.iter().map(|omega| omega * omega).collect();
        let mass = diagonal(vec![1.0; omegas.len()]);
        Model::builder("masses").mass(mass).stiffness(diagonal(squares)).force_shape(forces)
    }

    fn chosen(model: &Model, change: impl FnOnce(&mut Settings)) -> (Vec<usize>, Vec<(usize, LeftOut)>) {
        let mut settings = Settings::default();
        change(&mut settings);
        settings.validate(model).unwrap();
        let ModesFollowed { followed, left_out } = ModesFollowed::choose(model, &settings);
        (followed, left_out)
    }

    #[test]
    fn modes_in_reach_are_followed_whether_they_are_forced_or_not() {
        let model = masses(&[1.0, 1.5, 3.0, 3.9, 4.1], &[1.0, 0.0, 1.0, 1e-5, 1.0]).build().unwrap();
        let (followed, left_out) = chosen(&model, |_| {});
        assert_eq!((followed, left_out), (vec![0, 1, 2, 3], vec![(4, LeftOut::OutOfRange)]));
        // Bounds count for what they say, twice as far.
        let (followed, _) = chosen(&model, |s| s.frequency.max = Some(1.6));
        assert_eq!(followed, [0, 1, 2]);
        let (followed, _) = chosen(&model, |s| (s.frequency.min, s.frequency.max) = (Some(7.0), Some(8.0)));
        assert_eq!(followed, [0, 3, 4]);
        // The backbone's own bounds: it could not start.
        assert_eq!(chosen(&model, |s| s.backbone.max_frequency = Some(3.5)).0, [0, 1, 2]);
        // A list is taken as it is.
        let list = ModeChoice::These(NumberList::new(&[3, 2]).unwrap());
        let (followed, left_out) = chosen(&model, |s| s.backbone.modes = list);
        assert_eq!((followed, left_out.len(), &left_out[0]), (vec![2, 1], 3, &(0, LeftOut::NotListed)));
    }

    #[test]
    fn a_forced_harmonic_brings_higher_modes_into_reach() {
        let model = masses(&[1.0, 6.0, 13.0], &[1.0; 3]).harmonic(3).build().unwrap();
        assert_eq!(chosen(&model, |_| {}).0, [0, 1]);
    }

    #[test]
    fn there_is_an_end_to_modes() {
        let omegas: Vec<f64> = (0..10).map(|i| 1.0 + 0.1 * f64::from(i)).collect();
        let (followed, left_out) = chosen(&masses(&omegas, &[1.0; 10]).build().unwrap(), |_| {});
        assert_eq!(followed, [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(left_out, [(8, LeftOut::TooMany), (9, LeftOut::TooMany)]);
        // Those that are forced come first, the lowest of them as the primary one.
        let mut forces = [1.0; 10];
        (forces[0], forces[2], forces[9]) = (0.0, 0.0, 1e-9);
        let (followed, left_out) = chosen(&masses(&omegas, &forces).build().unwrap(), |_| {});
        assert_eq!(followed, [1, 0, 3, 4, 5, 6, 7, 8]);
        assert_eq!(left_out, [(2, LeftOut::TooMany), (9, LeftOut::TooMany)]);
    }

    #[test]
    fn a_mode_that_does_not_oscillate_is_left_out() {
        let model = masses(&[1.0, 1.5, 2.0], &[1.0; 3])
            .damping_matrix(crate::linalg::Matrix::diagonal(&[0.02, 3.6, 0.04]))
            .build()
            .unwrap();
        assert_eq!(chosen(&model, |_| {}), (vec![0, 2], vec![(1, LeftOut::Overdamped)]));
        // A resonance of phases is there at any damping.
        let of_phase = |s: &mut Settings| s.backbone.equation = BackboneEquation::PhaseResonance;
        assert_eq!(chosen(&model, of_phase).0, [0, 1, 2]);
        // What is asked for is tried, and the reason told.
        let listed = |s: &mut Settings| s.backbone.modes = ModeChoice::These(NumberList::new(&[1, 2]).unwrap());
        assert_eq!(chosen(&model, listed), (vec![0, 1], vec![(2, LeftOut::NotListed)]));
    }

    #[test]
    fn a_backbone_that_does_not_start_is_left_out() {
        let model = masses(&[1.0, 2.0], &[1.0; 2]).build().unwrap();
        let mut settings = Settings::default();
        settings.backbone.modes = ModeChoice::These(NumberList::new(&[1, 2]).unwrap());
        (settings.backbone.max_frequency, settings.backbone.max_points) = (Some(1.5), 5);
        let backbones = Backbones::compute(&model, &settings).unwrap();
        let ModesFollowed { followed, left_out } = backbones.modes();
        assert_eq!(followed, [0]);
        let (mode, LeftOut::NotStarted(why)) = &left_out[0] else { panic!("{left_out:?}") };
        assert!(*mode == 1 && why.contains("backbone.max_frequency = 1.5"), "{why}");
        // That of the primary mode has to start.
        settings.backbone.modes = ModeChoice::These(NumberList::new(&[2, 1]).unwrap());
        assert!(Backbones::compute(&model, &settings).is_err());
    }
}
