//! Whether the orbit that marching came to from a point of a branch is that of another motion.

use super::{Reader, Result};
use rusqlite::params;

/// Relative distance in amplitude up to which an orbit is that of its own point: folds, at which two motions come together, are near.
const OWN: f64 = 0.01;

/// It is that of another motion that is nearer than this share of the distance: motions are read off between points of curves.
const NEARER: f64 = 0.5;

/// A marched orbit, and where it is told.
#[derive(Debug, Clone, Copy)]
pub(super) struct Marched {
    /// Its frequency, rad/s, and its largest |x| of the first monitored dof, m.
    pub at: (f64, f64),
    /// That of its branch as near to this frequency as it comes on the part that was looked at, m.
    pub own: f64,
}

impl Reader {
    /// Whether a branch of a level passes the frequency of an orbit far nearer to it than the part of the branch does that it was
    /// looked for at.
    pub(super) fn is_strayed(&self, level: i64, marched: Marched) -> Result<bool> {
        let Marched { at: (omega, amplitude), own } = marched;
        let off = |other: f64| (amplitude / other - 1.0).abs();
        if off(own).is_nan() || off(own) <= OWN {
            return Ok(false);
        }
        let sql = "SELECT a.omega, a.amplitude, b.omega, b.amplitude FROM branches JOIN points AS a ON a.branch = branches.id \
                   JOIN points AS b ON b.branch = a.branch \
                   AND b.i = CASE WHEN a.i + 1 < branches.points THEN a.i + 1 WHEN closed THEN 0 END \
                   WHERE level = ?1 AND (a.omega < ?2) != (b.omega < ?2) \
                   AND a.amplitude IS NOT NULL AND b.amplitude IS NOT NULL";
        let passages: Vec<[f64; 4]> =
            self.all(sql, params![level, omega], |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?]))?;
        let between = |[w0, x0, w1, x1]: [f64; 4]| x0 + (x1 - x0) * (omega - w0) / (w1 - w0);
        Ok(passages.into_iter().any(|passage| off(between(passage)) < NEARER * off(own)))
    }
}
