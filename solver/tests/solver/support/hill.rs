//! Multipliers of one deviation from a periodic motion, by Runge–Kutta integration.

use std::f64::consts::TAU;

/// det(Φ − μI) of u″ + `damping` u′ + `stiffness`(x(t)) u = 0 over the first `over` of the equal steps between the values of x over a
/// period of frequency `omega`, two a step of the integration.
pub fn hill(
    motion: &[f64],
    omega: f64,
    over: usize,
    damping: f64,
    stiffness: impl Fn(f64) -> f64,
    multiplier: f64,
) -> f64 {
    let h = 2.0 * TAU / omega / motion.len() as f64;
    let rate = |u: [f64; 2], at: usize| [u[1], -damping * u[1] - stiffness(motion[at % motion.len()]) * u[0]];
    let columns = [[1.0, 0.0], [0.0, 1.0]].map(|mut u: [f64; 2]| {
        for at in (0..over).step_by(2) {
            let moved = |by: f64, r: [f64; 2]| [u[0] + by * r[0], u[1] + by * r[1]];
            let r1 = rate(u, at);
            let r2 = rate(moved(0.5 * h, r1), at + 1);
            let r3 = rate(moved(0.5 * h, r2), at + 1);
            let r4 = rate(moved(h, r3), at + 2);
            u = [0, 1].map(|i| u[i] + h / 6.0 * (r1[i] + 2.0 * r2[i] + 2.0 * r3[i] + r4[i]));
        }
        u
    });
    let [[a, c], [b, d]] = columns;
    (a - multiplier) * (d - multiplier) - b * c
}
