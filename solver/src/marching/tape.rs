//! What steps do to small deviations, recorded until all columns are taken through them at once.

use super::local::{Action, LocalLaw};
use super::{Contacts, Marching};
use crate::linalg::vectorised;

/// One or several time steps, linearised.
pub enum Move {
    /// So many steps in which no contact closes and no law has a slope.
    Free(usize),
    /// One step.
    Bound(Bound),
}

/// A step with forces that depend on the motion. Offsets are into [`Tape::rows`], [`Tape::actions`].
pub struct Bound {
    /// First of the actions of the laws, in the order of the laws.
    pub laws: usize,
    /// Number of nodes that rub, and the offset of their rows q (first all of them) and g:
    /// δ̂ ← δ̂ − Σ g (q·δ).
    pub friction: (usize, usize),
    /// Number of nodes that touch at the end of the step, and the offset of their rows P (first all of them) and G:
    /// δ⁺ = δ̂ − Σ G (P·(η + δ̂)).
    pub contact: (usize, usize),
}

/// Steps in the order of time.
#[derive(Default)]
pub struct Tape {
    pub moves: Vec<Move>,
    pub rows: Vec<f64>,
    pub actions: Vec<Action>,
    /// Nodes that touched in the step before, and the offset of their rows: without friction they stay as they are.
    last: (Vec<usize>, usize),
}

/// Numbers on the tape beyond which it is used: as much as stays in a cache.
const FULL: usize = 40_000;

impl Tape {
    pub fn is_full(&self) -> bool {
        self.rows.len() + size_of::<Action>() / size_of::<f64>() * self.actions.len() > FULL
    }

    pub fn clear(&mut self) {
        self.moves.clear();
        self.rows.clear();
        self.actions.clear();
        self.last.0.clear();
    }

    /// Adds the step that was made ready last. `has_laws`: whether any law acts with a slope.
    #[inline(always)]
    pub fn record(&mut self, contacts: &mut Contacts, laws: &[LocalLaw<'_>], slope: f64) {
        let acts = laws.iter().any(|law| law.memory_size() > 0 || law.action().response.du != [[0.0; 3]; 3]);
        let touching = contacts.touching().len();
        if !acts && touching == 0 {
            match self.moves.last_mut() {
                Some(Move::Free(count)) => *count += 1,
                _ => self.moves.push(Move::Free(1)),
            }
            return;
        }
        let first = self.actions.len();
        self.actions.extend(laws.iter().map(|law| *law.action()));
        let mut bound = Bound { laws: first, friction: (0, 0), contact: (touching, 0) };
        if touching > 0 {
            if contacts.has_friction() {
                bound.friction.1 = self.rows.len();
                bound.friction.0 = contacts.linearise_friction(slope, &mut self.rows);
                bound.contact.1 = self.rows.len();
                contacts.linearise(&mut self.rows);
            } else {
                if self.last.0 != contacts.touching() {
                    self.last = (contacts.touching().to_vec(), self.rows.len());
                    contacts.linearise(&mut self.rows);
                }
                bound.contact.1 = self.last.1;
            }
        }
        self.moves.push(Move::Bound(bound));
    }
}

impl Marching<'_> {
    /// Adds the step that is made ready.
    pub(super) fn record(&mut self, tape: &mut Tape) {
        let slope = 1.0 / self.step;
        vectorised(
            #[inline(always)]
            || tape.record(&mut self.contacts, &self.laws, slope),
        );
    }
}
