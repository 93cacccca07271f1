//! Axes around the values that they are for.

use super::data::{Axis, Measure, Scale, Unit};
use crate::words::length_unit;

/// Decades that a logarithmic axis spans at most.
const SPAN: f64 = 40.0;
/// No axis reaches so far: a number beyond is damage.
const ABSURD: f64 = 1e100;
/// Room left beside the data, as a share of the axis.
const MARGIN: f64 = 0.05;

impl Axis {
    /// From one value to another; around it if they are the same.
    pub fn exact(title: impl Into<String>, unit: Unit, ends: (f64, f64)) -> Self {
        Self {
            name: String::new(),
            title: title.into(),
            unit,
            range: bounds([ends.0, ends.1]),
            whole: None,
            scale: Scale::Linear,
            ticks: Vec::new(),
            measure: None,
        }
    }

    /// Around values, with room beside them. A lowest value of 0 stays the end.
    pub fn around(title: impl Into<String>, unit: Unit, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = bounds(values);
        let room = MARGIN * (high - low);
        Self::exact(title, unit, (if low == 0.0 { 0.0 } else { low - room }, high + room))
    }

    /// Logarithmic, around the positive ones among values.
    pub fn logarithmic(title: impl Into<String>, unit: Unit, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = bounds(values.into_iter().filter(|&value| value > 0.0 && value < ABSURD).map(f64::log10));
        let low = low.max(high - SPAN);
        let room = MARGIN * (high - low);
        let ends = (10_f64.powf(low - room), 10_f64.powf(high + room));
        Self { scale: Scale::Log, ..Self::exact(title, unit, ends) }
    }

    /// Of frequencies of a response whose harmonic of this number is forced, rad/s.
    pub fn of_frequencies(ends: (f64, f64), harmonic: usize) -> Self {
        Self::exact(frequency(harmonic), Unit::si("rad/s"), ends).called("frequency").of(Measure::Frequency)
    }

    /// With a name for a choice.
    pub fn called(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Of this quantity.
    pub fn of(self, measure: Measure) -> Self {
        Self { measure: Some(measure), ..self }
    }

    /// Where a value lies: 0 at the lowest, 1 at the highest; NaN if it has no place.
    pub fn share(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        match self.scale {
            Scale::Log => (value / low).ln() / (high / low).ln(),
            Scale::Linear => (value - low) / (high - low),
        }
    }

    /// Whether a value lies on it.
    pub fn shows(&self, value: f64) -> bool {
        (0.0..=1.0).contains(&self.share(value))
    }

    /// Whether a curve through these values comes onto it.
    pub fn is_met_by(&self, values: impl Iterator<Item = f64>) -> bool {
        let shares = values.map(|value| self.share(value)).filter(|share| !share.is_nan());
        let (low, high) = shares.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        low <= 1.0 && high >= 0.0
    }

    /// The value at a share.
    pub fn value_at(&self, share: f64) -> f64 {
        let (low, high) = self.range;
        match self.scale {
            Scale::Log => low * (high / low).powf(share),
            Scale::Linear => low + share * (high - low),
        }
    }

    /// As the page shows it at first.
    pub fn at_first(&self) -> Self {
        Self { range: self.whole.unwrap_or(self.range), ..self.clone() }
    }

    /// Quantity and unit: `frequency ω (rad/s)`.
    pub fn heading(&self) -> String {
        match self.unit.name.as_str() {
            "" => self.title.clone(),
            unit => format!("{} ({unit})", self.title),
        }
    }
}

impl Unit {
    /// In which lengths up to this one are read best.
    pub fn of_lengths(largest: f64) -> Self {
        let (factor, name) = length_unit(largest);
        Self { name: name.into(), factor }
    }
}

/// Whether any of these points lies between axes across and up or, of a line through them, what is between two of them may.
pub fn in_sight((x, y): (&Axis, &Axis), points: &[(f64, f64)], is_line: bool) -> bool {
    let between = |ends: &[(f64, f64)]| {
        ends.iter().all(|(across, up)| !across.is_nan() && !up.is_nan())
            && x.is_met_by(ends.iter().map(|end| end.0))
            && y.is_met_by(ends.iter().map(|end| end.1))
    };
    points.iter().any(|(across, up)| x.shows(*across) && y.shows(*up)) || is_line && points.windows(2).any(between)
}

/// Largest finite number; 0 if there is none.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().filter(|value| value.abs() < ABSURD).fold(0.0, f64::max)
}

/// Lowest and highest of the finite ones among values; never equal.
pub fn bounds(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|value| value.abs() < ABSURD);
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let size = low.abs().max(high.abs());
    // Less is rounding.
    if high - low > 1e-9 * size { (low, high) } else { (low - 0.05 * size.max(1e-15), high + 0.05 * size.max(1e-15)) }
}

/// What the frequency is called of a response whose harmonic of this number is forced, in words.
pub fn frequency(harmonic: usize) -> String {
    if harmonic == 1 {
        "frequency ω".into()
    } else {
        format!("frequency ω of the response, 1/{harmonic} of the force's")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whose_frequency_it_is() {
        let heading = |harmonic| Axis::of_frequencies((1.0, 2.0), harmonic).heading();
        assert_eq!(
            [heading(1), heading(3)],
            ["frequency ω (rad/s)", "frequency ω of the response, 1/3 of the force's (rad/s)"]
        );
    }

    #[test]
    fn an_axis_around_one_value_has_a_length() {
        let none = Unit::none;
        for axis in [
            Axis::around("", none(), [5.0]),
            Axis::around("", none(), [0.0]),
            Axis::around("", none(), []),
            Axis::logarithmic("", none(), [3.0]),
            Axis::around("", none(), [f64::NAN, 1e300]),
        ] {
            let (low, high) = axis.range;
            assert!(high > low && axis.share(low) == 0.0 && axis.share(high) == 1.0, "{axis:?}");
        }
    }

    #[test]
    fn a_curve_may_cross_an_axis_between_its_points() {
        let axis = Axis::exact("", Unit::none(), (1.0, 2.0));
        let met = |values: &[f64]| axis.is_met_by(values.iter().copied());
        assert_eq!(
            [met(&[0.5, 1.5]), met(&[0.5, 2.5]), met(&[0.5, f64::NAN, 0.9]), met(&[])],
            [true, true, false, false]
        );
        assert!(axis.shows(2.0) && !axis.shows(2.1) && !axis.shows(f64::NAN));
    }

    #[test]
    fn a_line_may_cross_a_frame_that_none_of_its_points_is_in() {
        let axis = Axis::exact("", Unit::none(), (1.0, 2.0));
        let seen = |points: &[(f64, f64)], is_line| in_sight((&axis, &axis), points, is_line);
        let across = [(0.0, 1.5), (3.0, 1.5)];
        assert_eq!([seen(&across, true), seen(&across, false)], [true, false]);
        assert!(seen(&[(1.5, 1.5)], false));
        // Neither beside the frame nor across a gap.
        assert!(!seen(&[(3.0, 0.0), (4.0, 3.0)], true));
        assert!(!seen(&[(0.0, 1.5), (f64::NAN, f64::NAN), (3.0, 1.5)], true));
    }

    #[test]
    fn lengths_have_units() {
        let axis = Axis::exact("amplitude of tip", Unit::of_lengths(2e-3), (0.0, 2e-3));
        assert_eq!(axis.heading(), "amplitude of tip (mm)");
    }
}
