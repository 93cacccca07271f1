//! One period of motion at chosen points: what contact nodes do against the casing, and what monitored dofs do.

use super::branch::Curve;
use super::column::Column;
use protocol::array::ArrayError;
use protocol::curve::Size;
use protocol::to_everyone::StoredResult;
use serde::Serialize;
use solver::formulation::harmonics::width;
use solver::formulation::state::State;
use solver::structure::laws::Law;
use solver::structure::{ContactElement, Element, Model};

/// A place whose motion is drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Node {
    /// Name of the contact element or of the monitored dof.
    pub name: String,
    /// Clearance to the casing, m; `None` without contact.
    pub gap: Option<f64>,
    /// Of a monitored dof: displacements, m, at which stops begin to act that act on it alone.
    pub stops: Vec<f64>,
    /// The displacement, in modal coordinates: modes.
    #[serde(skip)]
    shape: Vec<f64>,
    /// Which argument of the laws is its predicted pressure.
    #[serde(skip)]
    pressure: Option<usize>,
}

/// The motion at a point of a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Motion {
    /// Branch, by index.
    pub branch: usize,
    /// Index of the point.
    pub index: usize,
    /// nodes × 2 × (2H + 1): displacement, of a contact node towards the casing, m, and predicted pressure p, N, as series
    /// c₀, a₁, b₁, …: x = c₀ + Σ a_k cos kωt + b_k sin kωt. The contact pressure is max(0, p).
    pub coefficients: Column,
}

/// Motions at chosen points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Motions {
    /// Number of harmonics H.
    pub harmonics: usize,
    /// The contact nodes, then the monitored dofs that are none of them.
    pub nodes: Vec<Node>,
    /// The chosen points.
    pub points: Vec<Motion>,
}

/// Contact nodes of a model, then its monitored dofs, but for those whose displacement closes the gap of a node.
pub fn nodes(model: &Model) -> Vec<Node> {
    let shape = |dofs: &[(usize, f64)]| model.modes().along(dofs).collect::<Vec<f64>>();
    let touching = |contact: ContactElement<'_>| Node {
        name: contact.element.name.clone(),
        gap: Some(contact.law.gap),
        stops: Vec::new(),
        shape: shape(&contact.element.channels[0]),
        pressure: Some(contact.first),
    };
    let monitored = |&dof: &usize| Node {
        name: model.dofs()[dof].clone(),
        gap: None,
        stops: stops(model, dof),
        shape: shape(&[(dof, 1.0)]),
        pressure: None,
    };
    let is_shown = |dof: &&usize| model.contacts().any(|contact| contact.element.channels[0] == [(**dof, 1.0)]);
    let others = model.monitors().iter().filter(|dof| !is_shown(dof)).map(monitored);
    model.contacts().map(touching).chain(others).collect()
}

/// Displacements of a dof at which stops begin to act that act on it alone.
fn stops(model: &Model, dof: usize) -> Vec<f64> {
    let stop = |element: &Element| match element.channels[0][..] {
        [(own, factor)] if own == dof && factor != 0.0 => Some(element.law.clearance()? / factor),
        _ => None,
    };
    model.elements().iter().filter_map(stop).collect()
}

impl Motions {
    /// None yet, of a model with H harmonics.
    pub fn new(model: &Model, harmonics: usize) -> Self {
        Self { harmonics, nodes: nodes(model), points: Vec::new() }
    }

    /// Adds motions of a branch, `count` at most: peak, folds and start, then evenly along the arc.
    ///
    /// # Errors
    /// If the arrays of the result do not fit the model's size.
    pub fn choose(
        &mut self,
        (branch, curve): (usize, &Curve),
        result: &StoredResult,
        size: &Size,
        count: usize,
    ) -> Result<(), ArrayError> {
        let Some(message) = &result.branch else { return Ok(()) };
        let states = message.points.motions.states(size.channels, size.modes)?;
        for index in chosen(curve, count) {
            let motion = self.motion((branch, index), &states[index]);
            self.points.push(motion);
        }
        Ok(())
    }

    /// The motion at a point of the branch that a result holds, if it holds one with such a point.
    ///
    /// # Errors
    /// If the arrays of the result do not fit the model's size.
    pub fn at(
        &self,
        (branch, index): (usize, usize),
        result: &StoredResult,
        size: &Size,
    ) -> Result<Option<Motion>, ArrayError> {
        let Some(message) = &result.branch else { return Ok(None) };
        let states = message.points.motions.states(size.channels, size.modes)?;
        Ok(states.get(index).map(|state| self.motion((branch, index), state)))
    }

    fn motion(&self, (branch, index): (usize, usize), state: &State) -> Motion {
        Motion { branch, index, coefficients: Column::short(self.coefficients(state)) }
    }

    /// How many of the nodes, the first ones, can touch.
    pub fn touching(&self) -> usize {
        self.nodes.iter().take_while(|node| node.gap.is_some()).count()
    }

    /// The nodes whose shape is shown: those that can touch, or the monitored dofs where none can.
    pub fn along(&self) -> &[Node] {
        match self.touching() {
            0 => &self.nodes,
            touching => &self.nodes[..touching],
        }
    }

    /// Displacement of every node, m, where those of the modes are `modal`.
    pub fn displacements(&self, modal: &[f64]) -> Vec<f64> {
        let of = |node: &Node| node.shape.iter().zip(modal).map(|(shape, y)| shape * y).sum();
        self.nodes.iter().map(of).collect()
    }

    /// Displacement and predicted pressure of every node: nodes × 2 × (2H + 1).
    fn coefficients(&self, state: &State) -> Vec<f64> {
        let nc = width(self.harmonics);
        let series = |node: &Node| {
            let pressure = node.pressure.map_or(vec![0.0; nc], |u| state.arguments[u * nc..(u + 1) * nc].to_vec());
            [state.combine(node.shape.iter().copied()), pressure]
        };
        self.nodes.iter().flat_map(series).flatten().collect()
    }
}

fn chosen(curve: &Curve, count: usize) -> Vec<usize> {
    let even = (0..count).map(|i| i * curve.size / count);
    let special = curve.special.iter().map(|special| special.index);
    let mut list = Vec::new();
    for index in std::iter::once(curve.peak).chain(special).chain(even) {
        if list.len() < count && !list.contains(&index) {
            list.push(index);
        }
    }
    list.sort_unstable();
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_of_a_dof_alone_are_where_they_act() {
        let model = Model::builder("stop")
            .mass([[1.0, 0.0], [0.0, 1.0]])
            .stiffness([[2.0, -1.0], [-1.0, 2.0]])
            .damping_ratio(0.01)
            .force("x1", 1.0)
            .monitor("x1")
            .monitor("x2")
            .stop("stop", "x1", 0.3)
            .build()
            .unwrap();
        // What closes the gap is told once.
        let found: Vec<(String, Option<f64>)> = nodes(&model).into_iter().map(|node| (node.name, node.gap)).collect();
        assert_eq!(found, [("stop".into(), Some(0.3)), ("x2".into(), None)]);
        assert_eq!(stops(&model, 0), [0.3]);
        assert!(stops(&model, 1).is_empty());
    }
}
