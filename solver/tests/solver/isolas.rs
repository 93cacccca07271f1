//! Isolas that follow from a backbone alone, without any guess, and where they are born and merge: predicted by the energy
//! balance of the backbone and computed from the branches themselves, side by side.

use solver::files;
use solver::formulation::harmonics::evaluate;
use solver::formulation::state::State;
use solver::marching::{Marching, MarchingSettings};
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchPoint, SpecialKind};
use solver::response::forced::{Forced, SearchRange};
use solver::response::level::{BranchId, Level};
use solver::response::windows::{Event, EventKind, events};
use solver::settings::Settings;
use solver::structure::Model;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::path::Path;

fn load(name: &str) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name);
    files::load(&folder).unwrap_or_else(|error| panic!("{error}"))
}

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn with_harmonics(count: usize) -> Settings {
    let mut settings = Settings::default();
    settings.harmonics.count = count;
    settings
}

fn all(backbone: &Backbone, kind: EventKind) -> Vec<Event> {
    events(backbone).into_iter().filter(|event| event.kind == kind).collect()
}

/// A model with what is needed to compute its levels.
struct Study {
    model: Model,
    settings: Settings,
    backbone: Backbone,
}

impl Study {
    fn new(name: &str, settings: Settings) -> Self {
        let model = load(name);
        let backbone = Backbone::compute(&model, &settings).unwrap();
        Self { model, settings, backbone }
    }

    fn level(&self, amplitude: f64) -> Level {
        Level::compute(&self.model, &self.settings, &self.backbone, amplitude).unwrap()
    }

    /// The only isola of a level, closed and apart from the main branch.
    fn isola(&self, amplitude: f64) -> Branch {
        let level = self.level(amplitude);
        let accounts: Vec<_> = level.windows.iter().map(|w| w.seeds.clone()).collect();
        assert_eq!(level.isolas().count(), 1, "A = {amplitude}: {accounts:?}");
        assert!(
            level.windows.iter().any(|w| w.branches().contains(&BranchId::isola(0))),
            "A = {amplitude}: {accounts:?}"
        );
        let isola = level.isolas().next().unwrap().clone();
        assert!(isola.is_closed(), "A = {amplitude}: {:?}", isola.outcome);
        let mut forced = Forced::new(
            &self.model,
            &self.settings,
            SearchRange::new(&self.settings, &self.backbone).unwrap(),
            amplitude,
        );
        assert!(!forced.lies_on(&isola.peak().state, level.main()));
        isola
    }

    /// Amplitude at which the isola shrinks to a point. Its width in frequency, between its folds, goes like the square
    /// root of the distance from there: A is extrapolated to width² = 0 through `shares`, levels relative to `near`.
    fn birth(&self, near: f64, shares: &[f64]) -> f64 {
        let points: Vec<(f64, f64)> = shares
            .iter()
            .map(|share| {
                let amplitude = share * near;
                let (low, high) = fold_frequencies(&self.isola(amplitude));
                ((high - low).powi(2), amplitude)
            })
            .collect();
        let weight = |i: usize| {
            let others = (0..points.len()).filter(|&j| j != i);
            others.map(|j| points[j].0 / (points[j].0 - points[i].0)).product::<f64>()
        };
        (0..points.len()).map(|i| weight(i) * points[i].1).sum()
    }

    /// Largest amplitude, to `tolerance`, at which the isola is still apart, between `low` (it is) and `high` (it has
    /// merged: the main branch goes where it was).
    fn merge(&self, mut low: f64, mut high: f64, tolerance: f64) -> f64 {
        let reach = self.isola(low).peak().amplitude();
        assert!(self.level(low).main().peak().amplitude() < 0.9 * reach);
        let merged = self.level(high);
        assert!(merged.isolas().next().is_none() && merged.main().peak().amplitude() > 0.95 * reach, "A = {high}");
        while high - low > tolerance * low {
            let middle = 0.5 * (low + high);
            let level = self.level(middle);
            if level.isolas().next().is_none() {
                assert!(level.main().peak().amplitude() > 0.95 * reach, "A = {middle}: neither an isola nor merged");
                high = middle;
            } else {
                assert!(level.main().peak().amplitude() < 0.95 * reach, "A = {middle}: the main branch twice");
                low = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Lowest and highest frequency, at the two folds of a simple isola.
fn fold_frequencies(isola: &Branch) -> (f64, f64) {
    let mut folds: Vec<f64> = isola.special(SpecialKind::Fold).map(BranchPoint::omega).collect();
    folds.sort_by(f64::total_cmp);
    assert_eq!(folds.len(), 2, "{folds:?}");
    (folds[0], folds[1])
}

fn report(what: &str, predicted: f64, computed: f64) {
    println!("{what}: predicted {predicted:.8}, computed {computed:.8}, {:+.1e}", computed / predicted - 1.0);
}

/// Converged states of a closed branch at a frequency, the largest first.
fn states_at(study: &Study, branch: &Branch, omega: f64) -> Vec<State> {
    let mut forced = Forced::new(
        &study.model,
        &study.settings,
        SearchRange::new(&study.settings, &study.backbone).unwrap(),
        branch.forcing,
    );
    let count = branch.points.len();
    let pairs = (0..count).map(|i| (&branch.points[i], &branch.points[(i + 1) % count]));
    let crossing = pairs.filter(|(a, b)| (a.omega() - omega) * (b.omega() - omega) < 0.0);
    let mut states: Vec<State> = crossing
        .map(|(a, b)| {
            let share = (omega - a.omega()) / (b.omega() - a.omega());
            forced.converge(&State { omega, ..a.state.interpolate(&b.state, share) }).unwrap()
        })
        .collect();
    let size = |state: &State| -> f64 { state.modal.iter().map(|q| q * q).sum() };
    states.sort_by(|a, b| size(b).total_cmp(&size(a)));
    states
}

/// Displacements and velocities of all dofs at t = 0.
fn start(model: &Model, state: &State) -> (Vec<f64>, Vec<f64>) {
    let dofs = 0..model.size();
    let values = dofs.map(|i| evaluate(&state.displacement(model, i), 0.0));
    values.map(|[x, slope, _]| (x, state.omega * slope)).unzip()
}

/// Largest |x| of the first monitored dof of a state.
fn amplitude_of(model: &Model, state: &State) -> f64 {
    let series = state.displacement(model, model.monitors()[0]);
    let count = 20_000;
    (0..count).map(|i| evaluate(&series, TAU * f64::from(i) / f64::from(count))[0].abs()).fold(0.0, f64::max)
}

/// Largest |x| of the first monitored dof, period by period, when a state is left to time marching.
fn march(model: &Model, state: &State, settings: &MarchingSettings, periods: usize) -> Vec<f64> {
    let mut marching = Marching::new(model, settings, state.forcing, state.omega).unwrap();
    let (x, v) = start(model, state);
    marching.set_state(&x, &v).unwrap();
    (0..periods).map(|_| marching.period().unwrap().max[0]).collect()
}

/// Largest relative distance of the amplitudes of the periods from the one expected.
fn worst(amplitudes: &[f64], expected: f64) -> f64 {
    amplitudes.iter().map(|a| (a / expected - 1.0).abs()).fold(0.0, f64::max)
}

// --------------------------------------------------------------------------------------------------- nonlinear damping

#[test]
fn a_nonlinear_damper() {
    // With one harmonic exactly: birth at A = 0.0048 with amplitude 2, merge at 0.0114 with amplitude 1, both at ω = 1 (see
    // the model). The damping is weak, and more harmonics hardly change anything.
    for count in [1, 10] {
        let study = Study::new("nonlinear_damper", with_harmonics(count));
        let (birth, merge) = (all(&study.backbone, EventKind::Birth)[0], all(&study.backbone, EventKind::Merge)[0]);
        assert!((birth.threshold / 0.0048 - 1.0).abs() < 1e-5 && (merge.threshold / 0.0114 - 1.0).abs() < 1e-5);
        assert!((birth.amplitude / 2.0 - 1.0).abs() < 1e-3 && (merge.amplitude - 1.0).abs() < 1e-3);
        assert!((birth.omega - 1.0).abs() < 1e-4 && (merge.omega - 1.0).abs() < 1e-4);
        let born = study.birth(birth.threshold, &[1.01, 1.02, 1.03, 1.04]);
        report(&format!("nonlinear damper, H = {count}: birth"), birth.threshold, born);
        let merged = study.merge(0.0112, 0.01157, 1e-5);
        report(&format!("nonlinear damper, H = {count}: merge"), merge.threshold, merged);
        // What extrapolation and bisection can tell.
        assert!((born / birth.threshold - 1.0).abs() < 2e-5 && (merged / merge.threshold - 1.0).abs() < 2e-5);
    }
}

// ------------------------------------------------------------------------------------------------- vibration absorber

/// The detached phase-resonance backbones of the absorber: through the resonances of the main branch at A = 0.2, where the
/// isola has merged with it.
fn absorber() -> Vec<Study> {
    let mut settings = Settings::default();
    (settings.frequency.min, settings.frequency.max) = (Some(0.5), Some(12.0));
    (settings.backbone.max_frequency, settings.backbone.max_amplitude) = (Some(12.0), Some(6.0));
    settings.branch.max_amplitude = Some(20.0);
    let study = Study::new("nltva", settings);
    let level = study.level(0.2);
    let main = level.main();
    let resonances = Forced::new(&study.model, &settings, SearchRange::new(&settings, &study.backbone).unwrap(), 0.2)
        .resonances(main);
    let through = resonances.iter().map(|near| Backbone::through(&study.model, &settings, near, &mut quiet).unwrap());
    through.map(|backbone| Study { model: study.model.clone(), settings, backbone }).collect()
}

#[test]
fn the_detached_resonance_curve_of_a_nonlinear_absorber() {
    // Detroux, Habib, Masset & Kerschen, Mech. Syst. Signal Process. 60–61, 2015, find an isola ("detached resonance
    // curve") by tracking bifurcations. Here it follows from the level at which it has merged.
    let studies = absorber();
    // The resonances of the two peaks come first; the other two lie on one detached backbone.
    let births: Vec<Event> = studies[1..].iter().map(|study| all(&study.backbone, EventKind::Birth)[0]).collect();
    assert_eq!(births.len(), 2);
    for birth in &births {
        assert!((birth.threshold / 0.124859 - 1.0).abs() < 1e-5 && (birth.omega / 1.80722 - 1.0).abs() < 1e-5);
    }
    let study = &studies[1];
    assert!(study.backbone.points.iter().all(|p| p.point.amplitude() > 0.5), "it is connected to a linear mode");

    let isola = study.isola(0.15);
    let (low, high) = fold_frequencies(&isola);
    println!("absorber, A = 0.15: {low:.5} to {high:.5} rad/s, peak {:.5}", isola.peak().amplitude());
    assert!((low - 1.58330).abs() < 1e-4 && (high - 2.30378).abs() < 1e-4);
    assert!((isola.peak().amplitude() - 2.40795).abs() < 1e-4);

    let computed = study.birth(births[0].threshold, &[1.001, 1.002, 1.003]);
    report("absorber: birth", births[0].threshold, computed);
    // The least forcing in quadrature is an upper bound of the least forcing at any phase. The two differ by 0.16 %, with
    // this strongly damped absorber; the extrapolation is good to 1e-6.
    let relative = computed / births[0].threshold - 1.0;
    assert!((relative + 1.6e-3).abs() < 1e-4, "{relative}");
    // It merges with a part of the main branch that is nowhere near quadrature: the detached backbone has no maximum.
    assert!(all(&study.backbone, EventKind::Merge).is_empty());
    let merged = study.merge(0.18, 0.19, 1e-4);
    println!("absorber: merge not predicted, computed {merged:.6}");
    assert!((merged / 0.18562 - 1.0).abs() < 2e-4, "{merged}");

    // Time marching stays on the upper part; from the lower part, unstable, it goes there as well.
    for omega in [1.8, 2.0, 2.2] {
        let states = states_at(study, &isola, omega);
        assert_eq!(states.len(), 2);
        let [upper, lower] = [&states[0], &states[1]].map(|state| {
            (amplitude_of(&study.model, state), march(&study.model, state, &MarchingSettings::default(), 200))
        });
        println!("absorber, {omega} rad/s: {:.5}, marched within {:.1e}", upper.0, worst(&upper.1, upper.0));
        assert!(worst(&upper.1, upper.0) < 1e-4 && worst(&lower.1[..5], lower.0) < 1e-3);
        assert!(worst(&lower.1[199..], upper.0) < 5e-3 && lower.0 < 0.995 * upper.0, "{}", lower.1[199]);
    }
}

// ------------------------------------------------------------------------------------------- subharmonic with impacts

/// The mass of models/impact_subharmonic, x″ + 0.01 x′ + x = A cos 3ωt before a rigid stop at 1, with elastic impacts:
/// orbits of one impact a period, from closed forms.
struct Impacts {
    omega: f64,
    /// Displacement of the free part and velocity of the steady part at the impact, per impact velocity.
    y: f64,
    z: f64,
    /// Amplitude of the steady part per unit of forcing.
    steady: f64,
}

impl Impacts {
    const RATIO: f64 = 0.005;

    fn new(omega: f64) -> Self {
        let period = TAU / omega;
        let ((e11, e21), (e12, e22)) = (Self::free(period, 1.0, 0.0), Self::free(period, 0.0, 1.0));
        // Between impacts x = h + p, p the steady response to the forcing, equal at both ends. At the impacts x = 1 and
        // x′ = ±u: with y = 1 − p and z = p′ there, h goes from (y, −u − z) to (y, u − z), that is
        // (1 − e11) y + e12 z = −e12 u and −e21 y + (e22 − 1) z = −(1 + e22) u.
        let determinant = (1.0 - e11) * (e22 - 1.0) + e12 * e21;
        let y = (-e12 * (e22 - 1.0) + e12 * (1.0 + e22)) / determinant;
        let z = (-(1.0 - e11) * (1.0 + e22) - e21 * e12) / determinant;
        let forcing = 3.0 * omega;
        let steady = 1.0 / (1.0 - forcing * forcing).hypot(2.0 * Self::RATIO * forcing);
        Self { omega, y, z, steady }
    }

    /// Free motion from (x, v) after a time t.
    fn free(t: f64, x: f64, v: f64) -> (f64, f64) {
        let damped = (1.0 - Self::RATIO * Self::RATIO).sqrt();
        let (sine, cosine) = (damped * t).sin_cos();
        let decay = (-Self::RATIO * t).exp();
        let displacement = x * cosine + (v + Self::RATIO * x) / damped * sine;
        (decay * displacement, decay * (v * cosine - (x + Self::RATIO * v) / damped * sine))
    }

    /// Coefficients in u of the condition that p has its amplitude, (1 − y)² + (z/3ω)² − (A steady)² = 0.
    fn quadratic(&self, amplitude: f64) -> (f64, f64, f64) {
        let slope = self.z / (3.0 * self.omega);
        (self.y * self.y + slope * slope, -2.0 * self.y, 1.0 - (amplitude * self.steady).powi(2))
    }

    /// Least forcing for which there is an orbit.
    fn least(&self) -> f64 {
        let (a, b, _) = self.quadratic(0.0);
        (1.0 - b * b / (4.0 * a)).sqrt() / self.steady
    }

    /// Excursions max |x| of the two orbits, the larger first.
    fn excursions(&self, amplitude: f64) -> [f64; 2] {
        let (a, b, c) = self.quadratic(amplitude);
        [1.0, -1.0].map(|sign| {
            let u = (-b + sign * (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
            let (y, z) = (self.y * u, self.z * u);
            let orbit = |i: i32| {
                let t = TAU / self.omega * f64::from(i) / 20_000.0;
                let phase = 3.0 * self.omega * t;
                Self::free(t, y, -u - z).0 + (1.0 - y) * phase.cos() + z / (3.0 * self.omega) * phase.sin()
            };
            assert!(u > 0.0 && (0..=20_000).all(|i| orbit(i) < 1.0 + 1e-12), "it impacts once a period, from below");
            (0..=20_000).map(|i| orbit(i).abs()).fold(0.0, f64::max)
        })
    }
}

#[test]
fn the_subharmonic_of_an_impact_oscillator() {
    let counts = [10, 20, 40, 80];
    let frequencies = [1.3, 1.5];
    let mut excursions = Vec::new();
    let mut births = Vec::new();
    for count in counts {
        let study = Study::new("impact_subharmonic", with_harmonics(count));
        let isola = study.isola(1.0);
        let sizes = frequencies.map(|omega| {
            let states = states_at(&study, &isola, omega);
            assert_eq!(states.len(), 2);
            [&states[0], &states[1]].map(|state| amplitude_of(&study.model, state))
        });
        excursions.push(sizes);
        let birth = all(&study.backbone, EventKind::Birth)[0];
        let computed = study.birth(birth.threshold, &[1.01, 1.02, 1.03, 1.04]);
        report(&format!("impacts, H = {count}: birth"), birth.threshold, computed);
        assert!((computed / birth.threshold - 1.0).abs() < 1e-4);
        births.push(birth.threshold);
    }
    // Truncated impacts converge at first order (see closed_forms.rs): doubling H nearly halves the error, and what is
    // extrapolated from the last two is good to a few tenths of a percent.
    let converges = |what: &str, values: &[f64], exact: f64| {
        let errors: Vec<f64> = values.iter().map(|value| value / exact - 1.0).collect();
        let extrapolated = 2.0 * errors[3] - errors[2];
        println!("impacts, {what} {exact:.5}: {errors:.4?}, extrapolated {extrapolated:.4}");
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(pair[1] > 0.0 && order > 0.8 && order < 1.4, "{what}: {errors:?}");
        }
        assert!(errors[3] < 0.05 && extrapolated.abs() < 5e-3, "{what}: {errors:?} {extrapolated}");
    };
    for (i, omega) in frequencies.into_iter().enumerate() {
        let exact = Impacts::new(omega).excursions(1.0);
        for (j, exact) in exact.into_iter().enumerate() {
            let values: Vec<f64> = excursions.iter().map(|sizes| sizes[i][j]).collect();
            converges(&format!("excursion at {omega} rad/s"), &values, exact);
        }
    }
    let least = (0..90_000).map(|i| Impacts::new(1.05 + 1e-5 * f64::from(i)).least()).fold(f64::INFINITY, f64::min);
    converges("birth", &births, least);
}

// ------------------------------------------------------------------------------------------------------ beam and stop

#[test]
fn a_cantilever_before_a_stop_has_an_isola_of_ten_harmonics() {
    let study = Study::new("cantilever_stop", Settings::default());
    let level = study.level(0.1);
    let isola = study.isola(0.1);
    let (low, high) = fold_frequencies(&isola);
    println!("cantilever: {low:.4} to {high:.4} rad/s, peak {:.4e} m", isola.peak().amplitude());
    assert!((low - 68.5895).abs() < 1e-3 && (high - 74.6535).abs() < 1e-3);
    // It goes on where the main branch falls back to the linear range.
    let touching = level.main().points.iter().filter(|p| p.contact()[0] > 0.0);
    let end = touching.map(BranchPoint::omega).fold(0.0, f64::max);
    println!("cantilever: contact on the main branch up to {end:.4} rad/s");
    assert!((end - 68.998).abs() < 1e-2 && level.main().frequency_range().1 > high);
    let birth = all(&study.backbone, EventKind::Birth).into_iter().find(|e| e.omega > low && e.omega < high).unwrap();
    let computed = study.birth(birth.threshold, &[1.01, 1.02, 1.03, 1.04]);
    report("cantilever: birth", birth.threshold, computed);
    // 0.4 % below.
    assert!((computed / birth.threshold - 1.0).abs() < 5e-3);
    // It belongs to ten harmonics and the default ε: with 20 the branches here are others, none of them closed, and time
    // marching leaves it for the linear response. The contact of time marching is inelastic for the mass of the tip, but a
    // stiff elastic spring in place of the stop leaves it too.
    for share in [0.3, 0.7, 0.9] {
        let upper = &states_at(&study, &isola, low + share * (high - low))[0];
        let expected = amplitude_of(&study.model, upper);
        let marched = march(&study.model, upper, &MarchingSettings::default(), 200);
        println!("cantilever, {:.3} rad/s: {expected:.3e} m, marched {:.3e}", upper.omega, marched[199]);
        assert!(marched[199] < 0.1 * expected, "time marching stays on the isola after all: say so here");
    }
}
