//! The class `Robot`.

use crate::compile::Compilation;
use crate::errors::{self, of_package};
use crate::info;
use crate::pictures;
use crate::source::{AllLimits, Source};
use crate::workspace::Workspaces;
use hamel::Model;
use hamel::erased::Layout;
use hamel::mechanism::Mechanism;
use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

type Arrays<'py> = Bound<'py, PyArrayDyn<f64>>;
type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// A robot or a scene: its equations of motion, evaluated on arrays. `hamel.load` makes one.
///
/// With N, K and S of `sizes`, q is (..., N), efforts tau are (..., K), speeds v and accelerations are (..., S); K = S except for nonholonomic joints. The dimensions before the
/// last are a batch and broadcast as those of numpy do; large batches run on several threads, with the same bits as on one. Arguments may be of any real numbers in any
/// order; they are neither modified nor kept, and must not be changed by another thread during a call.
///
/// q is what the joints store, one after the other: the angle of a revolute joint, the displacement of a prismatic one, cosine and sine of a continuous one, a rotation matrix of
/// a ball. `configuration` makes it of angles and displacements of all joints, `joint` tells which entries belong to a joint.
///
/// Raises `ArgumentError` for a wrong shape, an unknown name or a number that is not finite, `DynamicsError` for equations without a solution.
#[pyclass(frozen, module = "hamel")]
pub struct Robot {
    model: Model,
    source: Source,
    limits: AllLimits,
    compilation: Option<Compilation>,
    workspaces: Workspaces,
}

impl Robot {
    /// The robot of a text that has been read, with what was compiled of it.
    pub fn new(
        source: Source,
        model: Model,
        limits: AllLimits,
        compilation: Option<Compilation>,
    ) -> Self {
        let equations = compilation.as_ref().map(|own| own.equations.clone());
        Self {
            workspaces: Workspaces::new(model.mechanism(), equations),
            compilation,
            model,
            source,
            limits,
        }
    }

    /// What it is in Rust.
    pub const fn model(&self) -> &Model {
        &self.model
    }

    /// What it was read from.
    pub const fn origin(&self) -> &Source {
        &self.source
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
    /// Name of the robot or scene.
    #[getter]
    fn name(&self) -> &str {
        &self.model.scene().name
    }

    /// What the scene shows; may be empty.
    #[getter]
    fn description(&self) -> &str {
        &self.model.scene().description
    }

    /// The text that it was read from.
    #[getter]
    fn source(&self) -> &str {
        &self.source.text
    }

    /// What the file says and a robot does not have, as texts: limits that are not simulated, meshes, unknown elements.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.model
            .scene()
            .notices
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    /// Names of the joints, in the order of their entries.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.joints().collect::<Vec<_>>())
    }

    /// Names of the bodies: one per joint, except for joints that carry several. Links that are fixed to others are frames.
    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.bodies().collect::<Vec<_>>())
    }

    /// Names of the frames beside those of the bodies.
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.frames().collect::<Vec<_>>())
    }

    /// The methods that call compiled functions, as `compile` made them; all others, and all of a robot that is not compiled, go by the general algorithms.
    #[getter]
    fn compiled<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let functions = self.compilation.iter().flat_map(|own| &own.functions);
        PyTuple::new(py, functions.copied().collect::<Vec<_>>())
    }

    /// The same robot with equations of motion that are compiled for it alone: as C, which holds nothing the robot does not need, by the C compiler that the variable `CC` names, else
    /// the first of `cc`, `gcc` and `clang`. That takes from a tenth of a second to a minute; calls take a fraction of the time then.
    ///
    /// It has the same methods, with the same results to rounding. They are compared once, where the file begins. Where `[[constraint]]`s couple joints, v has to meet them.
    ///
    /// What is not in `compiled` is answered by the general algorithms: Jacobians and frames, and functions that would be too long. So are states at which a compiled function
    /// has no finite value, and derivatives where efforts change with time. `hamel.simulate` takes the robot too. It pickles, and is compiled again where it is read.
    ///
    /// Args:
    ///     functions: names of methods to be compiled, of `forward_dynamics`, `inverse_dynamics`, `bias_forces`, `mass_matrix`, `energy` (with its parts), `poses`,
    ///         `forward_dynamics_derivatives` and `inverse_dynamics_derivatives`; without it all but the derivatives, which take longest to compile.
    ///
    /// Raises:
    ///     CompilationError: no C compiler; a scene of which no equations are written, with the element; a function that was named and would be too long.
    #[pyo3(signature = (functions=None))]
    fn compile(&self, py: Python<'_>, functions: Option<Vec<String>>) -> PyResult<Self> {
        self.compiled_with(py, functions)
    }

    /// Limits by the names of joints, as the file says them; of a robot they are not simulated.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for (name, limits) in &self.limits {
            all.set_item(name, info::limits_of(py, limits)?)?;
        }
        Ok(all)
    }

    /// Sizes of its vectors: N = `configuration`, K = `freedoms`, S = `speeds`.
    #[pyo3(name = "sizes")]
    #[getter]
    fn sizes_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let sizes = self.sizes();
        let class = of_package(py, &CLASS, "hamel._values", "Sizes")?;
        class.call1((sizes.configuration, sizes.freedoms, sizes.speeds))
    }

    /// What is known of a joint, by its name or that of its body: a `JointInfo`.
    fn joint<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let body = self.joint_named(py, name)?;
        self.info(py, body)
    }

    /// The initial state of the file: a `State`. A robot in URDF is at home and at rest, one in MJCF or SDF where its file draws it.
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

    /// q of positions, (..., N): the joints moved by them from home.
    ///
    /// The position of a revolute or continuous joint is its angle, of a prismatic one its displacement, of a ball its rotation vector; rad and m.
    ///
    /// Args:
    ///     positions: (..., K), or a dict of positions by the names of joints, the others at home.
    fn configuration<'py>(&self, positions: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.configuration_of(positions)
    }

    /// Positions of q, (..., K), which `configuration` takes back to q. Angles that q stores as cosine and sine, and rotations, are found between -pi and pi.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    fn positions<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.positions_of(q)
    }

    /// Derivatives of q by local coordinates phi about q, (..., N, K), at phi = 0: they map changes of phi to changes of q. For joints that store angles or displacements they are the identity.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    fn configuration_by_local<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.by_local_of(q)
    }

    /// q moved to the nearest point where stored scalars are those of a configuration, (..., N): what q lacks whose digits were cut off, as by float32.
    ///
    /// Functions of q refuse a q that is off by more than 1e-9: a rotation matrix that is none, a quaternion not of length 1, a loop that is open.
    ///
    /// Args:
    ///     near: about configurations, (..., N).
    fn project<'py>(&self, near: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.projected(near)
    }

    /// Accelerations of speeds under efforts, (..., S): rad/s² and m/s².
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     tau: efforts, (..., K), N m and N. Of a joint whose motion the scene prescribes they are accelerations.
    ///
    /// Raises:
    ///     DynamicsError: a singular mass matrix.
    fn forward_dynamics<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.accelerations([q, v, tau])
    }

    /// Efforts per speed that inputs must exert for accelerations, (..., S): N m and N. Springs, dampers and gravity act beside them.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     a: accelerations, (..., S), rad/s² and m/s².
    fn inverse_dynamics<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.efforts([q, v, a])
    }

    /// Inverse dynamics at zero accelerations, (..., S): Coriolis and centrifugal forces, gravity, springs and dampers; N m and N.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    fn bias_forces<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.bias([q, v])
    }

    /// The mass matrix, (..., S, S); kg, kg m, kg m².
    ///
    /// Args:
    ///     q: configurations, (..., N).
    fn mass_matrix<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.mass(q)
    }

    /// Accelerations and their derivatives, as `ForwardDerivatives`: by local coordinates phi about q, by v and by tau. Nothing is differenced.
    ///
    /// For joints that store angles or displacements phi is a change of q.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     tau: efforts, (..., K), N m and N.
    ///
    /// Raises:
    ///     DynamicsError: a singular mass matrix; something that acts whose derivatives are not known.
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

    /// Derivatives of inverse dynamics, as `InverseDerivatives`: by local coordinates phi about q and by v. That by accelerations is the mass matrix.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     a: accelerations, (..., S), rad/s² and m/s².
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

    /// Second derivatives of the accelerations, weighted and summed: the Hessian of weights · forward_dynamics by local coordinates phi about q, v and tau, (..., 2K + S, 2K + S), in
    /// this order. Nothing is differenced; compiled robots take it from the general algorithms too.
    ///
    /// For joints that store angles or displacements phi is a change of q.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     tau: efforts, (..., K), N m and N.
    ///     weights: one for each acceleration, (..., S).
    ///
    /// Raises:
    ///     DynamicsError: a singular mass matrix; something that acts whose second derivatives are not known; constraints between joints.
    fn forward_dynamics_second_derivatives<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        tau: Given<'_, 'py>,
        weights: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.acceleration_hessians([q, v, tau, weights])
    }

    /// Second derivatives of inverse dynamics, weighted and summed: the Hessian of weights · inverse_dynamics by local coordinates phi about q, v and a, (..., K + 2S, K + 2S), in this
    /// order. Nothing is differenced; compiled robots take it from the general algorithms too.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     a: accelerations, (..., S), rad/s² and m/s².
    ///     weights: one for each effort, (..., S).
    ///
    /// Raises:
    ///     DynamicsError: something that acts whose second derivatives are not known.
    fn inverse_dynamics_second_derivatives<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
        weights: Given<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        self.effort_hessians([q, v, a, weights])
    }

    /// Inverse dynamics as a linear function of the inertial parameters, as `Regressor`: `matrix @ robot.inertial_parameters + rest`. Compiled robots take it from the general algorithms too.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     a: accelerations, (..., S), rad/s² and m/s².
    fn joint_torque_regressor<'py>(
        &self,
        q: Given<'_, 'py>,
        v: Given<'_, 'py>,
        a: Given<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let found: [Arrays<'py>; 2] = self.regressors([q, v, a])?;
        let class = of_package(q.py(), &CLASS, "hamel._values", "Regressor")?;
        let [matrix, rest] = found;
        class.call1((matrix, rest))
    }

    /// Inertial parameters of all bodies, (10 B,): of each its mass, kg, first moments mc_x, mc_y, mc_z, kg m, and moments of inertia I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the origin and in
    /// the axes of its frame, kg m².
    #[getter]
    fn inertial_parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.mechanism().inertial_parameters().into_pyarray(py)
    }

    /// The fewest combinations of inertial parameters on which efforts depend, as `BaseParameters`. Constraints that couple joints are not considered.
    ///
    /// Raises:
    ///     DynamicsError: a joint of which too few configurations are found.
    fn base_parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let base = py.detach(|| self.model().base_parameters());
        let base = base.map_err(|error| errors::dynamics(py, error.to_string()))?;
        let (rows, columns) = base.matrix().shape();
        let entries = (0..rows * columns).map(|at| base.matrix()[(at / columns, at % columns)]);
        let matrix = entries.collect::<Vec<f64>>().into_pyarray(py);
        let names: Vec<String> = (0..rows)
            .map(|own| base.combination(own).to_string())
            .collect();
        let kept: Vec<i64> = base.kept().iter().map(|&place| place as i64).collect();
        let class = of_package(py, &CLASS, "hamel._values", "BaseParameters")?;
        class.call1((
            matrix.reshape([rows, columns])?,
            kept.into_pyarray(py),
            PyTuple::new(py, names)?,
            base.certificate().is_minimal(),
        ))
    }

    /// The matrix that takes v to the twist of a frame or a body, (..., 6, S): angular velocity in the first three rows, rad/s, linear velocity in the last three, m/s.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     frame: name of a frame or a body.
    ///     axes: `world_aligned` for the velocity of the frame's origin in world axes, `body` for that in its own axes, `world` for that of the point at the world's
    ///         origin in world axes.
    #[pyo3(signature = (q, frame, axes="world_aligned"))]
    fn jacobian<'py>(&self, q: Given<'_, 'py>, frame: &str, axes: &str) -> PyResult<Arrays<'py>> {
        self.jacobian_of(q, (frame, axes))
    }

    /// The twist of a frame or a body relative to the world, (..., 6): angular velocity first, rad/s, then linear, m/s.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    ///     frame: name of a frame or a body.
    ///     axes: as for `jacobian`.
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

    /// The pose of a frame or a body, (..., 4, 4): takes its coordinates to those of the world, m.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     frame: name of a frame or a body.
    fn pose<'py>(&self, q: Given<'_, 'py>, frame: &str) -> PyResult<Arrays<'py>> {
        self.pose_of(q, frame)
    }

    /// Poses of all bodies in the order of `bodies`, (..., bodies, 4, 4): take their coordinates to those of the world, m.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    fn poses<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.poses_of_bodies(q)
    }

    /// Kinetic and potential energy together, (...), J.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    fn energy<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        self.total_energy([q, v])
    }

    /// Kinetic energy, (...), J.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     v: speeds, (..., S), rad/s and m/s.
    fn kinetic_energy<'py>(&self, q: Given<'_, 'py>, v: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        let [kinetic, _] = self.energies([q, v])?;
        Ok(kinetic)
    }

    /// Potential energy in gravity and of springs, (...), J; that in gravity is zero at the world's origin.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    fn potential_energy<'py>(&self, q: Given<'_, 'py>) -> PyResult<Arrays<'py>> {
        let rest = PyArray1::<f64>::zeros(q.py(), self.sizes().speeds, false).into_any();
        let [_, potential] = self.energies([q, &rest])?;
        Ok(potential)
    }

    /// The centre of mass of all bodies, (..., 3), world axes, m.
    ///
    /// Args:
    ///     q: configurations, (..., N).
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
            path: _,
            text,
            is_robot,
            options,
            joints,
        } = self.source.clone();
        let parse = py.import("hamel._hamel")?.getattr("parse")?;
        let source = (name, text, is_robot);
        let state = options.state.map(|state| (state.name, state.coordinates));
        let options = (
            options.floating_base,
            options.lenient,
            options.posture,
            state,
        );
        let joints: Vec<String> = joints.into_iter().map(|joint| joint.spec).collect();
        let compilation = self.compilation.as_ref().map(|own| (own.asked.clone(),));
        let arguments = (source, options, joints, compilation);
        Ok((parse, arguments.into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let sizes = self.sizes();
        let compiled = self.compilation.as_ref().map_or("", |_| ", compiled");
        format!(
            "<hamel.Robot {:?}: {} joints, {} bodies, {} entries of q, {} speeds{compiled}>",
            self.name(),
            self.model.joints().count(),
            self.model.bodies().count(),
            sizes.configuration,
            sizes.speeds
        )
    }

    fn _repr_html_(&self) -> String {
        format!("{}{}", pictures::image(self), info::table(self))
    }
}
