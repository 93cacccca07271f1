//! The time of day.

use std::time::SystemTime;

/// Now, RFC 3339, UTC, to the ms: `2026-11-21T10:15:00.000Z`.
pub fn now() -> String {
    humantime::format_rfc3339_millis(SystemTime::now()).to_string()
}

/// Now, UTC, for names of files: `20261121-101500`.
pub fn compact() -> String {
    let second = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    second.replace(['-', ':', 'Z'], "").replace('T', "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn now_in_two_ways() {
        let (text, name) = (now(), compact());
        assert!(humantime::parse_rfc3339(&text).is_ok() && text.ends_with('Z'), "{text}");
        assert!(name.len() == 15 && name.replace('-', "").parse::<u64>().is_ok(), "{name}");
    }
}
