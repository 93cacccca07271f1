//! A motion marched from period to period until it is known what it is.

use super::{Motion, PeriodObserver, SettleSettings};
use crate::linalg::dot;
use crate::marching::{Marching, MarchingError};
use crate::response::branch::Branch;
use crate::response::task::BranchId;
use crate::stability::multipliers::Verdict;
use crate::stability::nearby::{apart, distance, images, orbits};
use crate::stability::shooting::{NewtonOptions, Orbit, Shooting};
use crate::structure::Model;

/// Relative size of the push that makes a motion leave its orbit.
const PUSH: f64 = 1e-3;
/// A motion repeats itself if all that is left of its way there is a smaller share of its size.
const SETTLED: f64 = 1e-4;
/// A motion of several periods differs from one to the next by so many times of what is left of its way, at least.
const APART: f64 = 100.0;
/// A motion that repeats itself to this share of its size will not leave any more.
const FOR_GOOD: f64 = 1e-9;
/// A motion that is within this share of its size of another one for good is that one.
const SAME: f64 = 0.01;
/// Periods in a row after which a motion counts as settled.
const STREAK: usize = 5;
/// Distance of the motion beside the one that is described, by which its growth is measured, in shares of its size.
const BESIDE: f64 = 1e-7;
/// A motion that does not repeat itself is quasi-periodic if small deviations grow or shrink by less than this per period, and by
/// less than half of what linear damping takes: what still rings on its way to something else loses that.
const NEUTRAL: f64 = 0.005;
/// It is chaotic if they grow by more; what lies between is not told.
const CHAOTIC: f64 = 0.03;
/// A motion has settled if the amplitude ranges of both halves of its record differ by no more than this share of their width.
const STATIONARY: f64 = 0.05;
/// A record is so long, in the time in which linear damping takes what rings on to 1/e of it, that it is told from what lasts.
const TOLD: f64 = 1.0;
/// Unless that were so many times the longest way to something periodic: then it is not told.
const LONGEST: usize = 2;
/// After so many periods each a motion is looked at for what draws it.
const PATIENCE: usize = 50;
/// It ends on a stable orbit if its way there since the last time is that of small deviations to this share.
const AS_TOLD: f64 = 0.05;
/// Newton iterations from where it has come to.
const ITERATIONS: usize = 12;

/// What a motion is seen to be.
pub(super) struct Found {
    pub motion: Option<Motion>,
    pub range: Range,
    pub growth: Option<f64>,
}

/// A motion from period to period.
pub(super) struct Course<'m> {
    model: &'m Model,
    omega: f64,
    marching: Marching<'m>,
    /// States at the begin of every period of the response.
    states: Vec<Vec<f64>>,
    /// What it started from.
    images: Vec<Vec<f64>>,
    /// Size of that.
    size: f64,
    orbit: Orbit,
}

impl<'m> Course<'m> {
    pub fn new(model: &'m Model, orbit: &Orbit) -> Result<Self, MarchingError> {
        let size = apart(model, orbit.omega, &orbit.state, &vec![0.0; orbit.state.len()]);
        let mut state = orbit.state.clone();
        let n = model.size();
        // In all modes, in displacement and velocity, and of no symmetry.
        for (j, value) in state[..2 * n].iter_mut().enumerate() {
            *value += PUSH * size * if j < n { 1.0 } else { orbit.omega } / (1.0 + j as f64);
        }
        let mut marching = orbit.marching(model)?;
        marching.restart(&state)?;
        let images = images(model, orbit)?;
        Ok(Self { model, omega: orbit.omega, marching, states: vec![state], images, size, orbit: orbit.clone() })
    }

    pub fn run(
        &mut self,
        settings: &SettleSettings,
        observer: &mut PeriodObserver<'_>,
    ) -> Result<Option<Found>, MarchingError> {
        let (mut streak, mut before) = (0, None);
        for number in 1..=settings.transient {
            if observer(self.omega, self.period()?[0]).is_break() {
                return Ok(None);
            }
            let repeats = self.repeats(settings.repeats);
            streak = if repeats.is_some() && repeats == before { streak + 1 } else { 0 };
            before = repeats;
            if let (Some(count), true) = (repeats, streak >= STREAK) {
                let mut range = Range::new(self.model);
                for _ in 0..count {
                    range.add(&self.period()?);
                }
                return Ok(Some(Found { motion: Some(Motion::Periodic(count)), range, growth: None }));
            }
            if number % PATIENCE == 0
                && let Some(amplitudes) = self.drawn_to()
            {
                let mut range = Range::new(self.model);
                range.add(&amplitudes);
                return Ok(Some(Found { motion: Some(Motion::Periodic(1)), range, growth: None }));
            }
        }
        self.describe(settings, observer)
    }

    /// The stable orbit of one period that draws the motion, with the largest |x| of each monitored dof: light damping takes its time.
    /// What is left of the way there is what the derivative of the map of a period makes of what was left before.
    fn drawn_to(&mut self) -> Option<Vec<f64>> {
        let orbit_of = |state: &[f64]| Orbit { state: state.to_vec(), ..self.orbit.clone() };
        let near = orbit_of(self.state());
        let mut shooting = Shooting::around(self.model, &near).ok()?;
        let start = shooting.point_at(&near);
        let (point, period) =
            shooting.solve(&start, &NewtonOptions { plane: None, searches: false, iterations: ITERATIONS })?;
        let verdict = Verdict::of(&period.multipliers().ok()?, shooting.margin(&point, &period));
        if verdict != Verdict::Stable {
            return None;
        }
        let from = |x: &[f64]| -> Vec<f64> { x.iter().zip(&point.x).map(|(x, at)| x - at).collect() };
        let before = shooting.point_at(&orbit_of(&self.states[self.periods() - PATIENCE]));
        let told = (0..PATIENCE).fold(from(&before.x), |left, _| period.monodromy.mul_vec(&left));
        let left = from(&start.x);
        let apart: Vec<f64> = told.iter().zip(&left).map(|(told, left)| told - left).collect();
        let size = |x: &[f64]| dot(x, x).sqrt();
        let is_drawn = size(&left) < size(&from(&before.x)) && size(&apart) < AS_TOLD * size(&left);
        is_drawn.then(|| {
            *self.states.last_mut().expect("there is the first one") = shooting.orbit(&point).state;
            period.amplitudes
        })
    }

    /// A motion that does not repeat itself.
    fn describe(
        &mut self,
        settings: &SettleSettings,
        observer: &mut PeriodObserver<'_>,
    ) -> Result<Option<Found>, MarchingError> {
        let mut beside = self.orbit.marching(self.model)?;
        let mut deviation = vec![0.0; self.states[0].len()];
        deviation[0] = BESIDE * self.size;
        let mut halves = [Range::new(self.model), Range::new(self.model)];
        let mut growth = 0.0;
        let loss = self.loss();
        let needed = (TOLD / loss).ceil();
        let longest = LONGEST * settings.transient.max(settings.record);
        let record = if needed <= longest as f64 { settings.record.max(needed as usize) } else { settings.record };
        for i in 0..record {
            let is_late = 2 * i >= record;
            let moved: Vec<f64> = self.state().iter().zip(&deviation).map(|(x, d)| x + d).collect();
            beside.restart(&moved)?;
            let amplitudes = self.period()?;
            beside.period()?;
            deviation = beside.state().iter().zip(self.state()).map(|(b, x)| b - x).collect();
            let left = apart(self.model, self.omega, &beside.state(), self.state()) / (BESIDE * self.size);
            deviation.iter_mut().for_each(|d| *d /= left.max(f64::MIN_POSITIVE));
            // A deviation takes its time to turn to where it grows most.
            growth += if is_late { left.ln() } else { 0.0 };
            halves[usize::from(is_late)].add(&amplitudes);
            if observer(self.omega, amplitudes[0]).is_break() {
                return Ok(None);
            }
        }
        let growth = growth / (record as f64 / 2.0);
        let [early, late] = halves;
        let lasts = || needed <= record as f64 && growth.abs() < NEUTRAL.min(0.5 * loss) && early.is_like(&late);
        let motion = match growth {
            growth if growth > CHAOTIC => Some(Motion::Chaotic),
            _ if lasts() && self.has_left() => Some(Motion::QuasiPeriodic),
            _ => None,
        };
        let growth = Some(growth).filter(|growth| growth.is_finite());
        Ok(Some(Found { motion, range: early.with(&late), growth }))
    }

    /// Share of its size that linear damping takes in a period from what rings in the mode that is damped least.
    fn loss(&self) -> f64 {
        // What does not deform the structure does not ring.
        let rings = |j: &usize| !self.model.modes().is_rigid(*j);
        let rates = (0..self.model.size()).filter(rings).map(|j| self.model.resonance(j).1);
        rates.fold(f64::INFINITY, f64::min).max(0.0) * std::f64::consts::TAU / self.omega
    }

    /// Periods that were marched.
    pub fn periods(&self) -> usize {
        self.states.len() - 1
    }

    /// Whether it is well away from where it started: what has just begun to leave says nothing of where it goes.
    fn has_left(&self) -> bool {
        distance(self.model, self.omega, self.state(), &self.images) > 10.0 * PUSH * self.size
    }

    fn state(&self) -> &[f64] {
        self.states.last().expect("there is the first one")
    }

    /// One period; the largest |x| of each monitored dof in it.
    fn period(&mut self) -> Result<Vec<f64>, MarchingError> {
        let summary = self.marching.period()?;
        self.states.push(self.marching.state());
        Ok(summary.max)
    }

    /// After how many periods the motion repeats itself, as far as can be seen now: what is left of its way, if it goes on to
    /// become shorter as it does, is next to nothing.
    fn repeats(&self, most: usize) -> Option<usize> {
        let last = self.states.len() - 1;
        let between = |i: usize, j: usize| apart(self.model, self.omega, &self.states[i], &self.states[j]);
        let size = apart(self.model, self.omega, self.state(), &vec![0.0; self.state().len()]).max(self.size);
        let left = |count: usize| {
            let (now, before) = (between(last, last - count), between(last - count, last - 2 * count));
            // Rounding goes on for ever.
            if now < FOR_GOOD * size {
                0.0
            } else if now < before {
                now / (1.0 - now / before)
            } else {
                f64::INFINITY
            }
        };
        let count = (1..=most.min(last / 2)).find(|&count| left(count) < SETTLED * size)?;
        // One that winds round an orbit on its way there comes back to where it was as well, though ever nearer to it.
        let mut parts = (1..count).filter(|part| count % part == 0);
        let winds = parts.any(|part| between(last, last - part) < APART * left(count));
        // As long as it is where it started it may not have left, unless it is there for good.
        // Next to a period doubling it alternates before it leaves.
        let is_there = distance(self.model, self.omega, self.state(), &self.images) < SAME * size;
        (!winds && (!is_there || left(count) == 0.0)).then_some(count)
    }

    /// The branch whose marched orbit a motion of one period is on, if it was met again.
    pub fn owner(&self, known: &[(BranchId, &Branch)]) -> Option<BranchId> {
        let size = apart(self.model, self.omega, self.state(), &vec![0.0; self.state().len()]);
        let off = |branch: &Branch| {
            let images = orbits(self.model, branch, self.omega).into_iter().filter_map(|(_, polished)| {
                let images = images(self.model, &polished.orbit).ok()?;
                Some(distance(self.model, self.omega, self.state(), &images))
            });
            images.fold(f64::INFINITY, f64::min)
        };
        let nearest = known.iter().map(|(id, branch)| (*id, off(branch))).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, off)| *off < SAME * size).map(|(id, _)| id)
    }
}

/// Smallest and largest of the largest |x| in a period, of each monitored dof.
pub(super) struct Range(pub Vec<[f64; 2]>);

impl Range {
    fn new(model: &Model) -> Self {
        Self(vec![[f64::INFINITY, 0.0]; model.monitors().len()])
    }

    fn add(&mut self, amplitudes: &[f64]) {
        let wider = |(range, x): (&mut [f64; 2], &f64)| *range = [range[0].min(*x), range[1].max(*x)];
        self.0.iter_mut().zip(amplitudes).for_each(wider);
    }

    fn with(mut self, other: &Self) -> Self {
        for bound in 0..2 {
            self.add(&other.0.iter().map(|range| range[bound]).collect::<Vec<_>>());
        }
        self
    }

    /// Whether both are the same to a small share of their width.
    fn is_like(&self, other: &Self) -> bool {
        let near = |(a, b): (&[f64; 2], &[f64; 2])| {
            let width = (a[1] - a[0]).max(b[1] - b[0]);
            a.iter().zip(b).all(|(x, y)| (x - y).abs() <= STATIONARY * width)
        };
        self.0.iter().zip(&other.0).all(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::state::State;
    use crate::laws::{LawKind, PolynomialSpring, Term};
    use crate::stability::polish::{Around, PolishSettings, polish};
    use std::ops::ControlFlow;

    /// A hardening spring well above its resonance, damped next to nothing, thrown off its small motion.
    #[test]
    fn what_rings_on_for_long_is_not_called_quasi_periodic() {
        let terms = vec![Term { power: 3, coefficient: 0.1 }];
        let law = LawKind::PolynomialSpring(PolynomialSpring { terms });
        for ratio in [3e-5, 2e-4, 1e-3] {
            let model = Model::builder("ringing")
                .mass([[1.0]])
                .stiffness([[1.0]])
                .damping_ratio(ratio)
                .force("x1", 1.0)
                .element("spring", law.clone(), ["x1"])
                .build()
                .unwrap();
            let mut modal = vec![0.0; 11];
            modal[1] = 0.5 / (1.0 - 2.3 * 2.3);
            let arguments = modal.clone();
            let state = State { harmonics: 5, omega: 2.3, decay: 0.0, forcing: 0.5, arguments, modal };
            let found = polish(&model, &PolishSettings::default(), &state, Around::default()).polished.unwrap();
            let mut thrown = found.orbit.clone();
            thrown.state[0] += 0.5;
            let mut course = Course::new(&model, &thrown).unwrap();
            let found = course.describe(&SettleSettings::default(), &mut |_, _| ControlFlow::Continue(()));
            let found = found.unwrap().unwrap();
            assert_eq!(found.motion, None, "{ratio}: {:?}", found.growth);
        }
    }
}
