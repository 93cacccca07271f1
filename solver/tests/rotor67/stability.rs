//! Polished points against figures of an independent program: marched folds, and where responses are stable.

use crate::common::{BACKWARD, FRICTIONLESS, found_from_window};
use solver::stability::polish::{Around, PolishSettings, polish};

#[test]
fn look() {
    for (scenario, amplitude, omega) in [(&FRICTIONLESS, 60, 2623.0), (&BACKWARD, 20, 2474.0)] {
        let level = scenario.level(amplitude);
        let isola = level.branch(found_from_window(level, omega)).unwrap();
        let count = isola.points.len();
        println!("{count} points, {:?}", isola.frequency_range());
        for i in (0..count).step_by(count / 16) {
            let state = &isola.points[i].state;
            let (before, after) = (&isola.points[(i + count - 1) % count].state, &isola.points[(i + 1) % count].state);
            let time = std::time::Instant::now();
            let around = Around { way: Some([before, after]), neighbour: None };
            let result = polish(scenario.model(), &PolishSettings::default(), state, around);
            let time = time.elapsed();
            let size = isola.points[i].amplitude();
            print!(
                "{i} {:.2} {size:.3e} {time:?} {:?} {:?} {:?}",
                state.omega, result.verdict, result.reason, result.periods
            );
            if let Some(p) = result.polished {
                let mu: Vec<_> = p.multipliers[..3]
                    .iter()
                    .map(|m| format!("{:.4}{:+.4}i |{:.4}|", m.re, m.im, m.modulus()))
                    .collect();
                print!(" {:.2} {:.4e} d {:.4} imp {:.4} {mu:?}", p.orbit.omega, p.amplitudes[0], p.distance, p.impacts);
            }
            println!();
        }
    }
}
