//! Monitored dofs, and where they touch.

use serde::Serialize;
use solver::structure::Model;
use solver::structure::laws::Law;

/// A factor along a normal that differs from 1 by less is 1, rounded.
const ROUNDING: f64 = 1e-9;

/// A monitored dof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Monitor {
    /// Name.
    pub name: String,
    /// Where it touches the nearest casing or stop, either way, if it alone moves towards one.
    pub touch: Option<Touch>,
}

/// Where a dof touches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Touch {
    /// Its displacement there, m.
    pub at: f64,
    /// Whether that is the gap: it moves along the normal, not at an angle to it.
    pub is_gap: bool,
}

impl Touch {
    /// What is there, on labels.
    pub fn name(self) -> &'static str {
        if self.is_gap { "gap" } else { "contact begins" }
    }
}

/// Monitored dofs, with the places where they touch if they alone move towards a casing or a stop.
pub fn monitors(model: &Model) -> Vec<Monitor> {
    let touch = |dof: usize| {
        let touches = model.elements().iter().filter_map(|element| match element.channels[0][..] {
            [(own, factor)] if own == dof && factor != 0.0 => {
                let is_gap = (factor.abs() - 1.0).abs() < ROUNDING;
                Some(Touch { at: element.law.clearance()? / factor.abs(), is_gap })
            }
            _ => None,
        });
        // A stop that is pressed at rest is not touched first anywhere.
        touches.filter(|touch| touch.at > 0.0).min_by(|a, b| a.at.total_cmp(&b.at))
    };
    model.monitors().iter().map(|&dof| Monitor { name: model.dofs()[dof].clone(), touch: touch(dof) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_dofs_touch() {
        let model = Model::builder("stops")
            .mass([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            .stiffness([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
            .damping_ratio(0.01)
            .force("x1", 1.0)
            .monitor("x1")
            .monitor("x2")
            .monitor("x3")
            .stop("normal to it", "x1", 0.3)
            .stop("at 60°", [("x2", -0.5)], 0.3)
            .stop("of two", [("x2", 0.8), ("x3", 0.6)], 0.1)
            .build()
            .unwrap();
        let touches: Vec<Option<Touch>> = monitors(&model).into_iter().map(|monitor| monitor.touch).collect();
        let [gap, oblique] = [(0.3, true), (0.6, false)].map(|(at, is_gap)| Some(Touch { at, is_gap }));
        assert_eq!(touches, [gap, oblique, None]);
        assert_eq!([gap, oblique].map(|touch| touch.unwrap().name()), ["gap", "contact begins"]);
    }
}
