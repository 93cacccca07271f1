//! States with more harmonics, a harmonic at a time: pressures of rigid contact have all of them, and what a few more change is more than
//! Newton's method gets over at once.

use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::{norm, weighted};
use crate::formulation::Formulation;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::settings::{HarmonicSettings, Settings};
use crate::structure::Model;

/// Newton steps for one more harmonic, shortened where they do not help.
const STEPS: usize = 60;

/// Two neighbouring forced responses with the harmonics of `truncation`, each in the plane across the line between the two.
pub(super) fn raised<'m, F: Formulation<'m>>(
    model: &'m Model,
    settings: &Settings,
    truncation: HarmonicSettings,
    ends: [&State; 2],
) -> Option<[State; 2]> {
    let (tracked, unknown) = (settings.tracked(model), Unknown::Frequency { forcing: ends[0].forcing });
    let newton = NewtonSettings { damped: true, max_iterations: STEPS, ..settings.continuation.newton };
    let mut raised = ends.map(State::clone);
    for count in raised[0].harmonics + 1..=truncation.count {
        let truncation = HarmonicSettings { count, ..truncation };
        let mut problem = F::build(model, truncation, tracked, unknown, Scales::new(model, tracked)).ok()?;
        raised = across(&mut problem, &raised, &newton)?;
    }
    Some(raised)
}

/// The two with the harmonics of the problem.
fn across<'m, F: Formulation<'m>>(problem: &mut F, ends: &[State; 2], newton: &NewtonSettings) -> Option<[State; 2]> {
    let harmonics = problem.system().harmonics;
    let [mut before, mut after] = ends.each_ref().map(|state| problem.encode(&state.with_harmonics(harmonics)));
    let way: Vec<f64> = after.iter().zip(&before).map(|(after, before)| after - before).collect();
    let length = norm(problem.metric(), &way);
    let row: Vec<f64> = weighted(problem.metric(), &way).into_iter().map(|weight| weight / length).collect();
    for y in [&mut before, &mut after] {
        let origin = y.clone();
        Newton::default().solve(problem, y, Constraint::Hyperplane { row: &row, origin: &origin }, newton).ok()?;
    }
    Some([problem.decode(&before).ok()?, problem.decode(&after).ok()?])
}
