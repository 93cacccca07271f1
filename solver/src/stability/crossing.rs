//! What happens to multipliers between two orbits of a branch: which of them crosses the unit circle, and where.

use super::multipliers::{Multiplier, Outside};

/// A multiplier that is farther than this outside, and came from farther than this, where its crossing is resolved: a jump.
const JUMP: f64 = 0.02;

/// What the numbers of multipliers outside the unit circle say of the way from one orbit to another.
///
/// Real multipliers outside merge into pairs and pairs split without anything happening to the orbits: of their numbers only
/// the parities count. Each side of the real axis can be left through 1 or −1 alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// No crossing, or several that undo each other.
    Nothing,
    /// A real multiplier through 1.
    AtOne,
    /// A real multiplier through −1.
    AtMinusOne,
    /// A complex pair.
    Pair,
    /// More than one of these.
    Several,
}

impl Event {
    /// Between two orbits.
    pub fn between(a: &Outside, b: &Outside) -> Self {
        let odd = |a: usize, b: usize| !a.abs_diff(b).is_multiple_of(2);
        match (a.count().abs_diff(b.count()), odd(a.above, b.above), odd(a.below, b.below)) {
            (0, false, false) => Self::Nothing,
            (1, true, false) => Self::AtOne,
            (1, false, true) => Self::AtMinusOne,
            (2, false, false) => Self::Pair,
            _ => Self::Several,
        }
    }

    /// Whether this multiplier can be the one that crosses.
    fn takes(self, mu: &Multiplier) -> bool {
        match self {
            Self::AtOne => mu.is_real() && mu.re > 0.0,
            Self::AtMinusOne => mu.is_real() && mu.re < 0.0,
            Self::Pair => !mu.is_real() && mu.im > 0.0,
            Self::Nothing | Self::Several => mu.im >= 0.0,
        }
    }

    /// Whether counts on the way belong to the orbit `a` rather than to `b`, as far as this event is concerned: for orbits with
    /// other multipliers so near the circle that their counts say nothing.
    pub fn is_nearer(self, a: &Outside, b: &Outside, counts: &Outside) -> bool {
        match self {
            Self::AtOne => counts.above.abs_diff(a.above).is_multiple_of(2),
            Self::AtMinusOne => counts.below.abs_diff(a.below).is_multiple_of(2),
            _ => counts.count().abs_diff(a.count()) < counts.count().abs_diff(b.count()),
        }
    }
}

/// The multiplier that crosses, at the orbit where it is outside and at the one where it is inside.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Outside.
    pub outer: Multiplier,
    /// Inside: the nearest one that can become the other. None if there is none, as where a pair has still to merge.
    pub inner: Option<Multiplier>,
    /// Distance of `outer` from the nearest multiplier inside at the other orbit, of whatever kind.
    pub gap: f64,
}

impl Crossing {
    /// From the multipliers of the orbit with more of them outside and of the one with fewer.
    pub fn of(event: Event, outer: &[Multiplier], inner: &[Multiplier]) -> Option<Self> {
        let outer = newcomer(event, outer, inner).or_else(|| newcomer(Event::Several, outer, inner))?;
        let within = || inner.iter().filter(|mu| mu.excess() <= 0.0);
        let apart = |mu: &&Multiplier| mu.distance(&outer);
        let nearest = |a: &&Multiplier, b: &&Multiplier| apart(a).total_cmp(&apart(b));
        let gap = within().map(|mu| apart(&mu)).fold(f64::INFINITY, f64::min);
        let inner = within().filter(|mu| event.takes(mu)).min_by(nearest).copied();
        Some(Self { outer, inner, gap })
    }

    /// Whether it is far from where it comes from: where orbits next to each other have it, it jumps.
    pub fn jumps(&self) -> bool {
        self.outer.excess().max(self.gap) > JUMP
    }

    /// Distances |μ| − 1 outside and inside.
    pub fn excess(&self) -> (f64, Option<f64>) {
        (self.outer.excess(), self.inner.map(|mu| mu.excess()))
    }
}

/// The multiplier nearest to the circle among those outside at one orbit that were not outside at the other.
fn newcomer(event: Event, outer: &[Multiplier], inner: &[Multiplier]) -> Option<Multiplier> {
    let outside = |list: &[Multiplier]| {
        list.iter().filter(|mu| mu.excess() > 0.0 && event.takes(mu)).copied().collect::<Vec<_>>()
    };
    let mut candidates = outside(outer);
    for known in outside(inner) {
        let apart = |i: &usize| candidates[*i].distance(&known);
        if let Some(same) = (0..candidates.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))) {
            candidates.swap_remove(same);
        }
    }
    candidates.into_iter().min_by(|a, b| a.excess().total_cmp(&b.excess()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real(re: f64) -> Multiplier {
        Multiplier { re, im: 0.0 }
    }

    fn pair(modulus: f64, angle: f64) -> [Multiplier; 2] {
        [angle, -angle].map(|angle| Multiplier { re: modulus * angle.cos(), im: modulus * angle.sin() })
    }

    #[test]
    fn parities_tell_which_crossing_it_is() {
        let counts = |above, below, paired| Outside { above, below, paired };
        let event = |a, b| Event::between(&a, &b);
        assert_eq!(event(counts(0, 0, 2), counts(2, 0, 0)), Event::Nothing);
        assert_eq!(event(counts(1, 0, 0), counts(0, 0, 2)), Event::AtOne);
        assert_eq!(event(counts(0, 1, 2), counts(0, 2, 2)), Event::AtMinusOne);
        assert_eq!(event(counts(1, 0, 0), counts(1, 0, 2)), Event::Pair);
        // As many outside as before, but others.
        assert_eq!(event(counts(0, 1, 0), counts(1, 0, 0)), Event::Several);
        assert_eq!(event(counts(0, 0, 0), counts(1, 1, 0)), Event::Several);
    }

    #[test]
    fn a_pair_near_the_circle_is_not_taken_for_what_crosses() {
        let passive = pair(0.9937, 1.0);
        let inside = [passive[0], passive[1], real(-0.7)];
        let outside = [real(-1.2), passive[0], passive[1]];
        let crossing = Crossing::of(Event::AtMinusOne, &outside, &inside).unwrap();
        assert_eq!((crossing.outer, crossing.inner), (real(-1.2), Some(real(-0.7))));
        // From 0.5 to −3 at once.
        let inside = [passive[0], passive[1], real(0.5)];
        let crossing = Crossing::of(Event::AtMinusOne, &[real(-3.0), passive[0], passive[1]], &inside).unwrap();
        assert_eq!((crossing.outer, crossing.inner), (real(-3.0), None));
        assert!(crossing.gap > 3.0);
        // What was outside before is not what has left.
        let before = pair(1.05, 2.0);
        let outside = [before[0], before[1], pair(1.3, 0.5)[0], pair(1.3, 0.5)[1], passive[0], passive[1]];
        let inside = [before[0], before[1], pair(0.9, 0.5)[0], pair(0.9, 0.5)[1], passive[0], passive[1]];
        let crossing = Crossing::of(Event::Pair, &outside, &inside).unwrap();
        assert_eq!(crossing.outer, pair(1.3, 0.5)[0]);
    }
}
