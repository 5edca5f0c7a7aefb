//! The class `Joint`.

use crate::errors::{self, of_package};
use crate::info::escaped;
use crate::joint_source::SpecSource;
use crate::source::OwnJoint;
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::emit::report::typeset::Equation;
use hamel_codegen::emit::report::{self, Formula};
use hamel_codegen::emit::rust::{Runtime, file};
use hamel_codegen::model::End;
use hamel_interpreted::{JointType, TooLarge};
use num_traits::ToPrimitive;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::sync::{MutexExt, PyOnceLock};
use pyo3::types::{PyDict, PyTuple};
use std::sync::{Mutex, PoisonError};

type Arrays<'py> = Bound<'py, PyArrayDyn<f64>>;
type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// A joint type, derived and proved from its spec.
///
/// With N `coordinates` and K `freedoms`, q is (..., N), local coordinates phi are (..., K); the dimensions before the last are a batch and broadcast. Parameters of the
/// joint, such as a pitch, are given by keyword, in SI units. Arguments are neither modified nor kept.
///
/// Its formulas are evaluated operation by operation (`evaluation`), as they are in a robot that `hamel.load(scene, joints=[joint])` makes of it: slower than the joints of
/// the library, which are compiled, and equal up to rounding.
///
/// Args:
///     spec: the text of a spec, the path of a `.joint` file, or the name of a joint of the library.
///
/// Raises:
///     FileError: a file that cannot be read; all mistakes of the spec, or what cannot be proved of it, each with its line.
#[pyclass(frozen, module = "hamel")]
pub struct Joint {
    derived: Mutex<Derived>,
    kind: Result<JointType, TooLarge>,
}

/// What `latex` knows, by name.
const FORMULAS: &[(&str, KernelKind)] = &[
    ("H", KernelKind::Pose),
    ("X", KernelKind::TwistMap),
    ("X_child", KernelKind::TwistMapChild),
    ("S", KernelKind::VelocityMap),
    ("dS", KernelKind::VelocityMapGradient),
    ("gamma", KernelKind::Gamma),
    ("J22", KernelKind::J22),
    ("A", KernelKind::Constraint),
    ("S_bar", KernelKind::SpeedBasis),
    ("dS_bar", KernelKind::SpeedBasisGradient),
    ("P", KernelKind::PortMap),
    ("q_rate", KernelKind::ConfigurationRate),
    ("c", KernelKind::BiasAcceleration),
];

impl Joint {
    /// The joint of a spec.
    ///
    /// # Errors
    /// All mistakes of the text, or what cannot be proved.
    pub fn of(py: Python<'_>, source: SpecSource) -> PyResult<Self> {
        let derive = || {
            let SpecSource { name, text, folder } = &source;
            hamel_codegen::derive_in(text, name, folder.as_deref())
        };
        let derived = py
            .detach(derive)
            .map_err(|mistakes| errors::spec(py, &mistakes))?;
        Ok(Self {
            kind: JointType::new(&derived),
            derived: Mutex::new(derived),
        })
    }

    /// What is asked of the derived joint. No code of Python runs meanwhile: it could ask the same joint.
    fn ask<R>(&self, py: Python<'_>, what: impl FnOnce(&Derived) -> R) -> R {
        let derived = self.derived.lock_py_attached(py);
        what(&derived.unwrap_or_else(PoisonError::into_inner))
    }

    /// Names as a tuple.
    fn named<'py>(
        &self,
        py: Python<'py>,
        names: impl FnOnce(&Derived) -> Vec<String>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.ask(py, names))
    }

    /// The type that is evaluated.
    ///
    /// # Errors
    /// A joint that is too large for that.
    pub fn kind(&self, py: Python<'_>) -> PyResult<&JointType> {
        let kind = self.kind.as_ref();
        kind.map_err(|error| errors::other(py, error.to_string()))
    }

    /// The type with the text that makes it again.
    ///
    /// # Errors
    /// Those of [`Joint::kind`].
    pub fn registered(&self, py: Python<'_>) -> PyResult<OwnJoint> {
        Ok(OwnJoint {
            kind: self.kind(py)?.clone(),
            spec: self.ask(py, |own| own.spec.whole_source()),
        })
    }

    /// The place of a body: the first unless another is named.
    ///
    /// # Errors
    /// No body of that name.
    pub fn body(&self, py: Python<'_>, name: Option<&str>) -> PyResult<usize> {
        let found = self.ask(py, |derived| place_of_body(derived, name));
        found.map_err(|message| errors::argument(py, message))
    }
}

/// The place of a body, or why there is none.
fn place_of_body(derived: &Derived, name: Option<&str>) -> Result<usize, String> {
    let Some(name) = name else { return Ok(0) };
    let bodies = &derived.spec.bodies;
    let place = bodies.iter().position(|body| body == name);
    place.ok_or_else(|| {
        let known = match bodies.as_slice() {
            [] => String::from("it carries one, which has no name"),
            names => format!("they are {}", names.join(", ")),
        };
        let joint = &derived.spec.name.value;
        format!("body is {name:?}: joint `{joint}` has no body of that name; {known}")
    })
}

/// A formula by its name, or why there is none.
fn formula(derived: &Derived, what: &str, body: Option<&str>) -> Result<Formula, String> {
    let known = FORMULAS.iter().find(|(name, _)| *name == what);
    let Some((_, kind)) = known else {
        let names: Vec<&str> = FORMULAS.iter().map(|(name, _)| *name).collect();
        return Err(format!(
            "what is {what:?}: it must be one of {}",
            names.join(", ")
        ));
    };
    let own = derived.bodies().nth(place_of_body(derived, body)?);
    own.and_then(|own| report::formula(own, *kind))
        .ok_or_else(|| {
            let joint = &derived.spec.name.value;
            format!("what is {what:?}: joint `{joint}` has no formula of it")
        })
}

#[pymethods]
impl Joint {
    #[new]
    fn new(spec: Given<'_, '_>) -> PyResult<Self> {
        Self::of(spec.py(), SpecSource::of(spec)?)
    }

    /// Its name, by which scenes ask for it.
    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.ask(py, |own| own.spec.name.value.clone())
    }

    /// What the spec says of it.
    #[getter]
    fn description(&self, py: Python<'_>) -> String {
        self.ask(py, |own| {
            let lines = own.spec.docs.iter().map(|line| line.trim());
            lines.collect::<Vec<_>>().join("\n").trim().to_owned()
        })
    }

    /// The text of its spec, which needs no file beside it.
    #[getter]
    fn source(&self, py: Python<'_>) -> String {
        self.ask(py, |own| own.spec.whole_source())
    }

    /// How its values are found: `interpreted`.
    #[getter]
    const fn evaluation(&self) -> &'static str {
        "interpreted"
    }

    /// Names of the entries of q.
    #[getter]
    fn coordinates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.named(py, |own| {
            let symbols = own.arguments.configuration.iter();
            symbols.map(|symbol| symbol.name().to_owned()).collect()
        })
    }

    /// Names of its degrees of freedom: of the entries of phi and of v.
    #[getter]
    fn freedoms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.named(py, |own| {
            let freedoms = own.spec.freedoms.value.iter();
            freedoms.map(|freedom| freedom.name.clone()).collect()
        })
    }

    /// Names of its speeds: fewer than its degrees of freedom where it is nonholonomic.
    #[getter]
    fn speeds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.named(py, |own| own.speed_names.clone())
    }

    /// Names of the bodies that it carries; empty where it carries one that has no name.
    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.named(py, |own| own.spec.bodies.clone())
    }

    /// Its parameters, as `Parameter`s in the order of the spec.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let class = of_package(py, &CLASS, "hamel._values", "Parameter")?;
        let end = |end: &Option<End>| end.as_ref().and_then(|end| end.value.to_f64());
        let told = self.ask(py, |own| {
            let all = own.spec.parameters.iter().map(|own| {
                let (name, unit) = (own.symbol.name().to_owned(), own.unit.clone());
                let (lower, upper) = (end(&own.range.lower), end(&own.range.upper));
                (name, unit, own.docs.trim().to_owned(), lower, upper)
            });
            all.collect::<Vec<_>>()
        });
        let all = told.into_iter().map(|told| class.call1(told));
        PyTuple::new(py, all.collect::<PyResult<Vec<_>>>()?)
    }

    /// What was proved of it, as `Claim`s.
    #[getter]
    fn claims<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let class = of_package(py, &CLASS, "hamel._values", "Claim")?;
        let all = self.ask(py, |own| own.claims.clone()).into_iter();
        let all = all.map(|claim| {
            let proof = claim.proof.name();
            class.call1((
                claim.name,
                claim.statement,
                proof,
                claim.detail,
                claim.points,
            ))
        });
        PyTuple::new(py, all.collect::<PyResult<Vec<_>>>()?)
    }

    /// Where q must not come, as the spec writes it: the joint loses its meaning or a degree of freedom there.
    #[getter]
    fn exceptions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.named(py, |own| {
            let loci = own.space.loci.iter();
            loci.map(|locus| locus.value.text.clone()).collect()
        })
    }

    /// The home configuration, (N,).
    ///
    /// Args:
    ///     parameters: those of the joint, by keyword.
    #[pyo3(signature = (**parameters))]
    fn home<'py>(
        &self,
        py: Python<'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.home_of(py, parameters)
    }

    /// S, which takes rates of phi to v, (..., K, K): at phi = 0, or at q and phi.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     phi: local coordinates about q, (..., K); zero where they are not given.
    ///     parameters: those of the joint, by keyword.
    #[pyo3(name = "S", signature = (q, phi=None, /, **parameters))]
    fn velocity_map<'py>(
        &self,
        q: Given<'_, 'py>,
        phi: Option<Given<'_, 'py>>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.velocity_map_of(q, phi, parameters)
    }

    /// The derivatives of S by phi at phi = 0, (..., K, K, K): entry [..., k, i, j] is that of S[i, j] by phi[k].
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     parameters: those of the joint, by keyword.
    #[pyo3(name = "dS", signature = (q, /, **parameters))]
    fn velocity_map_gradient<'py>(
        &self,
        q: Given<'_, 'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.velocity_map_gradient_of(q, parameters)
    }

    /// X, which takes v to the twist of a body relative to the parent, (..., 6, K): parent axes, at the parent's origin; angular velocity first.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     body: name of one of `bodies`; the first where it is not given.
    ///     parameters: those of the joint, by keyword.
    #[pyo3(name = "X", signature = (q, body=None, /, **parameters))]
    fn twist_map<'py>(
        &self,
        q: Given<'_, 'py>,
        body: Option<&str>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.twist_map_of(q, body, parameters)
    }

    /// The pose of a body, (..., 4, 4): takes its coordinates to those of the parent, m.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     body: name of one of `bodies`; the first where it is not given.
    ///     parameters: those of the joint, by keyword.
    #[pyo3(signature = (q, body=None, /, **parameters))]
    fn pose<'py>(
        &self,
        q: Given<'_, 'py>,
        body: Option<&str>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.pose_of(q, body, parameters)
    }

    /// q moved by local coordinates, (..., N): the coordinate mapping, which is q at phi = 0.
    ///
    /// Args:
    ///     q: configurations, (..., N).
    ///     phi: local coordinates about q, (..., K).
    ///     parameters: those of the joint, by keyword.
    #[pyo3(name = "phi", signature = (q, phi, /, **parameters))]
    fn retract<'py>(
        &self,
        q: Given<'_, 'py>,
        phi: Given<'_, 'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Arrays<'py>> {
        self.retract_of(q, phi, parameters)
    }

    /// A formula as LaTeX, as the pages of joints show it.
    ///
    /// Args:
    ///     what: `H`, `X`, `X_child`, `S` to first order in phi, `dS`, `gamma`, `J22`, `A`, `S_bar`, `dS_bar`, `P`, `q_rate` or `c`.
    ///     body: name of one of `bodies`; the first where it is not given.
    #[pyo3(signature = (what, body=None))]
    fn latex(&self, py: Python<'_>, what: &str, body: Option<&str>) -> PyResult<String> {
        let formula = self.ask(py, |own| formula(own, what, body));
        let formula = formula.map_err(|message| errors::argument(py, message))?;
        let lines: Vec<String> = formula.equations.iter().map(Equation::latex).collect();
        Ok(match lines.as_slice() {
            [only] => only.clone(),
            lines => format!(
                "\\begin{{gathered}} {} \\end{{gathered}}",
                lines.join(r" \\ ")
            ),
        })
    }

    /// The module in Rust that the generator writes of it.
    fn rust(&self, py: Python<'_>) -> PyResult<String> {
        let text = self.ask(py, |own| {
            let label = format!("{}.joint", own.spec.name.value);
            file(own, &label, &Runtime::default())
        });
        text.map_err(|error| errors::other(py, error.to_string()))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().into_any(), (self.source(py),)))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        self.ask(py, |own| {
            format!(
                "<hamel.Joint {:?}: {} entries of q, {} freedoms, {} speeds, {} claims>",
                own.spec.name.value,
                own.shape.configuration,
                own.shape.freedoms,
                own.shape.speeds,
                own.claims.len()
            )
        })
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        self.ask(py, |own| {
            let formula = |formula: &Formula| {
                let equations: String = formula.equations.iter().map(Equation::mathml).collect();
                format!("<p>{}</p>{equations}", escaped(&formula.title))
            };
            let body: String = report::main_formulas(own).iter().map(formula).collect();
            let name = &own.spec.name.value;
            let summary = report::summary(&own.spec.docs, name);
            format!(
                "<div><p><b>{}</b>: {}</p>{body}</div>",
                escaped(name),
                escaped(&summary)
            )
        })
    }
}
