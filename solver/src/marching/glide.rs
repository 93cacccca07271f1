//! A time step of modes on which nothing but the forcing acts.

use super::inverse::Uncoupled;

/// y_n with the increments that lead to it and on, as in [`Marching`](super::Marching).
pub struct Motion<'a> {
    pub y: &'a mut [f64],
    pub increment: &'a mut [f64],
    pub next: &'a mut [f64],
}

impl Motion<'_> {
    /// A step of uncoupled modes on which no law acts, in one pass; `ahead` is where the next increment leads without contact.
    #[inline(always)]
    pub fn glide(self, modes: &Uncoupled, (forcing, cosine): (&[f64], f64), squares: &[f64], ahead: &mut [f64]) {
        let n = self.y.len();
        let (y, increment, next, ahead) = (self.y, &mut self.increment[..n], &mut self.next[..n], &mut ahead[..n]);
        let (decays, compliances) = (&modes.decays[..n], &modes.compliances[..n]);
        let (forcing, squares) = (&forcing[..n], &squares[..n]);
        for j in 0..n {
            increment[j] = next[j];
            y[j] += increment[j];
            next[j] = decays[j] * increment[j] + compliances[j] * (forcing[j] * cosine - squares[j] * y[j]);
            ahead[j] = y[j] + next[j];
        }
    }
}
