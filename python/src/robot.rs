//! The class `Robot`, and the ways to one.

use crate::errors::{self, of_package};
use crate::info;
use crate::source::{AllLimits, Source};
use crate::workspace::Workspaces;
use hamel::Model;
use hamel::erased::Layout;
use hamel::mechanism::Mechanism;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

type Arrays<'py> = Bound<'py, PyArrayDyn<f64>>;
type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// The robot or the scene in a file or a text.
#[pyfunction]
#[pyo3(signature = (file_or_text, *, floating_base=false))]
pub fn load(file_or_text: &Bound<'_, PyAny>, floating_base: bool) -> PyResult<Robot> {
    Robot::new(file_or_text.py(), Source::of(file_or_text, floating_base)?)
}

/// The robot of a text that was read before, for pickles.
#[pyfunction]
pub fn parse(py: Python<'_>, source: (String, String, bool, bool)) -> PyResult<Robot> {
    let (name, text, is_urdf, floating_base) = source;
    Robot::new(
        py,
        Source {
            name,
            text,
            is_urdf,
            floating_base,
        },
    )
}

/// A robot or a scene: its equations of motion, evaluated on arrays.
#[pyclass(frozen, module = "hamel")]
pub struct Robot {
    model: Model,
    source: Source,
    limits: AllLimits,
    workspaces: Workspaces,
}

impl Robot {
    fn new(py: Python<'_>, source: Source) -> PyResult<Self> {
        let read = py.detach(|| source.model());
        let (model, limits) = read.map_err(|error| errors::file(py, &source.name, &error))?;
        if source.floating_base && !source.is_urdf {
            let message = "floating_base is True: only robots in URDF have a base that it frees; a scene has a joint `free`";
            return Err(errors::argument(py, message));
        }
        Ok(Self {
            workspaces: Workspaces::new(model.mechanism()),
            model,
            source,
            limits,
        })
    }

    /// What it is in Rust.
    pub const fn model(&self) -> &Model {
        &self.model
    }

    /// Its bodies and joints.
    pub fn mechanism(&self) -> &Mechanism {
        self.model.mechanism()
    }

    /// Sizes of its vectors.
    pub fn sizes(&self) -> &Layout {
        self.model.sizes()
    }

    /// Memory for its equations of motion.
    pub const fn workspaces(&self) -> &Workspaces {
        &self.workspaces
    }

    /// Limits of its joints by their names.
    pub const fn limits_by_name(&self) -> &AllLimits {
        &self.limits
    }
}

#[pymethods]
impl Robot {
    #[getter]
    fn name(&self) -> &str {
        &self.model.scene().name
    }

    #[getter]
    fn description(&self) -> &str {
        &self.model.scene().description
    }

    #[getter]
    fn source(&self) -> &str {
        &self.source.text
    }

    #[getter]
    fn notices(&self) -> Vec<String> {
        self.model
            .scene()
            .notices
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.joints().collect::<Vec<_>>())
    }

    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.bodies().collect::<Vec<_>>())
    }

    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.frames().collect::<Vec<_>>())
    }

    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for (name, limits) in &self.limits {
            all.set_item(name, info::limits_of(py, limits)?)?;
        }
        Ok(all)
    }

    #[pyo3(name = "sizes")]
    #[getter]
    fn sizes_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let sizes = self.sizes();
        let class = of_package(py, &CLASS, "hamel._values", "Sizes")?;
        class.call1((sizes.configuration, sizes.freedoms, sizes.speeds))
    }

    fn joint<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let body = self.joint_named(py, name)?;
        self.info(py, body)
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let start = self.model.state();
        let arrays = (
            PyArray1::from_vec(py, start.configuration),
            PyArray1::from_vec(py, start.speeds),
            start.time,
        );
        of_package(py, &CLASS, "hamel._values", "State")?.call1(arrays)
    }

    fn configuration<'py>(&self, positions: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.configuration_of(positions)
    }

    fn positions<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.positions_of(q)
    }

    fn forward_dynamics<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.accelerations([q, v, tau])
    }

    fn inverse_dynamics<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.efforts([q, v, a])
    }

    fn bias_forces<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.bias([q, v])
    }

    fn mass_matrix<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.mass(q)
    }

    fn forward_dynamics_derivatives<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let [rates, by_local, by_speeds, by_efforts] =
            self.accelerations_and_derivatives([q, v, tau])?;
        let class = of_package(q.py(), &CLASS, "hamel._values", "ForwardDerivatives")?;
        class.call1((rates, by_local, by_speeds, by_efforts))
    }

    fn inverse_dynamics_derivatives<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let [by_local, by_speeds] = self.effort_derivatives([q, v, a])?;
        let class = of_package(q.py(), &CLASS, "hamel._values", "InverseDerivatives")?;
        class.call1((by_local, by_speeds))
    }

    #[pyo3(signature = (q, frame, axes="world_aligned"))]
    fn jacobian<'py>(&self, q: Given<'_, 'py>, frame: &str, axes: &str) -> PyResult<Arrays<'py>> {
        self.jacobian_of(q, (frame, axes))
    }

    #[pyo3(signature = (q, v, frame, axes="world_aligned"))]
    fn twist<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        frame: &str,
        axes: &str,
    ) -> PyResult<Arrays<'py>> {
        self.twist_of([q, v], (frame, axes))
    }

    fn pose<'py>(&self, q: Given<'_, 'py>, frame: &str) -> PyResult<Arrays<'py>> {
        self.pose_of(q, frame)
    }

    fn poses<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.poses_of_bodies(q)
    }

    fn energy<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.total_energy([q, v])
    }

    fn kinetic_energy<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        let [kinetic, _] = self.energies([q, v])?;
        Ok(kinetic)
    }

    fn potential_energy<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        let rest = PyArray1::<f64>::zeros(q.py(), self.sizes().speeds, false).into_any();
        let [_, potential] = self.energies([q, &rest])?;
        Ok(potential)
    }

    fn center_of_mass<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.center(q)
    }

    #[getter]
    fn _columns(&self) -> (Vec<String>, Vec<String>) {
        info::columns(self)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let Source {
            name,
            text,
            is_urdf,
            floating_base,
        } = self.source.clone();
        let parse = py.import("hamel._hamel")?.getattr("parse")?;
        let source = (name, text, is_urdf, floating_base).into_pyobject(py)?;
        Ok((parse, (source,).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let sizes = self.sizes();
        format!(
            "<hamel.Robot {:?}: {} joints, {} bodies, {} entries of q, {} speeds>",
            self.name(),
            self.model.joints().count(),
            self.model.bodies().count(),
            sizes.configuration,
            sizes.speeds
        )
    }

    fn _repr_html_(&self) -> String {
        info::table(self)
    }
}
