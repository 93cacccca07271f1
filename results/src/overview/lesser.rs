//! What motions that branch off others have lost.

use solver::structure::Model;

/// How motions that branch off others differ from those.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Lesser {
    /// They are less symmetric.
    Symmetry,
    /// They last more periods of the force.
    Period,
    /// One of both, or it is not known which.
    #[default]
    Either,
}

impl Lesser {
    /// Of a structure: only where the force acts on a higher harmonic of the response do motions repeat themselves within its period, and
    /// one mass whose laws are not all odd has no symmetry to lose. Others may have one that nobody tells the program.
    pub fn of(model: &Model) -> Self {
        let has_symmetry = model.is_odd() || model.dofs().len() > 1;
        match (has_symmetry, model.forcing().harmonic > 1) {
            (_, false) => Self::Symmetry,
            (false, true) => Self::Period,
            (true, true) => Self::Either,
        }
    }

    /// `less symmetric than …`, of those that are named so.
    pub fn than(self, others: &str) -> String {
        match self {
            Self::Symmetry => format!("less symmetric than {others}"),
            Self::Period => format!("of a longer period than {others}"),
            Self::Either => format!("less symmetric than {others} or of a longer period"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::Matrix;
    use solver::structure::laws::{PenaltySpring, PolynomialSpring, Term};

    #[test]
    fn what_is_lost_follows_from_laws_and_forcing() {
        let model = |is_odd: bool, harmonic: usize| {
            let one = Matrix::diagonal(&[1.0]);
            let model = Model::builder("mass").mass(one.clone()).stiffness(one).damping_ratio(0.01).force(0, 1.0);
            let model = match is_odd {
                true => model.element(
                    "spring",
                    PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] },
                    [vec![(0, 1.0)]],
                ),
                false => model.element("stop", PenaltySpring { stiffness: 1.0, gap: 1.0 }, [vec![(0, 1.0)]]),
            };
            model.harmonic(harmonic).build().unwrap()
        };
        for (is_odd, harmonic, expected) in [
            (true, 1, "less symmetric than those"),
            (false, 1, "less symmetric than those"),
            (false, 2, "of a longer period than those"),
            (true, 3, "less symmetric than those or of a longer period"),
        ] {
            assert_eq!(Lesser::of(&model(is_odd, harmonic)).than("those"), expected);
        }
    }
}
