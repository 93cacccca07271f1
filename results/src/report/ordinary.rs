//! What ordinary continuation has under the same force as an isola of motions of a further order.

use crate::curves::Curve;
use crate::overview::{BranchRow, Level, Omissions, Overview, highest, verified_result};
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
    /// At a level and a frequency of the response, rad/s, of this model, its force on the harmonic of the order that `reader` tells of. Of
    /// a further order, whose frequencies the main branch may not reach, the linear response stands for it there.
    pub fn at(reader: &Reader, model: &Model, settings: &Settings, level: f64, omega: f64) -> Option<Self> {
        let force = model.forcing().harmonic as f64 * omega;
        let main = main_response(reader, level, force);
        let linear = || reader.order().and_then(|_| linear_response(model, settings, level, omega));
        let amplitude = main.or_else(linear)?;
        Some(Self { omega: force, amplitude, is_of_main: main.is_some() })
    }
}

/// Largest amplitude, m, of the main branches at a level, where the force has a frequency, rad/s; `None` where they are not known. What cannot
/// be read is said in the report of the first order.
fn main_response(reader: &Reader, level: f64, omega: f64) -> Option<f64> {
    let first = Reader::open(reader.dir()).ok()?;
    let at = omega / first.model().ok()?.forcing_harmonic as f64;
    let overview = Overview::read(&first, &mut Omissions::default()).ok()?;
    let same = overview.levels.iter().find(|other| other.value == level)?;
    let curve = |row| Curve::of(&verified_result(&first, row).ok()?, 0).ok()?;
    let curves = same.mains().filter_map(curve);
    let responses = curves.filter_map(|main| response_at(&main.omega.values, &main.amplitude.first()?.values, at));
    responses.max_by(f64::total_cmp)
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

    #[test]
    fn of_several_responses_at_one_frequency_the_largest() {
        let (omega, amplitudes) = ([1.0, 2.0, 4.0, 3.0, 3.0, 5.0], [1.0, 3.0, 7.0, 2.0, 1.0, 1.5]);
        let response = |at| response_at(&omega, &amplitudes, at);
        assert_eq!([response(1.5), response(3.0), response(4.5)], [Some(2.0), Some(5.0), Some(1.375)]);
        assert_eq!([response(0.9), response(5.1)], [None; 2]);
    }
}
