//! What time marching says of isolas and of the largest response.

use super::evidence::Evidence;
use crate::overview::{BranchRow, Level};
use crate::store::Stability;
use crate::words::count;

impl Evidence<'_> {
    /// Whether isolas can be settled on, as a clause about one of them and all of them.
    pub(super) fn stability_of_isolas(&self) -> String {
        let isolas: Vec<&BranchRow> = self.levels.iter().flat_map(Level::isolas).collect();
        let verified: Vec<&Stability> = isolas.iter().filter_map(|isola| isola.stability.as_ref()).collect();
        if verified.is_empty() {
            return "whether it is stable and what leads there was not verified".into();
        }
        let stable = verified.iter().filter(|stability| stability.stable > 0.0).count();
        let unknown = verified.iter().filter(|stability| stability.stable == 0.0 && stability.unstable < 1.0).count();
        let all = count(verified.len(), "isola");
        let left = match isolas.len() - verified.len() {
            0 => String::new(),
            left => format!(" ({left} more not verified)"),
        };
        let found = match (stable, unknown) {
            (0, 0) => {
                format!("time marching found nothing of {all} stable{left}: it separates, but nothing settles there")
            }
            (0, _) => format!("time marching found nothing of {all} stable{left}, though not all could be verified"),
            (stable, _) if stable == verified.len() && stable == 1 => {
                format!("time marching found parts of it stable{left}: there the structure can settle")
            }
            (stable, _) if stable == verified.len() => {
                format!("time marching found parts of each of {all} stable{left}: there the structure can settle")
            }
            (stable, _) => {
                format!("time marching found parts of {stable} of {all} stable{left}: there the structure can settle")
            }
        };
        format!("{found}; what leads there was not looked for")
    }

    /// What is known of the stability of the largest response.
    pub(super) fn stability_of_peak(&self, largest: &BranchRow) -> &'static str {
        match largest.stability.as_ref().and_then(|stability| stability.peak.as_deref()) {
            Some("stable") => "; by time marching it is stable",
            Some("unstable") => "; by time marching it is unstable",
            Some("marginal") => "; by time marching it is at the edge of stability",
            Some("not_comparable") => {
                "; whether it is stable is not known: marching loses impact energy that the balance keeps"
            }
            Some(_) => "; time marching found no periodic motion near it",
            None => "; whether it is stable was not verified",
        }
    }
}
