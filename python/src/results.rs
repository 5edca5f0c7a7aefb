//! Arrays of results, while they are written.

use crate::arguments::numpy_module;
use crate::errors;
use numpy::ndarray::{ArrayView, IxDyn};
use numpy::{PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn};
use pyo3::prelude::*;

/// Results of fewer numbers are written beside the array and copied: to make sure that nothing else reads or writes an array takes longer.
const SMALL: usize = 1 << 10;

/// Results of more numbers are made by numpy, which can refuse them.
const LARGE: usize = 1 << 20;

/// Doubles of the largest array that there can be.
const MOST: usize = isize::MAX as usize / size_of::<f64>();

/// An array that is being written.
pub struct Room<'py> {
    dims: Vec<usize>,
    place: Place<'py>,
}

enum Place<'py> {
    Beside(Vec<f64>),
    Within(PyReadwriteArrayDyn<'py, f64>),
}

impl<'py> Room<'py> {
    /// Room for an array of these dimensions, zero everywhere.
    ///
    /// # Errors
    /// More numbers than memory holds.
    pub fn new(py: Python<'py>, dims: Vec<usize>) -> PyResult<Self> {
        let place = match size(&dims) {
            Some(entries) if entries <= SMALL => Place::Beside(vec![0.0; entries]),
            Some(entries) if entries <= LARGE => {
                let array = PyArrayDyn::zeros(py, IxDyn(&dims), false);
                Place::Within(array.try_readwrite()?)
            }
            Some(entries) if entries <= MOST => {
                let array = numpy_module(py)?.call_method1("zeros", (dims.clone(),))?;
                Place::Within(array.cast_into::<PyArrayDyn<f64>>()?.try_readwrite()?)
            }
            _ => return Err(errors::memory()),
        };
        Ok(Self { dims, place })
    }

    /// Its numbers.
    pub fn numbers(&mut self) -> &mut [f64] {
        match &mut self.place {
            Place::Beside(numbers) => numbers,
            // In the order of C, as it was made.
            Place::Within(array) => array.as_slice_mut().unwrap_or_default(),
        }
    }

    /// The array.
    ///
    /// # Errors
    /// None: it has as many numbers as its dimensions say.
    pub fn array(self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        match self.place {
            Place::Within(array) => Ok((**array).clone()),
            Place::Beside(numbers) => {
                let view = ArrayView::from_shape(IxDyn(&self.dims), &numbers);
                let view = view.map_err(|error| errors::argument(py, error.to_string()))?;
                Ok(PyArrayDyn::from_array(py, &view))
            }
        }
    }
}

/// How many there are of these dimensions; `None` where no number tells it.
pub fn size(dims: &[usize]) -> Option<usize> {
    dims.iter()
        .try_fold(1_usize, |all, &size| all.checked_mul(size))
}
