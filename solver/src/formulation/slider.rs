//! When a slider behind a spring sticks and when it slides, over a period of its motion.
//!
//! A trigonometric polynomial rises and falls monotonically between its extrema. On each such way the slider sticks until
//! the spring's force reaches the limit, if it does, and slides from there to the extremum, where it comes to rest.

use crate::formulation::crossings::{crossings, root};
use crate::formulation::harmonics::evaluate;
use crate::structure::laws::Slider;
use std::f64::consts::TAU;

/// Instants per number of a series at which its range is looked at: enough for a thousandth of it.
const SAMPLES: usize = 16;

/// A response turns where a slider begins to slide, and may turn back next to it: a step leads over that place only if the ranges of the
/// motion at both of its ends are within this share of the one at which sliding begins.
const STEP: f64 = 0.01;

/// Range of a motion over that at which the slider begins to slide, less one: negative while it sticks.
pub fn excess(slider: Slider, series: &[f64]) -> f64 {
    let count = SAMPLES * series.len();
    let values = (0..count).map(|i| evaluate(series, TAU * i as f64 / count as f64)[0]);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    (high - low) * slider.stiffness / (2.0 * slider.limit) - 1.0
}

/// Whether a slider begins or ceases to slide between two motions (m) that are too far apart for it.
pub fn passes_over_beginning(slider: Slider, motions: [&[f64]; 2]) -> bool {
    let [from, to] = motions.map(|series| excess(slider, series));
    from * to < 0.0 && from.abs().max(to.abs()) > STEP
}

/// A part of the period during which a slider does one thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Instant at which it begins, as a phase, rad.
    pub begin: f64,
    /// Instant at which it ends, at most 2π later.
    pub end: f64,
    /// What it does.
    pub does: Does,
}

/// What a slider does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Does {
    /// Sticks where the spring has no force, m, since it came to rest at the extremum at this phase; none if it never slid.
    Stick {
        /// Displacement without force.
        at: f64,
        /// Phase of the extremum.
        since: Option<f64>,
    },
    /// Slides with this force, N.
    Slide(f64),
}

/// An extremum of the displacement.
#[derive(Debug, Clone, Copy)]
struct Extremum {
    tau: f64,
    value: f64,
}

/// What a slider does over a period of the displacement `series` once every period is like the one before, from the `slopes` of
/// the series on a uniform grid (`slope`: their own series). It has no force at rest, and slides no further than it is made to.
pub fn phases(slider: Slider, series: &[f64], slope: &[f64], slopes: &[f64]) -> Vec<Phase> {
    let reach = slider.limit / slider.stiffness;
    let mut extrema: Vec<Extremum> = crossings(slope, 0.0, slopes)
        .iter()
        .map(|crossing| Extremum { tau: crossing.tau, value: evaluate(series, crossing.tau)[0] })
        .collect();
    if extrema.is_empty() {
        extrema.push(Extremum { tau: 0.0, value: series[0] });
    }
    let mut by_value = extrema.clone();
    by_value.sort_by(|a, b| a.value.total_cmp(&b.value));
    let (lowest, highest) = (by_value[0], by_value[by_value.len() - 1]);
    if highest.value - lowest.value <= 2.0 * reach {
        let (at, since) = if highest.value > reach {
            (highest.value - reach, Some(highest.tau))
        } else if lowest.value < -reach {
            (lowest.value + reach, Some(lowest.tau))
        } else {
            (0.0, None)
        };
        return vec![Phase { begin: 0.0, end: TAU, does: Does::Stick { at, since } }];
    }
    // From the highest point on, where it comes to rest whatever was before.
    let first = extrema.iter().position(|extremum| extremum.tau == highest.tau).unwrap_or(0);
    extrema.rotate_left(first);
    extrema.iter_mut().filter(|extremum| extremum.tau < highest.tau).for_each(|extremum| extremum.tau += TAU);
    extrema.push(Extremum { tau: highest.tau + TAU, ..highest });
    slide_through(slider, series, &extrema)
}

/// Phases from a first extremum, at which the slider comes to rest from sliding up, to the last one.
fn slide_through(slider: Slider, series: &[f64], extrema: &[Extremum]) -> Vec<Phase> {
    let reach = slider.limit / slider.stiffness;
    let mut found = Vec::new();
    let (mut rest, mut at) = (extrema[0], extrema[0].value - reach);
    for way in extrema.windows(2) {
        let (from, to) = (way[0], way[1]);
        let side = (to.value - from.value).signum();
        if side * (to.value - at) <= reach {
            continue;
        }
        let limit = at + side * reach;
        let beyond = |tau: f64| {
            let [value, slope, _] = evaluate(series, tau);
            // The first guess is a far one, maybe at an inflection: NaN lets no step be the last one before its time.
            (value - limit, slope, f64::NAN)
        };
        let starts = root(&beyond, (from.tau, to.tau), 0.5 * (from.tau + to.tau), side < 0.0);
        found.push(Phase { begin: rest.tau, end: starts, does: Does::Stick { at, since: Some(rest.tau) } });
        found.push(Phase { begin: starts, end: to.tau, does: Does::Slide(side * slider.limit) });
        (rest, at) = (to, to.value - side * reach);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::harmonics::{Transform, differentiate};

    const SLIDER: Slider = Slider { stiffness: 100.0, limit: 1.0 };

    fn of(series: &[f64]) -> Vec<Phase> {
        let mut slope = vec![0.0; series.len()];
        differentiate(series, &mut slope);
        let (mut slopes, mut unused) = (vec![0.0; 64], vec![0.0; 64]);
        Transform::new(series.len() / 2, 64).synthesise(&slope, None, &mut slopes, &mut unused);
        phases(SLIDER, series, &slope, &slopes)
    }

    #[test]
    fn a_step_over_the_beginning_of_sliding_is_short() {
        let slider = Slider { stiffness: 2.0, limit: 1.0 };
        // It begins at a range of one, whatever the mean and wherever in the period.
        let passes = |ranges: [f64; 2]| {
            let motions = ranges.map(|range| [7.0, 0.3 * range, 0.4 * range, 0.0, 0.0]);
            passes_over_beginning(slider, [&motions[0], &motions[1]])
        };
        for (from, to, expected) in
            [(0.95, 1.05, true), (0.995, 1.02, true), (0.995, 1.005, false), (0.5, 0.9, false), (1.1, 2.0, false)]
        {
            assert_eq!(passes([from, to]), expected, "{from} to {to}");
            assert_eq!(passes([to, from]), expected, "{to} to {from}");
        }
    }

    #[test]
    fn of_a_sine_the_slider_sticks_twice_and_slides_twice() {
        // From the maximum 0.05 down it slides below 0.03, from the minimum up above −0.03.
        let (top, bottom, sticks) = (0.25 * TAU, 0.75 * TAU, 0.6f64.acos());
        let expected = [
            (top, top + sticks, Does::Stick { at: 0.04, since: Some(top) }),
            (top + sticks, bottom, Does::Slide(-1.0)),
            (bottom, bottom + sticks, Does::Stick { at: -0.04, since: Some(bottom) }),
            (bottom + sticks, top + TAU, Does::Slide(1.0)),
        ];
        let found = of(&[0.0, 0.0, 0.05]);
        assert_eq!(found.len(), 4, "{found:?}");
        for (phase, (begin, end, does)) in found.iter().zip(expected) {
            assert!((phase.begin - begin).abs() + (phase.end - end).abs() < 1e-12, "{phase:?}");
            match (phase.does, does) {
                (Does::Stick { at, .. }, Does::Stick { at: expected, .. }) => assert!((at - expected).abs() < 1e-14),
                (found, expected) => assert_eq!(found, expected),
            }
        }
    }

    #[test]
    fn a_small_motion_never_slides_and_one_far_out_shakes_down() {
        let stick = |at, since| vec![Phase { begin: 0.0, end: TAU, does: Does::Stick { at, since } }];
        assert_eq!(of(&[0.0, 0.009, 0.0]), stick(0.0, None));
        assert_eq!(of(&[0.0, 0.0, 0.0]), stick(0.0, None));
        let [out] = of(&[0.03, 0.0, 0.005])[..] else { panic!("slides") };
        let Does::Stick { at, since: Some(since) } = out.does else { panic!("never slid") };
        assert!((at - 0.025).abs() < 1e-15 && (since - 0.25 * TAU).abs() < 1e-12, "{out:?}");
    }

    /// Against the law stepped over a fine grid, for motions with partial loops inside the large one.
    #[test]
    fn forces_are_those_of_the_law_stepped_finely() {
        use crate::structure::laws::{Before, Instant, Jenkins, Law};
        let law = Jenkins { stiffness: SLIDER.stiffness, limit: SLIDER.limit };
        let mut next = crate::formulation::pressure::tests::random(11);
        for case in 0..200 {
            let series: Vec<f64> = (0..9).map(|_| 0.012 * next()).collect();
            let found = of(&series);
            let steps = 40_000;
            let mut before = Before::default();
            for n in 0..2 * steps {
                let tau = TAU * f64::from(n) / f64::from(steps);
                let u = evaluate(&series, tau)[0];
                let force = law.respond(&Instant { u: [u, 0.0, 0.0], ..Instant::default() }, &before).force[0];
                before = Before { u, force };
                if n < steps || n % 97 != 0 {
                    continue;
                }
                let inside = |phase: &&Phase| {
                    let since = (tau - phase.begin).rem_euclid(TAU);
                    since <= phase.end - phase.begin
                };
                let phase = found.iter().find(inside).expect("phases cover the period");
                let exact = match phase.does {
                    Does::Stick { at, .. } => SLIDER.stiffness * (u - at),
                    Does::Slide(force) => force,
                };
                assert!((exact - force).abs() < 1e-4, "{case}: {exact} against {force} at {tau}: {found:?}");
            }
        }
    }
}
