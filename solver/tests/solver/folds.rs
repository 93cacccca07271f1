//! Fold and peak curves: births and merges of isolas from the folds and peaks of branches that are known.

use crate::support::fold_curves::{Study, all, assert_close, fold_miss, folds, quiet, report};
use crate::support::study::shipped;
use solver::formulation::state::State;
use solver::response::branch::Stop;
use solver::response::folds::{Critical, CriticalCurve, CriticalKind, Extent, Quantity};
use solver::response::windows::{EventKind, events};
use solver::settings::Quadrature;
use solver::structure::laws::{Jenkins, PolynomialDamper, PolynomialSpring, Term};
use solver::{Backbone, Level, Model, Outcome, SearchRange, Settings};
use std::time::Instant;

#[test]
fn the_absorber_s_isola_from_the_folds_of_the_main_branch() {
    let study = Study::new(shipped("nltva", &[]), Settings::default());
    let main = study.main(0.13);
    let extent = Extent { forcing: (0.01, 0.5), frequency: (0.2, 10.0), points: 5000 };
    let mut critical = study.folds(extent);
    let folds = folds(&main);
    assert_eq!(folds.len(), 4);
    let since = Instant::now();
    let curves: Vec<CriticalCurve> = folds.iter().map(|fold| critical.curve(fold, &mut quiet).unwrap()).collect();
    curves.iter().for_each(|curve| report(curve, since));
    // Two pairs, each born at a cusp of its own.
    for (i, fold) in folds.iter().enumerate() {
        let on: Vec<bool> = curves.iter().map(|curve| critical.lies_on(fold, curve)).collect();
        assert_eq!(on, [i < 2, i < 2, i >= 2, i >= 2]);
    }
    for curve in &curves {
        assert!(curve.points.iter().all(|point| point.residual() < 1e-11));
        assert_eq!(all(curve, CriticalKind::Cusp).len(), 1);
    }
    assert_eq!(curves[0].events.len(), 1);
    // Two other programs and an independent harmonic balance agree on these.
    let curve = &curves[2];
    assert_eq!(curve.events.len(), 3);
    let (birth, merge) = (all(curve, CriticalKind::Birth)[0], all(curve, CriticalKind::Merge)[0]);
    assert_close(birth, 0.1246595, 1e-6);
    assert_close(merge, 0.1856230, 1e-6);

    let crossings = critical.crossings(curve, 0.15);
    let states: Vec<State> = crossings.into_iter().map(Result::unwrap).collect();
    for expected in [1.58329571, 2.30378026] {
        let state = states.iter().find(|state| (state.omega / expected - 1.0).abs() < 1e-7).unwrap();
        let isola = study.through(state);
        assert!(isola.is_closed(), "{}", isola.outcome);
        let (low, high) = isola.frequency_range();
        assert_close(low, 1.58329571, 1e-6);
        assert_close(high, 2.30378026, 1e-6);
    }
    // On both sides of the events: a small isola and none; a large isola and a main branch that goes where it was.
    let at = |forcing: f64, critical: &mut Critical<'_>| -> Vec<State> {
        critical.crossings(curve, forcing).into_iter().map(Result::unwrap).collect()
    };
    let omega = curve.events(CriticalKind::Birth).next().unwrap().omega();
    let near = |states: &[State]| states.iter().filter(|state| (state.omega - omega).abs() < 0.05).count();
    assert_eq!(near(&at(birth * (1.0 - 1e-4), &mut critical)), 0);
    let small = at(birth * (1.0 + 1e-4), &mut critical);
    assert_eq!(near(&small), 2);
    let small = study.through(small.iter().find(|state| (state.omega - omega).abs() < 0.05).unwrap());
    let (low, high) = small.frequency_range();
    assert!(small.is_closed() && high - low < 0.1, "{}: {low} to {high}", small.outcome);
    let before = at(merge * (1.0 - 1e-4), &mut critical);
    let largest = before.iter().max_by(|a, b| a.omega.total_cmp(&b.omega)).unwrap();
    let large = study.through(largest);
    assert!(large.is_closed() && study.main(merge * (1.0 - 1e-4)).peak().amplitude() < 1.3);
    assert_close(study.main(merge * (1.0 + 1e-4)).peak().amplitude(), large.peak().amplitude(), 1e-3);
}

/// Between birth and merge of the isola of a nonlinear damper the slider acts; 14 harmonics on their own have the merge at 0.0233323.
#[test]
fn what_twice_the_harmonics_say_of_a_merge_is_not_of_the_birth_beside_it() {
    let terms = [(3, -0.03), (5, 0.01)].map(|(power, coefficient)| Term { power, coefficient }).to_vec();
    let model = Model::builder("three masses")
        .mass([[1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, 0.8]])
        .stiffness([[2.0, -1.0, 0.0], [-1.0, 2.2, -0.7], [0.0, -0.7, 1.4]])
        .damping_ratio(0.005)
        .force("x3", 1.0)
        .monitor("x3")
        .element("slider", Jenkins { stiffness: 0.3, limit: 0.04 }, ["x1"])
        .element("damper", PolynomialDamper { terms }, ["x3"])
        .element("spring", PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.03 }] }, ["x2"])
        .build()
        .unwrap();
    let mut settings = Settings::default();
    settings.harmonics.count = 7;
    let study = Study::new(model, settings);
    let main = study.main(0.04);
    let mut critical = study.folds(Extent { forcing: (0.005, 0.1), frequency: (0.4, 3.0), points: 5000 });
    let curves: Vec<CriticalCurve> =
        folds(&main).iter().filter_map(|fold| critical.curve(fold, &mut quiet).ok()).collect();
    let events: Vec<_> = curves
        .iter()
        .flat_map(|curve| curve.events.iter().map(|event| (event, curve.points[event.index].state.forcing)))
        .collect();
    for (kind, expected) in [(CriticalKind::Birth, 0.020_134_6), (CriticalKind::Merge, 0.023_332_5)] {
        let mut of_kind = events.iter().filter(|(event, at)| event.kind == kind && (at / expected - 1.0).abs() < 1e-4);
        let (event, at) = of_kind.next().unwrap();
        let doubled = event.doubled.map(|(forcing, _)| forcing);
        let is_right = doubled.map(|doubled| (doubled / at - 1.0).abs() < 1e-4);
        assert!(is_right.unwrap_or(kind == CriticalKind::Merge), "{kind:?} at {at}: {doubled:?}");
    }
}

/// A softening spring that hardens beyond 3 m: A turns where its values along the curve do, and nowhere else, though tangents of the
/// walk, far up where the curve runs along ω, say so.
#[test]
fn a_turns_only_where_its_values_do() {
    let terms = vec![Term { power: 3, coefficient: -0.4 }, Term { power: 5, coefficient: 0.045 }];
    let model = Model::builder("softening")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(0.005)
        .force("x1", 1.0)
        .element("spring", PolynomialSpring { terms }, ["x1"])
        .build()
        .unwrap();
    let study = Study::new(model, Settings::default());
    let main = study.main(0.0106);
    let mut critical = study.folds(Extent { forcing: (0.0052, 0.022), frequency: (0.1, 2.0), points: 5000 });
    let curve = critical.curve(folds(&main).last().unwrap(), &mut quiet).unwrap();
    let forcing: Vec<f64> = curve.forcing().collect();
    let turns = (1..forcing.len() - 1)
        .filter(|&i| (forcing[i] > forcing[i - 1]) != (forcing[i + 1] > forcing[i]))
        .collect::<Vec<_>>();
    assert_eq!(curve.events.iter().map(|event| event.index).collect::<Vec<_>>(), turns);
    assert_close(all(&curve, CriticalKind::Birth)[0], 0.0105076, 1e-5);
    assert_close(all(&curve, CriticalKind::Merge)[0], 0.0107582, 1e-5);
}

/// With two harmonics the third is left out, which moves birth and merge; what is said of twice as many is what they have on their own.
#[test]
fn what_twice_the_harmonics_change_is_what_they_have_on_their_own() {
    let curve = |count: usize| {
        let mut settings = Settings::default();
        settings.harmonics.count = count;
        let study = Study::new(shipped("nltva", &[]), settings);
        let extent = Extent { forcing: (0.01, 0.5), frequency: (0.2, 10.0), points: 5000 };
        let main = study.main(0.13);
        let curves: Vec<CriticalCurve> =
            folds(&main).iter().map(|fold| study.folds(extent).curve(fold, &mut quiet).unwrap()).collect();
        curves.into_iter().max_by_key(|curve| curve.events.len()).unwrap()
    };
    let (coarse, fine) = (curve(2), curve(4));
    for kind in [CriticalKind::Birth, CriticalKind::Merge] {
        let event = coarse.events.iter().find(|event| event.kind == kind).unwrap();
        let (forcing, omega) = event.doubled.unwrap();
        let expected = fine.events(kind).next().unwrap();
        assert_close(forcing, expected.state.forcing, 1e-7);
        assert_close(omega, expected.omega(), 1e-5);
        assert!((forcing / all(&coarse, kind)[0] - 1.0).abs() > 1e-5);
    }
    assert!(coarse.events.iter().all(|event| (event.kind == CriticalKind::Cusp) == event.doubled.is_none()));
}

#[test]
fn the_absorber_s_isola_from_its_linear_peaks() {
    let study = Study::new(shipped("nltva", &[]), Settings::default());
    let main = study.main(1e-3);
    let extent = Extent { forcing: (1e-4, 0.5), frequency: (0.2, 10.0), points: 5000 };
    let mut critical = study.peaks(extent);
    let points = &main.points;
    let is_maximum = |&i: &usize| {
        points[i].amplitude() > points[i - 1].amplitude() && points[i].amplitude() >= points[i + 1].amplitude()
    };
    let maxima: Vec<&State> = (1..points.len() - 1).filter(is_maximum).map(|i| &points[i].state).collect();
    assert_eq!(maxima.len(), 2, "the equal peaks");
    let since = Instant::now();
    let curves: Vec<CriticalCurve> = maxima.iter().map(|near| critical.curve(near, &mut quiet).unwrap()).collect();
    curves.iter().for_each(|curve| report(curve, since));
    assert!(curves[0].events.is_empty());
    // At births and merges all extrema of a branch coincide: the same values as from the folds.
    let curve = &curves[1];
    assert_eq!(curve.events.len(), 2);
    assert_close(all(curve, CriticalKind::Birth)[0], 0.1246595, 1e-6);
    assert_close(all(curve, CriticalKind::Merge)[0], 0.1856230, 1e-6);
    assert_eq!(curve.outcome, Outcome::Open(Stop::ForcingBound, Stop::ForcingBound));
    let ends = [&curve.points[0], curve.points.last().unwrap()].map(|point| point.state.forcing);
    assert_close(ends[0].min(ends[1]), 1e-4, 1e-9);
    assert_close(ends[0].max(ends[1]), 0.5, 1e-9);
    // At A = 0.15 they are extrema of the amplitude of the main branch and of the isola: the largest is the isola's peak.
    let states = critical.crossings(curve, 0.15).into_iter().map(Result::unwrap);
    let peak = states.max_by(|a, b| a.amplitude(&study.model, 0).total_cmp(&b.amplitude(&study.model, 0))).unwrap();
    let isola = study.through(&peak);
    assert!(isola.is_closed());
    assert_close(isola.peak().amplitude(), peak.amplitude(&study.model, 0), 1e-9);
}

#[test]
fn an_isola_of_nonlinear_damping() {
    // With one harmonic exactly: birth at A = 0.0048 with amplitude 2, merge at 0.0114 with amplitude 1, both at ω = 1 (see
    // the model). The damping is weak, and more harmonics hardly change anything.
    for (count, tolerance) in [(1, 1e-9), (10, 1e-5)] {
        let mut settings = Settings::default();
        settings.harmonics.count = count;
        (settings.frequency.min, settings.frequency.max) = (Some(0.9), Some(1.1));
        let study = Study::new(shipped("nonlinear_damper", &[]), settings);
        let extent = Extent { forcing: (0.001, 0.05), frequency: (0.5, 2.0), points: 5000 };
        let main = study.main(0.0116);
        let (mut critical, mut peaks) = (study.folds(extent), study.peaks(extent));
        let folds = folds(&main);
        assert_eq!(folds.len(), 4);
        let since = Instant::now();
        let curve = critical.curve(&folds[0], &mut quiet).unwrap();
        report(&curve, since);
        assert!(curve.is_closed() && curve.events.len() == 4);
        assert!(folds.iter().all(|fold| critical.lies_on(fold, &curve)));
        let since = Instant::now();
        let peak_curve = peaks.curve(&study.main(0.0012).peak().state, &mut quiet).unwrap();
        report(&peak_curve, since);
        assert_eq!(peak_curve.events.len(), 2);
        for curve in [curve, peak_curve] {
            for (kind, forcing, amplitude) in [(CriticalKind::Birth, 0.0048, 2.0), (CriticalKind::Merge, 0.0114, 1.0)] {
                let point = curve.events(kind).next().unwrap();
                assert_close(point.state.forcing, forcing, tolerance);
                assert_close(point.amplitude(), amplitude, tolerance);
                assert_close(point.omega(), 1.0, tolerance);
            }
        }
    }
}

#[test]
fn the_isolas_of_a_blade() {
    let model = shipped("rotor67", &[("contact.friction", "0")]);
    let reach = SearchRange { frequency: (2000.0, 3600.0), amplitude: 4e-3, natural: None, forcing: None };
    let study = Study { model, settings: Settings::default(), reach };
    let extent = Extent { forcing: (15.0, 300.0), frequency: (2000.0, 4000.0), points: 3000 };
    let since = Instant::now();
    let main = study.main(80.0);
    println!("main branch: {} points in {:.3} s", main.points.len(), since.elapsed().as_secs_f64());
    let mut critical = study.folds(extent);
    let folds = folds(&main);
    assert_eq!(folds.len(), 2);
    let since = Instant::now();
    let curve = critical.curve(&folds[0], &mut quiet).unwrap();
    report(&curve, since);
    // An independent program, 2048 instants a period; its second birth and first merge are rounded.
    let (births, merges) = (all(&curve, CriticalKind::Birth), all(&curve, CriticalKind::Merge));
    for (value, expected) in births.iter().zip([28.877, 30.68]).chain(merges.iter().zip([32.75, 70.495])) {
        assert_close(*value, expected, 5e-4);
    }
    assert!(births.len() == 3 && merges.len() >= 2);
    // Beyond them all, that of the isola far up.
    assert_close(births[2], 41.687_515_6, 1e-7);
    // It goes on where the contacts of other nodes begin and end, and what it says beyond is true.
    assert_eq!(curve.outcome, Outcome::Open(Stop::ForcingBound, Stop::ForcingBound));
    let corners = curve.corners.iter().map(|corner| (corner.element, curve.points[corner.index].state.forcing));
    for (element, forcing) in [(1, 70.274_726_6), (2, 241.646_364), (2, 257.030_307)] {
        assert!(corners.clone().any(|(by, at)| by == element && (at / forcing - 1.0).abs() < 1e-8), "{forcing}");
    }
    for level in [70.35, 70.45, 245.0, 255.0, 260.0, 275.0] {
        let main = study.main(level);
        for state in critical.crossings(&curve, level) {
            let state = state.unwrap();
            let miss = fold_miss(&main, &state).min(fold_miss(&study.through(&state), &state));
            assert!(miss < 1e-6, "A = {level}: no fold at {} rad/s, but {miss:.1e} beside", state.omega);
        }
    }
    // The isolas at A = 60, from the main branch at 80.
    let mut isolas = Vec::new();
    for state in critical.crossings(&curve, 60.0) {
        let state = state.unwrap();
        let since = Instant::now();
        let isola = study.through(&state);
        println!("{}: {} points in {:.3} s", isola.outcome, isola.points.len(), since.elapsed().as_secs_f64());
        if isola.is_closed() {
            let (low, high) = isola.frequency_range();
            assert!((low / state.omega - 1.0).abs() < 1e-7 || (high / state.omega - 1.0).abs() < 1e-7);
            isolas.push(isola);
        }
    }
    // Two folds of each of the two.
    assert_eq!(isolas.len(), 4);
    let isola = isolas.iter().min_by(|a, b| a.frequency_range().0.total_cmp(&b.frequency_range().0)).unwrap();
    // From the isola's peak: the same births and the merge between them, past the contacts that begin on the way.
    for quantity in [Quantity::Amplitude, Quantity::Rms] {
        let mut peaks = Critical::new(&study.model, &study.settings, quantity, extent).unwrap();
        let since = Instant::now();
        let peak_curve = peaks.curve(&isola.peak().state, &mut quiet).unwrap();
        report(&peak_curve, since);
        assert!(peak_curve.events.len() >= 3);
        // Two maxima of one branch may also meet, at corners too.
        let is_of_branches = |kind: CriticalKind| !matches!(kind, CriticalKind::Cusp | CriticalKind::Unknown);
        for event in peak_curve.events.iter().filter(|event| is_of_branches(event.kind)) {
            let forcing = peak_curve.points[event.index].state.forcing;
            let same = all(&curve, event.kind).into_iter().map(|other| (forcing / other - 1.0).abs());
            assert!(same.fold(f64::INFINITY, f64::min) < 1e-9, "{:?} at {forcing}", event.kind);
        }
    }
}

#[test]
fn the_isola_of_a_blade_with_friction() {
    let reach = SearchRange { frequency: (2000.0, 3600.0), amplitude: 4e-3, natural: None, forcing: None };
    let study = Study { model: shipped("rotor67", &[]), settings: Settings::default(), reach };
    let extent = Extent { forcing: (10.0, 100.0), frequency: (2000.0, 4000.0), points: 3000 };
    let mut critical = study.folds(extent);
    let since = Instant::now();
    let curve = critical.curve(&folds(&study.main(20.0))[0], &mut quiet).unwrap();
    report(&curve, since);
    let (births, merges) = (all(&curve, CriticalKind::Birth), all(&curve, CriticalKind::Merge));
    assert_eq!((births.len(), merges.len()), (1, 1));
    // What branches on both sides say: a small isola and none; a large isola and a main branch that goes where it was.
    let omega = curve.events(CriticalKind::Birth).next().unwrap().omega();
    let mut near = |forcing: f64| -> Vec<State> {
        let states = critical.crossings(&curve, forcing).into_iter().map(Result::unwrap);
        states.filter(|state| (state.omega / omega - 1.0).abs() < 1e-3).collect()
    };
    assert!(near(births[0] * (1.0 - 1e-4)).is_empty());
    let small = near(births[0] * (1.0 + 1e-4));
    assert_eq!(small.len(), 2);
    let isola = study.through(&small[0]);
    let (low, high) = isola.frequency_range();
    assert!(isola.is_closed() && high - low < 1e-3 * omega, "{}: {low} to {high}", isola.outcome);
    let merge = curve.events(CriticalKind::Merge).next().unwrap();
    let before = critical.crossings(&curve, merges[0] * (1.0 - 1e-4)).into_iter().map(Result::unwrap);
    let distance = |state: &State| (state.omega - merge.omega()).abs();
    let nearest = before.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    let isola = study.through(&nearest);
    assert!(isola.is_closed());
    let [before, after] = [-1e-4, 1e-4].map(|share| study.main(merges[0] * (1.0 + share)).peak().amplitude());
    assert!(before < 0.9 * isola.peak().amplitude());
    assert_close(after, isola.peak().amplitude(), 1e-2);
}

#[test]
fn corners_where_a_contact_begins_or_ends() {
    let study = Study::new(shipped("cantilever_stop", &[]), Settings::default());
    let extent = Extent { forcing: (0.025, 2.0), frequency: (5.0, 1000.0), points: 5000 };
    let mut critical = study.folds(extent);
    let main = study.main(0.05);
    let mut curves: Vec<CriticalCurve> = Vec::new();
    for fold in folds(&main) {
        if !curves.iter().any(|curve| critical.lies_on(&fold, curve)) {
            let since = Instant::now();
            curves.push(critical.curve(&fold, &mut quiet).unwrap());
            report(curves.last().unwrap(), since);
        }
    }
    assert!(curves.iter().all(|curve| !curve.outcome.is_unfinished()));
    // Neither the state nor the direction back to it is lost, and the points beside a corner are next to it.
    for (curve, corner) in curves.iter().flat_map(|curve| curve.corners.iter().map(move |corner| (curve, corner))) {
        let near = &curve.points[corner.index - 1..=corner.index + 1];
        assert!(near.windows(2).all(|pair| (pair[0].omega() / pair[1].omega() - 1.0).abs() < 1e-4));
        assert!(near.iter().all(|point| point.residual() < 1e-10) && corner.element == 0);
    }
    // At one of them two folds of the main branch, of which neither step led to the other, meet and vanish.
    let is_corner = |curve: &CriticalCurve, index: usize| curve.corners.iter().any(|corner| corner.index == index);
    let meeting = |curve: &CriticalCurve| {
        let cusp = curve.events.iter().find(|event| event.kind == CriticalKind::Cusp && is_corner(curve, event.index));
        cusp.map(|event| curve.points[event.index].state.forcing)
    };
    let meetings: Vec<f64> = curves.iter().filter_map(meeting).collect();
    assert_eq!(meetings.len(), 1);
    assert_close(meetings[0], 0.050_391_06, 1e-7);
    // Branches that are traced beyond the corners, each at a level of its own, have the folds that the curves say.
    let beyond =
        [(0.025_992, [0.0255, 0.0252]), (0.050_391, [0.03, 0.045]), (0.046_135, [0.1, 1.0]), (1.765_695, [1.8, 1.9])];
    for (corner, levels) in beyond {
        let is_there = |at: f64| (at / corner - 1.0).abs() < 2e-5;
        let of = |curve: &&CriticalCurve| {
            curve.corners.iter().any(|corner| is_there(curve.points[corner.index].state.forcing))
        };
        let curve = curves.iter().find(of).unwrap();
        for level in levels {
            let main = study.main(level);
            let states = critical.crossings(curve, level);
            assert!(!states.is_empty());
            for state in states.into_iter().map(Result::unwrap) {
                let miss = fold_miss(&main, &state).min(fold_miss(&study.through(&state), &state));
                assert!(miss < 1e-6, "A = {level}: no fold at {} rad/s, but {miss:.1e} beside", state.omega);
            }
        }
    }
}

#[test]
fn the_subharmonic_of_an_impact_oscillator() {
    for count in [10, 20] {
        let mut settings = Settings::default();
        settings.harmonics.count = count;
        let model = shipped("impact_subharmonic", &[]);
        let backbone = Backbone::compute(&model, &settings).unwrap();
        let level = Level::compute(&model, &settings, &backbone, 1.0).unwrap();
        let isola = level.isolas().next().unwrap();
        let extent = Extent { forcing: (0.01, 2.0), frequency: (0.2, 10.0), points: 5000 };
        let mut critical = Critical::new(&model, &settings, Quantity::Frequency, extent).unwrap();
        let since = Instant::now();
        let [first, second] = &folds(isola)[..] else { panic!("an isola of two folds") };
        let curve = critical.curve(first, &mut quiet).unwrap();
        report(&curve, since);
        assert_eq!(curve.outcome, Outcome::Open(Stop::ForcingBound, Stop::ForcingBound));
        assert!(!curve.corners.is_empty());
        // One curve, up to time shifts by a period of the forcing.
        assert!(critical.lies_on(second, &curve));
        assert_eq!(curve.events.len(), 1);
        // The energy balance on the backbone, which knows nothing of folds, is not exact: the motion decays there.
        let predicted = events(&backbone).into_iter().find(|event| event.kind == EventKind::Birth).unwrap();
        assert_close(all(&curve, CriticalKind::Birth)[0], predicted.threshold, 1e-4);
    }
}

#[test]
fn laws_without_second_derivatives_are_refused() {
    let model = shipped("impact_subharmonic", &[]);
    let mut settings = Settings::default();
    settings.harmonics.quadrature = Quadrature::Samples;
    let extent = Extent { forcing: (0.01, 2.0), frequency: (0.2, 10.0), points: 5000 };
    let error = Critical::new(&model, &settings, Quantity::Frequency, extent).err().unwrap().to_string();
    assert!(error.contains("second derivatives") && error.contains("harmonics.quadrature"), "{error}");
}

#[test]
fn the_cusp_of_duffing_s_oscillator_however_light_its_damping() {
    for ratio in [5e-2f64, 1e-3, 1e-5] {
        let mut settings = Settings::default();
        settings.harmonics.count = 1;
        let ratio_text = ratio.to_string();
        let study = Study::new(shipped("duffing", &[("damping.default_ratio", &ratio_text)]), settings);
        // With one harmonic, u the square of the amplitude and d = 1 + 3/4 u − ω²: u (d² + 4 ζ² ω²) = A². Its first two
        // derivatives by u vanish where d = −3/8 u and 27/64 u² = 4 ζ² (1 + 9/8 u): there A² = 9/16 u³.
        let half = 16.0 / 3.0 * ratio * ratio;
        let u = half + (half * half + 256.0 / 27.0 * ratio * ratio).sqrt();
        let expected = 0.75 * u.powf(1.5);
        let forcing = 8.0 * expected;
        let extent = Extent { forcing: (0.1 * expected, 100.0 * expected), frequency: (0.3, 30.0), points: 5000 };
        let main = study.main(forcing);
        let folds = folds(&main);
        assert_eq!(folds.len(), 2);
        let mut critical = study.folds(extent);
        let since = Instant::now();
        let curve = critical.curve(&folds[0], &mut quiet).unwrap();
        report(&curve, since);
        assert_eq!(curve.outcome, Outcome::Open(Stop::ForcingBound, Stop::ForcingBound));
        assert!(critical.lies_on(&folds[1], &curve));
        assert_eq!(curve.events.len(), 1);
        let cusp = curve.events(CriticalKind::Cusp).next().unwrap();
        assert_close(cusp.state.forcing, expected, 1e-9);
        assert_close(cusp.omega(), (1.0 + 1.125 * u).sqrt(), 1e-6);
        // Its peaks are one curve without an extremum of A.
        let mut peaks = study.peaks(extent);
        let since = Instant::now();
        let curve = peaks.curve(&main.peak().state, &mut quiet).unwrap();
        report(&curve, since);
        assert!(curve.events.is_empty() && curve.outcome == Outcome::Open(Stop::ForcingBound, Stop::ForcingBound));
    }
}
