//! Positions of joints as users have them, local coordinates ϕ from home, to configurations Q and back.

use crate::arguments::{Argument, CONFIGURATION};
use crate::batch::evaluate;
use crate::dynamics::Results;
use crate::errors;
use crate::robot::Robot;
use hamel::mechanism::Body;
use pyo3::prelude::*;
use pyo3::types::PyDict;

impl Robot {
    /// Q of positions: an array of all of them, or those of some joints by name, the others at home.
    pub fn configuration_of<'py>(&self, positions: &Bound<'py, PyAny>) -> PyResult<Results<'py>> {
        let py = positions.py();
        let freedoms = self.sizes().freedoms;
        let given = match positions.cast::<PyDict>() {
            Ok(named) => self.gathered(named)?,
            Err(_) => positions.clone(),
        };
        let argument = Argument::read("positions", &given, freedoms)?;
        let shape = self.sizes().configuration;
        let [q] = evaluate(
            py,
            self.workspaces(),
            [argument],
            [&[shape]],
            |_, [phi], [q]| {
                for (index, body) in self.mechanism().joints() {
                    let (from, to) = places(body);
                    let moved = self
                        .mechanism()
                        .configuration_from_local(index, &phi[from])?;
                    q[to].copy_from_slice(&moved);
                }
                Ok(())
            },
        )?;
        Ok(q)
    }

    /// Positions of Q.
    pub fn positions_of<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Results<'py>> {
        let argument = Argument::read(CONFIGURATION, q, self.sizes().configuration)?;
        let shape = self.sizes().freedoms;
        let [phi] = evaluate(
            q.py(),
            self.workspaces(),
            [argument],
            [&[shape]],
            |_, [q], [phi]| {
                self.mechanism().check_configuration(q)?;
                for (_, body) in self.mechanism().joints() {
                    let (to, from) = places(body);
                    let local = body.joint().local(&body.home(), &q[from], &mut phi[to]);
                    local.map_err(|cause| body.finite_map(cause))?;
                }
                Ok(())
            },
        )?;
        Ok(phi)
    }

    /// ∂Q/∂ϕ at ϕ = 0: of each joint ∂Q/∂v S₀.
    pub fn by_local_of<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Results<'py>> {
        let argument = Argument::read(CONFIGURATION, q, self.sizes().configuration)?;
        let shape = [self.sizes().configuration, self.sizes().freedoms];
        let [slopes] = evaluate(
            q.py(),
            self.workspaces(),
            [argument],
            [&shape],
            |_, [q], [slopes]| {
                self.mechanism().check_configuration(q)?;
                for (_, body) in self.mechanism().joints() {
                    let (columns, rows) = places(body);
                    let q = &q[rows.clone()];
                    let mut velocities = vec![0.0; columns.len() * columns.len()];
                    body.joint().velocity_map(q, &mut velocities);
                    let mut rate = vec![0.0; rows.len()];
                    // Each column is v of one rate of ϕ.
                    for (column, v) in columns.clone().zip(velocities.chunks(columns.len())) {
                        body.joint().configuration_rate(q, v, &mut rate);
                        for (row, &rate) in rows.clone().zip(&rate) {
                            slopes[row * shape[1] + column] = rate;
                        }
                    }
                }
                Ok(())
            },
        )?;
        Ok(slopes)
    }

    /// The nearest Q on the manifolds.
    pub fn projected<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Results<'py>> {
        let shape = self.sizes().configuration;
        let [projected] = evaluate(
            q.py(),
            self.workspaces(),
            [Argument::read("near", q, shape)?],
            [&[shape]],
            |_, [q], [projected]| {
                self.mechanism().check_poses(q)?;
                projected.copy_from_slice(q);
                self.mechanism().project(projected)?;
                Ok(())
            },
        )?;
        Ok(projected)
    }

    /// An array of positions, zero except for those of the joints named.
    fn gathered<'py>(&self, named: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
        let py = named.py();
        let mut all = vec![0.0; self.sizes().freedoms];
        for (name, value) in named {
            let name: String = name.extract()?;
            let body = self.joint_named(py, &name)?;
            let own = body.ranges().freedoms.clone();
            let given = numbers(&name, &value, own.len())?;
            all[own].copy_from_slice(&given);
        }
        Ok(numpy::PyArray1::from_vec(py, all).into_any())
    }

    /// The joint of that name, or under the body of that name.
    pub fn joint_named(&self, py: Python<'_>, name: &str) -> PyResult<&Body> {
        let found = self.model().joint(name);
        found.map_err(|error| errors::of(py, &error.into()))
    }
}

/// Where the entries of a joint lie in ϕ and in Q.
fn places(body: &Body) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
    let ranges = body.ranges();
    (ranges.freedoms.clone(), ranges.configuration.clone())
}

/// The numbers given for one joint: one alone where it has one degree of freedom.
fn numbers(joint: &str, value: &Bound<'_, PyAny>, wanted: usize) -> PyResult<Vec<f64>> {
    if let (1, Ok(number)) = (wanted, value.extract::<f64>()) {
        return Ok(vec![number]);
    }
    let given: Option<Vec<f64>> = value.extract().ok();
    match given {
        Some(given) if given.len() == wanted => Ok(given),
        _ => {
            let message = format!(
                "positions: joint `{joint}` is at {value:?}: it must be at {wanted} numbers"
            );
            Err(errors::argument(value.py(), message))
        }
    }
}

/// A range as a slice of Python.
pub fn range<'py>(
    py: Python<'py>,
    range: &std::ops::Range<usize>,
) -> Bound<'py, pyo3::types::PySlice> {
    // No vector of a mechanism is near that long.
    let place = |end: usize| isize::try_from(end).unwrap_or(isize::MAX);
    pyo3::types::PySlice::new(py, place(range.start), place(range.end), 1)
}
