//! Polished points against figures of an independent program: marched folds, and where responses are stable.

use crate::common::{BACKWARD, FRICTIONLESS, found_from_window};
use solver::stability::along::{AlongSettings, along};
use std::ops::ControlFlow;

#[test]
fn look() {
    for (scenario, amplitude, omega) in [(&FRICTIONLESS, 60, 2623.0), (&FRICTIONLESS, 60, 0.0), (&BACKWARD, 20, 2474.0)]
    {
        let level = scenario.level(amplitude);
        let isola = if omega > 0.0 { level.branch(found_from_window(level, omega)).unwrap() } else { level.main() };
        let count = isola.points.len();
        println!("{count} points, {:?}", isola.frequency_range());
        let time = std::time::Instant::now();
        let result = along(scenario.model(), &AlongSettings::default(), isola, &mut |point| {
            let i = point.index;
            let result = &point.polish;
            let size = isola.points[i].amplitude();
            let state = &isola.points[i].state;
            print!("{i} {:.2} {size:.3e} {:?} {:?} {:?}", state.omega, result.verdict, result.reason, result.periods);
            if let Some(p) = &result.polished {
                let mu: Vec<_> = p.multipliers[..3]
                    .iter()
                    .map(|m| format!("{:.4}{:+.4}i |{:.4}|", m.re, m.im, m.modulus()))
                    .collect();
                print!(" {:.2} {:.4e} d {:.4} imp {:.4} {mu:?}", p.orbit.omega, p.amplitudes[0], p.distance, p.impacts);
            }
            println!();
            ControlFlow::Continue(())
        });
        println!("{:?}", time.elapsed());
        for b in result.bifurcations {
            println!(
                "{} {:.3} {:.5e} after {} {:?} {:?}",
                b.kind, b.omega, b.amplitudes[0], b.after, b.outside, b.multiplier
            );
        }
    }
}
