//! Orders of people to a running coordinator, on `rpc/control`.

use crate::codec::messages;
use serde::{Deserialize, Serialize};

/// An order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlRequest {
    /// Stop the run: branches under way are given up, what is stored stays.
    Cancel,
    /// Try the tasks of the dead list again.
    RetryDead,
}

/// What came of an order, in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControlReply {
    /// For whoever gave it.
    pub message: String,
}

messages! {
    ControlRequest => "control_request",
    ControlReply => "control_reply",
}
