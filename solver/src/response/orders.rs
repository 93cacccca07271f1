//! Sub-harmonic orders: a motion of order m lasts m periods of the force, which acts on its harmonic m. A study looks for one order,
//! that of the model, or for several; each is a harmonic balance of its own.

use crate::curve::problem::SAME_IMAGE;
use crate::formulation::harmonics::width;
use crate::formulation::state::State;
use crate::settings::{FrequencySettings, HarmonicSettings, NumberList, SearchSettings, Settings};
use crate::structure::Model;
use std::sync::Arc;

/// One order: the structure with its force on harmonic m, and the settings that go with it.
#[derive(Debug, Clone)]
pub struct Order {
    /// The structure.
    pub model: Arc<Model>,
    /// The settings. Bounds of the frequency that are given are those of the first order's motions: the force has the same in all
    /// orders.
    pub settings: Settings,
    /// Whether it is the first one, whose main branches are followed. Of others only motions count that earlier ones do not have.
    pub is_first: bool,
}

/// The orders of a study.
#[derive(Debug, Clone)]
pub struct Orders(Arc<[Order]>);

impl Orders {
    /// Those of valid settings.
    pub fn of(model: &Model, settings: &Settings) -> Self {
        let orders = orders(model, &settings.search);
        Self(orders.iter().map(|&order| Order::new(model, settings, (orders[0], order))).collect())
    }

    /// The order of this number, or the first one; `None` if it is not looked for.
    pub fn get(&self, order: Option<usize>) -> Option<&Order> {
        match order {
            None => self.0.first(),
            Some(number) => self.0.iter().find(|order| order.number() == number),
        }
    }

    /// The first one, whose main branches are followed.
    ///
    /// # Panics
    /// Of settings that are not valid.
    pub fn first(&self) -> &Order {
        &self.0[0]
    }

    /// All, the first one first.
    pub fn iter(&self) -> impl Iterator<Item = &Order> {
        self.0.iter()
    }
}

impl Order {
    fn new(model: &Model, settings: &Settings, (first, order): (usize, usize)) -> Self {
        let FrequencySettings { min, max } = settings.frequency;
        let bound = |bound: Option<f64>| bound.map(|omega| omega * first as f64 / order as f64);
        let frequency = FrequencySettings { min: bound(min), max: bound(max) };
        let model = Arc::new(model.with_force_on(order));
        // Samples are the same a period of the force later, and where laws are odd, mirrored, half of one: what is told from motions of
        // shorter periods by their harmonics has to be exact.
        let samples = settings.harmonics.samples.next_multiple_of(2 * order);
        let harmonics = HarmonicSettings { samples, ..settings.harmonics };
        Self { model, settings: Settings { frequency, harmonics, ..*settings }, is_first: order == first }
    }

    /// The same with bounds of the frequency where only one is given: the other one is that of the first order, whose motions are
    /// followed between these frequencies (rad/s).
    #[must_use]
    pub fn between(&self, first: usize, (low, high): (f64, f64)) -> Self {
        let FrequencySettings { min, max } = self.settings.frequency;
        if min.is_some() == max.is_some() {
            return self.clone();
        }
        let bound = |omega: f64| Some(omega * first as f64 / self.number() as f64);
        let frequency = FrequencySettings { min: min.or(bound(low)), max: max.or(bound(high)) };
        Self { settings: Settings { frequency, ..self.settings }, ..self.clone() }
    }

    /// m.
    pub fn number(&self) -> usize {
        self.model.forcing().harmonic
    }
}

/// The orders that are looked for, ascending: those asked for, or that of the model.
pub fn orders(model: &Model, search: &SearchSettings) -> Vec<usize> {
    search.harmonics.as_ref().map_or_else(|| vec![model.forcing().harmonic], |list| list.numbers().to_vec())
}

/// What tells motions of an order that are of an earlier one as well.
#[derive(Debug, Clone, Default)]
pub(super) struct Shorter {
    /// A motion all of whose harmonics are multiples of one of these is.
    multiples: Vec<usize>,
}

impl Shorter {
    /// For the order of `model`, of those that are looked for.
    pub(super) fn of(model: &Model, asked: Option<&NumberList>) -> Self {
        let order = model.forcing().harmonic;
        let earlier = asked.map_or(&[][..], NumberList::numbers).iter().filter(|&&earlier| earlier < order);
        // What two orders have in common repeats itself after as many periods of the force as divide both.
        Self { multiples: earlier.map(|&earlier| order / common(order, earlier)).collect() }
    }

    /// Whether motions all of whose harmonics are multiples of this one are of an earlier order.
    pub(super) fn has_multiples_of(&self, harmonic: usize) -> bool {
        self.multiples.iter().any(|multiple| harmonic.is_multiple_of(*multiple))
    }

    /// Whether a motion is of an earlier order.
    pub(super) fn has(&self, state: &State) -> bool {
        self.multiples.iter().any(|&multiple| {
            let (mut others, mut all) = (0.0, 0.0);
            for series in state.modal.chunks(width(state.harmonics)) {
                for (k, pair) in series[1..].chunks(2).enumerate() {
                    let square: f64 = pair.iter().map(|entry| entry * entry).sum();
                    all += square;
                    others += if (k + 1) % multiple == 0 { 0.0 } else { square };
                }
            }
            others.sqrt() <= SAME_IMAGE * f64::sqrt(all)
        })
    }
}

/// Greatest common divisor.
fn common(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Matrix;

    fn mass() -> Model {
        let one = || Matrix::diagonal(&[1.0]);
        Model::builder("mass").mass(one()).stiffness(one()).force_shape([1.0]).build().unwrap()
    }

    fn asked(numbers: &[usize]) -> Settings {
        let search = SearchSettings { harmonics: NumberList::new(numbers), ..SearchSettings::default() };
        let frequency = FrequencySettings { min: Some(0.6), max: Some(3.0) };
        Settings { search, frequency, ..Settings::default() }
    }

    #[test]
    fn the_force_has_the_same_bounds_in_every_order() {
        let list = Orders::of(&mass(), &asked(&[1, 3]));
        let told = list.iter().map(|order| (order.number(), order.settings.frequency, order.is_first));
        let bounds = |min: f64, max: f64| FrequencySettings { min: Some(min), max: Some(max) };
        assert_eq!(told.collect::<Vec<_>>(), [(1, bounds(0.6, 3.0), true), (3, bounds(0.6 / 3.0, 3.0 / 3.0), false)]);
        let [only] = &*Orders::of(&mass(), &Settings::default()).0 else { panic!("one order") };
        assert_eq!((only.number(), only.is_first), (1, true));
        let [only] = &*Orders::of(&mass(), &asked(&[2])).0 else { panic!("one order") };
        assert_eq!((only.number(), only.is_first, only.settings.frequency), (2, true, bounds(0.6, 3.0)));
    }

    #[test]
    fn a_bound_that_is_not_given_is_the_first_orders_and_samples_are_those_of_every_period() {
        let mut settings = asked(&[2, 3]);
        settings.frequency.min = None;
        let list = Orders::of(&mass(), &settings);
        let order = list.get(Some(3)).unwrap();
        assert_eq!(order.settings.harmonics.samples % 6, 0);
        assert_eq!(list.first().settings.harmonics.samples, settings.harmonics.samples);
        let bounds = |order: &Order| (order.settings.frequency.min, order.settings.frequency.max);
        assert_eq!(bounds(&order.between(2, (0.9, 3.0))), (Some(0.9 * 2.0 / 3.0), Some(2.0)));
        // What nobody gave is each order's own, and what is given stays.
        for given in [None, Some(0.6)] {
            settings.frequency = FrequencySettings { min: given, max: given.map(|min| 5.0 * min) };
            let list = Orders::of(&mass(), &settings);
            let order = list.get(Some(3)).unwrap();
            assert_eq!(bounds(&order.between(2, (0.9, 3.0))), bounds(order));
        }
    }

    #[test]
    fn a_motion_is_of_the_first_order_that_has_it() {
        // Harmonics of one mode, whatever its mean.
        let state = |harmonics: &[usize]| {
            let mut modal = vec![0.3; 1];
            modal.extend((1..=12).flat_map(|k| if harmonics.contains(&k) { [0.0, 1.0] } else { [1e-9, 0.0] }));
            State { harmonics: 12, omega: 1.0, decay: 0.0, forcing: 1.0, arguments: Vec::new(), modal }
        };
        for (numbers, order, of_earlier, own) in [
            (&[1, 3][..], 3, &[&[3][..], &[3, 6, 9]][..], &[&[1, 3][..], &[2, 3], &[3, 6, 10]][..]),
            // Twice the period of the force is order 2's, and so is the force's own.
            (&[2, 4], 4, &[&[2, 4], &[4, 8]], &[&[1, 4], &[3, 4]]),
            // Order 3 has nothing of two periods: order 4 lists it.
            (&[3, 4], 4, &[&[4, 8]], &[&[2, 4], &[1, 4]]),
            (&[1, 2, 3], 1, &[], &[&[1], &[2]]),
        ] {
            let shorter = Shorter::of(&mass().with_force_on(order), asked(numbers).search.harmonics.as_ref());
            assert!(of_earlier.iter().all(|harmonics| shorter.has(&state(harmonics))), "{numbers:?}, order {order}");
            assert!(!own.iter().any(|harmonics| shorter.has(&state(harmonics))), "{numbers:?}, order {order}");
        }
    }
}
