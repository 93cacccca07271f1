//! Arrays of numbers as bytes with type and shape: `numpy.frombuffer(a["data"], a["dtype"]).reshape(a["shape"])`.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A dense array, row-major.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Array {
    /// `<f8`: little-endian 64-bit floating point.
    pub dtype: String,
    /// Lengths of the axes.
    pub shape: Vec<usize>,
    /// The numbers.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// Why an array cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ArrayError {
    /// Not 64-bit floating point.
    #[error("array `{name}` is of type `{dtype}`, expected `<f8`")]
    Type {
        /// Which array.
        name: &'static str,
        /// Its type.
        dtype: String,
    },
    /// Not the shape expected.
    #[error("array `{name}` has shape {shape:?} and {bytes} bytes, expected shape {expected:?}")]
    Shape {
        /// Which array.
        name: &'static str,
        /// Its shape.
        shape: Vec<usize>,
        /// Its bytes.
        bytes: usize,
        /// Shape expected.
        expected: Vec<usize>,
    },
    /// So many harmonics that their number cannot be meant.
    #[error("array `{name}` of {harmonics} harmonics")]
    Harmonics {
        /// Which array.
        name: &'static str,
        /// Number of harmonics H.
        harmonics: usize,
    },
    /// Not there, though every sender has it.
    #[error("array `{name}` is missing")]
    Missing {
        /// Which array.
        name: &'static str,
    },
    /// A verification that no branch can have.
    #[error("a verification with numbers that are not finite, or of points that are not there")]
    Verification,
    /// Motions of another truncation than the run's.
    #[error("{harmonics} harmonics in a run of {expected}")]
    OtherHarmonics {
        /// Their number of harmonics H.
        harmonics: usize,
        /// The run's.
        expected: usize,
    },
    /// Not numbers.
    #[error("array `{name}` has entries that are not finite")]
    NotFinite {
        /// Which array.
        name: &'static str,
    },
    /// A point of a curve over the forcing amplitude that is at none.
    #[error("the forcing amplitude of point {index} is not a finite number above zero")]
    Forcing {
        /// Which point.
        index: usize,
    },
    /// A special point of a branch that is none of its points.
    #[error("special point {index} of {points} points")]
    Special {
        /// Its index.
        index: usize,
        /// Points of the branch.
        points: usize,
    },
}

/// More than any setting allows, and far from where sizes overflow.
const MAX_HARMONICS: usize = 1 << 16;

impl Array {
    /// Array of `shape`, whose product is the number of values.
    pub fn new(shape: impl Into<Vec<usize>>, values: impl IntoIterator<Item = f64>) -> Self {
        let shape = shape.into();
        let size = 8 * shape.iter().product::<usize>();
        let mut data = Vec::with_capacity(size);
        values.into_iter().for_each(|value| data.extend_from_slice(&value.to_le_bytes()));
        debug_assert_eq!(data.len(), size);
        Self { dtype: "<f8".into(), shape, data }
    }

    /// The values, if the array has the shape expected.
    ///
    /// # Errors
    /// Another type or shape, or bytes that do not fill it.
    pub fn values(&self, name: &'static str, expected: &[usize]) -> Result<Vec<f64>, ArrayError> {
        if self.dtype != "<f8" {
            return Err(ArrayError::Type { name, dtype: self.dtype.clone() });
        }
        let count = expected.iter().try_fold(8usize, |size, &axis| size.checked_mul(axis));
        if self.shape != expected || count != Some(self.data.len()) {
            let (shape, bytes, expected) = (self.shape.clone(), self.data.len(), expected.to_vec());
            return Err(ArrayError::Shape { name, shape, bytes, expected });
        }
        let (chunks, _) = self.data.as_chunks::<8>();
        Ok(chunks.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
    }

    /// The same; every value has to be finite.
    ///
    /// # Errors
    /// Those of [`Array::values`], and values that are not finite.
    pub fn finite(&self, name: &'static str, expected: &[usize]) -> Result<Vec<f64>, ArrayError> {
        let values = self.values(name, expected)?;
        if values.iter().all(|value| value.is_finite()) { Ok(values) } else { Err(ArrayError::NotFinite { name }) }
    }

    /// Whether its bytes are as many numbers as its shape says.
    pub fn is_sound(&self) -> bool {
        let bytes = self.shape.iter().try_fold(8usize, |size, &axis| size.checked_mul(axis));
        self.dtype == "<f8" && bytes == Some(self.data.len())
    }

    /// Length of the first axis.
    pub fn len(&self) -> usize {
        self.shape.first().copied().unwrap_or(0)
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Fourier series a0, a1, b1, … (each of 2H + 1 numbers) as complex harmonics X_k = a_k − i b_k: axes
    /// `leading` × (H + 1) × 2, the last one (re, im).
    pub fn harmonics<'s>(leading: &[usize], harmonics: usize, series: impl IntoIterator<Item = &'s [f64]>) -> Self {
        let shape: Vec<usize> = leading.iter().copied().chain([harmonics + 1, 2]).collect();
        let values = series.into_iter().flat_map(|series| {
            series.chunks(2 * harmonics + 1).flat_map(move |one| {
                let pair = move |k: usize| if k == 0 { [one[0], 0.0] } else { [one[2 * k - 1], -one[2 * k]] };
                (0..=harmonics).flat_map(pair)
            })
        });
        Self::new(shape, values)
    }

    /// Back to the series of [`Array::harmonics`], one after the other; every value has to be finite.
    ///
    /// # Errors
    /// Those of [`Array::finite`], and more harmonics than any run has.
    pub fn series(&self, name: &'static str, leading: &[usize], harmonics: usize) -> Result<Vec<f64>, ArrayError> {
        if harmonics > MAX_HARMONICS {
            return Err(ArrayError::Harmonics { name, harmonics });
        }
        let shape: Vec<usize> = leading.iter().copied().chain([harmonics + 1, 2]).collect();
        let values = self.finite(name, &shape)?;
        let mut series = Vec::with_capacity(values.len());
        for one in values.chunks(2 * (harmonics + 1)) {
            series.push(one[0]);
            series.extend(one[2..].chunks(2).flat_map(|pair| [pair[0], -pair[1]]));
        }
        Ok(series)
    }
}
