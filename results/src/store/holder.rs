//! Who conducts a run.

/// Who conducts a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// Its process.
    pub pid: u32,
    /// Its machine.
    pub host: String,
    /// Whether that is this one.
    pub is_here: bool,
}
