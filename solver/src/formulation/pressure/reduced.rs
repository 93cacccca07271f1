//! The same matrix with fewer unknowns, where forces act for parts of the period only.
//!
//! A law that acts on arcs knows of its arguments no more than their values there, which an orthonormal basis Q spans with fewer
//! numbers than harmonics ([`span`]): ∂f/∂a = ∂f/∂a Qᵀ Q. With w = Q δa and everything but δa itself in the rows of the
//! arguments called T, δa + T (w, z) = −r, where z are the other unknowns:
//!
//! w + Q T (w, z) = −Q r, and the rows of z as they are.
//!
//! Determinants are the same (Sylvester), and δa follows from w and z. With 20 harmonics, contact that lasts for a quarter of the
//! period takes half of the unknowns, and factorising them an eighth of the time.

use super::PressureForm;
use super::assemble::{Columns, Target};
use super::layout::Unknowns;
use crate::formulation::span::span;
use crate::linalg::{axpy, dot, multiply};
use std::f64::consts::TAU;

/// The matrix is reduced only to less than this share of the unknowns.
const WORTHWHILE: f64 = 0.8;

/// Numbers that an arc takes beside those of its share of the period.
const ENDS: usize = 8;

/// Smaller matrices are factorised as they are.
const SMALL: usize = 240;

/// How a matrix is reduced.
pub(super) struct Reduced {
    /// The unknowns that are left.
    pub unknowns: Unknowns,
    /// Q of every block (rank × nc), none where it is the identity.
    spans: Vec<Option<Vec<f64>>>,
    nc: usize,
}

impl Reduced {
    /// Of the unknowns of a state where the elements act on these arcs, unless it is hardly smaller.
    fn new<'a>(unknowns: &Unknowns, arcs: impl Iterator<Item = &'a [(f64, f64)]> + Clone, nc: usize) -> Option<Self> {
        let is_worthwhile = |narrow: &Unknowns| (narrow.len() as f64) < WORTHWHILE * unknowns.len() as f64;
        let narrowed = |ranks: &mut dyn Iterator<Item = usize>| {
            unknowns.narrowed(ranks.zip(&unknowns.blocks).map(|(rank, block)| rank * block.channels.len()))
        };
        let expected = narrowed(&mut arcs.clone().map(|arcs| least_rank(arcs, nc)));
        if unknowns.len() < SMALL || !is_worthwhile(&expected) {
            return None;
        }
        let spanned = |arcs: &[(f64, f64)]| {
            let span = (!arcs.is_empty()).then(|| span(arcs, nc));
            span.filter(|span| span.len() < nc * nc)
        };
        let spans: Vec<Option<Vec<f64>>> = arcs.map(spanned).collect();
        let narrow = narrowed(&mut spans.iter().map(|span| span.as_ref().map_or(nc, |span| span.len() / nc)));
        is_worthwhile(&narrow).then_some(Self { unknowns: narrow, spans, nc })
    }

    /// Ranges of every series of the arguments, all and reduced, with Q.
    fn series<'a>(
        &'a self,
        all: &'a Unknowns,
    ) -> impl Iterator<Item = (usize, std::ops::Range<usize>, Option<&'a [f64]>)> {
        let blocks = all.blocks.iter().zip(&self.unknowns.blocks).zip(&self.spans);
        blocks.flat_map(|((all, narrow), span)| {
            let rank = narrow.unknowns.len() / narrow.channels.len();
            all.arguments().map(move |(i, _, start)| {
                let first = narrow.unknowns.start + i * rank;
                (start, first..first + rank, span.as_deref())
            })
        })
    }

    /// Q v of a right-hand side or a form on all unknowns, and its other entries as they are.
    fn restrict(&self, all: &Unknowns, side: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns.len()];
        for (start, range, span) in self.series(all) {
            let source = &side[start..start + self.nc];
            match span {
                Some(span) => out[range].iter_mut().zip(span.chunks(self.nc)).for_each(|(o, q)| *o = dot(q, source)),
                None => out[range].copy_from_slice(source),
            }
        }
        out[self.unknowns.arguments().end..].copy_from_slice(&side[all.arguments().end..]);
        out
    }

    /// The transposed: Qᵀ w, and the others as they are.
    fn widen(&self, all: &Unknowns, solution: &[f64], out: &mut [f64]) {
        for (start, range, span) in self.series(all) {
            let target = &mut out[start..start + self.nc];
            match span {
                Some(span) => {
                    target.fill(0.0);
                    span.chunks(self.nc).zip(&solution[range]).for_each(|(q, w)| axpy(*w, q, target));
                }
                None => target.copy_from_slice(&solution[range]),
            }
        }
        out[all.arguments().end..].copy_from_slice(&solution[self.unknowns.arguments().end..]);
    }
}

impl PressureForm<'_> {
    /// The reduction for the state last evaluated and a border row, where one is worth its while.
    pub(super) fn reduction(&self, row: &[f64]) -> Option<Reduced> {
        let has_own =
            || self.unknowns.blocks.iter().any(|block| is_nonzero(&row[self.layout.element(&block.channels)]));
        if self.condition.is_some() || has_own() {
            return None;
        }
        let arcs = self.unknowns.blocks.iter().map(|block| self.forces[block.element].arcs.as_slice());
        Reduced::new(&self.unknowns, arcs, self.layout.nc)
    }

    /// Fills the reduced matrix of the state last evaluated, and T.
    pub(super) fn assemble_reduced(&mut self, reduced: &Reduced, border: &[f64]) {
        let (nc, all, size) = (self.layout.nc, self.unknowns.len(), reduced.unknowns.len());
        let narrow = self.narrowed_jacobians(reduced);
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        rows.resize(all * size, 0.0);
        let mut receptances = std::mem::take(&mut self.receptances);
        let mut rates = std::mem::take(&mut self.modal_rates);
        let mut target = Target { data: &mut rows, size, first: 0 };
        self.assemble_rows(&mut target, &self.reduced_columns(reduced, &narrow), &mut receptances, &mut rates);
        (self.receptances, self.modal_rates) = (receptances, rates);
        let columns = self.reduced_columns(reduced, &narrow);
        if let Some(phase) = &self.phase {
            self.assemble_dependent_form(&mut rows[(all - 2) * size..(all - 1) * size], phase, &columns);
        }
        self.assemble_dependent_form(&mut rows[(all - 1) * size..], border, &columns);
        let matrix = self.lu.reset(size);
        for (start, range, span) in reduced.series(&self.unknowns) {
            let source = &rows[start * size..(start + nc) * size];
            let target = &mut matrix[range.start * size..range.end * size];
            match span {
                Some(span) => multiply(span, source, nc, target),
                None => target.copy_from_slice(source),
            }
        }
        for i in reduced.unknowns.arguments() {
            matrix[i * size + i] += 1.0;
        }
        let others = &rows[self.unknowns.arguments().end * size..];
        matrix[reduced.unknowns.arguments().end * size..].copy_from_slice(others);
        self.rows = rows;
    }

    fn reduced_columns<'a>(&'a self, reduced: &'a Reduced, narrow: &'a [Option<Vec<f64>>]) -> Columns<'a> {
        let whole = |element: usize| &self.forces[element].jacobian;
        let blocks = self.unknowns.blocks.iter().zip(narrow);
        let blocks = blocks
            .map(|(block, narrow)| self.block_columns(block, narrow.as_ref().unwrap_or_else(|| whole(block.element))));
        Columns { unknowns: &reduced.unknowns, blocks: blocks.collect() }
    }

    /// ∂f/∂a Qᵀ of every block whose arguments are reduced.
    fn narrowed_jacobians(&self, reduced: &Reduced) -> Vec<Option<Vec<f64>>> {
        let nc = self.layout.nc;
        let narrowed = |(element, span): (usize, &Option<Vec<f64>>)| {
            let span = span.as_ref()?;
            let series = self.forces[element].jacobian.chunks(nc);
            Some(series.flat_map(|series| span.chunks(nc).map(move |q| dot(q, series))).collect())
        };
        let blocks = self.unknowns.blocks.iter().map(|block| block.element);
        blocks.zip(&reduced.spans).map(narrowed).collect()
    }

    /// Solutions for right-hand sides one after the other, in place, with the reduced matrix last factorised.
    pub(super) fn solve_reduced(&mut self, reduced: &Reduced, sides: &mut [f64]) {
        let (all, size) = (&self.unknowns, reduced.unknowns.len());
        let mut solutions: Vec<f64> = sides.chunks(all.len()).flat_map(|side| reduced.restrict(all, side)).collect();
        self.lu.solve(&mut solutions);
        for (side, solution) in sides.chunks_mut(all.len()).zip(solutions.chunks(size)) {
            let (arguments, others) = side.split_at_mut(all.arguments().end);
            for (argument, row) in arguments.iter_mut().zip(self.rows.chunks(size)) {
                *argument -= dot(row, solution);
            }
            others.copy_from_slice(&solution[reduced.unknowns.arguments().end..]);
        }
    }

    /// Solution of the transposed system for a form on the state.
    pub(super) fn solve_reduced_transposed(&mut self, reduced: &Reduced, form: &[f64]) -> Vec<f64> {
        let all = &self.unknowns;
        let mut own = vec![0.0; all.len()];
        for block in &all.blocks {
            own[block.unknowns.clone()].copy_from_slice(&form[self.layout.element(&block.channels)]);
        }
        let mut weights = vec![0.0; all.len()];
        self.assemble_form(&mut weights, form);
        // What depends on the forces only is in the span.
        weights.iter_mut().zip(&own).for_each(|(weight, own)| *weight -= own);
        let mut side = reduced.restrict(all, &weights);
        for (own, row) in own.iter().zip(self.rows.chunks(side.len())).filter(|(own, _)| **own != 0.0) {
            axpy(-own, row, &mut side);
        }
        self.lu.solve_transposed(&mut side);
        reduced.widen(all, &side, &mut weights);
        weights.iter_mut().zip(&own).for_each(|(weight, own)| *weight += own);
        weights
    }
}

/// Of a series on arcs, the numbers that are needed at least: as many as of a periodic one on as much of the period, and those
/// of the ends.
fn least_rank(arcs: &[(f64, f64)], nc: usize) -> usize {
    let length: f64 = arcs.iter().map(|(begin, end)| end - begin).sum();
    if arcs.is_empty() { nc } else { nc.min((nc as f64 * length / TAU) as usize + ENDS) }
}

fn is_nonzero(values: &[f64]) -> bool {
    values.iter().any(|value| *value != 0.0)
}
