//! Where an axis has ticks, and what is written at them.

use super::sizes::TICK;
use crate::figure::{Axis, Scale};
use crate::words::{decimal, power, scientific};

/// Ticks with numbers on an axis, at most and at least.
const COUNTS: (usize, usize) = (8, 2);
/// Space between numbers, px: across and up.
const SPACE: (f64, f64) = (14.0, 11.0);
/// Fewer numbers on a logarithmic axis than these have others between them.
const FEW: usize = 3;
/// Decades that an axis with finer ticks spans at most.
const DECADES: usize = 8;

/// A tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Where, as a share of the axis.
    pub share: f64,
    /// What is written there; nothing at fine ones.
    pub text: Option<String>,
}

/// The ticks of an axis so long, px, as many as have room; a number across takes so much room as `width` says.
pub fn ticks(axis: &Axis, length: f64, width: Option<&dyn Fn(&str) -> f64>) -> Vec<Tick> {
    let counts = (COUNTS.1..=COUNTS.0).rev();
    let mut tried = counts.map(|count| some(axis, count));
    // Of names more are left out, if need be all but the first.
    let fewer = (2..=axis.ticks.len()).map(|stride| named(axis, stride));
    let fewest = some(axis, COUNTS.1);
    tried.by_ref().chain(fewer).find(|ticks| has_room(ticks, length, width)).unwrap_or(fewest)
}

/// Whether the numbers of ticks stay apart.
fn has_room(ticks: &[Tick], length: f64, width: Option<&dyn Fn(&str) -> f64>) -> bool {
    let mut numbers: Vec<(f64, f64)> = ticks
        .iter()
        .filter_map(|tick| {
            let text = tick.text.as_deref()?;
            let room = width.map_or(TICK + SPACE.1, |width| width(text) + SPACE.0);
            Some((tick.share * length, 0.5 * room))
        })
        .collect();
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    numbers.windows(2).all(|pair| pair[1].0 - pair[0].0 >= pair[0].1 + pair[1].1)
}

/// About so many ticks of an axis.
fn some(axis: &Axis, count: usize) -> Vec<Tick> {
    if !axis.ticks.is_empty() {
        return named(axis, axis.ticks.len().div_ceil(2 * count).max(1));
    }
    let factor = axis.unit.factor;
    let ends = (axis.range.0 * factor, axis.range.1 * factor);
    let tick = |(value, text): (f64, Option<String>)| Tick { share: axis.share(value / factor), text };
    match axis.scale {
        Scale::Linear => round(ends, count as f64).into_iter().map(tick).collect(),
        Scale::Log => logarithmic(ends, count).into_iter().map(tick).collect(),
    }
}

/// Ticks of an axis with names, one of so many.
fn named(axis: &Axis, stride: usize) -> Vec<Tick> {
    let tick = |(at, name): &(f64, String)| Tick { share: axis.share(*at), text: Some(name.clone()) };
    axis.ticks.iter().step_by(stride).map(tick).collect()
}

/// Round values.
fn round((low, high): (f64, f64), count: f64) -> Vec<(f64, Option<String>)> {
    let rough = (high - low) / count;
    let decade = rough.log10().floor() as i32;
    let factor = [1, 2, 5, 10].into_iter().find(|&f| f64::from(f) * power(decade) >= 0.999 * rough).unwrap_or(10);
    let step = f64::from(factor) * power(decade);
    let slack = 1e-9 * (high - low);
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
    let write = |n: i64| {
        let value = n as f64 * step;
        (value, Some(format!("{value:.decimals$}").replace('-', "−")))
    };
    (first..=last).map(write).collect()
}

/// Powers of ten, and finer ones where there are few.
fn logarithmic(ends: (f64, f64), count: usize) -> Vec<(f64, Option<String>)> {
    let numbered = numbered(ends, count);
    let is_plain = numbered.iter().all(|value| (0.9e-3..1e5).contains(value));
    let write = if is_plain { decimal } else { scientific };
    let fine = if inside(ends, &[1]).len() > DECADES { Vec::new() } else { inside(ends, &[2, 3, 4, 5, 6, 7, 8, 9]) };
    let fine = fine.into_iter().filter(|value| !numbered.contains(value)).map(|value| (value, None));
    numbered.iter().map(|&value| (value, Some(write(value)))).chain(fine).collect()
}

fn numbered(ends: (f64, f64), count: usize) -> Vec<f64> {
    let decades = inside(ends, &[1]);
    match decades.len() {
        0..=1 if count > 3 => {
            let usual = inside(ends, &[1, 2, 5]);
            if usual.len() < FEW { inside(ends, &[1, 2, 3, 5, 7]) } else { usual }
        }
        2..=3 if count > 4 => inside(ends, &[1, 3]),
        0 => inside(ends, &[1, 2, 5]),
        n => decades.into_iter().rev().step_by(n.div_ceil(count.max(1))).collect(),
    }
}

fn inside((low, high): (f64, f64), factors: &[i32]) -> Vec<f64> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let values = (first..=last).flat_map(|exponent| factors.iter().map(move |&f| f64::from(f) * power(exponent)));
    values.filter(|value| (low..=high).contains(value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Unit;

    fn texts(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().filter_map(|tick| tick.text.as_deref()).collect()
    }

    /// What is written at the ticks of an axis so long, up or across.
    fn written(axis: &Axis, length: f64, is_across: bool) -> Vec<String> {
        let width = |text: &str| 6.0 * text.chars().count() as f64;
        texts(&ticks(axis, length, is_across.then_some(&width))).into_iter().map(String::from).collect()
    }

    #[test]
    fn numbers_at_round_values() {
        let axis = |ends| Axis::exact("", Unit::none(), ends);
        assert_eq!(written(&axis((2273.0, 2554.0)), 432.0, true), ["2300", "2350", "2400", "2450", "2500", "2550"]);
        assert_eq!(written(&axis((2273.0, 2554.0)), 120.0, true), ["2300", "2400", "2500"]);
        assert_eq!(written(&axis((0.0, 0.3)), 160.0, false), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]);
        assert_eq!(written(&axis((-1.0, 1.0)), 80.0, false), ["−1", "0", "1"]);
        let millimetres = Axis::exact("", Unit::of_lengths(2e-3), (0.0, 2e-3));
        assert_eq!(written(&millimetres, 120.0, false), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
    }

    #[test]
    fn names_stay_apart() {
        let names = ["leading edge", "middle", "trailing edge", "hub"].map(String::from);
        let ticks = names.into_iter().enumerate().map(|(i, name)| (i as f64, name)).collect();
        let axis = Axis { ticks, ..Axis::exact("", Unit::none(), (-0.5, 3.5)) };
        assert_eq!(written(&axis, 500.0, true), ["leading edge", "middle", "trailing edge", "hub"]);
        assert_eq!(written(&axis, 250.0, true), ["leading edge", "trailing edge"]);
        assert_eq!(written(&axis, 60.0, true), ["leading edge"]);
    }

    #[test]
    fn numbers_of_logarithmic_axes() {
        let axis = |values: &[f64]| Axis::logarithmic("", Unit::none(), values.iter().copied());
        assert_eq!(written(&axis(&[0.005, 0.04, -1.0]), 320.0, false), ["0.005", "0.01", "0.02"]);
        assert_eq!(written(&axis(&[0.18, 0.82]), 320.0, false), ["0.2", "0.3", "0.5", "0.7"]);
        assert_eq!(written(&axis(&[1e-8, 1.0]), 160.0, false), ["10⁰", "10⁻²", "10⁻⁴", "10⁻⁶", "10⁻⁸"]);
        let many = ticks(&axis(&[1e-8, 1.0]), 200.0, None);
        assert!(many.iter().all(|tick| (0.0..=1.0).contains(&tick.share)));
    }
}
