//! Columns of a curve as arrays by name: those of the list first, in its order, then what later programs have besides.

use crate::array::{Array, ArrayError};
use crate::size::Size;
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};
use solver::response::columns::{self, Axis, Column, Row};
use std::borrow::Cow;

/// Arrays by name, which stand as fields of their own in the map of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns(Vec<(Cow<'static, str>, Array)>);

impl Columns {
    /// Columns that points have, from their rows. One that a point is without is left out.
    pub fn new<'p>(
        list: impl Iterator<Item = &'static Column>,
        rows: impl ExactSizeIterator<Item = &'p Row> + Clone,
    ) -> Self {
        let array = |(place, column): (usize, &'static Column)| {
            let values: Vec<&[f64]> = rows.clone().map(|row| row.get(place)).collect::<Option<_>>()?;
            let mut shape = vec![values.len()];
            if column.axis != Axis::Point {
                shape.push(values.first().map_or(0, |values| values.len()));
            }
            Some((Cow::Borrowed(column.name), Array::new(shape, values.concat())))
        };
        Self(list.enumerate().filter_map(array).collect())
    }

    /// Rows of `count` points, for a model of this size.
    ///
    /// # Errors
    /// If an array of the list has another shape. A later column may be absent.
    pub fn rows(
        &self,
        list: impl Iterator<Item = &'static Column>,
        count: usize,
        size: &Size,
    ) -> Result<Vec<Row>, ArrayError> {
        // The number of points is what the message says it is: no row is made before the arrays are known to be as long.
        let mut parts = Vec::new();
        for column in list {
            let width = size.along(column.axis);
            let shape = if column.axis == Axis::Point { vec![count] } else { vec![count, width] };
            let array = self.get(column.name);
            if array.is_none() && !column.is_later {
                return Err(ArrayError::Missing { name: column.name });
            }
            parts.push((width, array.map(|array| array.values(column.name, &shape)).transpose()?));
        }
        let part = |i: usize, (width, values): &(usize, Option<Vec<f64>>)| {
            values.as_ref().map(|values| values[i * width..(i + 1) * width].to_vec())
        };
        Ok((0..count).map(|i| Row::new(parts.iter().map(|column| part(i, column)).collect())).collect())
    }

    /// The array of this name, if there is one.
    pub fn get(&self, name: &str) -> Option<&Array> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, array)| array)
    }

    /// The array of this name to be changed, if there is one.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut Array> {
        self.0.iter_mut().find(|(known, _)| known == name).map(|(_, array)| array)
    }

    /// The array of a column that every sender has.
    ///
    /// # Errors
    /// If it is not there.
    pub fn required(&self, name: &'static str) -> Result<&Array, ArrayError> {
        self.get(name).ok_or(ArrayError::Missing { name })
    }

    /// Names and arrays.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Array)> {
        self.0.iter().map(|(name, array)| (name.as_ref(), array))
    }

    /// Names and arrays to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (&str, &mut Array)> {
        self.0.iter_mut().map(|(name, array)| (&**name, array))
    }

    /// Columns of a list that are there.
    pub fn among(
        &self,
        list: impl Iterator<Item = &'static Column>,
    ) -> impl Iterator<Item = (&'static Column, &Array)> {
        list.filter_map(|column| Some((column, self.get(column.name)?)))
    }

    /// The same columns without numbers.
    pub fn emptied(&self) -> Self {
        Self(self.0.iter().map(|(name, _)| (name.clone(), Array::new([0], []))).collect())
    }

    /// Reads fields of a map.
    ///
    /// # Errors
    /// If a column of the list that every sender has is missing, or one of the list is no array. Unknown arrays
    /// are kept, so that a result passed on keeps its bytes, unless they contradict themselves or have the name of
    /// something else; other unknown fields are ignored.
    pub(crate) fn read<'de, D: Deserializer<'de>>(
        deserializer: D,
        list: impl Iterator<Item = &'static Column>,
    ) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Fields(list.map(|column| (column, None)).collect()))
    }
}

impl FromIterator<(&'static str, Array)> for Columns {
    fn from_iter<I: IntoIterator<Item = (&'static str, Array)>>(arrays: I) -> Self {
        Self(arrays.into_iter().map(|(name, array)| (Cow::Borrowed(name), array)).collect())
    }
}

impl Serialize for Columns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        self.0.iter().try_for_each(|(name, array)| map.serialize_entry(name, array))?;
        map.end()
    }
}

/// Arrays that stand beside columns wherever these are stored.
const BESIDE: [&str; 6] = ["omega", "decay", "forcing", "argument", "modal", "displacement"];

/// Whether an array that is not known may have this name: nothing else that is stored with it has.
fn is_free(name: &str, others: &[(Cow<'static, str>, Array)]) -> bool {
    let mut listed = columns::of_points().chain(columns::of_backbone());
    !BESIDE.contains(&name)
        && !listed.any(|column| column.name == name)
        && !others.iter().any(|(other, _)| other == name)
}

/// A field that is not known.
#[derive(Deserialize)]
#[serde(untagged)]
enum UnknownField {
    Array(Array),
    Other(IgnoredAny),
}

/// The columns of a list, as they come.
struct Fields(Vec<(&'static Column, Option<Array>)>);

impl<'de> Visitor<'de> for Fields {
    type Value = Columns;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("arrays by name")
    }

    fn visit_map<M: MapAccess<'de>>(mut self, mut map: M) -> Result<Columns, M::Error> {
        let mut others = Vec::new();
        while let Some(name) = map.next_key::<String>()? {
            match self.0.iter_mut().find(|(column, _)| column.name == name) {
                Some((column, Some(_))) => return Err(M::Error::duplicate_field(column.name)),
                Some((_, array)) => *array = Some(map.next_value()?),
                None => match map.next_value()? {
                    UnknownField::Array(array) if array.is_sound() && is_free(&name, &others) => {
                        others.push((Cow::Owned(name), array));
                    }
                    UnknownField::Array(_) | UnknownField::Other(IgnoredAny) => {}
                },
            }
        }
        let mut columns = Vec::new();
        for (column, array) in self.0 {
            match array {
                Some(array) => columns.push((Cow::Borrowed(column.name), array)),
                None if column.is_later => {}
                None => return Err(M::Error::missing_field(column.name)),
            }
        }
        columns.append(&mut others);
        Ok(Columns(columns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static KNOWN: [Column; 2] = [
        Column::new("speed", "m/s", Axis::Monitors, "largest speed"),
        Column::new("verdict", "", Axis::Point, "whether it is stable").later(),
    ];
    const SIZE: Size = Size { channels: 1, modes: 1, monitors: 2, contacts: 0 };

    fn bytes(columns: Vec<(&'static str, Array)>) -> Vec<u8> {
        rmp_serde::to_vec_named(&columns.into_iter().collect::<Columns>()).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<Columns, String> {
        let mut deserializer = rmp_serde::Deserializer::new(bytes);
        Columns::read(&mut deserializer, KNOWN.iter()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_later_column_may_be_absent_others_not() {
        let speed = ("speed", Array::new([1, 2], [3.0, 4.0]));
        let verdict = ("verdict", Array::new([1], [1.0]));
        let both = read(&bytes(vec![speed.clone(), verdict.clone()])).unwrap();
        let row = both.rows(KNOWN.iter(), 1, &SIZE).unwrap().remove(0);
        assert_eq!((row.get(0), row.get(1)), (Some(&[3.0, 4.0][..]), Some(&[1.0][..])));
        assert_eq!(Columns::new(KNOWN.iter(), [row].iter()), both);

        let before = read(&bytes(vec![speed.clone()])).unwrap();
        let row = before.rows(KNOWN.iter(), 1, &SIZE).unwrap().remove(0);
        assert_eq!((row.get(0), row.get(1)), (Some(&[3.0, 4.0][..]), None));
        assert_eq!(Columns::new(KNOWN.iter(), [row].iter()), before);

        let error = read(&bytes(vec![verdict.clone()])).unwrap_err();
        assert!(error.contains("missing field `speed`"), "{error}");
        let error = read(&bytes(vec![speed.clone(), speed])).unwrap_err();
        assert!(error.contains("duplicate field `speed`"), "{error}");
    }

    #[test]
    fn what_is_not_known_is_kept_behind_what_is() {
        let speed = ("speed", Array::new([1, 2], [3.0, 4.0]));
        let tomorrow = ("of tomorrow", Array::new([1], [5.0]));
        let as_sent = bytes(vec![speed.clone(), tomorrow.clone()]);
        let columns = read(&as_sent).unwrap();
        assert_eq!(rmp_serde::to_vec_named(&columns).unwrap(), as_sent);
        assert_eq!(read(&bytes(vec![tomorrow, speed])).unwrap(), columns);
        assert_eq!(columns.rows(KNOWN.iter(), 1, &SIZE).unwrap().len(), 1);
    }

    #[test]
    fn what_is_not_known_takes_no_other_name_and_does_not_contradict_itself() {
        let speed = ("speed", Array::new([1, 2], [3.0, 4.0]));
        let array = || Array::new([1], [5.0]);
        let unsound = Array { shape: vec![2], ..array() };
        let huge = Array { shape: vec![usize::MAX, 2], ..array() };
        let alone = read(&bytes(vec![speed.clone()])).unwrap();
        for (name, array) in
            [("modal", array()), ("omega", array()), ("displacement", array()), ("rms", array()), ("arc", array())]
                .into_iter()
                .chain([("of tomorrow", unsound), ("of tomorrow", huge)])
        {
            assert_eq!(read(&bytes(vec![speed.clone(), (name, array)])).unwrap(), alone, "{name}");
        }
        let twice = read(&bytes(vec![speed, ("of tomorrow", array()), ("of tomorrow", array())])).unwrap();
        assert_eq!(twice.iter().count(), 2);
    }
}
