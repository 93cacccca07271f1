//! The figure of the forced response while branches come: what the page is told of each, and of axes and labels.

use super::{Run, Start};
use crate::curves::{BackboneCurve, Column, Curve, Monitor, Motions, ResonanceComparison, largest};
use crate::figure::{
    BackboneColumns, Coincidence, Color, ColumnStore, FEW, Figure, Font, Frame, Outline, PALETTE, Palette, Series,
    Subject, Unit, backbone_series, branch_series, called, convert, is_crowd, level_colors, make_room, place_for_page,
    say_thinner, special_points, straight_gaps,
};
use crate::overview::Level;
use crate::page::{length_unit, lengths};
use crate::summary_table::UnitChoice;
use serde::Serialize;

/// Points of a branch that labels keep away from, about.
const POINTS: usize = 64;

/// All branches so far, thinned, and what else the figure is made of.
#[derive(Debug)]
pub struct Sketch {
    levels: Vec<Level>,
    monitors: Vec<Monitor>,
    harmonic: usize,
    colors: Vec<Color>,
    backbone: Option<BackboneCurve>,
    branches: Vec<Curve>,
    resonance: ResonanceComparison,
    motions: Motions,
    units: UnitChoice,
    /// Where the next column goes.
    end: usize,
    font: Font,
}

/// What the page is given at first.
#[derive(Serialize)]
struct Opening {
    run: Run,
    palette: Palette,
    frequency_unit: String,
    length_unit: Option<Unit>,
    levels: Vec<Level>,
    level_colors: Vec<Color>,
    frames: Vec<Frame>,
    columns: ColumnStore,
    figure: Figure,
}

/// A branch that has come.
#[derive(Debug, Serialize)]
pub struct BranchEvent<'c> {
    first_column: usize,
    columns: ColumnStore,
    series: Vec<Series>,
    branch: &'c Curve,
    /// What others are called from now on, for the branch lies on them: which of those that came, and its name on each axis.
    renamed: Vec<(usize, Vec<String>)>,
}

/// The figure anew, without its series.
#[derive(Debug, Serialize)]
pub struct FigureEvent {
    #[serde(flatten)]
    figure: Figure,
    /// By how much the lines of each branch that has come are thinner than told with it, for it is narrow on these axes.
    thinner: Vec<f64>,
}

/// The backbone when it has come.
#[derive(Debug, Serialize)]
pub struct BackboneEvent {
    first_column: usize,
    columns: ColumnStore,
    series: Vec<Series>,
    frames: Vec<Frame>,
}

impl Sketch {
    /// Of a run without branches, with what the page is given of it, JSON.
    pub fn new(start: Start) -> (Self, String) {
        let level = |(amplitude, value): (String, f64)| Level { amplitude, value, ..Level::default() };
        let levels: Vec<Level> = start.levels.into_iter().map(level).collect();
        let colors = level_colors(levels.len());
        let mut sketch = Self {
            levels,
            monitors: start.monitors,
            harmonic: start.harmonic,
            colors,
            backbone: start.backbone,
            branches: Vec::new(),
            resonance: ResonanceComparison::default(),
            motions: Motions { harmonics: 0, nodes: Vec::new(), points: Vec::new() },
            units: start.units,
            end: 0,
            font: Font::bundled(),
        };
        let mut columns = ColumnStore::default();
        let mut figure = sketch.figure().figure;
        if let Some(backbone) = &sketch.backbone {
            figure.panels[0].series = backbone_series(&BackboneColumns::new(backbone, &mut columns));
        }
        sketch.end = columns.end();
        let opening = Opening {
            run: start.run,
            palette: PALETTE,
            frequency_unit: sketch.units.of_table().frequency.to_string(),
            length_unit: length_unit(sketch.units),
            levels: sketch.levels.clone(),
            level_colors: sketch.colors.clone(),
            frames: sketch.frames(),
            columns,
            figure,
        };
        let json = serde_json::to_string(&opening).expect("numbers and texts have JSON forms");
        (sketch, json)
    }

    fn subject(&self) -> Subject<'_> {
        Subject {
            levels: &self.levels,
            branches: &self.branches,
            monitors: &self.monitors,
            forcing_unit: "",
            is_finished: false,
            harmonic: self.harmonic,
            backbone: self.backbone.as_ref(),
            further: &[],
            curves: &[],
            sweep: None,
            resonance: &self.resonance,
            motions: &self.motions,
            missing: &[],
        }
    }

    /// The windows that the backbone has at every level.
    fn frames(&self) -> Vec<Frame> {
        let subject = self.subject();
        let of_level = |level| Frame::of_level(&subject, self.backbone.as_ref()?, level);
        (0..self.levels.len()).filter_map(of_level).collect()
    }

    /// Takes a branch in, or what is known of its stability since.
    pub fn branch<'c>(&mut self, curve: &'c Curve) -> BranchEvent<'c> {
        let name = |curve: &Curve| (curve.level, curve.kind, curve.number);
        let known = self.branches.iter().position(|known| name(known) == name(curve));
        let place = known.unwrap_or(self.branches.len());
        match known {
            Some(place) => self.branches[place] = thinned(curve),
            None => self.branches.push(thinned(curve)),
        }
        let branches: Vec<&Curve> = self.branches.iter().collect();
        let same = Coincidence::of(&branches, self.monitors.len());
        let amplitude = self.levels.get(curve.level).map_or("", |level| &level.amplitude);
        let names = |place| same.names(&branches, place).iter().map(|own| called(amplitude, own)).collect();
        let renamed = same.beneath(place).into_iter().map(|first| (first, names(first))).collect();
        let first_column = self.end;
        let mut columns = ColumnStore::starting_at(first_column);
        let drawn = Series { name: names(place), ..self.series(curve, &mut columns) };
        let marks = special_points(curve, &drawn, drawn.style.color).filter(|_| place < FEW);
        let gaps = straight_gaps(curve, &drawn, &mut columns);
        let series = std::iter::once(drawn.clone()).chain(gaps).chain(marks);
        let series = series.map(|series| same.veiled(place, series)).collect();
        self.end = columns.end();
        BranchEvent { first_column, columns, series, branch: curve, renamed }
    }

    fn series(&self, curve: &Curve, columns: &mut ColumnStore) -> Series {
        let amplitude = self.levels.get(curve.level).map_or("", |level| &level.amplitude);
        let color = self.colors.get(curve.level).copied().unwrap_or_default();
        // There are about as many isolas as levels.
        branch_series(curve, amplitude, color, is_crowd(self.levels.len()), columns)
    }

    /// Takes the backbone in.
    pub fn backbone(&mut self, curve: &BackboneCurve) -> BackboneEvent {
        self.backbone = Some(curve.clone());
        let first_column = self.end;
        let mut columns = ColumnStore::starting_at(first_column);
        let series = backbone_series(&BackboneColumns::new(curve, &mut columns));
        self.end = columns.end();
        BackboneEvent { first_column, columns, series, frames: self.frames() }
    }

    /// The figure without its series: axes, lines across, labels in their places, and how wide lines are there.
    pub fn figure(&self) -> FigureEvent {
        let subject = self.subject();
        let mut columns = ColumnStore::default();
        let mut figure = Outline::new(self.branches.iter(), &subject, &self.colors).with_marks(true).figure(None);
        let panel = &mut figure.panels[0];
        panel.series = self.branches.iter().map(|branch| self.series(branch, &mut columns)).collect();
        let axes = (&panel.x[0], &panel.y[0]);
        let thinner = panel.series.iter_mut().zip(&self.branches).map(|(series, branch)| {
            let full = series.style.width;
            make_room(series, branch, axes);
            full - series.style.width
        });
        let thinner: Vec<f64> = thinner.collect();
        if thinner.iter().any(|less| *less > 0.0) {
            say_thinner(&mut figure);
        }
        convert(&mut figure, lengths(self.units));
        place_for_page(&mut figure, &columns, &[], &self.font);
        figure.panels[0].series.clear();
        FigureEvent { figure, thinner }
    }
}

/// A branch with few of its points, the peaks among them, and without what is only said of points.
fn thinned(curve: &Curve) -> Curve {
    let stride = curve.size.div_ceil(POINTS).max(1);
    let mut places: Vec<usize> = (0..curve.size).step_by(stride).collect();
    places.extend(curve.amplitude.iter().map(|amplitude| largest(&amplitude.values)).filter(|&i| i < curve.size));
    places.sort_unstable();
    places.dedup();
    let thin = |column: &Column| Column::short(places.iter().map(|&i| column.values[i]).collect());
    Curve {
        size: places.len(),
        omega: thin(&curve.omega),
        amplitude: curve.amplitude.iter().map(thin).collect(),
        // What is asked of it is whether there is some.
        unstable: vec![curve.unstable.contains(&true)],
        stable: Vec::new(),
        others: Vec::new(),
        ..curve.clone()
    }
}

#[cfg(all(test, feature = "figures"))]
mod tests {
    use super::*;
    use crate::figure::Figures;
    use crate::fixture::Study;
    use crate::report::{Report, Selection};
    use protocol::to_everyone::Stage;
    use tempfile::tempdir;

    /// Lines of narrow isolas are as thin as in the report, once the axes are known.
    #[test]
    fn narrow_isolas_are_as_thin_as_in_the_report() {
        let dir = tempdir().unwrap();
        let (store, _) = Study::damper().finished(dir.path());
        let report = Report::read(&store, &Selection::Fitting).unwrap();
        let branches: Vec<Curve> = report.branches.iter().map(narrowed).collect();
        let subject = Subject { branches: &branches, ..report.subject() };
        let figures = Figures::new(&subject);
        let drawn = &figures.drawn["response"];
        let width = |branch: usize| {
            let mut series = drawn.panels[0].series.iter();
            series.find(|series| series.branch == Some(branch) && !series.name.is_empty()).unwrap().style.width
        };
        let run = Run { id: "run".into(), name: "run".into(), model: "model".into(), stage: Stage::Sweep };
        let levels = report.overview.levels.iter().map(|level| (level.amplitude.clone(), level.value)).collect();
        let (mut sketch, _) = Sketch::new(Start::new(run, report.monitors.clone(), levels, 1, None));
        let told: Vec<f64> = branches.iter().map(|branch| sketch.branch(branch).series[0].style.width).collect();
        let event = sketch.figure();
        assert_eq!(event.thinner.len(), branches.len());
        for (k, branch) in branches.iter().enumerate() {
            let less = event.thinner[k];
            assert_eq!(less > 0.0, branch.kind == "isola", "{}", branch.name);
            assert!((told[k] - less - width(k)).abs() < 0.1, "{} {less} {}", told[k], width(k));
        }
        assert!(event.figure.legend.iter().any(|entry| entry.text == "isola, thinner where narrow"));
    }

    /// An isola that is a thin sliver.
    fn narrowed(curve: &Curve) -> Curve {
        let mut curve = curve.clone();
        if curve.kind == "isola" {
            let (low, high) = (curve.omega.values[0], curve.amplitude_at_peak);
            let heights = curve.amplitude[0].values.clone();
            curve.omega = Column::short(heights.iter().map(|height| low + 1e-3 * low * height / high).collect());
        }
        curve
    }

    /// Whoever looks at a curve is told of all that lie on it, whichever came first.
    #[test]
    fn curves_that_lie_on_each_other_have_the_names_of_all() {
        let dir = tempdir().unwrap();
        let (store, _) = Study::damper().finished(dir.path());
        let report = Report::read(&store, &Selection::Fitting).unwrap();
        let isola = report.branches.iter().find(|branch| branch.kind == "isola").unwrap();
        let image = Curve { number: 2, name: "isola 2".into(), ..isola.clone() };
        let run = Run { id: "run".into(), name: "run".into(), model: "model".into(), stage: Stage::Sweep };
        let levels = report.overview.levels.iter().map(|level| (level.amplitude.clone(), level.value)).collect();
        let (mut sketch, _) = Sketch::new(Start::new(run, report.monitors.clone(), levels, 1, None));
        let first = sketch.branch(isola);
        assert_eq!((&first.series[0].name, first.renamed.len()), (&vec!["A = 0.006, isola 1".to_string()], 0));
        let second = sketch.branch(&image);
        let both = vec!["A = 0.006, isola 1 and 2".to_string()];
        assert_eq!(second.renamed, [(0, both.clone())]);
        assert!(!second.series[0].is_drawn(0));
        // Neither loses it when more is known of its stability.
        let again = sketch.branch(isola);
        assert_eq!((&again.series[0].name, again.renamed.len()), (&both, 0));
    }
}
