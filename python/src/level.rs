//! The level of instructions, for Python.

use hamel_sweep::level::{Arithmetic, LEVELS, VARIABLE, environment};
use pyo3::prelude::*;

/// The level of this process, and the sum of the bits of its mathematical functions.
#[pyfunction]
pub fn arithmetic(py: Python<'_>) -> (&'static str, String) {
    let Arithmetic { level, sum } = py.detach(Arithmetic::own);
    (level, sum)
}

/// Levels of x86-64, the lowest first, each with the variable that a process has in its environment when it starts, and its value; none where nothing is to be hidden.
#[pyfunction]
pub fn levels() -> Vec<(&'static str, Option<(&'static str, &'static str)>)> {
    let with_variable = |level| (level, environment(level).map(|value| (VARIABLE, value)));
    LEVELS.into_iter().map(with_variable).collect()
}
