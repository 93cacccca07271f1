//! Names of forcing levels: the amplitude as typed, and where the study looks for motions of several orders
//! ([`solver::response::orders`]) the order of all but the first, as `60-m3`.

/// What stands between amplitude and order.
const SEPARATOR: &str = "-m";

/// The name of a level of further order.
pub fn of_order(typed: &str, order: usize) -> String {
    format!("{typed}{SEPARATOR}{order}")
}

/// The order m that a level's name has; `None` of levels of a study's first order.
pub fn order(level: &str) -> Option<usize> {
    level.rsplit_once(SEPARATOR).and_then(|(_, order)| order.parse().ok())
}

/// The amplitude in a level's name, as typed.
pub fn typed(level: &str) -> &str {
    match level.rsplit_once(SEPARATOR) {
        Some((typed, _)) if order(level).is_some() => typed,
        _ => level,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_amplitude_and_order() {
        for amplitude in ["60", "1e-3", "2.5E-4"] {
            assert_eq!((typed(amplitude), order(amplitude)), (amplitude, None));
            let name = of_order(amplitude, 3);
            assert_eq!((typed(&name), order(&name)), (amplitude, Some(3)));
            assert!(crate::ids::TaskId::of_level(&name, 12).unwrap().is_of_level(&name));
            assert!(!crate::ids::TaskId::of_level(&name, 12).unwrap().is_of_level(amplitude));
        }
    }
}
