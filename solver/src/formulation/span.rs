//! What a truncated series can be on a part of the period: fewer numbers than its harmonics, the shorter the part.

use crate::formulation::harmonics::basis;
use crate::linalg::{axpy, dot};
use std::f64::consts::PI;

/// Directions that contribute less than this share of the largest are left out.
const NEGLIGIBLE: f64 = 1e-10;

/// Orthonormal rows (rank × nc, row-major) that span (1, cos τ, sin τ, …) for all τ of `arcs` (begin, end; radians).
pub fn span(arcs: &[(f64, f64)], nc: usize) -> Vec<f64> {
    let mut rows = Vec::new();
    for &(begin, end) in arcs {
        let half = 0.5 * (end - begin);
        // Chebyshev's points: beyond this degree nothing is left of the basis on the arc (Bessel functions J_n(Hh), n > Hh).
        let count = (1.5 * nc as f64 * half).ceil() as usize + 16;
        for n in 0..count {
            let mut row = vec![0.0; nc];
            basis(begin + half * (1.0 + ((n as f64 + 0.5) * PI / count as f64).cos()), &mut row);
            // Every arc counts alike, and the shortest has its direction.
            let weight = (count as f64).sqrt().recip();
            row.iter_mut().for_each(|b| *b *= weight);
            rows.push(row);
        }
    }
    orthonormal(rows, nc)
}

/// Orthonormal rows with the span of others (Gram–Schmidt, the longest remainder first).
fn orthonormal(mut rows: Vec<Vec<f64>>, nc: usize) -> Vec<f64> {
    let mut list: Vec<f64> = Vec::with_capacity(nc * nc);
    let mut threshold = 0.0;
    while list.len() < nc * nc {
        let squares = rows.iter().map(|row| dot(row, row)).enumerate();
        let Some((longest, square)) = squares.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if square.sqrt() <= threshold {
            break;
        }
        threshold = f64::max(threshold, NEGLIGIBLE * square.sqrt());
        let mut next = rows.swap_remove(longest);
        // What is left of a short remainder has lost its angles to the others by rounding.
        list.chunks(nc).for_each(|known| axpy(-dot(known, &next), known, &mut next));
        let length = dot(&next, &next).sqrt();
        next.iter_mut().for_each(|b| *b /= length);
        rows.iter_mut().for_each(|row| axpy(-dot(&next, row), &next, row));
        list.extend(next);
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn series_on_arcs_are_spanned() {
        let nc = 41;
        for arcs in [vec![(0.3, 0.9)], vec![(0.1, 0.2), (2.0, 3.5)], vec![(5.9, TAU + 0.2)]] {
            let span = span(&arcs, nc);
            let rank = span.len() / nc;
            assert!(rank < nc && span.len() == rank * nc, "{rank}");
            for (i, a) in span.chunks(nc).enumerate() {
                for (j, b) in span.chunks(nc).enumerate() {
                    assert!((dot(a, b) - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
            for (begin, end) in arcs {
                for n in 0..=50 {
                    let mut row = vec![0.0; nc];
                    basis(begin + f64::from(n) / 50.0 * (end - begin), &mut row);
                    span.chunks(nc).for_each(|known| axpy(-dot(known, &row), known, &mut row));
                    assert!(dot(&row, &row).sqrt() < 1e-7, "{}", dot(&row, &row).sqrt());
                }
            }
        }
    }

    #[test]
    fn the_whole_period_takes_all() {
        assert_eq!(span(&[(0.0, TAU)], 7).len(), 49);
        assert!(span(&[], 7).is_empty());
        assert_eq!(span(&[(1.0, 1.0)], 7).len(), 7);
    }
}
