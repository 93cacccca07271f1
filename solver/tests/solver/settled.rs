//! Starts that are marched before Newton's method: what attracts nearly every motion is found.

use crate::support::fold_curves::quiet;
use crate::support::study::with_harmonics;
use solver::laws::PenaltySpring;
use solver::response::starts::StartPlace;
use solver::response::task::{Task, TaskResult};
use solver::response::trace::{Given, execute};
use solver::{Forced, Model, SearchRange, State};

/// Relative error of ranges with 24 harmonics, eight in a period of the force.
const CLOSE: f64 = 3e-3;

/// A mass between two elastic stops, which it strikes several times in three periods of the force. By a shooting method that shares nothing
/// with this program (Runge–Kutta, with the instants of contact located) there are isolas of order 3 from 0.24179 to 0.28534 and from
/// 0.27448 to 0.32880 rad/s; at 0.278243 rad/s all of 200 random motions settle on the one (127) or the other (73). Of 3000 random series
/// none leads to either by Newton's method alone.
#[test]
fn isolas_that_attract_nearly_every_motion() {
    let stop = |gap: f64| PenaltySpring { stiffness: 18.93, gap };
    let model = Model::builder("between stops")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_matrix([[0.0172]])
        .force("x1", 1.0)
        .harmonic(3)
        .element("right", stop(1.0), ["x1"])
        .element("left", stop(1.055), [[("x1", -1.0)]])
        .build()
        .unwrap();
    let mut settings = with_harmonics(24);
    (settings.frequency.min, settings.frequency.max) = (Some(0.26), Some(0.34));
    let reach = SearchRange { frequency: (0.26, 0.34), amplitude: 2.0, natural: None, forcing: None };
    let mut forced = Forced::new(&model, &settings, reach, 0.5756);
    let own = |state: &&State| {
        let size = |k: usize| state.modal[2 * k - 1].hypot(state.modal[2 * k]);
        (1..=state.harmonics).filter(|k| k % 3 != 0).any(|k| size(k) > 1e-3 * size(3))
    };
    let ends = [(0.274_48, 0.328_80), (0.26, 0.285_34)];
    let mut found = [false; 2];
    for batch in (0..96).step_by(4) {
        let task = Task::Start(StartPlace::random(batch));
        let landed = execute(&mut forced, &task, &Given::default(), &mut quiet);
        let Some(TaskResult::Landings(landings)) = landed else { continue };
        for state in landings.iter().map(|landing| &landing.state).filter(own) {
            let Ok(branch) = forced.branch_through(state, &mut quiet) else { continue };
            let (low, high) = branch.frequency_range();
            let is = |(from, to): (f64, f64)| (low / from - 1.0).abs() < CLOSE && (high / to - 1.0).abs() < CLOSE;
            ends.into_iter().zip(&mut found).for_each(|(ends, found)| *found |= is(ends));
        }
        if found == [true; 2] {
            return;
        }
    }
    panic!("{found:?}");
}
