//! The linear response, by elimination.

use super::balance::Matrices;
use num_complex::Complex64;

/// Complex amplitudes x of (K + iωC − ω²M) x = f, x(t) = Re x e^{iωt}, m.
pub fn response(matrices: &Matrices, force: &[f64], omega: f64) -> Vec<Complex64> {
    let n = force.len();
    let entry = |i, j| {
        let at = (i, j);
        let real = matrices.stiffness[at] - omega * omega * matrices.mass[at];
        Complex64::new(real, omega * matrices.damping[at])
    };
    let row = |i: usize| (0..n).map(|j| entry(i, j)).chain([Complex64::new(force[i], 0.0)]).collect();
    let mut rows: Vec<Vec<Complex64>> = (0..n).map(row).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].norm().total_cmp(&rows[b][k].norm())).expect("k < n");
        rows.swap(k, pivot);
        let top = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / top[k];
            row.iter_mut().zip(&top).for_each(|(a, b)| *a -= factor * b);
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}

/// Where a function of ω is largest near `omega`, and its value there: a fine grid over ± `width`, then golden sections.
pub fn maximum(omega: f64, width: f64, function: impl Fn(f64) -> f64) -> (f64, f64) {
    const GRID: usize = 2000;
    let at = |i: usize| omega - width + 2.0 * width * i as f64 / GRID as f64;
    let best = (1..GRID).max_by(|&a, &b| function(at(a)).total_cmp(&function(at(b)))).expect("a grid");
    let (mut low, mut high) = (at(best - 1), at(best + 1));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if function(a) > function(b) { high = b } else { low = a }
    }
    let place = 0.5 * (low + high);
    (place, function(place))
}
