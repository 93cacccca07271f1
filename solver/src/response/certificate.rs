//! What the numbers of a branch are worth: whether its peak is one, what the harmonics that were left out would change, where it touches, and
//! whether the friction there is what its law is made for.

use crate::curve::outcome::{Outcome, Stop};
use serde::{Deserialize, Serialize};

/// Whether the largest amplitude of a branch is that of a maximum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// It is the largest one of a curve that is known from end to end, within the bounds that were given, and does not leave through one while
    /// it grows to amplitudes comparable to that: a maximum, or where the curve ends on another one that is known.
    At,
    /// It is only as far as the curve is known: the response may be larger.
    AtLeast,
}

impl Standing {
    /// Of the peak at point `peak` of so many points of a curve that ends so.
    pub fn of_peak(outcome: &Outcome, peak: usize, points: usize) -> Self {
        let Outcome::Open(first, last) = outcome else { return Self::At };
        // At a branch point what it branches off goes on, not the branch, and what follows a known one is part of that.
        let is_end = [(peak == 0, first), (peak + 1 >= points, last)];
        let is_elsewhere = |stop: &Stop| matches!(stop, Stop::Branching | Stop::Joined);
        let is_end = is_end.into_iter().any(|(is_there, stop)| is_there && !is_elsewhere(stop));
        if is_end || [first, last].into_iter().any(goes_on_higher) { Self::AtLeast } else { Self::At }
    }

    /// Its name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::At => "at",
            Self::AtLeast => "at_least",
        }
    }

    /// The standing of this name.
    pub fn named(name: &str) -> Option<Self> {
        [Self::At, Self::AtLeast].into_iter().find(|standing| standing.name() == name)
    }
}

/// Whether a curve may go on to larger amplitudes where it ends so: it was not done, or is at the amplitude bound.
fn goes_on_higher(stop: &Stop) -> bool {
    match stop {
        Stop::AmplitudeBound => true,
        Stop::Start
        | Stop::Rest
        | Stop::Closed
        | Stop::FrequencyBound
        | Stop::ForcingBound
        | Stop::Joined
        | Stop::Branching => false,
        Stop::PointBudget | Stop::Stalled(_) | Stop::Reversed | Stop::Cancelled => true,
    }
}

/// What is known of the harmonics beyond H of a branch, of its contact and its friction; `None` where it was not computed, or means nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Largest penetration of a contact over its gap.
    pub penetration: Option<f64>,
    /// Share (rms, over the whole branch) of the contact pressure beyond H.
    pub pressure_beyond: Option<f64>,
    /// The peak and the ends of the range, converged again with 2 H harmonics.
    pub doubled: Option<Doubled>,
    /// How far 2 H harmonics move the branch at most, of the points that leave most of their balance.
    #[serde(default)]
    pub elsewhere: Option<Change>,
    /// Lowest and highest frequency at which a contact touches, rad/s, located between points.
    #[serde(default)]
    pub contact_omega: Option<(f64, f64)>,
    /// Slowest sliding of a contact along the rotation while it presses, over the speed of the rotor there: where it is not above zero the
    /// sliding stops or turns round, for which the law of permanent sliding is not made.
    #[serde(default)]
    pub slowest_sliding: Option<f64>,
}

/// How far more harmonics move a branch at a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Where, rad/s.
    pub omega: f64,
    /// Distance from the branch there, in frequency and in amplitude of the first monitored dof together, relative to these: where the branch
    /// is steep its amplitude at one frequency changes by more. Amplitudes below a hundredth of the largest one of the branch count as that. `None` if near most points no motion was found: the one here is left
    /// farthest from balance.
    pub share: Option<f64>,
}

/// What of a branch was converged again with twice the harmonics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Doubled {
    /// Largest amplitude of the first monitored dof there, m.
    pub amplitude: f64,
    /// Relative shift of the peak's frequency.
    pub shift: f64,
    /// Lowest and highest frequency of a closed curve there, its outermost folds, rad/s.
    #[serde(default)]
    pub range: Option<(f64, f64)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_stands_where_the_curve_is_known_round_it() {
        let bound = Stop::FrequencyBound;
        for (outcome, peak, standing) in [
            (Outcome::Closed, 0, Standing::At),
            (Outcome::Open(Stop::Start, bound), 4, Standing::At),
            (Outcome::Open(bound, bound), 4, Standing::At),
            (Outcome::Open(bound, bound), 0, Standing::AtLeast),
            (Outcome::Open(Stop::Start, bound), 8, Standing::AtLeast),
            (Outcome::Open(Stop::Rest, bound), 4, Standing::At),
            (Outcome::Open(Stop::Joined, Stop::Joined), 0, Standing::At),
            (Outcome::Open(Stop::Joined, bound), 8, Standing::AtLeast),
            (Outcome::Open(Stop::Joined, Stop::Reversed), 0, Standing::AtLeast),
            (Outcome::Open(Stop::Rest, bound), 0, Standing::AtLeast),
            (Outcome::Open(Stop::Start, Stop::AmplitudeBound), 4, Standing::AtLeast),
            (Outcome::Open(Stop::Reversed, bound), 4, Standing::AtLeast),
            (Outcome::Open(Stop::Start, Stop::PointBudget), 4, Standing::AtLeast),
        ] {
            assert_eq!(Standing::of_peak(&outcome, peak, 9), standing, "{outcome}, {peak}");
        }
    }

    #[test]
    fn names_are_those_of_messages() {
        for standing in [Standing::At, Standing::AtLeast] {
            assert_eq!(serde_json::to_string(&standing).unwrap(), format!("\"{}\"", standing.name()));
            assert_eq!(Standing::named(standing.name()), Some(standing));
        }
    }
}
