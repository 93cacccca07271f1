//! Gaps that look as if they were given in millimetres.

use crate::study::Study;
use results::words::{digits, number};
use solver::structure::laws::Law;

/// Hardly a structure vibrates at this speed v, m/s: stresses are about ρ c v, 4 GPa in steel (c: speed of sound).
const FASTEST: f64 = 100.0;

/// Of gaps so wide that whatever reaches them at the lowest eigenfrequency is faster than structures can be: a question.
pub(super) fn in_millimetres(study: &Study) -> Option<String> {
    let model = &study.model;
    let (mode, omega) = model.modes().frequencies.iter().enumerate().find(|(j, _)| !model.modes().is_rigid(*j))?;
    let gaps = model.elements().iter().filter_map(|element| element.law.clearance()).filter(|gap| *gap > 0.0);
    let gap = gaps.reduce(f64::min)?;
    let speed = omega * gap;
    (speed > FASTEST).then(|| {
        format!(
            "to close a gap of {} m at the frequency of mode {} takes a speed of {} m/s, which hardly a structure bears: is the gap in mm? Units are m, \
             kg, N and s. In mm, t, N and s throughout all frequencies and forces are right, and what is told as m is mm",
            number(gap),
            mode + 1,
            digits(speed, 2)
        )
    })
}
