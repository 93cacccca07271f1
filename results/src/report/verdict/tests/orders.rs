//! Motions of several periods of the force.

use super::*;
use crate::report::ordinary::Ordinary;

/// How much larger they are than what ordinary continuation has under the same force.
#[test]
fn beside_the_main_branch_under_the_same_force() {
    let levels = [level(1.0, vec![isola(2e-3)])];
    let missed = |ordinary: Option<Ordinary>| {
        let [_, _, missed] = told(&levels, |evidence| (evidence.is_further, evidence.ordinary) = (true, ordinary));
        missed
    };
    let all = "All of it: ordinary continuation follows motions of a shorter period.";
    assert_eq!(missed(None), all);
    for (amplitude, is_of_main, compared) in [
        (1e-4, true, "20 times the 0.1 mm of the main branch"),
        (1.6e-3, true, "25 % more than the 1.6 mm of the main branch"),
        (4e-3, false, "50 % less than the 4 mm of the linear response"),
    ] {
        let said = missed(Some(Ordinary { omega: 260.0, amplitude, is_of_main }));
        let where_it_is = "an isola goes up to 2 mm at 130 rad/s (20.69 Hz)";
        let force = "where the force has the same frequency, 260 rad/s (41.38 Hz).";
        assert_eq!(said, format!("{all} At A = 1 {where_it_is}, {compared} {force}"));
    }
}
