//! Sums over rows of many columns at once, in the widest vectors of the processor. Products are added without being rounded (fused
//! multiply-add): the result is the same on every processor, and takes longer on one that cannot.

use pulp::Simd;

/// Columns that are treated together: the sums of a step stay in registers, their numbers in the nearest cache.
pub const LANES: usize = 8;

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
    std::array::from_fn(|r| simd.mul_add_f64s(a, x[r], simd.mul_f64s(b, y[r])))
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
        sum[r] = simd.mul_add_f64s(a, x[r], sum[r]);
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

/// Rows of uncoupled modes that a step with M nodes in contact takes, each of n numbers.
pub struct Pressed<'r> {
    /// D.
    pub decays: &'r [f64],
    /// a ω².
    pub stiffs: &'r [f64],
    /// Rows q and g, M of each, of nodes that rub; none without friction.
    pub friction: Option<[&'r [f64]; 2]>,
    /// Rows P and G, M of each.
    pub contact: [&'r [f64]; 2],
}

/// A step with M nodes in contact, on η and δ: δ̂ = D δ − aω² η − Σ g (q·δ), δ⁺ = δ̂ − Σ G (P·(η + δ̂)), η⁺ = η + δ⁺. The sums
/// stay in registers, and what is computed of a mode is used while it is there.
#[inline(always)]
pub fn press<'r, S: Simd, const R: usize, const M: usize>(
    simd: S,
    rows: &Pressed<'r>,
    eta: &mut [Lane<S, R>],
    delta: &mut [Lane<S, R>],
) {
    let n = eta.len();
    let delta = &mut delta[..n];
    let split = |rows: &'r [f64]| -> [&'r [f64]; M] { std::array::from_fn(|i| &rows[i * n..][..n]) };
    let (decays, stiffs) = (&rows.decays[..n], &rows.stiffs[..n]);
    let [p, g] = rows.contact.map(split);
    let zero = [simd.splat_f64s(0.0); R];
    let mut pressures = [zero; M];
    if let Some(friction) = rows.friction {
        let [q, turns] = friction.map(split);
        let mut turning = [zero; M];
        for j in 0..n {
            for i in 0..M {
                more(simd, &mut turning[i], -q[i][j], &delta[j]);
            }
        }
        for j in 0..n {
            let mut ahead = combine(simd, (decays[j], &delta[j]), (-stiffs[j], &eta[j]));
            for i in 0..M {
                more(simd, &mut ahead, turns[i][j], &turning[i]);
            }
            delta[j] = ahead;
            ahead = add(simd, &ahead, &eta[j]);
            for i in 0..M {
                more(simd, &mut pressures[i], -p[i][j], &ahead);
            }
        }
    } else {
        for j in 0..n {
            let mut ahead = combine(simd, (decays[j], &delta[j]), (-stiffs[j], &eta[j]));
            delta[j] = ahead;
            ahead = add(simd, &ahead, &eta[j]);
            for i in 0..M {
                more(simd, &mut pressures[i], -p[i][j], &ahead);
            }
        }
    }
    for j in 0..n {
        let mut sum = delta[j];
        for i in 0..M {
            more(simd, &mut sum, g[i][j], &pressures[i]);
        }
        delta[j] = sum;
        eta[j] = add(simd, &eta[j], &sum);
    }
}
