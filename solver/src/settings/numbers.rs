//! Short lists of numbers that count from 1: of modes, of harmonics.

use serde::de::{Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

/// Up to [`NumberList::MOST`] numbers, from 1, in the order given: as `[1, 2]`, `1`, or typed in a shell as `1,2`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberList {
    count: usize,
    numbers: [usize; NumberList::MOST],
}

impl NumberList {
    /// Most numbers of a list.
    pub const MOST: usize = 16;

    /// A list of these numbers, from 1; `None` of more than [`NumberList::MOST`].
    pub fn new(numbers: &[usize]) -> Option<Self> {
        let mut list = Self { count: numbers.len(), numbers: [0; Self::MOST] };
        list.numbers.get_mut(..numbers.len())?.copy_from_slice(numbers);
        Some(list)
    }

    /// A list of one number.
    pub fn one(number: usize) -> Self {
        let mut numbers = [0; Self::MOST];
        numbers[0] = number;
        Self { count: 1, numbers }
    }

    /// The numbers, from 1.
    pub fn numbers(&self) -> &[usize] {
        &self.numbers[..self.count]
    }
}

impl std::fmt::Display for NumberList {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.numbers() {
            [only] => write!(f, "{only}"),
            numbers => write!(f, "{numbers:?}"),
        }
    }
}

impl Serialize for NumberList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.numbers().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for NumberList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Numbers { expected: "a list of numbers like [1, 2]" })
    }
}

/// Reads a list; says what was expected where it is none.
pub(super) struct Numbers {
    pub expected: &'static str,
}

impl<'de> Visitor<'de> for Numbers {
    type Value = NumberList;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<NumberList, E> {
        let typed = || text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<Vec<usize>>>();
        listed(typed().ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))?)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<NumberList, E> {
        Ok(NumberList::one(usize::try_from(number).unwrap_or(usize::MAX)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<NumberList, E> {
        let number = usize::try_from(number).map_err(|_| E::invalid_value(Unexpected::Signed(number), &self))?;
        Ok(NumberList::one(number))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<NumberList, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = sequence.next_element()? {
            numbers.push(number);
        }
        listed(numbers)
    }
}

fn listed<E: Error>(numbers: Vec<usize>) -> Result<NumberList, E> {
    let too_many = || E::custom(format!("{} numbers: give at most {}", numbers.len(), NumberList::MOST));
    NumberList::new(&numbers).ok_or_else(too_many)
}
