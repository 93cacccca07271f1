//! The backbone as a message.

use crate::array::ArrayError;
use crate::codec::messages;
use crate::columns::Columns;
use crate::curve::{Points, Size};
use serde::{Deserialize, Deserializer, Serialize};
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::response::branch::Outcome;
use solver::response::columns;

/// Backbone of p points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackboneMessage {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// How its first piece begins and ends.
    pub outcome: Outcome,
    /// How further pieces begin and end; not written without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub crossing: Vec<Outcome>,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
    /// The points.
    pub points: Points,
    /// What a backbone has besides: [`columns::of_backbone`].
    #[serde(flatten, deserialize_with = "columns_of_backbone")]
    pub columns: Columns,
}

fn columns_of_backbone<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Columns, D::Error> {
    Columns::read(deserializer, columns::of_backbone())
}

messages! { BackboneMessage => "backbone" }

impl From<&Backbone> for BackboneMessage {
    fn from(backbone: &Backbone) -> Self {
        let points = &backbone.points;
        Self {
            mode: backbone.mode,
            outcome: backbone.outcome,
            crossing: backbone.crossing.clone(),
            rejections: backbone.rejections,
            points: Points::new(points.iter().map(|point| &point.point)),
            columns: Columns::new(columns::of_backbone(), points.iter().map(|point| &point.values)),
        }
    }
}

impl BackboneMessage {
    /// The backbone, for a model of this size.
    ///
    /// # Errors
    /// Arrays of other shapes than such a model has, and values that are not finite.
    pub fn backbone(&self, size: &Size) -> Result<Backbone, ArrayError> {
        let points = self.points.points(size)?;
        let rows = self.columns.rows(columns::of_backbone(), points.len(), size)?;
        let points = points.into_iter().zip(rows).map(|(point, values)| BackbonePoint { point, values });
        let (mode, outcome, crossing) = (self.mode, self.outcome, self.crossing.clone());
        Ok(Backbone { mode, points: points.collect(), outcome, crossing, rejections: self.rejections })
    }
}
