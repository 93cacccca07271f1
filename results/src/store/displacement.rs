//! Displacements of the dofs that matter, so that users of the file need no modal algebra.

use protocol::array::{Array, ArrayError};
use protocol::curve::Motions;
use protocol::model::ModelMessage;
use solver::linalg::axpy;
use std::collections::BTreeSet;

/// Rows of Φ of the nonlinear and monitored dofs.
#[derive(Debug)]
pub(crate) struct Displacements {
    /// The dofs.
    dofs: Vec<usize>,
    /// A row of Φ each.
    rows: Vec<Vec<f64>>,
}

impl Displacements {
    /// Of a model.
    pub fn new(model: &ModelMessage) -> Result<Self, ArrayError> {
        let n = model.dofs.len();
        let nonlinear =
            model.elements.iter().flat_map(|element| element.channels.iter().flatten()).map(|&(dof, _)| dof);
        let dofs: BTreeSet<usize> = nonlinear.chain(model.monitors.iter().copied()).filter(|&dof| dof < n).collect();
        let shapes = model.shapes.values("shapes", &[n, n])?;
        let rows = dofs.iter().map(|&dof| shapes[dof * n..(dof + 1) * n].to_vec()).collect();
        Ok(Self { dofs: dofs.into_iter().collect(), rows })
    }

    /// Names of the dofs.
    pub fn names<'m>(&self, model: &'m ModelMessage) -> Vec<&'m str> {
        self.dofs.iter().map(|&dof| model.dofs[dof].as_str()).collect()
    }

    /// Harmonics of the displacements: points × dofs × (H + 1) × 2.
    pub fn array(&self, motions: &Motions) -> Result<Array, ArrayError> {
        let (points, harmonics) = (motions.len(), motions.harmonics);
        let (modes, width) = (self.rows.first().map_or(0, Vec::len), 2 * (harmonics + 1));
        // Without points the number of modes is not known to the message.
        let modes = if points == 0 { motions.modal.shape.get(1).copied().unwrap_or(0) } else { modes };
        let modal = motions.modal.values("modal", &[points, modes, harmonics + 1, 2])?;
        let mut values = vec![0.0; points * self.rows.len() * width];
        for (p, motion) in modal.chunks((modes * width).max(1)).enumerate() {
            let out = &mut values[p * self.rows.len() * width..][..self.rows.len() * width];
            for (row, out) in self.rows.iter().zip(out.chunks_mut(width)) {
                row.iter().zip(motion.chunks(width)).for_each(|(&factor, series)| axpy(factor, series, out));
            }
        }
        Ok(Array::new([points, self.rows.len(), harmonics + 1, 2], values))
    }
}
