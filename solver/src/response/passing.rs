//! Known branches that pass by what was predicted, where no seed has landed near it.
//!
//! Steps of least norm, and steps in the forcing, may end far from a seed beside which a known branch passes: what was predicted is
//! there nonetheless, or it is a branch nearby that nothing has landed on. A branch is measured against a seed as a landing is.

use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchPoint};
use crate::response::forced::Forced;
use crate::response::name::BranchId;
use crate::response::seeds::{Landing, Seed};
use crate::response::windows::Window;

/// The known branch that passes nearest to one of the seeds of a well, among those of which a response lies no farther from it than
/// a landing on what was predicted may, at frequencies about those of the well; and its relative distance.
pub(super) fn passing<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seeds: &[Seed],
    well: &Window,
    known: &[(BranchId, &Branch)],
) -> Option<(BranchId, f64)> {
    let mut best: Option<(BranchId, f64)> = None;
    for (id, branch) in known {
        for seed in seeds {
            let Some(landing) = nearest(forced, &seed.state, well, branch).filter(Landing::is_near) else { continue };
            if best.is_none_or(|(_, distance)| landing.distance < distance) {
                best = Some((*id, landing.distance));
            }
        }
    }
    best
}

/// The response of a branch nearest to a seed, at frequencies about those of its well: one of its points, or one between two of them
/// that is nearer and converges. `None` if none is at such frequencies.
fn nearest<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seed: &State,
    well: &Window,
    branch: &Branch,
) -> Option<Landing> {
    let about = well.about();
    let measured = |forced: &Forced<'m, F>, state: &State| Landing {
        distance: forced.motion_distance(state, seed, well.mode),
        state: state.clone(),
    };
    let inside = branch.points.iter().filter(|point| about.contains(&point.omega()));
    let landings = inside.map(|point| measured(forced, &point.state));
    let nearest = landings.min_by(|a, b| a.distance.total_cmp(&b.distance));
    if nearest.as_ref().is_some_and(Landing::is_near) {
        return nearest;
    }
    let next = branch.points.iter().skip(1).chain(branch.points.first().filter(|_| branch.is_closed()));
    let reaches = |(a, b): &(&BranchPoint, &BranchPoint)| {
        a.omega().min(b.omega()) <= *about.end() && a.omega().max(b.omega()) >= *about.start()
    };
    let chords = branch.points.iter().zip(next).filter(reaches);
    let chords = chords.map(|(a, b)| (forced.nearest_on_chord(&a.state, &b.state, seed, well.mode), a, b));
    let ((share, _), a, b) = chords.min_by(|(a, ..), (b, ..)| a.1.total_cmp(&b.1))?;
    let between = forced.response_between(&a.state, &b.state, share).filter(|state| about.contains(&state.omega));
    let between = between.map(|state| measured(forced, &state));
    nearest.into_iter().chain(between).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;
    use crate::formulation::pressure::PressureForm;
    use crate::response::backbone::Backbone;
    use crate::response::branch::Side;
    use crate::response::forced::SearchRange;
    use crate::response::seeds::Phase;
    use crate::settings::Settings;
    use std::ops::ControlFlow;
    use std::path::Path;

    /// The motion of a point so many times as large, and shifted in time.
    fn seed(point: &BranchPoint, factor: f64) -> Seed {
        let mut state = point.state.shifted(1.0);
        state.modal.iter_mut().chain(&mut state.arguments).for_each(|entry| *entry *= factor);
        Seed { state, place: 0.0, phase: Phase::First }
    }

    /// Seeds beside the main branch of a stiffening oscillator: relative distances of motions that differ by a factor f are 1 − 1/f.
    #[test]
    fn a_branch_within_the_limit_of_a_seed_passes_by_it_and_no_other() {
        let model = files::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/duffing")).unwrap();
        let settings = Settings::default();
        let reach = SearchRange::new(&settings, &Backbone::compute(&model, &settings).unwrap()).unwrap();
        let forcing = 0.2;
        let mut forced: Forced<'_, PressureForm<'_>> = Forced::build(&model, &settings, reach, forcing).unwrap();
        let main = forced.main_branch(Side::Below, &mut |_| ControlFlow::Continue(())).unwrap();
        let peak = main.peak().clone();
        let window = |omega| Window { mode: 0, first: 0, last: 1, best: 0, threshold: 0.1, omega: (omega, omega) };
        let mut passed = |seed: Seed, omega: f64, branch: &Branch| {
            passing(&mut forced, &[seed], &window(omega), &[(BranchId::MAIN, branch)])
        };
        let within = |found: Option<(BranchId, f64)>, expected: f64| {
            found.is_some_and(|(id, distance)| id.is_main() && (distance - expected).abs() < 0.01)
        };
        let omega = peak.omega();
        assert!(within(passed(seed(&peak, 1.4), omega, &main), 1.0 - 1.0 / 1.4));
        assert_eq!(passed(seed(&peak, 1.5), omega, &main), None, "a third away");
        assert_eq!(passed(seed(&peak, 1.4), 1.1 * omega, &main), None, "at other frequencies");
        // Between two points, each of which is too far away.
        let of = |share: f64| {
            let rising = main.points[..main.peak_index()].iter();
            rising
                .min_by_key(|point| ((point.amplitude() / peak.amplitude() - share).abs() * 1e9) as u64)
                .unwrap()
                .clone()
        };
        let points = [0.35, 0.8].map(of).to_vec();
        let middle = of(0.55);
        let sparse = Branch { special: Vec::new(), points, ..main.clone() };
        let from = |point: &BranchPoint| (point.amplitude() / middle.amplitude() - 1.0).abs();
        assert!(sparse.points.iter().all(|point| from(point) > 0.32));
        assert!(passed(seed(&middle, 1.0), middle.omega(), &sparse).is_some());
        // There is no such motion between them.
        let mut elsewhere = seed(&middle, 1.0);
        elsewhere.state.modal[5] += 0.5 * middle.amplitude();
        assert_eq!(passed(elsewhere, middle.omega(), &sparse), None);
    }
}
