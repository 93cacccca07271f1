//! Where things stand: in the full state, and among the unknowns that are factorised.

use crate::formulation::receptance::RetainedMode;
use std::ops::Range;

/// The full state: arguments of all channels, modal amplitudes (both by series of nc numbers), parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Numbers per series, 2H + 1.
    pub nc: usize,
    pub channels: usize,
    pub modes: usize,
    pub parameters: usize,
}

impl Layout {
    pub fn len(&self) -> usize {
        self.parameters().end
    }

    /// Series of all channels.
    pub fn arguments(&self) -> Range<usize> {
        0..self.channels * self.nc
    }

    /// Series of all modes.
    pub fn modal(&self) -> Range<usize> {
        let start = self.arguments().end;
        start..start + self.modes * self.nc
    }

    pub fn parameters(&self) -> Range<usize> {
        let start = self.modal().end;
        start..start + self.parameters
    }

    /// Series of channel `u`.
    pub fn channel(&self, u: usize) -> Range<usize> {
        u * self.nc..(u + 1) * self.nc
    }

    /// Series of mode `j`.
    pub fn mode(&self, j: usize) -> Range<usize> {
        let start = self.modal().start + j * self.nc;
        start..start + self.nc
    }

    /// Series of the channels of an element.
    pub fn element(&self, channels: &Range<usize>) -> Range<usize> {
        channels.start * self.nc..channels.end * self.nc
    }
}

/// Places of (a_k, b_k); b_0 does not exist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub a: usize,
    pub b: Option<usize>,
}

impl Pair {
    /// Of harmonic k within a series.
    pub fn of(k: usize) -> Self {
        if k == 0 { Self { a: 0, b: None } } else { Self { a: 2 * k - 1, b: Some(2 * k) } }
    }

    /// Two neighbouring places for harmonic k (one for k = 0).
    fn at(start: usize, k: usize) -> Self {
        Self { a: start, b: (k > 0).then_some(start + 1) }
    }

    /// Moved by `start`.
    pub fn after(self, start: usize) -> Self {
        Self { a: start + self.a, b: self.b.map(|b| start + b) }
    }
}

/// An element whose arguments are unknowns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    /// Number of the element.
    pub element: usize,
    /// Its channels.
    pub channels: Range<usize>,
    /// Its unknowns: the series of these channels.
    pub unknowns: Range<usize>,
}

impl Block {
    /// Number within the element, channel and first unknown of each argument.
    pub fn arguments(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let nc = self.unknowns.len() / self.channels.len();
        self.channels.clone().enumerate().map(move |(i, u)| (i, u, self.unknowns.start + i * nc))
    }
}

/// A kept modal amplitude among the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KeptAt {
    pub kept: RetainedMode,
    /// Its places, rows and columns.
    pub at: Pair,
}

/// The unknowns of the matrix that is factorised: arguments of active elements, kept amplitudes, parameters; a border row
/// closes it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Unknowns {
    pub blocks: Vec<Block>,
    pub kept: Vec<KeptAt>,
    pub parameters: Range<usize>,
}

impl Unknowns {
    /// Of the elements that are active, numbered with their channels.
    pub fn new(active: impl Iterator<Item = (usize, Range<usize>)>, kept: &[RetainedMode], layout: &Layout) -> Self {
        let active = active.map(|(element, channels)| (element, channels.clone(), channels.len() * layout.nc));
        Self::with_lengths(active, kept.iter().copied(), layout.parameters)
    }

    /// The same unknowns where so many numbers stand for each block.
    pub fn narrowed(&self, lengths: impl Iterator<Item = usize>) -> Self {
        let blocks = self.blocks.iter().zip(lengths);
        let active = blocks.map(|(block, length)| (block.element, block.channels.clone(), length));
        Self::with_lengths(active, self.kept.iter().map(|kept| kept.kept), self.parameters.len())
    }

    fn with_lengths(
        active: impl Iterator<Item = (usize, Range<usize>, usize)>,
        kept: impl Iterator<Item = RetainedMode>,
        parameters: usize,
    ) -> Self {
        let mut end = 0;
        let mut next = |length: usize| {
            end += length;
            end - length..end
        };
        let blocks =
            active.map(|(element, channels, length)| Block { unknowns: next(length), element, channels }).collect();
        let kept = kept
            .map(|kept| {
                let length = if kept.harmonic == 0 { 1 } else { 2 };
                KeptAt { kept, at: Pair::at(next(length).start, kept.harmonic) }
            })
            .collect();
        Self { blocks, kept, parameters: next(parameters) }
    }

    /// Number of unknowns: size of the matrix, its border included.
    pub fn len(&self) -> usize {
        self.parameters.end
    }

    /// The arguments of the active elements.
    pub fn arguments(&self) -> Range<usize> {
        0..self.blocks.last().map_or(0, |block| block.unknowns.end)
    }

    /// The channels of the active elements, in order.
    pub fn channels(&self) -> impl Iterator<Item = usize> + '_ {
        self.blocks.iter().flat_map(|block| block.channels.clone())
    }

    /// Kept amplitudes of harmonic k.
    pub fn kept_at(&self, k: usize) -> impl Iterator<Item = &KeptAt> + '_ {
        self.kept.iter().filter(move |kept| kept.kept.harmonic == k)
    }
}
