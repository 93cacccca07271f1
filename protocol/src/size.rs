//! The size of a model, as far as arrays of curves depend on it.

use solver::response::columns::Axis;

/// Numbers of a model that the shapes of arrays depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Arguments of all laws.
    pub channels: usize,
    /// Modes.
    pub modes: usize,
    /// Monitored dofs.
    pub monitors: usize,
    /// Contact elements.
    pub contacts: usize,
}

impl Size {
    /// Of a model.
    pub fn of(model: &solver::structure::Model) -> Self {
        Self {
            channels: model.arguments(),
            modes: model.size(),
            monitors: model.monitors().len(),
            contacts: model.contacts().count(),
        }
    }

    /// How many numbers a column has for a point.
    pub(crate) fn along(&self, axis: Axis) -> usize {
        match axis {
            Axis::Point => 1,
            Axis::Monitors => self.monitors,
            Axis::Contacts => self.contacts,
            Axis::Modes => self.modes,
        }
    }
}
