//! Isola map: the thresholds along the backbones, where windows are born and merge, and what every level has.

use super::axis::in_sight;
use super::column_store::ColumnStore;
use super::data::{Axis, Direction, Entry, Figure, Kind, Label, Measure, Panel, Series, Side, Size, Span, Unit};
use super::folds::{CUSPS, MARKS, event_label, explained};
use super::style::{BOLD, Color, FINE, MARK, MEDIUM, Shape, Style};
use super::subject::{BackboneColumns, Subject};
use crate::curves::BackboneCurve;
use crate::overview::{BIRTH, EVENTS, Level, MERGES, WindowOutcome, WindowRow, events_of};
use crate::store::{CurvePoint, CurveRow};
use solver::response::branch::BranchKind;
use solver::response::windows::{Event, EventKind};

/// What happens from the lowest level divided by the first of these to the highest one times the second, as far as folds are followed,
/// is shown.
const NEAR: (f64, f64) = (4.0, 2.0);
/// Where nothing happens beyond the levels, thresholds are shown this factor below and above them.
const ROOM: f64 = 1.5;
/// What happens from the lowest level divided by the first of these to the highest one times the second is what the figure is about.
const AMONG: (f64, f64) = (2.0, 1.25);
/// Curves are shown this far on each side of what the figure is about, as a share of its range: those of other modes may go much farther.
const BESIDE: f64 = 1.0;
/// Marks of what is predicted show behind those of the same thing as computed, which lie over them.
const PREDICTED: f64 = 1.9 * MARK;
const COMPUTED: f64 = 1.15 * MARK;
/// Bars are thinner where there are many: their widths together, px, and those of the main branches, which are wide.
const TOGETHER: (f64, f64) = (100.0, 30.0);
/// Where levels lie close together, a share of the distance between them, in a file about so high, px.
const SHARE: f64 = 0.5;
const HEIGHT: f64 = 330.0;

/// Follows the name of what lies beside all that is shown.
const BEYOND: &str = " (beyond these frequencies)";

/// The figure.
///
/// # Errors
/// If there is no backbone: in words.
pub fn figure(
    subject: &Subject<'_>,
    store: &mut ColumnStore,
    columns: Option<&BackboneColumns>,
) -> Result<Figure, String> {
    let backbone = subject.backbone()?;
    let columns = columns.ok_or("the run has no backbone yet")?;
    let others = || subject.levels.iter().flat_map(|level| level.others().map(move |other| (level.value, other)));
    let is_near = near(subject);
    let primary = || points(backbone);
    let shown =
        || primary().chain(subject.further.iter().flat_map(points)).filter(|(threshold, _)| is_near(*threshold));
    let levels = subject.levels.iter().map(|level| level.value);
    let values = levels.chain(shown().map(|(threshold, _)| threshold));
    let y = Axis::logarithmic("forcing amplitude A, threshold A*", Unit::si(subject.forcing_unit), values)
        .of(Measure::Forcing);
    let is_any = shown().next().is_some();
    let thresholds = shown().chain(primary().filter(|_| !is_any)).map(|(_, omega)| omega);
    let x = Axis::around("", Unit::none(), frequencies(subject, &y, thresholds));

    let mut drawing = Drawing { series: Vec::new(), legend: Vec::new(), store, frame: (&x, &y) };
    let curve = Style::line(Color::Ink, MEDIUM);
    let whose = if subject.further.is_empty() { "the backbone".into() } else { format!("mode {}", backbone.mode + 1) };
    let places: Vec<(f64, f64)> = points(backbone).map(|(threshold, omega)| (omega, threshold)).collect();
    drawing.name(&format!("threshold A* of {whose}"), curve.clone(), &places);
    drawing.of_the_amplitude();
    let thin = (TOGETHER.0 / subject.levels.len().max(1) as f64).min(SHARE * HEIGHT * apart(subject, &y));
    let (thin, levels) = (thin.max(0.5 * FINE), subject.levels.len().max(1) as f64);
    let mains = subject.levels.iter().flat_map(|level| level.mains().map(|main| (level.value, main.omega)));
    let of_kind = |kind: BranchKind| {
        let of_kind = others().filter(move |(_, other)| other.kind == kind.name());
        of_kind.map(|(value, other)| (value, other.omega))
    };
    let across = FINE.min(TOGETHER.1 / levels);
    drawing.bars("main branches", Style::line(Color::Shade, across), mains);
    let color = Color::Category(1);
    // Open branches go from one end to the other; what branches off an isola lies within its bar.
    for (kind, name, style) in [
        (BranchKind::Open, "open branches", Style::line(color, across).with_dash(1)),
        (BranchKind::Isola, "isolas", Style::line(color, (1.3 * BOLD).min(thin))),
        (BranchKind::Cut, "cut off by a bound", Style::line(color, BOLD.min(thin)).with_dash(4)),
        (BranchKind::Unfinished, "unfinished", Style::line(color, BOLD.min(thin)).with_dash(2)),
        (BranchKind::Branched, "branches off another", Style::line(Color::Category(4), (0.8 * MEDIUM).min(0.6 * thin))),
    ] {
        drawing.bars(name, style, of_kind(kind));
    }
    let missed = windows(subject, is_missed);
    let alert = Style::line(Color::Alert, MEDIUM.min(thin)).with_dash(1);
    drawing.bars("windows not found", alert, missed.clone().map(|(value, window)| (value, window.omega)));
    drawing.points(
        "smallest A* of windows not found",
        Style::marks(Color::Alert, Shape::Cross, MARK, false),
        missed.map(|(value, window)| (window.omega_best, value)),
    );
    let pending = windows(subject, |outcome| matches!(outcome, WindowOutcome::Pending(_)));
    let shade = Style::line(Color::Shade, MEDIUM.min(thin)).with_dash(2);
    drawing.bars("windows pending", shade, pending.map(|(value, window)| (value, window.omega)));

    drawing.folds(subject, &y);
    drawing.further(subject, &y);

    let threshold = Series {
        name: vec!["backbone".into()],
        x: vec![columns.omega.clone()],
        y: vec![columns.threshold.clone()],
        style: curve,
        details: columns.details(),
        ..Series::default()
    };
    let below =
        Series { along_runs: true, name: Vec::new(), details: Vec::new(), style: below_chosen(), ..threshold.clone() };
    drawing.series.extend([below, threshold]);
    let is_shown = |event: &&Event| y.shows(event.threshold);
    let events =
        || backbone.events.iter().chain(subject.further.iter().flat_map(|further| &further.events)).filter(is_shown);
    for (kind, shape, name) in [
        (EventKind::Birth, Shape::Triangle, BIRTH.many),
        // Where the threshold has a maximum windows merge.
        (EventKind::Merge, Shape::InvertedTriangle, "merges"),
    ] {
        let name = format!("{name}, predicted");
        let style = Style::marks(Color::Ink, shape, PREDICTED, kind == EventKind::Merge);
        let of_kind = events().filter(|event| event.kind == kind);
        drawing.points(&name, style, of_kind.map(|event| (event.omega, event.threshold)));
    }
    drawing.happens(subject, &y);
    let mut labels = Vec::new();
    for words in EVENTS {
        let side = if words == BIRTH { Side::Below } else { Side::Above };
        let label = |point: &CurvePoint| event_label(subject, words, point, (point.omega, point.forcing), side);
        labels.extend(computed(subject, &y, words.kind.name()).map(label));
    }
    labels.extend(events().map(|event| label(subject, event)));
    let Drawing { series, legend, .. } = drawing;
    let panel = Panel {
        about: "Isola map: threshold of the forcing amplitude over frequency. Drag the line to move A.",
        size: Size::Tall,
        x: vec![Axis::of_frequencies(x.range, subject.harmonic)],
        y: vec![y],
        series,
        spans: vec![Span { axis: Direction::Y, at: Vec::new(), by_amplitude: true, style: chosen() }],
        labels,
        has_leaders: true,
        ..Panel::default()
    };
    Ok(Figure { name: "map", title: None, columns: 1, choice: "", linked_x: false, legend, panels: vec![panel] })
}

/// How far apart levels lie at least, but for a few, as a share of the axis.
fn apart(subject: &Subject<'_>, y: &Axis) -> f64 {
    let places: Vec<f64> = subject.levels.iter().map(|level| y.share(level.value)).collect();
    let mut distances: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 4).copied().unwrap_or(1.0)
}

/// Series with their names in the legend.
struct Drawing<'s> {
    series: Vec<Series>,
    legend: Vec<Entry>,
    store: &'s mut ColumnStore,
    /// Axes across and up.
    frame: (&'s Axis, &'s Axis),
}

impl Drawing<'_> {
    /// Names what lies at these places, and says so if that is beside what is shown.
    fn name(&mut self, text: &str, style: Style, places: &[(f64, f64)]) {
        let beside = if in_sight(self.frame, places, style.width > 0.0) { "" } else { BEYOND };
        self.legend.push(Entry::new(format!("{text}{beside}"), Kind::Line, style));
    }

    /// What is drawn of the forcing amplitude looked at, where one is chosen.
    fn of_the_amplitude(&mut self) {
        let below = Style { color: Color::Soft, ..below_chosen() };
        let entries = [("amplitude chosen: drag the line", chosen()), ("windows there, a colour each", below)];
        let entry = |(text, style)| Entry { by_amplitude: true, ..Entry::new(text, Kind::Line, style) };
        self.legend.extend(entries.map(entry));
    }

    /// Level lines with gaps between them.
    fn bars(&mut self, name: &str, style: Style, bars: impl Iterator<Item = (f64, (f64, f64))>) {
        let points = bars.flat_map(|(value, (low, high))| [(low, value), (high, value), (f64::NAN, f64::NAN)]);
        self.points(name, style, points);
    }

    /// Thresholds of further modes that come onto the axis of A.
    fn further(&mut self, subject: &Subject<'_>, y: &Axis) {
        let is_shown = |further: &&BackboneCurve| y.is_met_by(further.threshold.values.iter().copied());
        let curve =
            |further| points(further).map(|(threshold, omega)| (omega, threshold)).chain([(f64::NAN, f64::NAN)]);
        let curves = subject.further.iter().filter(is_shown).flat_map(curve);
        self.points("threshold A* of further modes", Style::line(Color::Ink, FINE), curves);
    }

    /// Fold curves.
    fn folds(&mut self, subject: &Subject<'_>, y: &Axis) {
        let is_shown = |curve: &&CurveRow| y.is_met_by(curve.points.iter().map(|point| point.forcing));
        let place = |point: &CurvePoint| (point.omega, point.forcing);
        let curves = subject.curves.iter().filter(is_shown);
        let points = curves.flat_map(|curve| curve.points.iter().map(place).chain([(f64::NAN, f64::NAN)]));
        self.points("folds, computed", Style::line(Color::Category(3), MEDIUM), points);
    }

    /// Where isolas are born and branches merge on fold curves.
    fn happens(&mut self, subject: &Subject<'_>, y: &Axis) {
        for (words, shape, is_hollow) in MARKS {
            let style = Style::marks(Color::Category(3), shape, COMPUTED, is_hollow);
            let found = || computed(subject, y, words.kind.name());
            let of_kind: Vec<(f64, f64)> = found().map(|p| (p.omega, p.forcing)).collect();
            self.points(&explained(words, found()), style, of_kind.into_iter());
        }
        let (wanted, shape, is_hollow, name) = CUSPS;
        let style = Style::marks(Color::Category(3), shape, MARK, is_hollow);
        self.points(name, style, computed(subject, y, wanted).map(|point| (point.omega, point.forcing)));
    }

    fn points(&mut self, name: &str, style: Style, points: impl Iterator<Item = (f64, f64)>) {
        let places: Vec<(f64, f64)> = points.collect();
        if places.is_empty() {
            return;
        }
        self.name(name, style.clone(), &places);
        let (x, y): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
        let (x, y) = (vec![self.store.exact(x)], vec![self.store.exact(y)]);
        self.series.push(Series { x, y, style, ..Series::default() });
    }
}

/// The line of the amplitude looked at.
fn chosen() -> Style {
    Style::line(Color::Category(2), FINE).with_dash(4)
}

/// The threshold where it lies below that line; each window has its own colour.
fn below_chosen() -> Style {
    Style::line(Color::Category(1), 1.6 * BOLD)
}

/// Where this happens along fold curves, as far as the axis of A shows it.
fn computed<'s>(subject: &Subject<'s>, y: &'s Axis, wanted: &str) -> impl Iterator<Item = &'s CurvePoint> {
    events_of(subject.curves, wanted).into_iter().filter(|point| y.shows(point.forcing))
}

/// Frequencies that the figure is drawn around: of branches apart from the main ones, of windows that led to nothing, and of what
/// happens beside the levels; of folds, thresholds and what happens elsewhere as far as they lie beside these. Without any, of all
/// of them.
fn frequencies(subject: &Subject<'_>, y: &Axis, thresholds: impl Iterator<Item = f64>) -> Vec<f64> {
    let (low, high) = super::axis::bounds(subject.levels.iter().map(|level| level.value));
    let is_beside = |forcing: &f64| (low / AMONG.0..=high * AMONG.1).contains(forcing);
    // Main and open branches go from one end of the frequencies to the other.
    let detached = subject.levels.iter().flat_map(Level::others).filter(|other| other.kind != BranchKind::Open.name());
    let ends = detached.flat_map(|other| [other.omega.0, other.omega.1]);
    let computed = || EVENTS.iter().flat_map(|words| computed(subject, y, words.kind.name()));
    let predicted = subject.backbone.into_iter().chain(subject.further).flat_map(|backbone| &backbone.events);
    let events = computed().map(|point| (point.forcing, point.omega));
    let events = events.chain(predicted.map(|event| (event.threshold, event.omega)));
    let missed = windows(subject, is_missed).flat_map(|(_, window)| [window.omega.0, window.omega.1]);
    let core = events.filter(|(forcing, _)| is_beside(forcing)).map(|(_, omega)| omega).chain(ends);
    let core: Vec<f64> = core.chain(missed).collect();
    let folds = subject.curves.iter().flat_map(|curve| &curve.points);
    let folds = folds.filter(|point| (low..=high).contains(&point.forcing)).map(|point| point.omega);
    let beside = computed().map(|point| point.omega).chain(folds).chain(thresholds);
    if core.is_empty() {
        return beside.collect();
    }
    let (low, high) = super::axis::bounds(core.iter().copied());
    let room = BESIDE * (high - low);
    beside.map(|omega| omega.clamp(low - room, high + room)).chain(core).collect()
}

/// Thresholds along a backbone, with their frequencies.
fn points(backbone: &BackboneCurve) -> impl Iterator<Item = (f64, f64)> {
    backbone.threshold.values.iter().copied().zip(backbone.omega.values.iter().copied())
}

/// Whether a threshold is shown: about the levels, and as far beyond as something happens near them.
fn near(subject: &Subject<'_>) -> impl Fn(f64) -> bool {
    let (low, high) = super::axis::bounds(subject.levels.iter().map(|level| level.value));
    let followed = low / NEAR.0..=high * NEAR.1;
    let computed =
        EVENTS.iter().flat_map(|words| events_of(subject.curves, words.kind.name())).map(|point| point.forcing);
    let predicted = subject.backbone.into_iter().chain(subject.further).flat_map(|backbone| &backbone.events);
    let happens = computed.chain(predicted.map(|event| event.threshold)).filter(|forcing| followed.contains(forcing));
    let (low, high) = happens.fold((low / ROOM, high * ROOM), |(low, high), a| (low.min(a), high.max(a)));
    move |threshold| (low..=high).contains(&threshold)
}

/// Whether nothing was found where a window says.
fn is_missed(outcome: &WindowOutcome) -> bool {
    matches!(outcome, WindowOutcome::NotFound(_) | WindowOutcome::Elsewhere(_))
}

/// Windows of the levels with such an outcome, each with its forcing amplitude.
fn windows<'s>(
    subject: &'s Subject<'_>,
    is_wanted: fn(&WindowOutcome) -> bool,
) -> impl Iterator<Item = (f64, &'s WindowRow)> + Clone {
    let all = subject.levels.iter().flat_map(|level| level.windows.iter().map(|window| (level.value, window)));
    all.filter(move |(_, window)| is_wanted(&window.outcome))
}

/// Births are named below the curve, merges above it.
fn label(subject: &Subject<'_>, event: &Event) -> Label {
    let (word, side) = if event.kind == EventKind::Birth { (BIRTH.verb, Side::Below) } else { (MERGES, Side::Above) };
    Label {
        text: format!("{word} at {}", subject.threshold(event.threshold)),
        x: vec![Some(event.omega)],
        y: vec![Some(event.threshold)],
        color: Color::Ink,
        level: None,
        side,
    }
}
