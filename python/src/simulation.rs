//! Motions: what `hamel.simulate` asks for, as a dictionary of arrays.

use crate::errors;
use crate::inputs::Listener;
use crate::robot::Robot;
use hamel::compiled::Compiled;
use hamel::integrate::{Form, GlobalError, Scheme, Solution, State};
use hamel::scene::{Arithmetic, Settings};
use hamel::{Error, Model, Simulation};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What is asked of a motion; what is not given is as the scene has it.
#[derive(FromPyObject)]
struct Request {
    #[pyo3(item)]
    t_end: Option<f64>,
    #[pyo3(item)]
    start: Option<(Vec<f64>, Vec<f64>, f64)>,
    #[pyo3(item)]
    method: Option<String>,
    #[pyo3(item)]
    tolerance: Option<f64>,
    #[pyo3(item)]
    dt: Option<f64>,
    #[pyo3(item)]
    accuracy: Option<f64>,
    #[pyo3(item)]
    form: Option<String>,
    #[pyo3(item)]
    arithmetic: Option<String>,
    #[pyo3(item)]
    samples: Option<Vec<f64>>,
    #[pyo3(item)]
    sample_step: Option<f64>,
    #[pyo3(item)]
    inputs: Option<Py<PyAny>>,
    #[pyo3(item)]
    estimate: bool,
}

/// A motion of a robot, as `hamel.simulate` puts it into words.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    robot: &Bound<'py, Robot>,
    request: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let request: Request = request.extract()?;
    let plan = Plan::new(&request).map_err(|message| errors::argument(py, message))?;
    let (model, compiled) = (robot.get().model(), robot.get().workspaces().compiled());
    let moved = py.detach(|| run((model, compiled), &request, plan));
    let motion = match moved {
        Ok(motion) => motion,
        Err(Ended::Exception(error)) => return Err(error),
        Err(Ended::Failure(error)) => return Err(errors::of(py, &error)),
    };
    motion.arrays(py, model)
}

/// Method, form and arithmetic, checked.
#[derive(Clone, Copy)]
struct Plan {
    method: Way,
    form: Option<Form>,
    arithmetic: Option<Arithmetic>,
}

/// What decides on the method.
#[derive(Clone, Copy)]
enum Way {
    /// The scene.
    Scene,
    /// Nothing but a tolerance.
    Tolerance(f64),
    /// The caller.
    Method(hamel::integrate::Method),
}

impl Plan {
    fn new(request: &Request) -> Result<Self, String> {
        if let (Some(dt), Some(tolerance)) = (request.dt, request.tolerance) {
            return Err(format!(
                "dt is {dt} and tolerance is {tolerance}: a method takes one of them"
            ));
        }
        if let Some(accuracy) = request.accuracy {
            let other = [("dt", request.dt), ("tolerance", request.tolerance)];
            let other = other
                .into_iter()
                .find_map(|(name, value)| Some((name, value?)));
            if let Some((name, value)) = other {
                return Err(format!(
                    "accuracy is {accuracy} and {name} is {value}: for an accuracy the tolerance is searched for"
                ));
            }
        }
        let form = match request.form.as_deref() {
            None => None,
            Some("lagrangian") => Some(Form::Lagrangian),
            Some("hamiltonian") => Some(Form::Hamiltonian),
            Some(form) => {
                return Err(format!(
                    "form is `{form}`: it must be `lagrangian` or `hamiltonian`"
                ));
            }
        };
        let arithmetic = request.arithmetic.as_deref().map(|name| {
            Arithmetic::named(name).ok_or_else(|| {
                format!("arithmetic is `{name}`: it must be `doubles`, `refined` or `auto`")
            })
        });
        let method = Self::way(request)?;
        if let (Some(accuracy), Way::Method(method @ hamel::integrate::Method::Fixed { .. })) =
            (request.accuracy, method)
        {
            let name = method.scheme().name();
            return Err(format!(
                "accuracy is {accuracy} and method is `{name}`, which has no step control: its accuracy is dt"
            ));
        }
        Ok(Self {
            method,
            form,
            arithmetic: arithmetic.transpose()?,
        })
    }

    fn way(request: &Request) -> Result<Way, String> {
        let named = request.method.as_deref();
        let scheme = match named {
            None => None,
            Some(Settings::AUTO) => None,
            Some(name) => Some(Scheme::named(name).ok_or_else(|| {
                let known = Scheme::ALL.iter().map(Scheme::name).chain([Settings::AUTO]);
                let known: Vec<&str> = known.collect();
                format!("method is `{name}`: it must be one of {}", known.join(", "))
            })?),
        };
        match (scheme, request.dt, request.tolerance) {
            (None, None, None) if named.is_none() => Ok(Way::Scene),
            (None, None, tolerance) => {
                Ok(Way::Tolerance(tolerance.unwrap_or(Settings::DEFAULT_TOL)))
            }
            (scheme, dt, tolerance) => {
                let accuracy = request
                    .accuracy
                    .filter(|_| scheme.is_some_and(|own| own.has_estimate()));
                let tolerance = tolerance.or(accuracy.map(|_| Settings::DEFAULT_TOL));
                let method = Settings::method_of(scheme, dt, tolerance);
                method.map(Way::Method).ok_or_else(|| {
                    let name = named.unwrap_or_default();
                    format!("the method `{name}` does not estimate its error: give it a step dt instead of a tolerance")
                })
            }
        }
    }
}

/// Why there is no motion.
enum Ended {
    Failure(Error),
    Exception(PyErr),
}

/// A motion, and its method.
struct Motion {
    solution: Solution,
    error: Option<GlobalError>,
    method: &'static str,
    energies: Vec<[f64; 2]>,
}

fn prepared<'a>(model: &'a Model, request: &Request, plan: Plan) -> Simulation<'a> {
    let mut simulation = model.simulate();
    if let Some((configuration, speeds, time)) = request.start.clone() {
        simulation = simulation.starting_at(State {
            time,
            configuration,
            speeds,
        });
    }
    if let Some(t_end) = request.t_end {
        simulation = simulation.until(t_end);
    }
    if let Some(step) = request.sample_step {
        simulation = simulation.sample_every(step);
    }
    if let Some(times) = request.samples.clone() {
        simulation = simulation.sample_at(times);
    }
    simulation = match plan.method {
        Way::Scene => simulation,
        Way::Tolerance(tolerance) => simulation.tolerance(tolerance),
        Way::Method(method) => simulation.method(method),
    };
    if let Some(form) = plan.form {
        simulation = simulation.form(form);
    }
    if let Some(arithmetic) = plan.arithmetic {
        simulation = simulation.arithmetic(arithmetic);
    }
    match request.accuracy {
        Some(error) => simulation.accuracy(error),
        None => simulation,
    }
}

fn run(
    (model, compiled): (&Model, Option<&Compiled>),
    request: &Request,
    plan: Plan,
) -> Result<Motion, Ended> {
    let listener = Listener::new(request.inputs.as_ref());
    let mut simulation = prepared(model, request, plan).stopping(|| listener.is_over());
    if let Some(compiled) = compiled {
        simulation = simulation.equations(|| Box::new(compiled.clone()));
    }
    if request.inputs.is_some() {
        simulation = simulation.inputs(|time, q, v, tau| listener.fill(time, q, v, tau));
    }
    let moved = match request.estimate {
        true => simulation
            .run_estimated()
            .map(|(solution, error)| (solution, Some(error))),
        false => simulation.run().map(|solution| (solution, None)),
    };
    if let Some(exception) = listener.exception() {
        return Err(Ended::Exception(exception));
    }
    let (solution, error) = moved.map_err(Ended::Failure)?;
    Ok(Motion {
        energies: energies(model, &solution).map_err(Ended::Failure)?,
        method: solution.scheme.name(),
        solution,
        error,
    })
}

/// Kinetic and potential energy of all samples, J.
fn energies(model: &Model, solution: &Solution) -> Result<Vec<[f64; 2]>, Error> {
    let samples = solution.samples.iter().map(|state| {
        let found = model
            .mechanism()
            .kinematics(&state.configuration, &state.speeds)?;
        Ok([found.kinetic_energy(), found.potential_energy()])
    });
    samples.collect()
}

impl Motion {
    fn arrays<'py>(&self, py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
        let samples = &self.solution.samples;
        let of = |read: &dyn Fn(&State) -> &[f64], width: usize| {
            let all: Vec<f64> = samples
                .iter()
                .flat_map(|state| read(state).to_vec())
                .collect();
            PyArray1::from_vec(py, all).reshape([samples.len(), width])
        };
        let sizes = model.sizes();
        let times: Vec<f64> = samples.iter().map(|state| state.time).collect();
        let energy =
            |part: usize| -> Vec<f64> { self.energies.iter().map(|own| own[part]).collect() };
        let all = PyDict::new(py);
        all.set_item("t", times.into_pyarray(py))?;
        all.set_item("q", of(&|state| &state.configuration, sizes.configuration)?)?;
        all.set_item("v", of(&|state| &state.speeds, sizes.speeds)?)?;
        all.set_item("kinetic_energy", energy(0).into_pyarray(py))?;
        all.set_item("potential_energy", energy(1).into_pyarray(py))?;
        all.set_item("method", self.method)?;
        all.set_item("is_stopped", self.solution.stopped)?;
        let events = self.solution.events.iter();
        let events: Vec<_> = events
            .map(|event| (event.state.time, event.name.clone()))
            .collect();
        all.set_item("events", events)?;
        let work = &self.solution.statistics;
        let statistics = PyDict::new(py);
        statistics.set_item("steps", work.steps)?;
        statistics.set_item("rejected", work.rejected)?;
        statistics.set_item("evaluations", work.evaluations)?;
        all.set_item("statistics", statistics)?;
        let error = self.error.as_ref();
        let of_samples = error.map(|own| -> Vec<f64> {
            own.samples
                .iter()
                .map(hamel::integrate::ErrorParts::total)
                .collect()
        });
        all.set_item("error", of_samples.map(|own| own.into_pyarray(py)))?;
        all.set_item("end_error", error.map(|own| own.end.total()))?;
        let doubt = error.and_then(|own| own.doubt.as_ref());
        all.set_item("doubt", doubt.map(ToString::to_string))?;
        Ok(all)
    }
}
