//! All figures of a run.

use super::column_store::ColumnStore;
use super::data::Figure;
use super::subject::{BackboneColumns, Subject};
use super::{backbone, balance, folds, map, modes, motion, resonance, response};
use std::collections::BTreeMap;

/// The figures that a run has something for, with their columns; of the others, why not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Columns that they share.
    pub columns: ColumnStore,
    /// By name.
    pub drawn: BTreeMap<&'static str, Figure>,
    /// By name, why there is nothing to draw.
    pub nothing: BTreeMap<&'static str, String>,
}

impl Figures {
    /// Of what there is of a run.
    pub fn new(subject: &Subject<'_>) -> Self {
        let mut store = ColumnStore::default();
        let columns = subject.backbone.map(|backbone| BackboneColumns::new(backbone, &mut store));
        let columns = columns.as_ref();
        let figures = [
            ("response", response::figure(subject, &mut store, columns)),
            ("balance", balance::figure(subject, &store, columns)),
            ("backbone", backbone::figure(subject, columns)),
            ("map", map::figure(subject, &mut store, columns)),
            ("folds", folds::figure(subject, &mut store)),
            ("resonance", resonance::figure(subject, &mut store)),
            ("modes", modes::figure(subject, &mut store, columns)),
            ("motion", motion::figure(subject.motions)),
        ];
        let mut all = Self::default();
        for (name, figure) in figures {
            match figure {
                Ok(figure) => drop(all.drawn.insert(name, figure)),
                Err(why) => drop(all.nothing.insert(name, why)),
            }
        }
        Self { columns: store, ..all }
    }
}
