//! What is known of joints, as objects of Python.

use crate::errors::of_package;
use crate::positions::range;
use crate::robot::Robot;
use crate::source::Limits;
use hamel::joint::Unit;
use hamel::mechanism::Body;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

impl Robot {
    /// The `JointInfo` of a joint.
    pub fn info<'py>(&self, py: Python<'py>, body: &Body) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let (joint, ranges, units) = (body.joint(), body.ranges(), body.joint().units());
        let name = body.joint_name();
        let bodies = self.mechanism().bodies();
        let carried = bodies.iter().filter(|own| own.joint_name() == name);
        let parent = body.parent().map(|parent| bodies[parent].name());
        let facts = PyDict::new(py);
        facts.set_item("name", name)?;
        facts.set_item("type", joint.name())?;
        facts.set_item(
            "bodies",
            PyTuple::new(py, carried.map(Body::name).collect::<Vec<_>>())?,
        )?;
        facts.set_item("parent", parent)?;
        facts.set_item("configuration", range(py, &ranges.configuration))?;
        facts.set_item("freedoms", range(py, &ranges.freedoms))?;
        facts.set_item("speeds", range(py, &ranges.speeds))?;
        facts.set_item("coordinates", PyTuple::new(py, joint.coordinates())?)?;
        facts.set_item("freedom_names", PyTuple::new(py, joint.freedoms())?)?;
        facts.set_item("speed_names", PyTuple::new(py, joint.speeds())?)?;
        let of = |count: usize, unit: &dyn Fn(usize) -> &'static str| {
            PyTuple::new(py, (0..count).map(unit).collect::<Vec<_>>())
        };
        let layout = joint.layout();
        facts.set_item(
            "units",
            of(layout.configuration, &|i| units.coordinate(i).name)?,
        )?;
        facts.set_item("speed_units", of(layout.speeds, &|i| units.speed(i).rate)?)?;
        facts.set_item(
            "effort_units",
            of(layout.freedoms, &|i| units.velocity(i).effort)?,
        )?;
        let limits = self.limits_by_name().get(name);
        facts.set_item("limits", limits.map(|own| limits_of(py, own)).transpose()?)?;
        of_package(py, &CLASS, "hamel._values", "JointInfo")?.call((), Some(&facts))
    }
}

/// `Limits`.
pub fn limits_of<'py>(py: Python<'py>, limits: &Limits) -> PyResult<Bound<'py, PyAny>> {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let Limits {
        lower,
        upper,
        velocity,
        effort,
    } = *limits;
    of_package(py, &CLASS, "hamel._values", "Limits")?.call1((lower, upper, velocity, effort))
}

/// Names of columns of q and of v: as `hamel simulate` calls those of scalars, and by the names of stored scalars where Q holds others.
pub fn columns(robot: &Robot) -> (Vec<String>, Vec<String>) {
    let mut columns = (Vec::new(), Vec::new());
    for (_, body) in robot.mechanism().joints() {
        let (joint, units, name) = (body.joint(), body.joint().units(), body.joint_name());
        for (i, own) in joint.coordinates().iter().enumerate() {
            let ending = ending(units.coordinate(i), |unit| unit.name);
            columns.0.push(format!("{name}.q.{own}{ending}"));
        }
        for (i, own) in joint.speeds().iter().enumerate() {
            let ending = ending(units.speed(i), |unit| unit.rate);
            columns.1.push(format!("{name}.v.{own}{ending}"));
        }
    }
    columns
}

/// How the name of a column ends: `_rad_per_s`; numbers have no unit.
fn ending(unit: Unit, text: impl Fn(Unit) -> &'static str) -> String {
    match text(unit) {
        "" | "1" => String::new(),
        text => format!(
            "_{}",
            text.replace("1/", "per_")
                .replace('/', "_per_")
                .replace(' ', "_")
        ),
    }
}

/// The table of joints as HTML, for notebooks.
pub fn table(robot: &Robot) -> String {
    let mut rows = String::new();
    for (_, body) in robot.mechanism().joints() {
        let ranges = body.ranges();
        let limits = robot.limits_by_name().get(body.joint_name());
        let cells = [
            body.joint_name().to_owned(),
            body.joint().name().to_owned(),
            body.name().to_owned(),
            entries(&ranges.configuration),
            entries(&ranges.speeds),
            limits.map_or_else(String::new, shown_limits),
        ];
        rows.push_str("<tr>");
        for cell in cells {
            rows.push_str(&format!("<td>{}</td>", escaped(&cell)));
        }
        rows.push_str("</tr>");
    }
    let heads = [
        "joint",
        "type",
        "body",
        "entries of q",
        "entries of v",
        "limits",
    ];
    let heads: String = heads
        .iter()
        .map(|head| format!("<th>{head}</th>"))
        .collect();
    let name = escaped(&robot.model().scene().name);
    format!(
        "<table><caption>{name}</caption><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    )
}

fn entries(range: &std::ops::Range<usize>) -> String {
    match range.len() {
        0 => String::new(),
        1 => range.start.to_string(),
        _ => format!("{} to {}", range.start, range.end - 1),
    }
}

fn shown_limits(limits: &Limits) -> String {
    let end =
        |limit: Option<f64>| limit.map_or_else(|| String::from("…"), |limit| limit.to_string());
    match (limits.lower, limits.upper) {
        (None, None) => String::new(),
        (lower, upper) => format!("{} to {}", end(lower), end(upper)),
    }
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
