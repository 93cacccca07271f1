//! Motions that are images of each other: shifted by a period of the forcing, or mirrored, half a period later.

use crate::balance::Balance;
use crate::quadrature::{dot, norm};
use std::f64::consts::PI;

/// A symmetry of the equations of motion: a shift in τ, and whether displacements change their sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    shift: f64,
    sign: f64,
}

/// Cosine between the differences of two neighbouring motions from their images, below which there is a motion
/// between them that is its own image.
const FLIPPED: f64 = -0.5;

/// Least distance from an image, of the motion, from which on it is another motion.
const OTHER: f64 = 1e-6;

/// All images, the motion itself first: shifts by 2πj/m, and mirror images where all laws are odd.
pub fn images(balance: &Balance) -> Vec<Image> {
    let m = balance.structure.harmonic;
    let shifts = (0..m).map(|j| Image { shift: 2.0 * PI * j as f64 / m as f64, sign: 1.0 });
    let mirrors = (0..m).map(|j| Image { shift: PI * (2 * j + 1) as f64 / m as f64, sign: -1.0 });
    if balance.structure.is_odd() { shifts.chain(mirrors).collect() } else { shifts.collect() }
}

impl Image {
    /// The image of y, or of a difference of two.
    pub fn of(&self, balance: &Balance, y: &[f64]) -> Vec<f64> {
        let mut image = y.to_vec();
        for series in image[..balance.size()].chunks_mut(balance.width()) {
            series[0] *= self.sign;
            for k in 1..=balance.harmonics() {
                let (sin, cos) = (k as f64 * self.shift).sin_cos();
                let (a, b) = (series[2 * k - 1], series[2 * k]);
                series[2 * k - 1] = self.sign * (a * cos + b * sin);
                series[2 * k] = self.sign * (b * cos - a * sin);
            }
        }
        image
    }
}

/// A motion shifted in τ.
pub fn shifted(balance: &Balance, y: &[f64], shift: f64) -> Vec<f64> {
    Image { shift, sign: 1.0 }.of(balance, y)
}

/// Whether a curve of motions that are not their own images passes through one that is: it branches off a more
/// symmetric one.
pub fn is_attached(balance: &Balance, points: &[Vec<f64>]) -> bool {
    images(balance).iter().skip(1).any(|image| {
        let away =
            |y: &Vec<f64>| -> Vec<f64> { image.of(balance, y).iter().zip(y).map(|(image, y)| image - y).collect() };
        let list: Vec<Vec<f64>> = points.iter().map(away).collect();
        let largest = list.iter().map(|away| norm(away)).fold(0.0, f64::max);
        let motion = points.iter().map(|y| norm(y)).fold(0.0, f64::max);
        let flips = |a: &[f64], b: &[f64]| dot(a, b) < FLIPPED * norm(a) * norm(b);
        largest > OTHER * motion && list.windows(2).any(|pair| flips(&pair[0], &pair[1]))
    })
}
