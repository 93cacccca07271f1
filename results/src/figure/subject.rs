//! What figures are drawn from, and how quantities are named.

use super::axis::largest;
use super::column_store::{ColumnStore, Ref};
use super::data::{Axis, Detail, Format, Measure, Unit};
use super::style::Color;
use crate::curves::{BackboneCurve, Column, Curve, Monitor, Motions, ResonanceComparison};
use crate::overview::{Level, told_threshold};
use crate::store::CurveRow;
use solver::response::columns;

/// What there is of a run.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'r> {
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// Branches of these levels.
    pub branches: &'r [Curve],
    /// Monitored dofs.
    pub monitors: &'r [Monitor],
    /// What A = 1 is, as axes have it; empty where that takes more words.
    pub forcing_unit: &'r str,
    /// Whether nothing is still to come.
    pub is_finished: bool,
    /// The harmonic of the response that is forced.
    pub harmonic: usize,
    /// The backbone that figures are about, once it is known.
    pub backbone: Option<&'r BackboneCurve>,
    /// The backbones of other modes.
    pub further: &'r [BackboneCurve],
    /// Fold curves.
    pub curves: &'r [CurveRow],
    /// Lowest and highest frequency of the sweep, rad/s.
    pub sweep: Option<(f64, f64)>,
    /// The largest response over the forcing.
    pub resonance: &'r ResonanceComparison,
    /// Motions at chosen points.
    pub motions: &'r Motions,
    /// What is missing, in sentences.
    pub missing: &'r [String],
}

/// The backbone with its columns.
#[derive(Debug, Clone)]
pub struct BackboneColumns {
    /// Frequency.
    pub omega: Ref,
    /// Amplitude of every monitored dof.
    pub amplitude: Vec<Ref>,
    /// Arc length.
    pub arc: Ref,
    /// Work that the forcing has to do.
    pub needed: Ref,
    /// Its work per unit of A.
    pub work: Ref,
    /// Threshold A*.
    pub threshold: Ref,
    decay: Ref,
    contact: Option<Ref>,
    linear: Ref,
    nonlinear: Ref,
    certificate: Ref,
    /// What is said of the columns that were added later.
    later: Vec<Detail>,
}

impl<'r> Subject<'r> {
    /// The backbone.
    ///
    /// # Errors
    /// If there is none yet, or if it cannot be read: in words.
    pub fn backbone(&self) -> Result<&'r BackboneCurve, String> {
        self.backbone.ok_or_else(|| self.nothing("the backbone", "the run has no backbone yet"))
    }

    /// How many points of a backbone figures show at first: up to where levels come near it. Beyond the last threshold of twice the
    /// highest level nothing is predicted for any of them.
    pub fn shown(&self, backbone: &BackboneCurve) -> usize {
        let thresholds = &backbone.threshold.values;
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let last = thresholds.iter().rposition(|threshold| *threshold <= NEAR * highest);
        last.filter(|last| *last >= FEWEST).map_or(thresholds.len(), |last| last + 1)
    }

    /// A threshold A* as on labels.
    pub fn threshold(&self, threshold: f64) -> String {
        told_threshold(threshold, self.levels.iter().map(|level| level.value))
    }

    /// Why there is nothing to draw: what would be drawn is damaged, or is not there for another reason.
    pub fn nothing(&self, what: &str, otherwise: &str) -> String {
        let left_out = |sentence: &&String| sentence.to_lowercase().starts_with(what) && sentence.contains("left out");
        self.missing.iter().find(left_out).map_or(otherwise, String::as_str).into()
    }

    /// The level to look at first: the lowest at which a window led to an isola of its frequencies, else the lowest with an isola, else the middle one.
    pub fn first_level(&self) -> Option<usize> {
        let predicted = self.levels.iter().position(|level| level.mode_of_isola().is_some());
        let with_isola = || self.levels.iter().position(|level| level.others().next().is_some());
        let level = predicted.or_else(with_isola).unwrap_or(self.levels.len() / 2);
        (level < self.levels.len()).then_some(level)
    }

    /// Axes of the amplitude of every monitored dof, each up to the largest of its values.
    pub fn amplitudes<V: IntoIterator<Item = f64>>(&self, values: impl Fn(usize) -> V) -> Vec<Axis> {
        let axis = |(m, monitor): (usize, &Monitor)| {
            let largest = largest(values(m));
            let title = format!("amplitude of {}", monitor.name);
            let axis = Axis::exact(title, Unit::of_lengths(largest), (0.0, 1.08 * largest));
            axis.called(&monitor.name).of(Measure::Response)
        };
        self.monitors.iter().enumerate().map(axis).collect()
    }
}

/// Backbones are shown up to this many times the highest level.
const NEAR: f64 = 2.0;
/// With fewer points a piece of a backbone says nothing: all of it is shown.
const FEWEST: usize = 4;

/// Colours of so many levels, evenly in their order: those that lie close together are told apart as well.
pub fn level_colors(count: usize) -> Vec<Color> {
    let share = |place: usize| if count > 1 { place as f64 / (count - 1) as f64 } else { 1.0 };
    (0..count).map(|place| Color::Level(share(place))).collect()
}

impl BackboneColumns {
    /// Puts the columns of a backbone into a store.
    pub fn new(backbone: &BackboneCurve, columns: &mut ColumnStore) -> Self {
        let touches = backbone.contact.values.iter().any(|share| share.is_finite());
        Self {
            omega: columns.add(backbone.omega.clone()),
            amplitude: columns.add_all(&backbone.amplitude),
            arc: columns.add(backbone.arc.clone()),
            needed: columns.add(backbone.needed.clone()),
            work: columns.add(backbone.work.clone()),
            threshold: columns.add(backbone.threshold.clone()),
            decay: columns.add(backbone.decay.clone()),
            contact: touches.then(|| columns.add(backbone.contact.clone())),
            linear: columns.add(backbone.r_lin.clone()),
            nonlinear: columns.add(backbone.r_nl.clone()),
            certificate: columns.add(backbone.certificate.clone()),
            later: backbone.later.iter().filter_map(|q| Detail::of(q.about, columns.add_all(&q.values))).collect(),
        }
    }

    /// All that is known of a point of the backbone.
    pub fn details(&self) -> Vec<Detail> {
        use Format::{Energy, Frequency, Length, Rate};
        let row = Detail::new;
        let listed =
            |name, column: &Ref| columns::named(name).and_then(|about| Detail::of(about, vec![column.clone()]));
        let mut rows = vec![
            row("frequency", Frequency, 6, &self.omega),
            Detail { values: self.amplitude.clone(), ..row("amplitude", Length, 4, &self.omega) },
        ];
        rows.extend(listed("threshold", &self.threshold));
        rows.extend(listed("r_lin", &self.linear));
        rows.extend(listed("r_nl", &self.nonlinear));
        rows.push(row("to be supplied", Energy, 4, &self.needed));
        rows.push(row("A·W", Energy, 4, &self.work.by_amplitude()));
        rows.push(row("decay rate", Rate, 4, &self.decay));
        rows.extend(self.contact.iter().filter_map(|contact| listed("contact", contact)));
        rows.extend(listed("certificate", &self.certificate));
        rows.extend(self.later.iter().cloned());
        rows
    }

    /// What figures of the backbone may be drawn over, with its columns: arc length, frequency, amplitudes.
    pub fn over<'b>(&self, backbone: &'b BackboneCurve, subject: &Subject<'_>) -> (Vec<Axis>, Vec<Ref>) {
        let count = subject.shown(backbone);
        let values = |column: &'b Column| column.values.iter().copied().take(count);
        let across = if backbone.is_crossed() { ", then along curves beside it" } else { "" };
        let title = format!("arc length along the backbone{across} (scaled)");
        let arc = Axis::around(title, Unit::none(), values(&backbone.arc));
        let mut omega = Axis::around("", Unit::none(), values(&backbone.omega));
        omega = Axis::of_frequencies(omega.range, subject.harmonic);
        let amplitudes = subject.monitors.iter().zip(&backbone.amplitude).enumerate().map(|(m, (monitor, column))| {
            let unit = Unit::of_lengths(largest(values(column)));
            let name = if m == 0 { "amplitude".into() } else { format!("amplitude of {}", monitor.name) };
            Axis::around(format!("amplitude of {}", monitor.name), unit, values(column)).called(name)
        });
        let axes = [arc.called("arc length"), omega].into_iter().chain(amplitudes).collect();
        let columns = [&self.arc, &self.omega].into_iter().chain(&self.amplitude).cloned().collect();
        (axes, columns)
    }
}

impl Detail {
    /// A line with one column.
    pub fn new(label: &'static str, format: Format, digits: u8, column: &Ref) -> Self {
        Self { label, format, unit: "", digits, values: vec![column.clone()] }
    }

    /// A line of a column of the solver's list, with its numbers; `None` if it is shown nowhere.
    pub fn of(about: &columns::Column, values: Vec<Ref>) -> Option<Self> {
        let hover = about.hover?;
        let (format, unit) = match about.unit {
            _ if hover.is_percentage => (Format::Share, ""),
            "m" => (Format::Length, ""),
            "rad/s" => (Format::Frequency, ""),
            "1/s" => (Format::Rate, ""),
            "J" | "J a period" => (Format::Energy, ""),
            unit => (Format::Number, unit),
        };
        Some(Self { label: hover.label, format, unit, digits: hover.digits, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::columns::{Axis as Along, Column};

    #[test]
    fn a_unit_that_has_no_format_follows_the_number() {
        let detail = |unit| {
            let column = Column::new("name", unit, Along::Point, "meaning").hover("label", 4);
            let detail = Detail::of(&column, vec![Ref::to(0)]).unwrap();
            (detail.format, detail.unit, detail.digits)
        };
        assert_eq!(detail("m"), (Format::Length, "", 4));
        assert_eq!(detail("m/s"), (Format::Number, "m/s", 4));
        let share = Column::new("name", "", Along::Contacts, "meaning").percentage("label", 3);
        assert_eq!(Detail::of(&share, vec![]).unwrap().format, Format::Share);
        assert_eq!(Detail::of(&Column::new("name", "m", Along::Point, "meaning"), vec![]), None);
    }
}
