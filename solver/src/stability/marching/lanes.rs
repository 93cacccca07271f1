//! Sums over rows of many columns at once, in the widest vectors of the processor. Products and sums are rounded one by one:
//! the result is the same on every processor.

use pulp::Simd;

/// Columns that are treated together: their numbers stay in the nearest cache.
pub const LANES: usize = 16;

/// One number of each column, in R vectors.
pub type Lane<S, const R: usize> = [<S as Simd>::f64s; R];

/// Rows of [`LANES`] numbers as vectors.
#[inline(always)]
pub fn rows<S: Simd, const R: usize>(numbers: &mut [f64]) -> &mut [Lane<S, R>] {
    S::as_mut_simd_f64s(numbers).0.as_chunks_mut().0
}

/// a x + b y.
#[inline(always)]
pub fn combine<S: Simd, const R: usize>(simd: S, (a, x): (f64, &Lane<S, R>), (b, y): (f64, &Lane<S, R>)) -> Lane<S, R> {
    let (a, b) = (simd.splat_f64s(a), simd.splat_f64s(b));
    std::array::from_fn(|r| simd.add_f64s(simd.mul_f64s(a, x[r]), simd.mul_f64s(b, y[r])))
}

/// x + y.
#[inline(always)]
pub fn add<S: Simd, const R: usize>(simd: S, x: &Lane<S, R>, y: &Lane<S, R>) -> Lane<S, R> {
    std::array::from_fn(|r| simd.add_f64s(x[r], y[r]))
}

/// sum + a x.
#[inline(always)]
pub fn more<S: Simd, const R: usize>(simd: S, sum: &mut Lane<S, R>, a: f64, x: &Lane<S, R>) {
    let a = simd.splat_f64s(a);
    for r in 0..R {
        sum[r] = simd.add_f64s(sum[r], simd.mul_f64s(a, x[r]));
    }
}

/// out_i = Σ_j row_ij x_j, one row for each of `out`; two at a time, so that neither waits for its own sum.
#[inline(always)]
pub fn gather<S: Simd, const R: usize>(simd: S, rows: &[f64], x: &[Lane<S, R>], out: &mut [Lane<S, R>]) {
    let n = x.len();
    for (out, rows) in out.chunks_mut(2).zip(rows.chunks(2 * n)) {
        let mut sums = [[simd.splat_f64s(0.0); R]; 2];
        if let [first, second] = out {
            let (a, b) = rows.split_at(n);
            for ((a, b), x) in a.iter().zip(b).zip(x) {
                more(simd, &mut sums[0], *a, x);
                more(simd, &mut sums[1], *b, x);
            }
            (*first, *second) = (sums[0], sums[1]);
        } else {
            for (a, x) in rows.iter().zip(x) {
                more(simd, &mut sums[0], *a, x);
            }
            out[0] = sums[0];
        }
    }
}

/// x_j ← x_j − Σ_i row_ij w_i, one row for each w.
#[inline(always)]
pub fn scatter<S: Simd, const R: usize>(simd: S, rows: &[f64], w: &[Lane<S, R>], x: &mut [Lane<S, R>]) {
    let n = x.len();
    for (j, x) in x.iter_mut().enumerate() {
        let mut sum = *x;
        for (i, w) in w.iter().enumerate() {
            more(simd, &mut sum, -rows[i * n + j], w);
        }
        *x = sum;
    }
}

/// x_j ← x_j − Σ_i row_ij w_i and y_j ← y_j + x_j, one row for each w.
#[inline(always)]
pub fn scatter_and_add<S: Simd, const R: usize>(
    simd: S,
    rows: &[f64],
    w: &[Lane<S, R>],
    x: &mut [Lane<S, R>],
    y: &mut [Lane<S, R>],
) {
    let n = x.len();
    for (j, (x, y)) in x.iter_mut().zip(y).enumerate() {
        let mut sum = *x;
        for (i, w) in w.iter().enumerate() {
            more(simd, &mut sum, -rows[i * n + j], w);
        }
        *x = sum;
        *y = add(simd, y, &sum);
    }
}
