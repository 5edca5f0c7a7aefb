//! Arguments: arrays of numbers, batched over leading dimensions that broadcast as those of numpy do.

use crate::errors;
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Arguments of no more numbers are copied: to make sure that nothing writes an array takes longer.
const SMALL: usize = 1 << 8;

/// The name of the argument of configurations.
pub const CONFIGURATION: &str = "q";

/// An array of states' shares: its last dimension has `entries` numbers.
pub struct Argument<'py> {
    name: &'static str,
    array: Bound<'py, PyArrayDyn<f64>>,
    numbers: Numbers<'py>,
    entries: usize,
}

/// The numbers of an array, in the order of C.
enum Numbers<'py> {
    Copied(Vec<f64>),
    Within(PyReadonlyArrayDyn<'py, f64>),
}

impl Numbers<'_> {
    fn all(&self) -> &[f64] {
        match self {
            Self::Copied(numbers) => numbers,
            // That they are a slice was seen when they were read.
            Self::Within(array) => array.as_slice().unwrap_or_default(),
        }
    }
}

impl<'py> Argument<'py> {
    /// What was given for the argument of that name. Doubles in the order of C are read where they are; all else is converted.
    ///
    /// # Errors
    /// What is no array of real numbers, or has another last dimension.
    pub fn read(name: &'static str, value: &Bound<'py, PyAny>, entries: usize) -> PyResult<Self> {
        let plain = value.cast::<PyArrayDyn<f64>>().ok();
        let read = plain.and_then(|array| Some((array.clone(), numbers(array)?)));
        let (array, numbers) = match read {
            Some(read) => read,
            None => converted(name, value)?,
        };
        match array.shape().last() {
            Some(&last) if last == entries => Ok(Self {
                name,
                array,
                numbers,
                entries,
            }),
            _ => {
                let shape = shown(array.shape());
                Err(errors::argument(
                    value.py(),
                    format!("{name} has shape {shape}: it must have shape (..., {entries})"),
                ))
            }
        }
    }

    /// The interpreter.
    pub fn py(&self) -> Python<'py> {
        self.array.py()
    }

    /// Its dimensions except for the last one.
    fn leading(&self) -> &[usize] {
        let shape = self.array.shape();
        &shape[..shape.len().saturating_sub(1)]
    }

    /// Whether it is that of configurations.
    pub fn is_configuration(&self) -> bool {
        self.name == CONFIGURATION
    }

    /// Its dimensions.
    pub fn shape(&self) -> &[usize] {
        self.array.shape()
    }

    /// Its numbers where they are one state's.
    pub fn one(&self) -> Option<&[f64]> {
        self.leading().is_empty().then(|| self.numbers.all())
    }

    /// Its numbers, to be read state by state of a batch of this shape.
    pub fn rows(&self, batch: &[usize]) -> Rows<'_> {
        Rows {
            data: self.numbers.all(),
            entries: self.entries,
            walk: Walk::new(self.leading(), batch),
        }
    }
}

/// The numbers of an array that needs no conversion.
fn numbers<'py>(array: &Bound<'py, PyArrayDyn<f64>>) -> Option<Numbers<'py>> {
    // Columns after columns are a slice as well.
    if !array.is_c_contiguous() {
        return None;
    }
    if array.len() <= SMALL {
        return Some(Numbers::Copied(array.to_vec().ok()?));
    }
    let array = array.try_readonly().ok()?;
    array.as_slice().is_ok().then_some(Numbers::Within(array))
}

/// An array of doubles in the order of C, made of whatever numpy makes an array of real numbers of.
fn converted<'py>(
    name: &'static str,
    value: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, Numbers<'py>)> {
    let py = value.py();
    let numpy = numpy_module(py)?;
    let refuse = |cause: PyErr| {
        // All else, such as Ctrl-C or a lack of memory, is not about the argument.
        let is_own =
            cause.is_instance_of::<PyTypeError>(py) || cause.is_instance_of::<PyValueError>(py);
        if !is_own {
            return cause;
        }
        let told = cause.value(py).to_string();
        errors::argument(py, format!("{name} is no array of numbers: {told}"))
    };
    let array = numpy
        .call_method1(intern!(py, "asarray"), (value,))
        .map_err(refuse)?;
    let dtype = array.getattr(intern!(py, "dtype"))?;
    let kind: String = dtype.getattr(intern!(py, "kind"))?.extract()?;
    if !matches!(&*kind, "b" | "i" | "u" | "f") {
        let message = format!("{name} is an array of {dtype}: it must be one of real numbers");
        return Err(errors::argument(py, message));
    }
    let wanted = (&array, intern!(py, "float64"), ("C", "ALIGNED"));
    let array = numpy
        .call_method1(intern!(py, "require"), wanted)
        .map_err(refuse)?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    let numbers = Numbers::Within(array.try_readonly()?);
    Ok((array, numbers))
}

/// The module numpy.
pub fn numpy_module(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static NUMPY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import("numpy")?.into_any().unbind())
    })?;
    Ok(module.bind(py))
}

/// A shape as Python writes it.
pub fn shown(shape: &[usize]) -> String {
    match shape {
        [only] => format!("({only},)"),
        shape => {
            let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// The leading dimensions that all arguments broadcast to.
///
/// # Errors
/// Leading dimensions that differ where neither is 1.
pub fn broadcast(py: Python<'_>, arguments: &[Argument<'_>]) -> PyResult<Vec<usize>> {
    let longest = arguments.iter().map(|own| own.leading().len()).max();
    let mut batch = vec![1; longest.unwrap_or(0)];
    for argument in arguments {
        let leading = argument.leading();
        let first = batch.len() - leading.len();
        for (place, &size) in batch[first..].iter_mut().zip(leading) {
            match (*place, size) {
                (_, 1) => {}
                (1, _) => *place = size,
                (known, size) if known == size => {}
                _ => return Err(apart(py, arguments)),
            }
        }
    }
    Ok(batch)
}

/// That leading dimensions do not broadcast.
fn apart(py: Python<'_>, arguments: &[Argument<'_>]) -> PyErr {
    let given = arguments.iter().map(|own| {
        let (name, shape) = (own.name, shown(own.array.shape()));
        format!("{name} {shape}")
    });
    let given: Vec<String> = given.collect();
    errors::argument(
        py,
        format!(
            "shapes do not broadcast: {}; dimensions before the last must be equal or 1",
            given.join(", ")
        ),
    )
}

/// The numbers of one argument, state by state.
pub struct Rows<'a> {
    data: &'a [f64],
    entries: usize,
    walk: Walk,
}

impl<'a> Rows<'a> {
    /// Those of one state of the batch.
    pub fn row(&self, state: usize) -> &'a [f64] {
        let first = self.walk.row(state) * self.entries;
        &self.data[first..first + self.entries]
    }
}

/// Which row of an argument belongs to a state of the batch.
enum Walk {
    /// All states have the only one.
    One,
    /// Each has its own.
    Each,
    /// Size of each dimension of the batch, and how many rows one step along it is; the last dimension first.
    Strided(Vec<(usize, usize)>),
}

impl Walk {
    fn new(leading: &[usize], batch: &[usize]) -> Self {
        if leading == batch {
            return Self::Each;
        }
        if leading.iter().all(|&size| size == 1) {
            return Self::One;
        }
        let mut stride = 1;
        let sizes = leading.iter().rev().copied().chain(std::iter::repeat(1));
        let steps = batch.iter().rev().zip(sizes).map(|(&extent, size)| {
            let step = if size == 1 { 0 } else { stride };
            stride *= size;
            (extent, step)
        });
        Self::Strided(steps.collect())
    }

    fn row(&self, state: usize) -> usize {
        match self {
            Self::One => 0,
            Self::Each => state,
            Self::Strided(steps) => {
                let mut rest = state;
                let mut row = 0;
                for &(extent, step) in steps {
                    row += rest % extent * step;
                    rest /= extent;
                }
                row
            }
        }
    }
}
