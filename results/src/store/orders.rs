//! A run by orders of motions: a reader tells of one of them, as of a run of its own.

use super::{Reader, Result, RunHeader};
use crate::journal::OrderPlan;
use protocol::level;
use protocol::model::ModelMessage;
use solver::response::orders::{Orders, orders};

impl Reader {
    /// Orders of motions that the run looks for beyond its first one.
    ///
    /// # Errors
    /// If names and settings of the run cannot be read.
    pub fn further_orders(&self) -> Result<Vec<usize>> {
        let model = self.model()?.model().map_err(|error| self.corrupt(error))?;
        Ok(orders(&model, &self.header()?.settings.search).into_iter().skip(1).collect())
    }

    /// Another reader of the same run, which tells of this order alone: its levels, what was found there, its backbones and the
    /// model with the force on that harmonic.
    ///
    /// # Errors
    /// If the run cannot be opened.
    pub fn of_order(&self, order: usize) -> Result<Self> {
        let mut reader = Self::open(self.dir())?;
        reader.order = Some(order);
        Ok(reader)
    }

    /// The order that is told of, if it is not the first.
    pub fn order(&self) -> Option<usize> {
        self.order
    }

    /// Whether a level is of the order that is told of.
    pub(super) fn tells_of(&self, level: &str) -> bool {
        level::order(level) == self.order
    }

    /// What selects the numbers of the levels that are told of, in SQL.
    pub(super) fn levels_told_of(&self) -> String {
        match self.order {
            None => "(SELECT level FROM levels WHERE amplitude NOT LIKE '%-m%')".into(),
            Some(order) => format!("(SELECT level FROM levels WHERE amplitude LIKE '%-m{order}')"),
        }
    }

    /// What the order is looked for with; `None` of the first one, and as long as there is no backbone.
    pub(super) fn order_plan(&self) -> Result<Option<OrderPlan>> {
        let Some(order) = self.order else { return Ok(None) };
        Ok(self.orders()?.into_iter().find(|plan| plan.order == order))
    }

    /// The model with its force on the harmonic of the order.
    pub(super) fn forced(&self, model: ModelMessage) -> ModelMessage {
        ModelMessage { forcing_harmonic: self.order.unwrap_or(model.forcing_harmonic), ..model }
    }

    /// The header of a run, with the settings that the order has.
    pub(super) fn settled(&self, header: RunHeader) -> Result<RunHeader> {
        let model = header.model.model().map_err(|error| self.corrupt(error))?;
        let orders = Orders::of(&model, &header.settings);
        let order = orders.get(self.order).ok_or_else(|| self.corrupt("an order of motions that nobody asked for"))?;
        Ok(RunHeader { settings: order.settings, model: self.forced(header.model), ..header })
    }
}
