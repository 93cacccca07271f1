//! The certificate of a branch: what the harmonics that were left out would change (penetration, pressure beyond H, the peak and the ends of
//! the range with twice the harmonics), where it touches, and how its tips slide.

use crate::curve::identity::Identity;
use crate::curve::least_norm::converge;
use crate::curve::outcome::{Outcome, Stop};
use crate::formulation::Formulation;
use crate::formulation::harmonics::{Transform, width};
use crate::formulation::modal::Modal;
use crate::formulation::scales::Scales;
use crate::formulation::unknown::Unknown;
use crate::response::branch::{Branch, BranchPoint, Observer};
use crate::response::certificate::{Certificate, Doubled};
use crate::response::climb::{Top, climb, maximum_near};
use crate::response::elsewhere::largest_change;
use crate::response::raised::raised;
use crate::response::sliding::slowest_sliding;
use crate::response::touching::contact_range;
use crate::settings::{HarmonicSettings, Settings};
use crate::structure::Model;
use crate::structure::laws::Law;

/// A peak that is higher than a branch point by no more than this share is one with it.
const BRANCHING: f64 = 1e-3;

/// The certificate of a branch. The observer is told of every step; breaking leaves out what is missing.
pub(super) fn certificate<'m, F: Formulation<'m>>(
    model: &'m Model,
    settings: &Settings,
    branch: &Branch,
    observer: &mut Observer<'_>,
) -> Certificate {
    let (penetration, pressure_beyond) = of_contacts(model, settings.harmonics, branch);
    let slowest_sliding = slowest_sliding(model, settings.harmonics, &branch.points);
    let build = |truncation| {
        let unknown = Unknown::Frequency { forcing: branch.forcing };
        let tracked = settings.tracked(model);
        F::build(model, truncation, tracked, unknown, Scales::new(model, tracked)).ok()
    };
    let mut own = build(settings.harmonics);
    let contact_omega =
        own.as_mut().and_then(|own| contact_range(own, settings.continuation, &branch.points, branch.is_closed()));
    let none = Certificate { penetration, pressure_beyond, contact_omega, slowest_sliding, ..Certificate::default() };
    let Some(mut problem) = build(settings.harmonics.doubled()) else { return none };
    let elsewhere = largest_change(&mut problem, settings.continuation, &branch.points, observer);
    let mut is_own = |found: &BranchPoint| own.as_mut().is_none_or(|own| leads_back(own, settings, branch, found));
    Certificate { doubled: doubled(&mut problem, model, settings, branch, &mut is_own, observer), elsewhere, ..none }
}

/// Largest penetration of a rigid contact over its gap, and share of the pressure (rms, over all contacts and points) beyond H;
/// nothing without such contacts, or where none is ever pressed.
fn of_contacts(model: &Model, truncation: HarmonicSettings, branch: &Branch) -> (Option<f64>, Option<f64>) {
    let modal = Modal::new(model);
    let contacts: Vec<(usize, f64)> =
        model.numbered().filter_map(|(channel, element)| Some((channel, element.law.rigid()?.gap))).collect();
    if contacts.is_empty() {
        return (None, None);
    }
    let mut pressure = Pressure::new(truncation);
    let mut penetration: Option<f64> = None;
    let (mut all, mut left_out) = (0.0, 0.0);
    for state in branch.points.iter().map(|point| &point.state) {
        for &(channel, gap) in &contacts {
            let nc = width(state.harmonics);
            let Some([whole, rest]) = pressure.energies(&state.arguments[channel * nc..(channel + 1) * nc]) else {
                continue;
            };
            (all, left_out) = (all + whole, left_out + rest);
            if gap > 0.0 {
                let series = state.combine(modal.shape(channel).iter().copied());
                let depth = pressure.largest(&series) / gap - 1.0;
                penetration = Some(penetration.unwrap_or(0.0).max(depth));
            }
        }
    }
    (penetration, (all > 0.0).then(|| (left_out / all).max(0.0).sqrt()))
}

/// Contact pressures over a period.
struct Pressure {
    transform: Transform,
    samples: Vec<f64>,
    unused: Vec<f64>,
}

impl Pressure {
    fn new(truncation: HarmonicSettings) -> Self {
        let samples = vec![0.0; truncation.samples];
        Self { transform: Transform::new(truncation.count, truncation.samples), unused: samples.clone(), samples }
    }

    /// Mean square of λ = max(0, p), and of its part beyond H; nothing if it is not pressed.
    fn energies(&mut self, predicted: &[f64]) -> Option<[f64; 2]> {
        self.transform.synthesise(predicted, None, &mut self.samples, &mut self.unused);
        self.samples.iter_mut().for_each(|p| *p = p.max(0.0));
        let whole = self.samples.iter().map(|p| p * p).sum::<f64>() / self.samples.len() as f64;
        if whole == 0.0 {
            return None;
        }
        let mut coefficients = [(); 2].map(|()| vec![Default::default(); self.transform.harmonics() + 1]);
        let [ours, others] = &mut coefficients;
        self.unused.fill(0.0);
        self.transform.analyse(&self.samples, &self.unused, ours, others);
        let kept: f64 =
            ours.iter().enumerate().map(|(k, c)| if k == 0 { c.norm_sqr() } else { 2.0 * c.norm_sqr() }).sum();
        Some([whole, whole - kept])
    }

    /// Largest value over the samples of a period.
    fn largest(&mut self, series: &[f64]) -> f64 {
        self.transform.synthesise(series, None, &mut self.samples, &mut self.unused);
        self.samples.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Steps of least norm from a motion without its higher harmonics to one of the branch.
const STEPS: usize = 20;

/// Whether a motion that was found with more harmonics leads back to the branch without them. One that leads to another curve belongs to that;
/// of one that leads nowhere nothing is known.
fn leads_back<'m, F: Formulation<'m>>(own: &mut F, settings: &Settings, branch: &Branch, found: &BranchPoint) -> bool {
    let newton = &settings.continuation.newton;
    let mut y = own.encode(&found.state.with_harmonics(own.system().harmonics));
    if converge(own, &mut y, STEPS, newton).is_err() {
        return true;
    }
    let points: Vec<Vec<f64>> = branch.points.iter().map(|point| own.encode(&point.state)).collect();
    let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    Identity::default().position(own, newton, &points, branch.is_closed(), &y).is_some()
}

/// The peak converged again with 2 H harmonics, if it is a maximum of the branch and its like is found there; of a closed curve the
/// ends of its range as well. `is_own` tells whether what is found belongs to the branch.
fn doubled<'m, F: Formulation<'m>>(
    problem: &mut F,
    model: &'m Model,
    settings: &Settings,
    branch: &Branch,
    is_own: &mut dyn FnMut(&BranchPoint) -> bool,
    observer: &mut Observer<'_>,
) -> Option<Doubled> {
    if is_highest_where_it_branches_off(branch) || branch.end_at_peak().is_some() {
        return None;
    }
    let points = &branch.points;
    let mut maximum = |measure: &dyn Fn(&BranchPoint) -> f64| {
        let index = (0..points.len()).max_by(|&a, &b| measure(&points[a]).total_cmp(&measure(&points[b])))?;
        let top = Top { points, is_closed: branch.is_closed(), index };
        let [before, after] = top.beside()?.map(|i| &points[i].state);
        let mut is_broken = false;
        let mut watched = |point: &BranchPoint| {
            let flow = observer(point);
            is_broken = flow.is_break();
            flow
        };
        let found = maximum_near(problem, settings.continuation, top, &[], measure, &mut watched);
        let found = found.filter(|found| is_broken || is_own(found));
        if found.is_some() || is_broken {
            return found;
        }
        let ends = raised::<F>(model, settings, settings.harmonics.doubled(), [before, after])?;
        let ends = ends.map(|state| problem.encode(&state));
        climb(problem, settings.continuation, ends, measure, observer).filter(|found| is_own(found))
    };
    let peak = maximum(&|point| point.amplitude())?;
    let mut end = |sign: f64| maximum(&|point| sign * point.omega()).map(|point| point.omega());
    let range = if branch.is_closed() { end(-1.0).zip(end(1.0)) } else { None };
    Some(Doubled { amplitude: peak.amplitude(), shift: peak.omega() / branch.peak().omega() - 1.0, range })
}

/// Whether a branch is as high as anywhere at a branch point where it ends: what it branches off may go on to larger amplitudes there,
/// and uphill from its peak is up that.
fn is_highest_where_it_branches_off(branch: &Branch) -> bool {
    let Outcome::Open(first, last) = branch.outcome else { return false };
    let ends = [(first, branch.points.first()), (last, branch.points.last())];
    let peak = branch.peak().amplitude();
    let is_high = |point: &BranchPoint| point.amplitude() > (1.0 - BRANCHING) * peak;
    ends.into_iter().any(|(stop, end)| stop == Stop::Branching && end.is_some_and(is_high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_beyond_the_truncation() {
        // max(0, cos τ): mean square 1/4; mean 1/π, first harmonic 1/2, second 2/(3π).
        let mut pressure = Pressure::new(HarmonicSettings { count: 2, samples: 4096, ..HarmonicSettings::default() });
        let [whole, beyond] = pressure.energies(&[0.0, 1.0, 0.0, 0.0, 0.0]).unwrap();
        let pi = std::f64::consts::PI;
        let expected = 0.25 - 1.0 / (pi * pi) - 0.125 - 2.0 / (9.0 * pi * pi);
        assert!((whole - 0.25).abs() < 1e-6 && (beyond - expected).abs() < 1e-6, "{whole}, {beyond}");
        assert!(pressure.energies(&[-2.0, 1.0, 0.0, 0.0, 0.0]).is_none());
        assert!((pressure.largest(&[0.5, 0.0, 2.0, 0.0, 0.0]) - 2.5).abs() < 1e-4);
    }
}
