//! Truncated Fourier series and the frequency–time transforms.
//!
//! A series with H harmonics is stored as `[a0, a1, b1, a2, b2, …]` (2H + 1 numbers):
//! x(τ) = a0 + Σ a_k cos kτ + b_k sin kτ = Re Σ X_k e^{ikτ}, X_k = a_k − i b_k, τ = ωt.

use linalg::Fourier;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Numbers per series with `harmonics` harmonics.
pub const fn width(harmonics: usize) -> usize {
    2 * harmonics + 1
}

/// X_k of a series.
pub fn complex(series: &[f64], k: usize) -> Complex64 {
    match k {
        0 => Complex64::new(series[0], 0.0),
        _ => Complex64::new(series[2 * k - 1], -series[2 * k]),
    }
}

/// Stores X_k into a series (of X_0 only the real part).
pub fn set_complex(series: &mut [f64], k: usize, value: Complex64) {
    if k == 0 {
        series[0] = value.re;
    } else {
        series[2 * k - 1] = value.re;
        series[2 * k] = -value.im;
    }
}

/// Shifts the phase: X_k ← X_k e^{ikφ}, that is x(τ) ← x(τ + φ).
pub fn shift_phase(series: &mut [f64], phase: f64) {
    for k in 1..=series.len() / 2 {
        let shifted = complex(series, k) * Complex64::from_polar(1.0, k as f64 * phase);
        set_complex(series, k, shifted);
    }
}

/// Values of 1, cos τ, sin τ, cos 2τ, … at τ, into `out` (nc).
pub fn basis(tau: f64, out: &mut [f64]) {
    out[0] = 1.0;
    for k in 1..=out.len() / 2 {
        (out[2 * k], out[2 * k - 1]) = (k as f64 * tau).sin_cos();
    }
}

/// Value, first and second derivative with respect to τ.
pub fn evaluate(series: &[f64], tau: f64) -> [f64; 3] {
    let mut sum = [series[0], 0.0, 0.0];
    let rotation = Complex64::from_polar(1.0, tau);
    let mut e = rotation;
    for k in 1..=series.len() / 2 {
        let (a, b, kf) = (series[2 * k - 1], series[2 * k], k as f64);
        let value = a * e.re + b * e.im;
        sum[0] += value;
        sum[1] += kf * (b * e.re - a * e.im);
        sum[2] -= kf * kf * value;
        e *= rotation;
    }
    sum
}

/// Root mean square over a period.
pub fn rms(series: &[f64]) -> f64 {
    (series[0] * series[0] + 0.5 * series[1..].iter().map(|c| c * c).sum::<f64>()).sqrt()
}

/// Maximum of |x| over a period, between samples too: the largest samples are refined by Newton's method on x′ = 0.
pub fn max_abs(series: &[f64], transform: &mut Transform) -> f64 {
    let n = transform.samples();
    let mut values = vec![0.0; n];
    let mut unused = vec![0.0; n];
    transform.synthesise(series, None, &mut values, &mut unused);
    let coarse = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let step = TAU / n as f64;
    let curvature: f64 = (1..=series.len() / 2).map(|k| (k * k) as f64 * series[2 * k - 1].hypot(series[2 * k])).sum();
    // A peak between samples cannot exceed its nearest sample by more than this.
    let slack = 0.125 * curvature * step * step;
    let mut best = coarse;
    for i in 0..n {
        let (left, here, right) = (values[(i + n - 1) % n].abs(), values[i].abs(), values[(i + 1) % n].abs());
        if here < coarse - slack || here < left || here < right {
            continue;
        }
        let mut tau = i as f64 * step;
        for _ in 0..20 {
            let [_, slope, curve] = evaluate(series, tau);
            let update = (slope / curve).clamp(-0.5 * step, 0.5 * step);
            if !update.is_finite() {
                break;
            }
            tau -= update;
            if update.abs() < 1e-12 {
                break;
            }
        }
        best = best.max(evaluate(series, tau)[0].abs());
    }
    best
}

/// Frequency–time transforms between series with H harmonics and N_t samples; two real signals share one complex FFT.
pub struct Transform {
    harmonics: usize,
    fourier: Fourier,
    buffer: Vec<Complex64>,
}

impl Transform {
    /// Transform for `harmonics` harmonics and `samples` ≥ 4 × `harmonics` instants a period.
    pub fn new(harmonics: usize, samples: usize) -> Self {
        assert!(samples >= 4 * harmonics && samples > 0, "checked by the settings");
        Self { harmonics, fourier: Fourier::new(samples), buffer: vec![Complex64::default(); samples] }
    }

    /// Instants a period, N_t.
    pub fn samples(&self) -> usize {
        self.fourier.samples()
    }

    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// Samples of `a` and, if given, of `b` at τ = 2πn/N_t. They are transformed as one, each in its own [`unit`].
    pub fn synthesise(&mut self, a: &[f64], b: Option<&[f64]>, out_a: &mut [f64], out_b: &mut [f64]) {
        self.buffer.fill(Complex64::default());
        let (unit_a, unit_b) = (unit(a), b.map_or(1.0, unit));
        add_spectrum(&mut self.buffer, a, |x| x / unit_a);
        if let Some(b) = b {
            add_spectrum(&mut self.buffer, b, |x| Complex64::new(-x.im, x.re) / unit_b);
        }
        self.fourier.inverse(&mut self.buffer);
        for ((z, a), b) in self.buffer.iter().zip(out_a).zip(out_b) {
            *a = z.re * unit_a;
            *b = z.im * unit_b;
        }
    }

    /// Fourier coefficients c_0 … c_K (x = Σ c_l e^{ilτ}, c_{−l} = c̄_l) of two sampled signals, K = length − 1 ≤ 2H. They are transformed as
    /// one, each in its own [`unit`].
    pub fn analyse(&mut self, a: &[f64], b: &[f64], out_a: &mut [Complex64], out_b: &mut [Complex64]) {
        let (unit_a, unit_b) = (unit(a), unit(b));
        for ((z, &a), &b) in self.buffer.iter_mut().zip(a).zip(b) {
            *z = Complex64::new(a * (1.0 / unit_a), b * (1.0 / unit_b));
        }
        self.fourier.forward(&mut self.buffer);
        let (n, half) = (self.samples(), 0.5 / self.samples() as f64);
        for (l, (ca, cb)) in out_a.iter_mut().zip(out_b).enumerate() {
            let (z, mirrored) = (self.buffer[l], self.buffer[(n - l) % n].conj());
            *ca = (z + mirrored) * (half * unit_a);
            let difference = z - mirrored;
            *cb = Complex64::new(difference.im, -difference.re) * (half * unit_b);
        }
    }
}

/// The power of two next to the largest of these numbers, by which division is exact: of two signals that are transformed as one the larger one
/// would leave its rounding in the other, as stiffnesses in N/m do in forces of µN.
fn unit(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    if largest.is_normal() { f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits()) } else { 1.0 }
}

fn add_spectrum(buffer: &mut [Complex64], series: &[f64], map: impl Fn(Complex64) -> Complex64) {
    let n = buffer.len();
    buffer[0] += map(complex(series, 0));
    for k in 1..=series.len() / 2 {
        let c = 0.5 * complex(series, k);
        buffer[k] += map(c);
        buffer[n - k] += map(c.conj());
    }
}

/// Series of a signal from its Fourier coefficients c_0 … c_H.
pub fn series_from_coefficients(coefficients: &[Complex64], series: &mut [f64]) {
    series[0] = coefficients[0].re;
    for (k, c) in coefficients.iter().enumerate().take(series.len() / 2 + 1).skip(1) {
        set_complex(series, k, 2.0 * c);
    }
}

/// Derivative with respect to τ: (a_k, b_k) → (k b_k, −k a_k).
pub fn differentiate(series: &[f64], out: &mut [f64]) {
    out[0] = 0.0;
    for k in 1..=series.len() / 2 {
        out[2 * k - 1] = k as f64 * series[2 * k];
        out[2 * k] = -(k as f64) * series[2 * k - 1];
    }
}

/// Adds to `block` (row-major, row stride `stride`, 2H+1 rows and columns) the matrix of "multiply by w(τ), truncate",
/// from the Fourier coefficients c_0 … c_2H of w: a Toeplitz plus a Hankel matrix. With `rate` ≠ 0 the operand is
/// `rate` times the τ-derivative of the series instead of the series.
pub fn add_product_matrix(coefficients: &[Complex64], rate: Option<f64>, block: &mut [f64], stride: usize) {
    let harmonics = (coefficients.len() - 1) / 2;
    let at = |l: isize| if l >= 0 { coefficients[l as usize] } else { coefficients[(-l) as usize].conj() };
    for k in 0..=harmonics {
        // Columns 0, cos jτ, sin jτ; each as the pair (a_k, b_k) of the product.
        let (row_a, row_b) = if k == 0 { (0, None) } else { (2 * k - 1, Some(2 * k)) };
        if rate.is_none() {
            let mean = if k == 0 { coefficients[0] } else { 2.0 * coefficients[k] };
            block[row_a * stride] += mean.re;
            if let Some(row_b) = row_b {
                block[row_b * stride] -= mean.im;
            }
        }
        let half = if k == 0 { 0.5 } else { 1.0 };
        for j in 1..=harmonics {
            let (minus, plus) = (at(k as isize - j as isize), coefficients[k + j]);
            let (sum, difference) = ((minus + plus) * half, (minus - plus) * half);
            let (cosine, sine) = ((sum.re, -sum.im), (difference.im, difference.re));
            let (from_a, from_b) = match rate {
                None => (cosine, sine),
                Some(rate) => {
                    let r = rate * j as f64;
                    ((-r * sine.0, -r * sine.1), (r * cosine.0, r * cosine.1))
                }
            };
            let row = &mut block[row_a * stride + 2 * j - 1..];
            row[0] += from_a.0;
            row[1] += from_b.0;
            if let Some(row_b) = row_b {
                let row = &mut block[row_b * stride + 2 * j - 1..];
                row[0] += from_a.1;
                row[1] += from_b.1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..n)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
            })
            .collect()
    }

    #[test]
    fn samples_and_series_are_inverse() {
        let (h, n) = (5, 32);
        let mut transform = Transform::new(h, n);
        let (a, b) = (random(width(h), 1), random(width(h), 2));
        let (mut ta, mut tb) = (vec![0.0; n], vec![0.0; n]);
        transform.synthesise(&a, Some(&b), &mut ta, &mut tb);
        for (i, (x, y)) in ta.iter().zip(&tb).enumerate() {
            let tau = TAU * i as f64 / n as f64;
            assert!((x - evaluate(&a, tau)[0]).abs() < 1e-14);
            assert!((y - evaluate(&b, tau)[0]).abs() < 1e-14);
        }
        let mut ca = vec![Complex64::default(); 2 * h + 1];
        let mut cb = ca.clone();
        transform.analyse(&ta, &tb, &mut ca, &mut cb);
        let mut back = vec![0.0; width(h)];
        series_from_coefficients(&cb, &mut back);
        for (x, y) in back.iter().zip(&b) {
            assert!((x - y).abs() < 1e-14);
        }
    }

    #[test]
    fn signals_of_other_sizes_leave_no_rounding() {
        let (h, n) = (5, 32);
        let mut transform = Transform::new(h, n);
        let small: Vec<f64> = random(width(h), 1).iter().map(|x| 1e-12 * x).collect();
        let large: Vec<f64> = random(width(h), 2).iter().map(|x| 1e9 * x).collect();
        for is_first in [true, false] {
            let (a, b) = if is_first { (&small, &large) } else { (&large, &small) };
            let (mut ta, mut tb) = (vec![0.0; n], vec![0.0; n]);
            transform.synthesise(a, Some(b), &mut ta, &mut tb);
            let samples = if is_first { &ta } else { &tb };
            for (i, x) in samples.iter().enumerate() {
                assert!((x - evaluate(&small, TAU * i as f64 / n as f64)[0]).abs() < 1e-26);
            }
            let mut ca = vec![Complex64::default(); 2 * h + 1];
            let mut cb = ca.clone();
            transform.analyse(&ta, &tb, &mut ca, &mut cb);
            let mut back = vec![0.0; width(h)];
            series_from_coefficients(if is_first { &ca } else { &cb }, &mut back);
            for (x, y) in back.iter().zip(&small) {
                assert!((x - y).abs() < 1e-26);
            }
        }
    }

    #[test]
    fn product_matrix_is_the_truncated_product() {
        let (h, n) = (4, 32);
        let nc = width(h);
        let mut transform = Transform::new(h, n);
        let weight = random(n, 3);
        let (mut c, mut unused) = (vec![Complex64::default(); 2 * h + 1], vec![Complex64::default(); 2 * h + 1]);
        transform.analyse(&weight, &weight, &mut c, &mut unused);
        let series = random(nc, 4);
        let mut slope = vec![0.0; nc];
        differentiate(&series, &mut slope);
        for (operand, rate) in [(series.clone(), None), (slope, Some(1.0))] {
            let (mut t, mut z) = (vec![0.0; n], vec![0.0; n]);
            transform.synthesise(&operand, None, &mut t, &mut z);
            t.iter_mut().zip(&weight).for_each(|(t, w)| *t *= w);
            let mut spectrum = vec![Complex64::default(); h + 1];
            let mut other = spectrum.clone();
            transform.analyse(&t, &z, &mut spectrum, &mut other);
            let mut expected = vec![0.0; nc];
            series_from_coefficients(&spectrum, &mut expected);
            let mut block = vec![0.0; nc * nc];
            add_product_matrix(&c, rate, &mut block, nc);
            for (i, e) in expected.iter().enumerate() {
                let value = crate::linalg::dot(&block[i * nc..(i + 1) * nc], &series);
                assert!((value - e).abs() < 1e-13, "row {i}: {value} {e}");
            }
        }
    }

    #[test]
    fn maximum_between_samples() {
        let mut transform = Transform::new(3, 16);
        let series = [0.1, 0.3, -0.7, 0.0, 0.05, 0.02, 0.0];
        let fine = (0..200_000).map(|i| evaluate(&series, TAU * i as f64 / 2e5)[0].abs()).fold(0.0, f64::max);
        assert!((max_abs(&series, &mut transform) - fine).abs() < 1e-9);
    }
}
