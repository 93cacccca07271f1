//! Symmetries of a structure: exchanges of equal parts, some turned round, that leave it and its forcing as they are.

use super::laws::Law;
use super::model::{Element, Model};
use crate::linalg::Matrix;

/// Entries of matrices and forces are equal up to this share of the largest one.
const SAME: f64 = 1e-9;

/// Most exchanges that are told.
const MOST: usize = 24;

/// Most places tried for dofs: of many equal parts there are more exchanges than anybody wants.
const TRIED: usize = 20_000;

/// A direction, by dofs.
type Direction = Vec<(usize, f64)>;

/// With a motion x(t) of the structure x′(t) is one: x′ᵢ = sᵢ x_{p(i)}, p a permutation of the dofs and sᵢ = ±1.
#[derive(Debug, Clone, PartialEq)]
pub struct Exchange {
    /// p(i) and sᵢ of every dof.
    dofs: Vec<(usize, f64)>,
}

impl Exchange {
    /// How far a motion, as a series of each dof, is from what the exchange makes of it: root of the elastic energies of the single dofs, relative to those of the
    /// motion. Zero where it is its own image, of order one where equal parts move differently.
    pub fn asymmetry(&self, model: &Model, motions: &[Vec<f64>]) -> f64 {
        let (mut apart, mut whole) = (0.0, 0.0);
        for (i, &(p, sign)) in self.dofs.iter().enumerate() {
            let weight = model.stiffness()[(i, i)].abs();
            for (own, image) in motions[i].iter().zip(&motions[p]) {
                apart += weight * (own - sign * image).powi(2);
                whole += weight * own * own;
            }
        }
        if whole > 0.0 { (apart / whole).sqrt() } else { 0.0 }
    }

    /// bᵀx′ as a direction of x, by dofs.
    fn image(&self, direction: &[(usize, f64)]) -> Direction {
        let moved = direction.iter().map(|&(i, b)| (self.dofs[i].0, self.dofs[i].1 * b));
        sorted(moved.filter(|(_, b)| *b != 0.0).collect())
    }

    /// Whether every element becomes one with the same law. Turned round may be only what acts along one argument by an odd law.
    fn keeps(&self, elements: &[Element]) -> bool {
        let mut taken = vec![false; elements.len()];
        elements.iter().all(|element| {
            let images: Vec<Direction> = element.channels.iter().map(|channel| self.image(channel)).collect();
            let is_image = |other: &Element| {
                let sign = |sign: f64| {
                    let same = |(image, own): (&Direction, &Direction)| is_same(image, own, sign);
                    images.len() == other.channels.len() && images.iter().zip(&other.channels).all(same)
                };
                other.law == element.law && (sign(1.0) || (images.len() == 1 && element.law.is_odd() && sign(-1.0)))
            };
            let found = (0..elements.len()).find(|&i| !taken[i] && is_image(&elements[i]));
            found.inspect(|&i| taken[i] = true).is_some()
        })
    }
}

/// Whether two directions are the same, one of them turned round if `sign` is negative.
fn is_same(one: &[(usize, f64)], other: &[(usize, f64)], sign: f64) -> bool {
    let other = nonzero(other);
    let is_equal = |((i, a), (j, b)): (&(usize, f64), &(usize, f64))| i == j && (a - sign * b).abs() <= SAME * b.abs();
    one.len() == other.len() && one.iter().zip(&other).all(is_equal)
}

/// The same direction, without dofs that are not in it, by dofs.
fn nonzero(direction: &[(usize, f64)]) -> Direction {
    sorted(direction.iter().copied().filter(|(_, b)| *b != 0.0).collect())
}

fn sorted(mut direction: Direction) -> Direction {
    direction.sort_by_key(|&(dof, _)| dof);
    direction
}

impl Model {
    /// Whether with a motion its mirror image, half a period of the forcing later, is one as well: every law is odd, or has one that is the
    /// same and acts the other way, as stops with the same gap on both sides do.
    pub fn is_odd(&self) -> bool {
        let one_sided: Vec<&Element> = self.elements().iter().filter(|element| !element.law.is_odd()).collect();
        let mut taken = vec![false; one_sided.len()];
        one_sided.iter().all(|element| {
            let channels: Vec<Direction> = element.channels.iter().map(|channel| nonzero(channel)).collect();
            let is_opposite = |other: &Element| {
                let turned = |(own, other): (&Direction, &Direction)| is_same(own, other, -1.0);
                other.law == element.law
                    && channels.len() == other.channels.len()
                    && channels.iter().zip(&other.channels).all(turned)
            };
            let found = (0..one_sided.len()).find(|&i| !taken[i] && is_opposite(one_sided[i]));
            found.inspect(|&i| taken[i] = true).is_some()
        })
    }

    /// Exchanges of dofs that leave matrices, forcing and laws as they are, other than leaving all in place; not all where there are
    /// very many.
    pub fn exchanges(&self) -> Vec<Exchange> {
        let mut search = Search {
            matrices: [self.mass(), self.stiffness()].map(Scaled::new),
            force: &self.forcing().shape,
            least: SAME * self.forcing().shape.iter().fold(0.0, |largest: f64, f| largest.max(f.abs())),
            placed: Vec::new(),
            tried: 0,
            found: Vec::new(),
        };
        search.place();
        let mut found = search.found;
        let is_other =
            |exchange: &Exchange| exchange.dofs.iter().enumerate().any(|(i, &(p, sign))| p != i || sign < 0.0);
        found.retain(|exchange| is_other(exchange) && exchange.keeps(self.elements()));
        if !found.is_empty() {
            let damping = self.physical_damping();
            let damping = Scaled::new(&damping);
            found.retain(|exchange| damping.is_kept_by(&exchange.dofs));
        }
        found.truncate(MOST);
        found
    }

    /// C = MΦ Ĉ (MΦ)ᵀ, n × n, N·s/m.
    fn physical_damping(&self) -> Matrix {
        let (n, shapes) = (self.size(), &self.modes().shapes);
        let column = |j: usize| self.mass().mul_vec(&(0..n).map(|i| shapes[(i, j)]).collect::<Vec<_>>());
        let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
        let force = |p: usize| self.damping().times(&columns.iter().map(|column| column[p]).collect::<Vec<_>>());
        let forces: Vec<Vec<f64>> = (0..n).map(force).collect();
        Matrix::from_fn(n, n, |i, p| columns.iter().zip(&forces[p]).map(|(column, force)| column[i] * force).sum())
    }
}

/// A matrix, and by how much its entries may differ.
struct Scaled<'m> {
    matrix: &'m Matrix,
    tolerance: f64,
}

impl<'m> Scaled<'m> {
    fn new(matrix: &'m Matrix) -> Self {
        let entries = (0..matrix.rows()).flat_map(|i| matrix.row(i));
        Self { matrix, tolerance: SAME * entries.fold(0.0, |largest: f64, entry| largest.max(entry.abs())) }
    }

    /// Whether the entries of two dofs with each other are those of the dofs in their places.
    fn is_same(&self, [(i, (p, sign)), (k, (q, other))]: [(usize, (usize, f64)); 2]) -> bool {
        let is_near = |own: f64, image: f64| (own - sign * other * image).abs() <= self.tolerance;
        is_near(self.matrix[(i, k)], self.matrix[(p, q)]) && is_near(self.matrix[(k, i)], self.matrix[(q, p)])
    }

    fn is_kept_by(&self, dofs: &[(usize, f64)]) -> bool {
        let all = || dofs.iter().copied().enumerate();
        all().all(|one| all().all(|other| self.is_same([one, other])))
    }
}

/// Places for one dof after the other.
struct Search<'m> {
    matrices: [Scaled<'m>; 2],
    force: &'m [f64],
    least: f64,
    placed: Vec<(usize, f64)>,
    tried: usize,
    found: Vec<Exchange>,
}

impl Search<'_> {
    /// All places of the next dof that fit those before it.
    fn place(&mut self) {
        let i = self.placed.len();
        if i == self.force.len() {
            self.found.push(Exchange { dofs: self.placed.clone() });
            return;
        }
        for p in 0..self.force.len() {
            for sign in [1.0, -1.0] {
                if self.tried < TRIED && self.fits(i, p, sign) {
                    self.placed.push((p, sign));
                    self.place();
                    self.placed.pop();
                }
            }
        }
    }

    fn fits(&mut self, i: usize, p: usize, sign: f64) -> bool {
        self.tried += 1;
        let is_free = self.placed.iter().all(|&(taken, _)| taken != p);
        if !is_free || (self.force[i] - sign * self.force[p]).abs() > self.least {
            return false;
        }
        let own = (i, (p, sign));
        let mut with = self.placed.iter().copied().enumerate().chain([own]);
        with.all(|other| self.matrices.iter().all(|of| of.is_same([own, other])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::ModelBuilder;
    use crate::structure::laws::{PenaltySpring, PolynomialSpring, Term};

    fn ring(count: usize, force: &[f64]) -> ModelBuilder {
        let coupling = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 1.2,
            d if d == 1 || d == count - 1 => -0.1,
            _ => 0.0,
        };
        Model::builder("ring")
            .mass(Matrix::diagonal(&vec![1.0; count]))
            .stiffness(Matrix::from_fn(count, count, coupling))
            .damping_ratio(0.01)
            .force_shape(force.to_vec())
            .monitor(0)
    }

    #[test]
    fn one_sided_laws_are_odd_in_pairs() {
        let model = |stops: &[(f64, f64)]| {
            let masses =
                Model::builder("stops").mass(Matrix::diagonal(&[1.0, 1.0])).stiffness(Matrix::diagonal(&[1.0, 1.0]));
            let model = masses.damping_ratio(0.01).force_shape(vec![1.0, 0.0]).monitor(0);
            let model = stops.iter().enumerate().fold(model, |model, (i, &(side, gap))| {
                let stop = PenaltySpring { stiffness: 3.0, gap };
                model.element(format!("stop {i}"), stop, [vec![(1, -side), (0, side)]])
            });
            model.element("spring", spring(3, 1.0), [vec![(0, 1.0)]]).build().unwrap()
        };
        // Whatever stands there of dofs that do not take part.
        let pair = |model: ModelBuilder, channels: [Vec<(usize, f64)>; 2]| {
            let stop = PenaltySpring { stiffness: 3.0, gap: 0.1 };
            let add = |model: ModelBuilder, (i, channel)| model.element(format!("stop {i}"), stop.clone(), [channel]);
            channels.into_iter().enumerate().fold(model, add).build().unwrap()
        };
        assert!(pair(ring(3, &[1.0, 0.0, 0.0]), [vec![(0, 1.0), (2, 0.0)], vec![(1, 0.0), (0, -1.0)]]).is_odd());
        for odd in [&[][..], &[(1.0, 0.1), (-1.0, 0.1)], &[(1.0, 0.1), (-1.0, 0.2), (1.0, 0.2), (-1.0, 0.1)]] {
            assert!(model(odd).is_odd(), "{odd:?}");
        }
        for other in [
            &[(1.0, 0.1)][..],
            &[(1.0, 0.1), (-1.0, 0.2)],
            &[(1.0, 0.1), (1.0, 0.1), (-1.0, 0.1)],
            &[(1.0, 0.1), (-2.0, 0.1)],
        ] {
            assert!(!model(other).is_odd(), "{other:?}");
        }
    }

    fn spring(power: u32, coefficient: f64) -> PolynomialSpring {
        PolynomialSpring { terms: vec![Term { power, coefficient }] }
    }

    fn on_all(model: ModelBuilder, count: usize, power: u32) -> Model {
        (0..count)
            .fold(model, |model, i| model.element(format!("s{i}"), spring(power, 0.5), [vec![(i, 1.0)]]))
            .build()
            .unwrap()
    }

    #[test]
    fn a_ring_turns_and_is_mirrored() {
        // Of n sectors pushed alike there are n turns and n mirrors, leaving all in place among them.
        for (count, expected) in [(3, 5), (4, 7), (5, 9)] {
            assert_eq!(on_all(ring(count, &vec![1.0; count]), count, 3).exchanges().len(), expected);
        }
        // One of them pushed alone: the mirror through it is left. With odd laws, two pushed against each other turn into each other
        // with all signs changed.
        assert_eq!(on_all(ring(4, &[1.0, 0.0, 0.0, 0.0]), 4, 3).exchanges().len(), 1);
        let against = [1.0, 0.0, -1.0, 0.0];
        assert_eq!(on_all(ring(4, &against), 4, 2).exchanges().len(), 1);
        assert_eq!(on_all(ring(4, &against), 4, 3).exchanges().len(), 3);
    }

    #[test]
    fn what_differs_is_no_copy() {
        let alike = || ring(3, &[1.0; 3]);
        let springs = |third: PolynomialSpring| {
            let two =
                alike().element("a", spring(3, 0.5), [vec![(0, 1.0)]]).element("b", spring(3, 0.5), [vec![(1, 1.0)]]);
            two.element("c", third, [vec![(2, 1.0)]]).build().unwrap().exchanges().len()
        };
        assert_eq!((springs(spring(3, 0.5)), springs(spring(3, 0.51))), (5, 1));
        // Of dampers one may differ as well.
        let damped =
            |last: f64| on_all(alike().damping_matrix(Matrix::diagonal(&[0.1, 0.1, last])), 3, 3).exchanges().len();
        assert_eq!((damped(0.1), damped(0.2)), (5, 1));
        let between = alike().element("a", spring(2, 0.5), [vec![(0, 1.0), (1, -1.0)]]).build().unwrap();
        // The spring, not odd, would be turned round.
        assert!(between.exchanges().is_empty());
        let odd = alike().element("a", spring(3, 0.5), [vec![(0, 1.0), (1, -1.0)]]).build().unwrap();
        assert_eq!(odd.exchanges().len(), 1);
    }

    #[test]
    fn a_motion_is_its_own_image_where_equal_parts_move_alike() {
        let model = on_all(ring(3, &[1.0; 3]), 3, 3);
        let farthest = |x: [f64; 3]| {
            let motions = x.map(|x| vec![0.0, x, 0.5 * x]);
            model.exchanges().iter().map(|exchange| exchange.asymmetry(&model, &motions)).fold(0.0, f64::max)
        };
        assert!(farthest([0.3; 3]) < 1e-12);
        assert!((farthest([1.0, 0.0, 0.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
