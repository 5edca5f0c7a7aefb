//! Pages and pictures of motions and robots.

use crate::errors;
use crate::robot::Robot;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hamel::Model;
use hamel::integrate::State;
use hamel_pictures::{Contents, Meshes, Page, Pictures, Sample, Told, does_work};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::io;
use std::path::Path;

/// A motion as Python has it; of each array a row for each sample.
#[derive(FromPyObject)]
pub struct Motion<'py> {
    #[pyo3(item)]
    t: PyReadonlyArray1<'py, f64>,
    #[pyo3(item)]
    q: PyReadonlyArray2<'py, f64>,
    #[pyo3(item)]
    v: PyReadonlyArray2<'py, f64>,
    #[pyo3(item)]
    error: Option<Vec<f64>>,
    #[pyo3(item)]
    method: String,
    #[pyo3(item)]
    has_inputs: bool,
}

impl Motion<'_> {
    /// Its states.
    ///
    /// # Errors
    /// No states; arrays of different lengths.
    fn states(&self) -> Result<Vec<State>, String> {
        let (t, q, v) = (self.t.as_array(), self.q.as_array(), self.v.as_array());
        let [times, configurations, speeds] = [t.len(), q.nrows(), v.nrows()];
        if times == 0 {
            return Err(String::from(
                "the motion has no samples, so that there is nothing to show",
            ));
        }
        if configurations != times || speeds != times {
            return Err(format!(
                "the motion has {times} times, {configurations} configurations and {speeds} speeds: it must have as many of each"
            ));
        }
        let rows = q.rows().into_iter().zip(v.rows());
        let states = t.iter().zip(rows).map(|(&time, (q, v))| State {
            time,
            configuration: q.to_vec(),
            speeds: v.to_vec(),
        });
        Ok(states.collect())
    }
}

/// The page of a motion as HTML.
#[pyfunction]
pub fn page(py: Python<'_>, robot: &Bound<'_, Robot>, motion: Motion<'_>) -> PyResult<String> {
    let refused = |message| errors::argument(py, message);
    let states = motion.states().map_err(refused)?;
    let robot = robot.get();
    let model = robot.model();
    let is_controlled = motion.has_inputs || model.scene().control.is_some();
    let contents = Contents {
        has_efforts: false,
        has_steps: false,
        does_work: is_controlled || does_work(model.mechanism()),
    };
    let known = |error: f64| error.is_finite().then_some(error);
    let errors = motion.error.as_ref();
    let errors: Option<Vec<_>> = errors.map(|all| all.iter().copied().map(known).collect());
    let told = Told {
        method: &motion.method,
        errors: errors.as_deref(),
    };
    let drawn = py.detach(|| {
        recorded(model, &states, contents)?
            .html(&meshes(robot), &told)
            .map_err(text)
    });
    drawn.map_err(refused)
}

fn recorded<'a>(
    model: &'a Model,
    states: &[State],
    contents: Contents,
) -> Result<Page<'a>, String> {
    let duration = match states {
        [first, .., last] => last.time - first.time,
        _ => 0.0,
    };
    let mut page = Page::new(model.scene(), contents, duration);
    for (number, state) in states.iter().enumerate() {
        let sample = Sample::of(model.mechanism(), state).map_err(text)?;
        page.sample(number, &sample, number + 1 == states.len());
    }
    Ok(page)
}

/// A picture of a motion: `svg`, `png` or `gif`; still ones show so many instants.
#[pyfunction]
pub fn picture<'py>(
    py: Python<'py>,
    robot: &Bound<'py, Robot>,
    motion: Motion<'py>,
    kind: &str,
    instants: usize,
) -> PyResult<Bound<'py, PyBytes>> {
    let refused = |message| errors::argument(py, message);
    let states = motion.states().map_err(refused)?;
    let robot = robot.get();
    let mut exception = None;
    let drawn = py.detach(|| {
        // SVG has none.
        let meshes = match kind {
            "svg" => Meshes::default(),
            _ => meshes(robot),
        };
        let (model, shown) = (robot.model(), (&*states, &meshes));
        drawn(model, shown, (kind, instants), &mut || {
            let heard = Python::attach(|py| py.check_signals());
            heard.map_err(|raised| {
                exception = Some(raised);
                io::ErrorKind::Interrupted.into()
            })
        })
    });
    match exception {
        Some(raised) => Err(raised),
        None => Ok(PyBytes::new(py, &drawn.map_err(refused)?)),
    }
}

/// The bytes of a picture; `listen` is asked from time to time, and ends the work by an error.
fn drawn(
    model: &Model,
    (states, meshes): (&[State], &Meshes),
    (kind, instants): (&str, usize),
    listen: &mut dyn FnMut() -> io::Result<()>,
) -> Result<Vec<u8>, String> {
    let (scene, mechanism) = (model.scene(), model.mechanism());
    let mut pictures = Pictures::default();
    for state in states {
        let found = mechanism.kinematics(&state.configuration, &state.speeds);
        pictures.sample(state.time, &found.map_err(text)?);
    }
    let mut file = Vec::new();
    let written = match kind {
        "png" => pictures.write_png(scene, meshes, instants, &mut file),
        "gif" => pictures.write_gif(scene, meshes, &mut file, &mut |_, _| listen()),
        _ => {
            file = pictures.svg(scene, instants).into_bytes();
            Ok(())
        }
    };
    written.map_err(text)?;
    Ok(file)
}

/// The meshes that a robot names, as far as there are files; those of a text are named from the working folder.
fn meshes(robot: &Robot) -> Meshes {
    let path = robot.origin().path.as_deref();
    let folder = path.and_then(Path::parent).unwrap_or(Path::new(""));
    Meshes::load(&robot.model().scene().shapes, folder)
}

/// A picture of a robot in its initial state for notebooks, as HTML; nothing where there is none.
pub fn image(robot: &Robot) -> String {
    let (model, meshes) = (robot.model(), meshes(robot));
    let kind = match meshes.parts() {
        [] => "svg",
        _ => "png",
    };
    let shown = (&[model.state()][..], &meshes);
    let Ok(file) = drawn(model, shown, (kind, 1), &mut || Ok(())) else {
        return String::new();
    };
    let coded = STANDARD.encode(file);
    let media = match kind {
        "svg" => "svg+xml",
        other => other,
    };
    format!("<img width=\"480\" height=\"320\" alt=\"\" src=\"data:image/{media};base64,{coded}\">")
}

fn text(error: impl ToString) -> String {
    error.to_string()
}
