//! The same matrix with fewer unknowns, where forces depend on few combinations of their arguments.
//!
//! On arcs the Jacobian of an element's forces has a low rank: of the predicted pressure only its values there count, of the
//! tangential motion only what turns the sliding velocity. With V orthonormal rows that span those of the Jacobian, ∂f/∂a = U V,
//! w = V δa, and everything but δa itself in the rows of the arguments called T U,
//!
//! δa + T U w + … = −r becomes w + V T U w + … = −V r.
//!
//! Determinants are the same (Sylvester). Given w, forces are U w, all motions follow from the receptance, and δa from them. It
//! takes about a third of the unknowns for a quarter of the period, and rows of one element at a time.

use super::PressureForm;
use super::assemble::{BlockColumns, Columns, Target};
use super::layout::{Block, Unknowns};
use super::solution::product;
use crate::formulation::unknown::Parameter;
use crate::linalg::{axpy, dot, multiply, multiply_transposed, vectorised};
use crate::structure::laws::MAX_ARGUMENTS;
use std::ops::Range;

/// Fewer unknowns than this are not worth the search for bases.
const MANY: usize = 1000;

/// The matrix is compressed only to less than this share of the unknowns.
const WORTHWHILE: f64 = 0.8;

/// Movements of arguments that move forces less than this share of what moves them most are left out.
const NEGLIGIBLE: f64 = 1e-10;

/// Random sums that are taken at once.
const SUMS: usize = 32;

/// So many of them one after the other that bring nothing new are the last: what is left of the rows then is longer than eight
/// thresholds with a probability of 10 to the minus so many.
const CERTAIN: usize = 8;

/// How a matrix is compressed.
pub(super) struct Compressed {
    /// The unknowns that are left.
    pub unknowns: Unknowns,
    elements: Vec<Element>,
}

/// V and U of an element.
struct Element {
    /// V: its diagonal blocks.
    parts: Vec<Part>,
    /// U (arguments × rank), row-major.
    jacobian: Vec<f64>,
    /// For each force, how many columns of U it depends on.
    reach: [usize; MAX_ARGUMENTS],
}

/// Orthonormal rows over some arguments of an element.
struct Part {
    arguments: Range<usize>,
    unknowns: Range<usize>,
    rows: Vec<f64>,
}

impl Element {
    /// Of a Jacobian (row-major, square) of series of nc numbers; `reach` of each force in arguments.
    fn new(jacobian: &[f64], nc: usize, reach: [usize; MAX_ARGUMENTS]) -> Self {
        let size = jacobian.len().isqrt();
        let largest = jacobian.chunks(size).map(|row| dot(row, row)).fold(0.0, f64::max).sqrt();
        // The first argument is what decides on contact, the others move along with each other.
        let groups = [0..nc, nc..size];
        let mut parts: Vec<Part> = Vec::new();
        let mut products = Vec::new();
        for arguments in groups.into_iter().filter(|arguments| !arguments.is_empty()) {
            let width = arguments.len();
            let mut group = Vec::with_capacity(size * width);
            jacobian.chunks(size).for_each(|row| group.extend_from_slice(&row[arguments.clone()]));
            let rows = row_space(&group, width, NEGLIGIBLE * largest);
            let (begin, rank) = (parts.last().map_or(0, |part| part.unknowns.end), rows.len() / width);
            let mut product = vec![0.0; size * rank];
            multiply_transposed(&group, &rows, width, &mut product);
            products.push(product);
            parts.push(Part { arguments, unknowns: begin..begin + rank, rows });
        }
        let rank = parts.last().map_or(0, |part| part.unknowns.end);
        let mut narrow = vec![0.0; size * rank];
        for (part, product) in parts.iter().zip(&products).filter(|(part, _)| !part.unknowns.is_empty()) {
            for (target, source) in narrow.chunks_mut(rank).zip(product.chunks(part.unknowns.len())) {
                target[part.unknowns.clone()].copy_from_slice(source);
            }
        }
        let columns = |arguments: usize| {
            let depends = |part: &&Part| part.arguments.start < arguments * nc;
            parts.iter().rev().find(depends).map_or(0, |part| part.unknowns.end)
        };
        Self { reach: reach.map(columns), parts, jacobian: narrow }
    }

    fn rank(&self) -> usize {
        self.parts.last().map_or(0, |part| part.unknowns.end)
    }
}

/// Orthonormal rows (rank × `width`) that span those of a row-major matrix but for remainders of about a threshold: random sums
/// of the rows, as long as they bring something new (the adaptive range finder of Halko, Martinsson & Tropp, SIAM Review 53,
/// 217–288, 2011, algorithm 4.2). The same at every call.
pub(super) fn row_space(matrix: &[f64], width: usize, threshold: f64) -> Vec<f64> {
    let rows = matrix.len() / width;
    let (mut basis, mut state, mut known) = (Vec::new(), 1, 0);
    let mut sums = vec![0.0; SUMS * width];
    while known < CERTAIN && basis.len() < width * width {
        let signs: Vec<f64> = (0..SUMS * rows).map(|_| sign(&mut state)).collect();
        multiply(&signs, matrix, rows, &mut sums);
        vectorised(
            #[inline(always)]
            || {
                for sum in sums.chunks_mut(width) {
                    // Twice, since what is left of a short remainder has lost its angles to the others by rounding.
                    for _ in 0..2 {
                        basis.chunks(width).for_each(|row| axpy(-dot(row, sum), row, sum));
                    }
                    let length = dot(sum, sum).sqrt();
                    known = if length <= threshold { known + 1 } else { 0 };
                    if known == CERTAIN || basis.len() == width * width {
                        return;
                    }
                    if known == 0 {
                        basis.extend(sum.iter().map(|s| s / length));
                    }
                }
            },
        );
    }
    basis
}

/// A random sign: ±1.
#[inline]
fn sign(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    if *state >> 63 == 0 { 1.0 } else { -1.0 }
}

impl Compressed {
    /// Rows of the right-hand sides or forms: V v of the arguments, and the others as they are.
    fn restrict(&self, all: &Unknowns, side: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns.len()];
        for (block, narrow, part) in self.parts(all) {
            let source = &side[block.unknowns.start + part.arguments.start..][..part.arguments.len()];
            let target = &mut out[narrow.unknowns.start + part.unknowns.start..][..part.unknowns.len()];
            product(&part.rows, source, target);
        }
        out[self.unknowns.arguments().end..].copy_from_slice(&side[all.arguments().end..]);
        out
    }

    /// The transposed: Vᵀ w.
    fn widen(&self, all: &Unknowns, solution: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; all.len()];
        for (block, narrow, part) in self.parts(all) {
            let source = &solution[narrow.unknowns.start + part.unknowns.start..][..part.unknowns.len()];
            let target = &mut out[block.unknowns.start + part.arguments.start..][..part.arguments.len()];
            part.rows.chunks(target.len()).zip(source).for_each(|(row, w)| axpy(*w, row, target));
        }
        out[all.arguments().end..].copy_from_slice(&solution[self.unknowns.arguments().end..]);
        out
    }

    fn parts<'a>(&'a self, all: &'a Unknowns) -> impl Iterator<Item = (&'a Block, &'a Block, &'a Part)> {
        let blocks = all.blocks.iter().zip(&self.unknowns.blocks).zip(&self.elements);
        blocks.flat_map(|((block, narrow), element)| element.parts.iter().map(move |part| (block, narrow, part)))
    }

    fn columns(&self) -> Columns<'_> {
        let blocks = self.elements.iter();
        let blocks = blocks.map(|element| BlockColumns { jacobian: &element.jacobian, reach: element.reach }).collect();
        Columns { unknowns: &self.unknowns, blocks }
    }
}

impl PressureForm<'_> {
    /// The compression for the state last evaluated and a border row, where it is worth its while.
    pub(super) fn compression(&self, row: &[f64]) -> Option<Compressed> {
        let all = &self.unknowns;
        let has_own = |block: &Block| row[self.layout.element(&block.channels)].iter().any(|entry| *entry != 0.0);
        if self.condition.is_some() || !self.has_many_unknowns() || all.blocks.iter().any(has_own) {
            return None;
        }
        Some(self.compressed()).filter(|found| (found.unknowns.len() as f64) < WORTHWHILE * all.len() as f64)
    }

    /// Whether there are enough unknowns at the state last evaluated for what pays for many only.
    pub(super) fn has_many_unknowns(&self) -> bool {
        self.unknowns.len() >= MANY
    }

    /// The compression for the state last evaluated.
    pub(super) fn compressed(&self) -> Compressed {
        let element = |block: &Block| {
            let bound = &self.elements[block.element];
            Element::new(&self.forces[block.element].jacobian, self.layout.nc, bound.reach)
        };
        let elements: Vec<Element> = self.unknowns.blocks.iter().map(element).collect();
        let unknowns = self.unknowns.narrowed(elements.iter().map(Element::rank));
        Compressed { unknowns, elements }
    }

    /// Fills the compressed matrix of the state last evaluated.
    pub(super) fn assemble_compressed(&mut self, compressed: &Compressed, border: &[f64]) {
        let (all, narrow) = (&self.unknowns, &compressed.unknowns);
        let size = narrow.len();
        let (mut lu, mut rows) = (std::mem::take(&mut self.lu), std::mem::take(&mut self.rows));
        let (mut receptances, mut rates) =
            (std::mem::take(&mut self.receptances), std::mem::take(&mut self.modal_rates));
        let columns = compressed.columns();
        let (arguments, others) = lu.reset(size).split_at_mut(narrow.arguments().end * size);
        self.fill_receptances(&mut receptances, true);
        let mut target = Target { data: others, size, first: all.arguments().end };
        self.assemble_kept(&mut target, &columns, &mut rates);
        for ((block, narrow), element) in all.blocks.iter().zip(&narrow.blocks).zip(&compressed.elements) {
            rows.clear();
            rows.resize(block.unknowns.len() * size, 0.0);
            let mut target = Target { data: &mut rows, size, first: block.unknowns.start };
            self.assemble_block(&mut target, &columns, block, &receptances, &rates);
            for part in &element.parts {
                let source = &rows[part.arguments.start * size..part.arguments.end * size];
                let first = narrow.unknowns.start + part.unknowns.start;
                let target = &mut arguments[first * size..(first + part.unknowns.len()) * size];
                multiply(&part.rows, source, part.arguments.len(), target);
            }
        }
        for (i, row) in arguments.chunks_mut(size).enumerate() {
            row[i] += 1.0;
        }
        (self.receptances, self.modal_rates) = (receptances, rates);
        let last = others.len() / size - 1;
        if let Some(phase) = &self.phase {
            self.assemble_dependent_form(&mut others[(last - 1) * size..last * size], phase, &columns);
        }
        self.assemble_dependent_form(&mut others[last * size..], border, &columns);
        (self.lu, self.rows) = (lu, rows);
    }

    /// Solutions for two right-hand sides one after the other, expanded to the full state, with the compressed matrix last
    /// factorised.
    pub(super) fn solve_compressed(&mut self, compressed: &Compressed, sides: &[f64], out: [&mut [f64]; 2]) {
        let all = &self.unknowns;
        let restricted = sides.chunks(all.len()).flat_map(|side| compressed.restrict(all, side));
        let mut solutions: Vec<f64> = restricted.collect();
        self.lu.solve(&mut solutions);
        let solutions = solutions.chunks(compressed.unknowns.len());
        for ((side, solution), out) in sides.chunks(all.len()).zip(solutions).zip(out) {
            self.expand_compressed(compressed, side, solution, out);
        }
    }

    /// Forces from w, motions from forces, and the arguments from both.
    fn expand_compressed(&self, compressed: &Compressed, side: &[f64], solution: &[f64], out: &mut [f64]) {
        let (nc, scales) = (self.layout.nc, &self.system.scales);
        let mut force = vec![0.0; self.layout.arguments().len()];
        let blocks = self.unknowns.blocks.iter().zip(&compressed.unknowns.blocks).zip(&compressed.elements);
        for ((block, narrow), element) in blocks {
            let range = self.layout.element(&block.channels);
            product(&element.jacobian, &solution[narrow.unknowns.clone()], &mut force[range]);
        }
        self.expand_dependent(&compressed.unknowns, solution, &force, out);
        let (arguments, rest) = out.split_at_mut(self.layout.arguments().end);
        let (modal, parameters) = rest.split_at(self.layout.modal().len());
        let along_omega = self.frequency().map_or(0.0, |index| parameters[index] * scales.frequency);
        let mut series = vec![0.0; nc];
        for block in &self.unknowns.blocks {
            let domega = self.forces[block.element].domega.chunks(nc);
            for ((_, u, start), explicit) in block.arguments().zip(domega) {
                let (channel, range) = (self.channels[u], self.layout.channel(u));
                self.receptance.modal().displacement(u, modal, &mut series);
                for (h, a) in arguments[range.clone()].iter_mut().enumerate() {
                    let moved = channel.gain * scales.modal * series[h];
                    let fed_back = channel.feedback * (force[range.start + h] + explicit[h] * along_omega);
                    *a = side[start + h] + (moved + fed_back) / channel.scale;
                }
            }
        }
    }

    /// Number of the parameter that is the frequency.
    fn frequency(&self) -> Option<usize> {
        self.system.unknown.parameters().iter().position(|parameter| *parameter == Parameter::Frequency)
    }

    /// Solution of the transposed system for a form on the state.
    pub(super) fn solve_compressed_transposed(&mut self, compressed: &Compressed, form: &[f64]) -> Vec<f64> {
        let (all, narrow, nc) = (&self.unknowns, &compressed.unknowns, self.layout.nc);
        // Entries for the arguments weigh their equations; these have motions and forces on their other side.
        let mut moved = form.to_vec();
        let mut fed_back = vec![0.0; narrow.len()];
        let mut own = vec![0.0; all.len()];
        for ((block, narrow), element) in all.blocks.iter().zip(&narrow.blocks).zip(&compressed.elements) {
            let rows = |i: usize| element.jacobian.chunks(element.rank().max(1)).skip(i * nc);
            let domega = self.forces[block.element].domega.chunks(nc);
            for ((i, u, start), explicit) in block.arguments().zip(domega) {
                let (channel, series) = (self.channels[u], &form[self.layout.channel(u)]);
                own[start..start + nc].copy_from_slice(series);
                let factor = channel.gain * self.system.scales.modal / channel.scale;
                let modal = moved[self.layout.modal()].chunks_mut(nc);
                let shape = self.receptance.modal().shape(u);
                shape.iter().zip(modal).for_each(|(s, target)| axpy(factor * s, series, target));
                let factor = channel.feedback / channel.scale;
                let target = &mut fed_back[narrow.unknowns.clone()];
                rows(i).zip(series).for_each(|(row, entry)| axpy(factor * entry, row, target));
                if let Some(index) = self.frequency() {
                    let unit = self.system.scales.frequency;
                    fed_back[compressed.unknowns.parameters.start + index] += factor * unit * dot(series, explicit);
                }
            }
        }
        let mut side = vec![0.0; narrow.len()];
        self.assemble_dependent_form(&mut side, &moved, &compressed.columns());
        axpy(1.0, &fed_back, &mut side);
        self.lu.solve_transposed(&mut side);
        let mut weights = compressed.widen(all, &side);
        axpy(1.0, &own, &mut weights);
        weights
    }
}
