//! What ordinary continuation has under the same force as an isola.

use crate::curves::Curve;
use crate::overview::{
    BranchRow, Level, Omissions, Overview, acting_at_rest, highest, pressed_at_rest, verified_result,
};
use crate::store::Reader;
use solver::formulation::Formulation;
use solver::formulation::harmonics::complex;
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::unknown::Unknown;
use solver::settings::Settings;
use solver::structure::Model;

/// The ordinary response under the same force as another one: at the same level and frequency of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ordinary {
    /// Frequency of the force, rad/s.
    pub omega: f64,
    /// Largest amplitude of the main branch there, m, or of the linear response.
    pub amplitude: f64,
    /// Whether it is that of the main branch, which may not have been followed so far.
    pub is_of_main: bool,
}

/// The highest isola of all, with its level.
pub(super) fn highest_of_all(levels: &[Level]) -> Option<(&Level, &BranchRow)> {
    let row = highest(levels.iter().flat_map(Level::isolas))?;
    let level = levels.iter().find(|level| level.isolas().any(|isola| std::ptr::eq(isola, row)))?;
    Some((level, row))
}

impl Ordinary {
    /// At a level, by its forcing amplitude, and a frequency of the response, rad/s, of this model, its force on the harmonic of the order that
    /// `reader` tells of, whose `levels` these are. Of a further order, whose frequencies the main branch may not reach, the linear
    /// response stands for it there, unless something acts on the smallest motions.
    pub fn at(
        reader: &Reader,
        levels: &[Level],
        (model, settings): (&Model, &Settings),
        (level, omega): (f64, f64),
    ) -> Option<Self> {
        let force = model.forcing().harmonic as f64 * omega;
        let mains = match reader.order() {
            None => Mains::whole(reader, levels, level),
            // What cannot be read is said in the report of the first order.
            Some(_) => {
                let first = Reader::open(reader.dir()).ok()?;
                Mains::whole(&first, &Overview::read(&first, &mut Omissions::default()).ok()?.levels, level)
            }
        }?;
        let main = mains.response_at(force);
        let is_linear_known = || reader.order().is_some() && !acts_at_rest(model);
        let linear = || is_linear_known().then(|| linear_response(model, settings, level, omega)).flatten();
        let amplitude = main.or_else(linear)?;
        Some(Self { omega: force, amplitude, is_of_main: main.is_some() })
    }
}

/// The main branches of a level.
struct Mains {
    curves: Vec<Curve>,
    /// The harmonic of theirs that is forced.
    harmonic: f64,
}

impl Mains {
    /// Those of a level, if all of them are known to their ends: else there may be larger responses.
    fn whole(reader: &Reader, levels: &[Level], level: f64) -> Option<Self> {
        let level = levels.iter().find(|other| other.value == level)?;
        let ends = reader.main_outcomes().ok()?;
        let curve = |row| Curve::of(&verified_result(reader, row).ok()?, 0).ok()?;
        let curves = level.mains().map(curve).collect::<Option<_>>().filter(|_| level.has_whole_mains(&ends))?;
        Some(Self { curves, harmonic: reader.model().ok()?.forcing_harmonic as f64 })
    }

    /// Largest amplitude, m, where the force has a frequency, rad/s; `None` where they are not known.
    fn response_at(&self, force: f64) -> Option<f64> {
        let at = |main: &Curve| response_at(&main.omega.values, &main.amplitude.first()?.values, force / self.harmonic);
        self.curves.iter().filter_map(at).max_by(f64::total_cmp)
    }
}

/// Whether the response to the smallest forces is another one than that of the matrices.
fn acts_at_rest(model: &Model) -> bool {
    acting_at_rest(model).next().is_some() || pressed_at_rest(model).next().is_some()
}

/// Amplitude of the first monitored dof, m, in the linear response at a frequency of the response, rad/s.
fn linear_response(model: &Model, settings: &Settings, forcing: f64, omega: f64) -> Option<f64> {
    let tracked = settings.tracked(model);
    let (unknown, scales) = (Unknown::Frequency { forcing }, Scales::new(model, tracked));
    let problem = PressureForm::build(model, settings.harmonics, tracked, unknown, scales).ok()?;
    let response = forced_response(&problem, forcing, omega).ok()?;
    let monitor = *model.monitors().first()?;
    let motion = response.combine(model.modes().along(&[(monitor, 1.0)]));
    Some(complex(&motion, model.forcing().harmonic).norm())
}

/// The largest amplitude that a curve has at a frequency, rad/s, by those of its points.
fn response_at(omega: &[f64], amplitudes: &[f64], at: f64) -> Option<f64> {
    let between = |(ends, sizes): (&[f64], &[f64])| {
        let share = (at - ends[0]) / (ends[1] - ends[0]);
        (0.0..=1.0).contains(&share).then(|| sizes[0] + share * (sizes[1] - sizes[0]))
    };
    omega.windows(2).zip(amplitudes.windows(2)).filter_map(between).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;
    use crate::store::FILE;

    /// Of a main branch that goes on beyond where it is known it is not known what it has at a frequency.
    #[test]
    fn of_a_main_branch_known_in_part_nothing_is_told() {
        let (dir, study) = (tempfile::tempdir().unwrap(), Study::damper());
        let run = dir.path().join("run");
        drop(study.finished(&run));
        let at = || {
            let reader = Reader::open(&run).unwrap();
            {
                let settings = reader.header().unwrap().settings;
                let levels = Overview::read(&reader, &mut Omissions::default()).unwrap().levels;
                Ordinary::at(&reader, &levels, (&study.model, &settings), (0.006, 1.0))
            }
        };
        let ordinary = at().unwrap();
        assert!(
            ordinary.is_of_main && ordinary.omega == 1.0 && (0.3..0.4).contains(&ordinary.amplitude),
            "{ordinary:?}"
        );
        let db = rusqlite::Connection::open(run.join(FILE)).unwrap();
        db.execute("UPDATE branches SET peak_standing = 'at_least' WHERE kind = 'main'", []).unwrap();
        assert_eq!(at(), None);
    }

    #[test]
    fn of_several_responses_at_one_frequency_the_largest() {
        let (omega, amplitudes) = ([1.0, 2.0, 4.0, 3.0, 3.0, 5.0], [1.0, 3.0, 7.0, 2.0, 1.0, 1.5]);
        let response = |at| response_at(&omega, &amplitudes, at);
        assert_eq!([response(1.5), response(3.0), response(4.5)], [Some(2.0), Some(5.0), Some(1.375)]);
        assert_eq!([response(0.9), response(5.1)], [None; 2]);
    }
}
