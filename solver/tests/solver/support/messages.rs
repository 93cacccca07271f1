//! What messages have to say.

/// A message of one line has all of these parts.
#[track_caller]
pub fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    assert_eq!(message.lines().count(), 1, "{message:?} is not one line");
}
