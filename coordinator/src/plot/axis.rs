//! Axes with numbers at round values.

use super::style::{INK, LABEL, TICK, TITLE, escaped, text};
use plotive::des;
use plotive::des::annot::{Anchor, Label, plot};
use plotive::des::axis::ticks::{DecimalFormatter, ListLocator, MinorTicks, Ticks};
use plotive::des::axis::{LogScale, Range};
use plotive::text::TextProps;

/// Height of a line of text, in ems.
const LINE: f32 = 1.36;
/// Ticks with numbers on an axis, about.
const COUNT: f64 = 6.0;
/// Decades with numbers on a logarithmic axis at most.
const DECADES: usize = 8;
/// Decades that a logarithmic axis spans at most.
const SPAN: f64 = 40.0;
/// No axis reaches so far: a number beyond is damage.
const ABSURD: f64 = 1e100;
/// Room left beside the data, as a share of the axis.
const MARGIN: f64 = 0.05;

/// An axis from a lowest to a highest value.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity and unit.
    pub title: String,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    is_log: bool,
    has_numbers: bool,
}

impl Axis {
    /// From one value to another; around it if they are the same.
    pub fn exact(title: impl Into<String>, ends: (f64, f64)) -> Self {
        let (low, high) = bounds([ends.0, ends.1]);
        Self { title: title.into(), low, high, is_log: false, has_numbers: true }
    }

    /// Around values, with room beside them. A lowest value of 0 stays the end.
    pub fn around(title: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = bounds(values);
        let room = MARGIN * (high - low);
        Self::exact(title, (if low == 0.0 { 0.0 } else { low - room }, high + room))
    }

    /// Logarithmic, around the positive ones among values.
    pub fn logarithmic(title: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = bounds(values.into_iter().filter(|&value| value > 0.0 && value < ABSURD).map(f64::log10));
        let low = low.max(high - SPAN);
        let room = MARGIN * (high - low);
        let ends = (10_f64.powf(low - room), 10_f64.powf(high + room));
        Self { is_log: true, ..Self::exact(title, ends) }
    }

    /// Without title and numbers: those of the panel below hold.
    pub fn bare(&self) -> Self {
        Self { title: String::new(), has_numbers: false, ..self.clone() }
    }

    /// Whether it is logarithmic.
    pub fn is_log(&self) -> bool {
        self.is_log
    }

    /// Where a value lies: 0 at the lowest, 1 at the highest; NaN if it has no place.
    pub fn share(&self, value: f64) -> f64 {
        if self.is_log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The axis as plotive takes it. Numbers of a logarithmic one are [`Axis::numbers`].
    pub fn design(&self) -> des::Axis {
        let range = Range::from((self.low, self.high));
        let axis = des::Axis::new();
        let (values, decimals) = if self.is_log { (self.decades(), 0) } else { self.round() };
        let ticks =
            Ticks::from(ListLocator(values)).with_label_props(TextProps { size: Some(TICK), ..Default::default() });
        let axis = if self.is_log {
            let axis = axis.with_scale(LogScale::new(10.0, range).into()).with_ticks(ticks.with_formatter(None));
            if self.inside(&[1]).len() > DECADES { axis } else { axis.with_minor_ticks(MinorTicks::new()) }
        } else {
            let format = self.has_numbers.then(|| DecimalFormatter { decimal_places: Some(decimals) }.into());
            axis.with_scale(range.into()).with_ticks(ticks.with_formatter(format))
        };
        if self.title.is_empty() { axis } else { axis.with_title(self.design_title()) }
    }

    /// plotive writes 0.001 as 1.00e-3 and takes no other text, so the numbers of a logarithmic axis are labels; an
    /// empty second line of the title keeps their room.
    fn design_title(&self) -> des::Text {
        let title = escaped(&self.title);
        let widths = self.texts().into_iter().map(|(_, text)| 0.4 + text.chars().map(width).sum::<f32>());
        let widest = widths.fold(0.0, f32::max);
        let room = if widest > 0.0 { format!("\n[size={}]\u{a0}[/size]", widest * TICK / LINE) } else { String::new() };
        des::Text::Rich(format!("[size={TITLE}]{title}[/size]{room}"))
    }

    /// The numbers of a logarithmic axis on the left.
    pub fn numbers(&self) -> Vec<des::Annotation> {
        let number = |(value, number): (f64, String)| {
            let beside = format!("{number}\u{a0}\u{a0}\u{a0}");
            Label::new(text(&beside, TICK, INK), plot(0.0), value).with_anchor(Anchor::CenterRight).into()
        };
        self.texts().into_iter().map(number).collect()
    }

    /// The numbers of a logarithmic axis, if it has them, as they are written: all decimal, or all powers of ten.
    fn texts(&self) -> Vec<(f64, String)> {
        if !(self.is_log && self.has_numbers) {
            return Vec::new();
        }
        let values = self.decades();
        let is_plain = values.iter().all(|value| (0.9e-3..1e5).contains(value));
        let write = if is_plain { decimal } else { scientific };
        values.into_iter().map(|value| (value, write(value))).collect()
    }

    /// Round values and their number of decimals.
    fn round(&self) -> (Vec<f64>, usize) {
        let rough = (self.high - self.low) / COUNT;
        let decade = rough.log10().floor() as i32;
        let factor = [1, 2, 5, 10].into_iter().find(|&f| f64::from(f) * power(decade) >= 0.999 * rough).unwrap_or(10);
        let step = f64::from(factor) * power(decade);
        let slack = 1e-9 * (self.high - self.low);
        let first = ((self.low - slack) / step).ceil() as i64;
        let last = ((self.high + slack) / step).floor() as i64;
        let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
        ((first..=last).map(|n| n as f64 * step).collect(), decimals)
    }

    fn inside(&self, factors: &[i32]) -> Vec<f64> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let values = (first..=last).flat_map(|exponent| factors.iter().map(move |&f| f64::from(f) * power(exponent)));
        values.filter(|value| (self.low..=self.high).contains(value)).collect()
    }

    /// Where a logarithmic axis has numbers.
    fn decades(&self) -> Vec<f64> {
        let decades = self.inside(&[1]);
        match decades.len() {
            0..=1 => self.inside(&[1, 2, 5]),
            2..=3 => self.inside(&[1, 3]),
            n => decades.into_iter().rev().step_by(n.div_ceil(DECADES)).collect(),
        }
    }
}

/// A power of ten, exactly the number that is written 1e…
fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// Lowest and highest of the finite ones among values; never equal.
fn bounds(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|value| value.abs() < ABSURD);
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let size = low.abs().max(high.abs());
    // Less is rounding.
    if high - low > 1e-9 * size { (low, high) } else { (low - 0.05 * size.max(1e-9), high + 0.05 * size.max(1e-9)) }
}

/// A number with one leading digit: 0.05, 200.
fn decimal(value: f64) -> String {
    let exponent = (value * 1.001).log10().floor() as i32;
    format!("{value:.*}", (-exponent).max(0) as usize)
}

/// A number with one leading digit: 10⁻⁶, 2·10⁷.
fn scientific(value: f64) -> String {
    let exponent = (value * 1.001).log10().floor() as i32;
    let leading = (value / power(exponent)).round();
    let digit = |c: char| {
        if c == '-' {
            '⁻'
        } else {
            ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c as usize - '0' as usize]
        }
    };
    let raised: String = exponent.to_string().chars().map(digit).collect();
    if leading == 1.0 { format!("10{raised}") } else { format!("{leading}·10{raised}") }
}

/// Width of a character of a number in ems, about.
fn width(c: char) -> f32 {
    match c {
        '0'..='9' => 0.58,
        '.' | '·' => 0.28,
        _ => 0.37,
    }
}

/// How high a line of labels is.
pub fn line_height() -> f32 {
    LINE * LABEL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_at_round_values() {
        let (values, decimals) = Axis::exact("", (2273.0, 2554.0)).round();
        assert_eq!((values, decimals), (vec![2300.0, 2350.0, 2400.0, 2450.0, 2500.0, 2550.0], 0));
        let (values, decimals) = Axis::exact("", (0.9995, 1.0006)).round();
        assert_eq!((values.len(), decimals), (6, 4));
        assert_eq!(Axis::exact("", (0.0, 0.3)).round().1, 2);
    }

    #[test]
    fn numbers_of_logarithmic_axes() {
        let texts = |axis: Axis| axis.texts().into_iter().map(|(_, text)| text).collect::<Vec<String>>();
        assert_eq!(texts(Axis::logarithmic("", [0.005, 0.04, -1.0])), ["0.005", "0.01", "0.02"]);
        assert_eq!(texts(Axis::logarithmic("", [1e-8, 1.0])), ["10⁰", "10⁻²", "10⁻⁴", "10⁻⁶", "10⁻⁸"]);
        assert_eq!([scientific(2e7), decimal(300.0)], ["2·10⁷", "300"]);
    }

    #[test]
    fn an_axis_around_one_value_has_a_length() {
        for axis in
            [Axis::around("", [5.0]), Axis::around("", [0.0]), Axis::around("", []), Axis::logarithmic("", [3.0])]
        {
            assert!(axis.high > axis.low && axis.share(axis.low) == 0.0 && axis.share(axis.high) == 1.0, "{axis:?}");
        }
    }
}
