//! The pressure form against the displacement form: they share the laws and the sampling, but neither the unknowns nor
//! the linear algebra (receptance of the modes there, condensed physical matrices here).

use solver::curve::continuation::{Continuation, ContinuationSettings, CurvePoint};
use solver::curve::newton::{Constraint, Newton, NewtonSettings};
use solver::curve::problem::Problem;
use solver::files;
use solver::formulation::Formulation;
use solver::formulation::displacement::DisplacementForm;
use solver::formulation::harmonics::{Transform, max_abs};
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::state::State;
use solver::formulation::unknown::Unknown;
use solver::linalg::{Matrix, dot};
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchPoint, Side};
use solver::response::forced::{Forced, SearchRange};
use solver::response::level::Level;
use solver::settings::{HarmonicSettings, Settings};
use solver::structure::laws::LawKind;
use solver::structure::{Damping, Model, ModelData};
use std::ops::ControlFlow;
use std::path::Path;

fn load(name: &str, overrides: &[(&str, &str)]) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name);
    files::load_with(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn settings(count: usize, samples: usize) -> Settings {
    Settings { harmonics: HarmonicSettings { count, samples, ..Default::default() }, ..Settings::default() }
}

/// Couples all modes: a tenth of the geometric mean of their own damping.
fn with_full_damping(model: Model) -> Model {
    let mut data = ModelData::from(model);
    if let Damping::Modal(c) = &data.damping {
        let coupled =
            |i: usize, j: usize| if i == j { c[i] } else { 0.1 * (c[i] * c[j]).sqrt() / (1 + i.abs_diff(j)) as f64 };
        data.damping = Damping::Full(Matrix::from_fn(c.len(), c.len(), coupled));
    }
    Model::try_from(data).unwrap()
}

/// Up to `count` states, evenly spread.
fn spread(states: Vec<State>, count: usize) -> Vec<State> {
    let step = states.len().div_ceil(count).max(1);
    states.into_iter().step_by(step).collect()
}

/// States of the points where a contact, if there is one, touches for part of the period.
fn touching<'p>(points: impl Iterator<Item = &'p BranchPoint>) -> Vec<State> {
    let touches = |point: &&BranchPoint| point.contact().is_empty() || point.contact().iter().any(|&share| share > 0.0);
    points.filter(touches).map(|point| point.state.clone()).collect()
}

/// Points of the backbone, and of the main branch at amplitude A, by the pressure form.
fn pressure_states(model: &Model, settings: &Settings, amplitude: f64) -> (Vec<State>, Vec<State>) {
    let mut silent = |_: &_| ControlFlow::Continue(());
    let backbone = Backbone::compute(model, settings).unwrap();
    let free = touching(backbone.points.iter().map(|point| &point.point));
    let mut forced = Forced::new(model, settings, SearchRange::new(settings, &backbone).unwrap(), amplitude);
    let branch = forced.main_branch(Side::Below, &mut silent).unwrap();
    (free, touching(branch.points.iter()))
}

struct Forms<'m> {
    displacement: DisplacementForm<'m>,
    pressure: PressureForm<'m>,
    /// Scaled residual of the pressure form that stands for a force as large as the forcing.
    forcing: f64,
}

impl<'m> Forms<'m> {
    fn new(model: &'m Model, settings: &Settings, unknown: Unknown) -> Self {
        let amplitude = if let Unknown::Frequency { forcing } = unknown { forcing } else { 0.0 };
        let (truncation, tracked) = (settings.harmonics, settings.tracked(model));
        let scales = Scales::new(model, tracked);
        let stiffness = model.elements().iter().map(|element| match &element.law {
            LawKind::Contact(contact) => contact.epsilon,
            _ => 0.0,
        });
        let unit = stiffness.fold(0.0, f64::max) * scales.length;
        let norm = amplitude * dot(&model.forcing().shape, &model.forcing().shape).sqrt();
        let displacement = DisplacementForm::new(model, truncation, tracked, unknown, scales).unwrap();
        let pressure = PressureForm::new(model, truncation, tracked, unknown, scales);
        Self { displacement, pressure, forcing: if unit > 0.0 && norm > 0.0 { norm / unit } else { 1.0 } }
    }

    /// Converges in the displacement form from a state whose harmonics are off by 1e-5 of themselves, at its own frequency
    /// (forced) or at its own first component (backbone); returns the residual of the result in the pressure form.
    fn back(&mut self, state: &State, unknown: Unknown) -> f64 {
        let mut y = self.displacement.encode(state);
        let length = y.len();
        let parameters = unknown.parameters().len();
        let mut row = vec![0.0; length];
        if unknown.is_autonomous() {
            let (mut largest, mut value) = (0, 0.0);
            for (i, v) in y[..length - parameters].iter().enumerate() {
                if v.abs() > value {
                    (largest, value) = (i, v.abs());
                }
            }
            row[largest] = 1.0;
        } else {
            row[length - 1] = 1.0;
        }
        let origin = y.clone();
        for (i, v) in y[..length - parameters].iter_mut().enumerate() {
            *v *= 1.0 + if i % 2 == 0 { 1e-5 } else { -1e-5 };
        }
        let settings = NewtonSettings { tolerance: 1e-11, max_iterations: 30, damped: false };
        let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
        // Resonance amplifies what is left of the forces: a second call takes one step more, down to rounding.
        for _ in 0..2 {
            Newton::default().solve(&mut self.displacement, &mut y, constraint, &settings).unwrap();
        }
        let state = self.displacement.decode(&y).unwrap();
        let mut y = self.pressure.encode(&state);
        self.pressure.linearise(&mut y) / self.forcing
    }
}

/// Checks both ways and prints the worst residuals, relative to the forcing.
fn check(name: &str, model: &Model, settings: &Settings, amplitude: f64, count: usize) {
    let (free, forced) = pressure_states(model, settings, amplitude);
    for (what, unknown, states) in [
        ("backbone", Unknown::Mode { damped: true }, free),
        ("main branch", Unknown::Frequency { forcing: amplitude }, forced),
    ] {
        assert!(states.len() > 10, "{name}: only {} points on the {what}", states.len());
        let mut forms = Forms::new(model, settings, unknown);
        let (mut there, mut back) = (0.0f64, 0.0f64);
        let total = states.len();
        for state in spread(states, count) {
            there = there.max(forms.displacement.residual_of(&state).unwrap());
            back = back.max(forms.back(&state, unknown));
        }
        println!("{name}, {what} ({total} points): pressure to displacement form {there:.1e}, back {back:.1e}");
        assert!(there < 1e-8 && back < 1e-8, "{name}, {what}: {there:e} there, {back:e} back");
    }
}

/// Points of a walk from `start` upwards in frequency until well beyond the first resonance, with their amplitudes.
fn walk_over_peak<P: Problem>(
    problem: &mut P,
    start: Vec<f64>,
    settings: &ContinuationSettings,
    measure: impl Fn(&mut P, &[f64]) -> f64,
) -> Vec<(f64, CurvePoint)> {
    let mut upwards = vec![0.0; start.len()];
    upwards[start.len() - 1] = 1.0;
    let mut walk = Continuation::start(problem, start, &upwards, *settings).unwrap();
    let first = walk.current().clone();
    let mut points = vec![(measure(walk.problem(), &first.y), first)];
    let mut top = 0.0f64;
    while points[points.len() - 1].0 >= 0.8 * top {
        let point = walk.next().unwrap_or_else(|| panic!("the walk ends on its way: {:?}", walk.stalled()));
        points.push((measure(walk.problem(), &point.y), point));
        top = top.max(points[points.len() - 1].0);
    }
    points
}

fn amplitude(model: &Model, state: &State) -> f64 {
    let series = state.displacement(model, model.monitors()[0]);
    max_abs(&series, &mut Transform::new(state.harmonics, 256))
}

/// Amplitude at the highest point of a smooth curve, from three points by a parabola in the arc.
fn parabolic_peak(points: &[(f64, CurvePoint)]) -> f64 {
    let top = (1..points.len() - 1).max_by(|&a, &b| points[a].0.total_cmp(&points[b].0)).unwrap();
    let [(left, _), (here, point), (right, next)] = &points[top - 1..=top + 1] else { unreachable!() };
    let (before, after) = (point.step, next.step);
    let (rise, fall) = ((here - left) / before, (right - here) / after);
    let curvature = (fall - rise) / (before + after);
    let slope = rise + curvature * before;
    here - slope * slope / (4.0 * curvature)
}

#[test]
fn both_forms_find_the_same_peak() {
    let mut settings = settings(5, 64);
    settings.continuation.max_step = 2e-3;
    for name in ["duffing", "nltva"] {
        let model = load(name, &[]);
        let Forms { mut displacement, mut pressure, .. } =
            Forms::new(&model, &settings, Unknown::Frequency { forcing: 0.1 });
        let start = forced_response(&pressure, 0.1, 0.7).unwrap();
        let (from, also_from) = (pressure.encode(&start), displacement.encode(&start));
        let steps = &settings.continuation;
        let one = walk_over_peak(&mut pressure, from, steps, |form, y| amplitude(&model, &form.decode(y).unwrap()));
        let other =
            walk_over_peak(&mut displacement, also_from, steps, |form, y| amplitude(&model, &form.decode(y).unwrap()));
        let (one, other) = (parabolic_peak(&one), parabolic_peak(&other));
        println!("{name}: peaks {one} m and {other} m, {:.1e} apart", one / other - 1.0);
        assert!((one / other - 1.0).abs() < 1e-6, "{name}: peaks {one} and {other}");
    }
}

/// With contact, sampling leaves several maxima a few 1e-6 apart on the top of a resonance, and each walk may step over
/// some of them: here every point of one form's walk is converged in the other at its own frequency.
#[test]
fn the_displacement_form_walks_the_curve_of_the_pressure_form() {
    let model = load("rotor67", &[]);
    let settings = settings(3, 256);
    let Forms { mut displacement, mut pressure, .. } =
        Forms::new(&model, &settings, Unknown::Frequency { forcing: 8.0 });
    let start = forced_response(&pressure, 8.0, 2320.0).unwrap();
    let from = displacement.encode(&start);
    let points = walk_over_peak(&mut displacement, from, &settings.continuation, |form, y| {
        amplitude(&model, &form.decode(y).unwrap())
    });
    let mut worst = 0.0f64;
    let mut newton = Newton::default();
    let mut row = vec![0.0; pressure.len()];
    row[pressure.len() - 1] = 1.0;
    let mut touching = 0;
    for (value, point) in points.iter().step_by(2) {
        let mut y = pressure.encode(&displacement.decode(&point.y).unwrap());
        let origin = y.clone();
        let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
        newton.solve(&mut pressure, &mut y, constraint, &settings.continuation.newton).unwrap();
        touching += usize::from(pressure.active().contains(&true));
        worst = worst.max((amplitude(&model, &pressure.decode(&y).unwrap()) / value - 1.0).abs());
    }
    println!("rotor 67: {} points walked, {touching} compared with contact, at most {worst:.1e} apart", points.len());
    assert!(touching > 20, "only {touching} points with contact");
    assert!(worst < 1e-6, "the walk leaves the curve by {worst:e}");
}

/// Largest distance between states of a curve in displacement form and what they converge to in pressure form: forced
/// responses at their own frequency.
fn farthest(pressure: &mut Forced<'_>, branch: &Branch, count: usize) -> f64 {
    let states = spread(branch.points.iter().map(|point| point.state.clone()).collect(), count);
    states.iter().fold(0.0, |worst, state| {
        let converged = pressure.converge(state).unwrap();
        worst.max(pressure.distance(state, &converged))
    })
}

#[test]
fn both_forms_trace_the_isola_of_rotor67() {
    let (model, settings) = (load("rotor67", &[("contact.friction", "0")]), Settings::default());
    let mut silent = |_: &_| ControlFlow::Continue(());
    let backbone = Backbone::compute(&model, &settings).unwrap();
    let level = Level::compute(&model, &settings, &backbone, 60.0).unwrap();
    let reach = SearchRange::new(&settings, &backbone).unwrap();
    let one = level.isolas().next().unwrap();
    let mut displacement = Forced::<DisplacementForm<'_>>::build(&model, &settings, reach, 60.0).unwrap();
    let other = displacement.branch_through(&one.points[0].state, &mut silent).unwrap();
    assert!(one.is_closed() && other.is_closed(), "{} and {}", one.outcome, other.outcome);
    let mut pressure = Forced::new(&model, &settings, reach, 60.0);
    let worst = farthest(&mut pressure, &other, 60);
    let peaks = one.peak().amplitude() / other.peak().amplitude() - 1.0;
    let ((low, high), (other_low, other_high)) = (one.frequency_range(), other.frequency_range());
    let ends = (low / other_low - 1.0).abs().max((high / other_high - 1.0).abs());
    println!(
        "rotor 67: {} points and {}, {worst:.1e} apart, peaks {peaks:.1e}, ends {ends:.1e}",
        one.points.len(),
        other.points.len()
    );
    assert!(worst < 1e-8 && peaks.abs() < 1e-8 && ends < 1e-8, "{worst:e}, peaks {peaks:e}, ends {ends:e}");
}

#[test]
fn both_forms_trace_the_backbone_of_duffing() {
    let (model, settings) = (load("duffing", &[]), Settings::default());
    let mut silent = |_: &_| ControlFlow::Continue(());
    let one = Backbone::compute(&model, &settings).unwrap();
    let other = Backbone::compute_in::<DisplacementForm<'_>>(&model, &settings, &mut silent).unwrap();
    assert_eq!(one.outcome, other.outcome);
    let scales = Scales::new(&model, 0);
    let mut pressure = PressureForm::new(&model, settings.harmonics, 0, Unknown::Mode { damped: true }, scales);
    let mut worst = 0.0f64;
    for point in &other.points {
        let state = &point.point.state;
        let mut y = pressure.encode(state);
        let origin = y.clone();
        // The size of the motion is held: b_1 of the mode followed.
        let mut row = vec![0.0; y.len()];
        row[state.arguments.len() + 2] = 1.0;
        let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
        Newton::default().solve(&mut pressure, &mut y, constraint, &settings.continuation.newton).unwrap();
        let apart = y.iter().zip(&origin).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        worst = worst.max(apart / origin.iter().fold(0.0f64, |m, y| m.max(y.abs())));
    }
    println!("duffing: {} points and {}, {worst:.1e} apart", one.points.len(), other.points.len());
    assert!(other.points.len() > 50 && worst < 1e-8, "{worst:e} apart");
}

#[test]
fn contact_between_two_bodies() {
    let settings = Settings {
        backbone: solver::settings::BackboneSettings { modes: solver::ModeChoice::one(2), ..Default::default() },
        ..settings(20, 256)
    };
    let model = load("two_masses_stop", &[]);
    check("two bodies", &model, &settings, 0.005, 30);
    check("two bodies, full damping", &with_full_damping(model), &settings, 0.005, 30);
}

#[test]
fn condensed_beam() {
    let model = load("cantilever_stop", &[]);
    check("cantilever", &model, &settings(7, 128), 1.0, 10);
}

#[test]
fn smooth_laws_with_full_damping() {
    check("absorber", &load("nltva", &[]), &settings(5, 64), 0.1, 30);
    check("duffing", &load("duffing", &[]), &settings(5, 64), 0.1, 30);
}

#[test]
fn rotor67_without_friction() {
    let model = load("rotor67", &[("contact.friction", "0")]);
    check("rotor 67, frictionless", &model, &settings(10, 512), 40.0, 8);
}

#[test]
fn rotor67_with_friction() {
    let model = load("rotor67", &[]);
    check("rotor 67, friction", &model, &settings(10, 512), 40.0, 8);
    check("rotor 67, friction, full damping", &with_full_damping(model), &settings(5, 128), 40.0, 8);
}
