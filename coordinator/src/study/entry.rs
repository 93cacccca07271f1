//! A forcing amplitude as written, and why it is refused.

/// What a list of amplitudes looks like.
pub(super) const EXAMPLE: &str =
    "give a list like [20, 60, 100], or a text like \"20, 60, 100\" or \"20:140:20\" (start:stop:step)";

/// A refused entry and what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refusal {
    pub value: String,
    pub remedy: String,
}

impl Refusal {
    pub fn new(value: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { value: value.into(), remedy: remedy.into() }
    }
}

/// A finite number above zero.
pub(super) fn number(text: &str) -> Result<f64, Refusal> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        Ok(_) => Err(Refusal::new(text, "a forcing amplitude is a finite number above zero")),
        Err(_) if text.is_empty() => Err(Refusal::new("(nothing)", format!("an entry is empty; {EXAMPLE}"))),
        Err(_) => Err(Refusal::new(text, format!("not a number; {EXAMPLE}"))),
    }
}
