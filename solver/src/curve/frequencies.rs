//! The frequencies of a curve's points, in order, with what makes a frequency easy to find among very many.

/// Points of a block.
const BLOCK: usize = 64;

/// Frequencies of the points of a curve, rad/s.
#[derive(Debug, Clone, Default)]
pub(super) struct Frequencies {
    list: Vec<f64>,
    /// Lowest and highest frequency of every block of chords, the end of the last one included.
    ranges: Vec<(f64, f64)>,
}

impl Frequencies {
    pub fn push(&mut self, omega: f64) {
        let index = self.list.len();
        // A point at which a block begins is the end of the last chord of the block before.
        if index.is_multiple_of(BLOCK) {
            self.ranges.push((f64::INFINITY, f64::NEG_INFINITY));
        }
        for block in [index / BLOCK, index.saturating_sub(1) / BLOCK] {
            let (low, high) = &mut self.ranges[block];
            (*low, *high) = (low.min(omega), high.max(omega));
        }
        self.list.push(omega);
    }

    /// Numbers of the points, of the first `count`, between which and the next one of these a frequency lies, ascending.
    pub fn around(&self, omega: f64, count: usize) -> impl Iterator<Item = usize> {
        let chords = count.min(self.list.len()).saturating_sub(1);
        let blocks = self.ranges.iter().enumerate().filter(move |(_, (low, high))| *low <= omega && omega <= *high);
        let chords = blocks.flat_map(move |(block, _)| block * BLOCK..chords.min((block + 1) * BLOCK));
        chords.filter(move |&i| (self.list[i] - omega) * (self.list[i + 1] - omega) <= 0.0)
    }
}

impl FromIterator<f64> for Frequencies {
    fn from_iter<I: IntoIterator<Item = f64>>(omegas: I) -> Self {
        let mut all = Self::default();
        omegas.into_iter().for_each(|omega| all.push(omega));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_around_a_frequency_are_those_that_looking_at_each_finds() {
        let wave = |i: usize| (0.037 * i as f64).sin() + 0.3 * (0.41 * i as f64).cos();
        for points in [0, 1, 2, 63, 64, 65, 66, 128, 129, 500] {
            let list: Vec<f64> = (0..points).map(wave).collect();
            let all: Frequencies = list.iter().copied().collect();
            for omega in list.iter().copied().chain((-15..15).map(|i| 0.1 * f64::from(i))) {
                for count in [0, 1, points / 2, points, points + 3] {
                    let pairs = list[..count.min(points)].windows(2).enumerate();
                    let one_by_one = pairs.filter(|(_, pair)| (pair[0] - omega) * (pair[1] - omega) <= 0.0);
                    let one_by_one: Vec<usize> = one_by_one.map(|(i, _)| i).collect();
                    assert_eq!(all.around(omega, count).collect::<Vec<_>>(), one_by_one, "{points} {count} {omega}");
                }
            }
        }
    }
}
