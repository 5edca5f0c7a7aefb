//! `Robot.compile`: the equations of motion of one robot in C, built by the C compiler of the machine.

use crate::errors;
use crate::inputs::Listener;
use crate::robot::Robot;
use crate::source::Source;
use hamel::Model;
use hamel::compiled::Compiled;
use hamel::scene::Diagnostics;
use hamel_compiler::Build;
use hamel_compiler::functions::Kind;
use hamel_native::{Compiler, Error};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// What can be compiled, by the names of the methods of a robot; the first of them is there by default, up to [`BY_DEFAULT`].
const FUNCTIONS: [(&str, Kind); 8] = [
    ("forward_dynamics", Kind::ForwardDynamics),
    ("inverse_dynamics", Kind::InverseDynamics),
    ("bias_forces", Kind::BiasForces),
    ("mass_matrix", Kind::MassMatrix),
    ("energy", Kind::Energies),
    ("poses", Kind::Poses),
    ("forward_dynamics_derivatives", Kind::ForwardDerivatives),
    ("inverse_dynamics_derivatives", Kind::InverseDerivatives),
];

/// Derivatives are longer than all other functions together, and are compiled where they are asked for.
const BY_DEFAULT: usize = 6;

/// What was compiled of a robot.
#[derive(Clone)]
pub struct Compilation {
    /// Which functions were asked for, if any by name.
    pub asked: Option<Vec<String>>,
    /// The methods that call them.
    pub functions: Vec<&'static str>,
    /// The equations.
    pub equations: Compiled,
}

impl Compilation {
    /// The equations of a robot with these functions, or with those that are there by default.
    ///
    /// # Errors
    /// An unknown name; what cannot be compiled; a machine without a C compiler; Ctrl-C.
    pub fn new(
        py: Python<'_>,
        source: &Source,
        model: &Model,
        asked: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let kinds = kinds(py, asked.as_deref())?;
        let build = build(source).map_err(|mistakes| errors::file(py, &source.name, &mistakes))?;
        let folder = Folder::new(py)?;
        let (path, label) = (folder.path(py)?, source.name.clone());
        let (made, exception) = py.detach(move || {
            let listener = Listener::new(None);
            let made = made(build, (&label, &kinds), &path, model, &|| {
                listener.is_over()
            });
            (made, listener.exception())
        });
        folder.remove(py)?;
        if let Some(exception) = exception {
            return Err(exception);
        }
        let made = made.map_err(|error| errors::compilation(py, &error.to_string()))?;
        if let (Some(_), Some(long)) = (&asked, made.left_out.first()) {
            return Err(errors::compilation(py, &long.to_string()));
        }
        let named = FUNCTIONS
            .iter()
            .filter(|(_, kind)| made.functions.contains(kind));
        Ok(Self {
            asked,
            functions: named.map(|(name, _)| *name).collect(),
            equations: made.dynamics,
        })
    }
}

/// The functions of these names.
fn kinds(py: Python<'_>, names: Option<&[String]>) -> PyResult<Vec<Kind>> {
    let Some(names) = names else {
        let default = FUNCTIONS[..BY_DEFAULT].iter();
        return Ok(default.map(|(_, kind)| *kind).collect());
    };
    let mut kinds = vec![];
    for name in names {
        let known = FUNCTIONS.iter().find(|(own, _)| own == name);
        let (_, kind) = known.ok_or_else(|| {
            let all: Vec<&str> = FUNCTIONS.iter().map(|(own, _)| *own).collect();
            let message = format!("functions has {name:?}: it may have {}", all.join(", "));
            errors::argument(py, message)
        })?;
        if !kinds.contains(kind) {
            kinds.push(*kind);
        }
    }
    match kinds.is_empty() {
        true => Err(errors::argument(
            py,
            "functions is empty: it must name one at least",
        )),
        false => Ok(kinds),
    }
}

/// For the scene compiler: what the robot is made of, with the specs of its joints.
fn build(source: &Source) -> Result<Build, Diagnostics> {
    let build = hamel_compiler::scene_of(&source.name, source.description()?);
    let own = source.joints.iter();
    let own = own.map(|joint| (joint.kind.name(), &*joint.spec));
    Ok(build.library(hamel::joints::specs()).library(own))
}

fn made(
    build: Build,
    (label, kinds): (&str, &[Kind]),
    folder: &Path,
    model: &Model,
    is_over: &dyn Fn() -> bool,
) -> Result<hamel_native::Equations, Error> {
    let compiler = Compiler::find(is_over)?;
    let source = hamel_native::Source::new(build, label, kinds)?;
    let start = model.state().configuration;
    source.load(&compiler, folder, (model.mechanism(), &start), is_over)
}

/// A folder for what the compiler reads and writes, which its owner alone may enter. A library that is loaded needs its file no more.
struct Folder(Py<PyAny>);

impl Folder {
    fn new(py: Python<'_>) -> PyResult<Self> {
        let made = py.import("tempfile")?.getattr("TemporaryDirectory")?;
        Ok(Self(made.call1((py.None(), "hamel-"))?.unbind()))
    }

    fn path(&self, py: Python<'_>) -> PyResult<PathBuf> {
        self.0.bind(py).getattr("name")?.extract()
    }

    fn remove(self, py: Python<'_>) -> PyResult<()> {
        self.0.bind(py).call_method0("cleanup").map(drop)
    }
}

impl Robot {
    /// The same robot with equations that are compiled.
    pub fn compiled_with(&self, py: Python<'_>, functions: Option<Vec<String>>) -> PyResult<Self> {
        let (source, model) = (self.origin(), self.model());
        let compilation = Compilation::new(py, source, model, functions)?;
        let (source, model) = (source.clone(), model.clone());
        Ok(Self::new(
            source,
            model,
            self.limits_by_name().clone(),
            Some(compilation),
        ))
    }
}
