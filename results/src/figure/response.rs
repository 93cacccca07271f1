//! Amplitude over frequency: main branches thin, isolas bold, one colour for each forcing level.

mod window;

use super::axis::in_sight;
use super::bands::bands;
use super::coincidence::Coincidence;
use super::column_store::ColumnStore;
use super::data::{Axis, Detail, Entry, Figure, Format, Kind, Label, Panel, Series, Side, Size};
use super::narrow;
use super::references::{backbone_series, further_backbone, further_within, touch_labels, touches};
use super::smooth::smooth;
use super::special::{mark, special_points, word};
use super::stability::Marking;
use super::style::{BOLD, Color, FINE, MEDIUM, Style, THIN};
use super::subject::{BackboneColumns, Subject, level_colors};
use crate::curves::{Beyond, Curve};
use solver::response::branch::{BranchKind, SpecialKind};
use solver::response::columns;

/// Peaks and folds are marked while there are so few branches.
pub const FEW: usize = 24;
/// Of more isolas, thin lines show more.
const CROWD: usize = 40;
/// Levels whose isolas are named before their main branches, and both before other levels.
const AT_ONCE: usize = 8;
/// So few levels have labels each.
const ALL_NAMED: usize = 4;
/// Branches with labels at most.
const LABELLED: usize = 40;
/// The figure.
///
/// # Errors
/// If there is no branch: in words.
pub fn figure(
    subject: &Subject<'_>,
    columns: &mut ColumnStore,
    backbone: Option<&BackboneColumns>,
) -> Result<Figure, String> {
    if subject.branches.is_empty() {
        let otherwise = match (subject.is_finished, subject.harmonic) {
            (false, _) => "no branch of these levels has been computed yet".into(),
            (true, 1) => "no branch was found at these levels".into(),
            (true, order) => format!("no motions of {order} periods of the force were found at these levels"),
        };
        return Err(subject.nothing("the branch", &otherwise));
    }
    let colors = level_colors(subject.levels.len());
    let has_marks = subject.branches.len() <= FEW;
    let marking = Marking::of(subject.branches.iter());
    let outline = Outline::new(subject.branches.iter(), subject, &colors);
    let outline = outline.with_marks(has_marks).marked(marking);
    let mut figure = outline.figure(backbone);
    let mut is_any_thinner = false;
    let is_crowded = is_crowd(subject.branches.iter().filter(|branch| branch.kind != "main").count());
    let mut marks = Vec::new();
    let panel = &mut figure.panels[0];
    let axes = (panel.x[0].clone(), panel.y.clone());
    let series = &mut panel.series;
    let further = further_within(subject, (&axes.0, &axes.1));
    series.extend(further.map(|further| further_backbone(further, columns)));
    // What a lower level has lies inside of what a higher one has.
    let mut order: Vec<usize> = (0..subject.branches.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(subject.branches[i].level));
    for i in order {
        let branch = &subject.branches[i];
        let amplitude = subject.levels.get(branch.level).map_or("", |level| &level.amplitude);
        let color = colors.get(branch.level).copied().unwrap_or_default();
        let own = branch_series(branch, amplitude, color, is_crowded, columns);
        let name = outline.same.names(&outline.branches, i).iter().map(|own| called(amplitude, own)).collect();
        let mut curve = Series { branch: Some(i), name, ..own };
        is_any_thinner |= make_room(&mut curve, branch, (&axes.0, &axes.1[0]));
        let heights: Vec<&[f64]> = branch.amplitude.iter().map(|column| column.values.as_slice()).collect();
        smooth(&mut curve, (&branch.omega.values, &heights), (&axes.0, &axes.1), columns);
        let veiled = |series| outline.same.veiled(i, series);
        if has_marks {
            marks.extend(special_points(branch, &curve, color).map(veiled));
        }
        let over = marking.over(branch, &curve, (&axes.0, &axes.1), columns);
        let bands = bands(branch, &curve, color, columns);
        series.extend(bands.into_iter().chain([curve]).chain(over).map(veiled));
    }
    series.append(&mut marks);
    if is_any_thinner {
        say_thinner(&mut figure);
    }
    Ok(figure)
}

/// Says that lines of some isolas are thinner than others.
pub fn say_thinner(figure: &mut Figure) {
    let isolas = figure.legend.iter_mut().filter(|entry| entry.text == BranchKind::Isola.name());
    isolas.for_each(|entry| entry.text += ", thinner where narrow");
}

/// All of the figure but the curves of its branches: axes, backbone, lines across, labels.
#[derive(Debug)]
pub struct Outline<'r> {
    branches: Vec<&'r Curve>,
    subject: &'r Subject<'r>,
    colors: &'r [Color],
    has_marks: bool,
    marking: Marking,
    same: Coincidence,
}

impl<'r> Outline<'r> {
    /// Of these branches of a subject.
    pub fn new(branches: impl Iterator<Item = &'r Curve>, subject: &'r Subject<'r>, colors: &'r [Color]) -> Self {
        let branches: Vec<&'r Curve> = branches.collect();
        let marking = Marking::growing(branches.iter().copied());
        let same = Coincidence::of(&branches, subject.monitors.len());
        Self { branches, subject, colors, has_marks: false, marking, same }
    }

    /// With what is known of the stability of branches that are all there.
    fn marked(self, marking: Marking) -> Self {
        Self { marking, ..self }
    }

    /// Whether peaks and folds are marked.
    pub fn with_marks(self, has_marks: bool) -> Self {
        Self { has_marks, ..self }
    }

    /// The figure with the backbone alone.
    pub fn figure(&self, backbone: Option<&BackboneColumns>) -> Figure {
        let (across, up) = (self.frequencies(), self.amplitudes());
        let of_further = backbone.map_or(0, |_| further_within(self.subject, (&across, &up)).count());
        let backbones = of_further + usize::from(backbone.is_some() && self.has_backbone_in_sight((&across, &up)));
        let panel = Panel {
            about: "Forced response: amplitude over frequency. Arrow keys go from point to point, Enter selects one.",
            size: Size::Tall,
            x: vec![across],
            y: up,
            series: backbone.map(backbone_series).unwrap_or_default(),
            spans: touches(self.subject.monitors).into_iter().collect(),
            labels: self.labels(),
            has_leaders: true,
            ..Panel::default()
        };
        Figure {
            name: "response",
            title: None,
            columns: 1,
            choice: "Amplitude of",
            linked_x: false,
            legend: self.legend(backbones, &panel.x[0]),
            panels: vec![panel],
        }
    }

    /// Whether the backbone comes into the frame, as the page shows it at first, of any of the monitored dofs.
    fn has_backbone_in_sight(&self, (across, up): (&Axis, &[Axis])) -> bool {
        let Some(backbone) = self.subject.backbone else { return false };
        let across = across.at_first();
        backbone.amplitude.iter().zip(up).any(|(amplitude, up)| {
            let points = backbone.omega.values.iter().copied().zip(amplitude.values.iter().copied());
            in_sight((&across, &up.at_first()), &points.collect::<Vec<_>>(), true)
        })
    }

    fn legend(&self, backbones: usize, frequencies: &Axis) -> Vec<Entry> {
        let color = self.colors.last().copied().unwrap_or_default();
        let has = |kind: BranchKind| self.branches.iter().any(|branch| branch.kind == kind.name());
        let marked = |wanted| {
            self.has_marks
                && self.branches.iter().any(|branch| branch.special.iter().any(|special| special.kind == wanted))
        };
        let line = Kind::Line;
        let is_cut = self.branches.iter().any(|branch| self.is_beyond(branch));
        let open = if is_cut { "open branch, also above what is shown" } else { "open branch" };
        let main = if self.has_peaks_beyond(frequencies) {
            "main branch, peaks also beyond what is shown"
        } else {
            "main branch"
        };
        let branches = [
            (has(BranchKind::Main), main, line, Style::line(color, THIN)),
            (has(BranchKind::Isola), "isola", line, Style::line(color, BOLD)),
            (has(BranchKind::Open), open, line, Style::line(color, BOLD)),
            (has(BranchKind::Cut), "cut off by a bound", line, Style::line(color, BOLD)),
            (has(BranchKind::Branched), "branches off another", line, Style::line(color, MEDIUM)),
            (has(BranchKind::Unfinished), "unfinished", line, Style::line(color, BOLD)),
        ];
        let backbone = if backbones > 1 { "backbones" } else { "backbone" };
        let others = [
            (
                self.branches.iter().any(|branch| branch.beyond.iter().any(Beyond::is_shown)),
                "what unstable motions turn into",
                Kind::Band,
                Style::area(Color::Shade),
            ),
            (backbones > 0, backbone, line, Style::line(Color::Soft, FINE).with_dash(1)),
            (marked(SpecialKind::Peak), "peak", line, mark(SpecialKind::Peak, color)),
            (marked(SpecialKind::Fold), "fold", line, mark(SpecialKind::Fold, color)),
        ];
        type Candidate<'c> = (bool, &'c str, Kind, Style);
        let shown = |(is_shown, text, kind, style): Candidate<'_>| is_shown.then(|| Entry::new(text, kind, style));
        let branches = self.scale().into_iter().chain(branches.into_iter().filter_map(shown));
        branches.chain(self.marking.entries(color)).chain(others.into_iter().filter_map(shown)).collect()
    }

    /// Which colours the lowest and the highest level have, where there are so many that some may have no label: those between follow in their
    /// order.
    fn scale(&self) -> Vec<Entry> {
        let mut levels: Vec<usize> = self.branches.iter().map(|branch| branch.level).collect();
        levels.sort_unstable();
        levels.dedup();
        if levels.len() <= ALL_NAMED {
            return Vec::new();
        }
        let entry = |level: Option<&usize>, which: &str| {
            let level = *level?;
            let amplitude = &self.subject.levels.get(level)?.amplitude;
            let style = Style::line(self.colors.get(level).copied().unwrap_or_default(), BOLD);
            Some(Entry::new(format!("A = {amplitude}, the {which} of {} levels", levels.len()), Kind::Line, style))
        };
        [entry(levels.first(), "lowest"), entry(levels.last(), "highest")].into_iter().flatten().collect()
    }

    /// The gap, then branches at their peaks: isolas before main branches, the highest level, the lowest one, and those
    /// between as far as there is room.
    fn labels(&self) -> Vec<Label> {
        let monitors = self.subject.monitors;
        let mut levels: Vec<usize> = self.branches.iter().map(|branch| branch.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let levels = spread(&levels);
        let of_kind = |levels: &[usize], is_main| levels.iter().map(move |level| (is_main, *level)).collect::<Vec<_>>();
        let kinds = levels.chunks(AT_ONCE).flat_map(|levels| [of_kind(levels, false), of_kind(levels, true)].concat());
        let of = |(is_main, level)| {
            let is_wanted = move |branch: &Curve| (branch.kind == "main") == is_main && branch.level == level;
            (0..self.branches.len()).filter(move |&i| is_wanted(self.branches[i]))
        };
        let labels = |i: usize| {
            let branch = self.branches[i];
            let peak = |m: usize| crate::curves::largest(&branch.amplitude[m].values);
            let level = self.subject.levels.get(branch.level);
            let forcing = format!("A = {}", level.map_or("", |level| &level.amplitude));
            let names = self.same.names(&self.branches, i);
            let mut different = names.clone();
            different.dedup();
            // It may lie on others where one dof is looked at, and not where another one is.
            let label = move |name: String| {
                let is_so = |m: usize| !self.same.is_hidden(i, m) && names[m] == name;
                let height = |m: usize| branch.amplitude[m].values.get(peak(m)).copied().filter(|_| is_so(m));
                Label {
                    text: if branch.kind == "main" { forcing.clone() } else { format!("{name}, {forcing}") },
                    x: (0..monitors.len()).map(|m| branch.omega.values.get(peak(m)).copied()).collect(),
                    y: (0..monitors.len()).map(height).collect(),
                    color: self.colors.get(branch.level).copied().unwrap_or_default(),
                    level: Some(branch.level),
                    side: Side::Above,
                }
            };
            different.into_iter().map(label).filter(|label| label.y.iter().any(Option::is_some))
        };
        touch_labels(monitors).into_iter().chain(kinds.flat_map(of).flat_map(labels).take(LABELLED)).collect()
    }
}

/// The order in which levels are named: last, first, middle, quarters, …
fn spread(levels: &[usize]) -> Vec<usize> {
    let count = levels.len();
    let mut order: Vec<usize> = if count > 1 { vec![count - 1, 0] } else { (0..count).collect() };
    let mut parts = 2;
    while order.len() < count {
        for place in (1..parts).map(|k| k * count / parts) {
            if !order.contains(&place) {
                order.push(place);
            }
        }
        parts *= 2;
    }
    order.into_iter().map(|place| levels[place]).collect()
}

/// A branch as a curve, with what is said of its points.
pub fn branch_series(
    branch: &Curve,
    amplitude: &str,
    color: Color,
    is_crowded: bool,
    store: &mut ColumnStore,
) -> Series {
    let omega = store.add(branch.omega.clone());
    let y = store.add_all(&branch.amplitude);
    let mut details = vec![Detail::new("frequency", Format::Frequency, 6, &omega)];
    for column in columns::of_points() {
        let known = || branch.other(column.name).filter(|quantity| quantity.is_known());
        let values =
            if column.name == "amplitude" { Some(y.clone()) } else { known().map(|q| store.add_all(&q.values)) };
        details.extend(values.and_then(|values| Detail::of(column, values)));
    }
    let is_main = branch.kind == "main";
    let is_loop = !is_main && branch.closed;
    let width = match branch.kind {
        _ if is_main || is_crowded => THIN,
        kind if kind == BranchKind::Branched.name() => MEDIUM,
        _ => BOLD,
    };
    Series {
        kind: if is_loop { Kind::Closed } else { Kind::Line },
        name: vec![called(amplitude, &branch.name)],
        x: vec![omega],
        y,
        style: Style { fill: is_loop && !is_crowded, ..Style::line(color, width) },
        level: Some(branch.level),
        marks: branch.special.iter().map(|special| (special.index, word(special.kind))).collect(),
        details,
        ..Series::default()
    }
}

/// Makes the line of a closed curve thinner if it is narrow; whether it was.
pub fn make_room(curve: &mut Series, branch: &Curve, axes: (&Axis, &Axis)) -> bool {
    let heights = branch.amplitude.first().map_or(&[][..], |column| &column.values);
    let full = curve.style.width;
    if curve.kind == Kind::Closed {
        curve.style.width = narrow::width((&branch.omega.values, heights), axes, (full, FINE));
    }
    curve.style.width < full
}

/// What branches of a level are called where their points are looked at.
pub fn called(amplitude: &str, names: &str) -> String {
    format!("A = {amplitude}, {names}")
}

/// Whether so many isolas are drawn thin and empty.
pub fn is_crowd(isolas: usize) -> bool {
    isolas > CROWD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_named_evenly() {
        assert_eq!(spread(&[3, 5, 8, 9, 11]), [11, 3, 8, 5, 9]);
        assert_eq!([spread(&[]), spread(&[7]), spread(&[7, 9])], [vec![], vec![7], vec![9, 7]]);
    }
}
