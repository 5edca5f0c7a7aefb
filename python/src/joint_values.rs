//! What a `Joint` evaluates on arrays.

use crate::arguments::{Argument, CONFIGURATION, broadcast};
use crate::errors;
use crate::joint::Joint;
use crate::results::{Room, size};
use hamel::erased::{AnyJoint, Shared};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Arrays<'py> = Bound<'py, PyArrayDyn<f64>>;
type Given<'a, 'py> = &'a Bound<'py, PyAny>;
type Parameters<'a, 'py> = Option<&'a Bound<'py, PyDict>>;

/// How far from the manifold of the joint q may be, as in robots.
const FURTHEST: f64 = 1e-9;

/// States between two looks at the signals of the process.
const LOOK: usize = 256;

impl Joint {
    /// The home configuration.
    pub fn home_of<'py>(
        &self,
        py: Python<'py>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built(py, parameters)?;
        let mut room = Room::new(py, vec![joint.layout().configuration])?;
        joint.home(room.numbers());
        match room.numbers().iter().all(|entry| entry.is_finite()) {
            true => room.array(py),
            false => Err(errors::argument(
                py,
                format!("joint `{}` has no home for these parameters", joint.name()),
            )),
        }
    }

    /// S at q and ϕ.
    pub fn velocity_map_of<'py>(
        &self,
        q: Given<'_, 'py>,
        phi: Option<Given<'_, 'py>>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built(q.py(), parameters)?;
        let (k, n) = (joint.layout().freedoms, joint.layout().configuration);
        let q = Argument::read(CONFIGURATION, q, n)?;
        let Some(phi) = phi else {
            return evaluate(&joint, [q], &[k, k], |[q], out| {
                by_rows(k, out, |out| joint.velocity_map(q, out))
            });
        };
        let phi = Argument::read("phi", phi, k)?;
        evaluate(&joint, [q, phi], &[k, k], |[q, phi], out| {
            // S(Q, ϕ) = S₀(Q′) D.
            let (mut moved, mut there, mut differential) =
                (vec![0.0; n], vec![0.0; k * k], vec![0.0; k * k]);
            joint.retract(q, phi, &mut moved);
            joint.velocity_map(&moved, &mut there);
            joint.retract_differential(q, phi, &mut differential);
            for (place, entry) in out.iter_mut().enumerate() {
                let (i, j) = (place / k, place % k);
                *entry = (0..k)
                    .map(|m| there[m * k + i] * differential[j * k + m])
                    .sum();
            }
        })
    }

    /// ∂S/∂ϕ.
    pub fn velocity_map_gradient_of<'py>(
        &self,
        q: Given<'_, 'py>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built(q.py(), parameters)?;
        let k = joint.layout().freedoms;
        let q = Argument::read(CONFIGURATION, q, joint.layout().configuration)?;
        evaluate(&joint, [q], &[k, k, k], |[q], out| {
            let mut slices = vec![0.0; k * k * k];
            joint.velocity_map_gradient(q, &mut slices);
            for (own, slice) in out.chunks_exact_mut(k * k).zip(slices.chunks_exact(k * k)) {
                by_rows(k, own, |out| out.copy_from_slice(slice));
            }
        })
    }

    /// X of a body.
    pub fn twist_map_of<'py>(
        &self,
        q: Given<'_, 'py>,
        body: Option<&str>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built_body(q.py(), body, parameters)?;
        let k = joint.layout().freedoms;
        let q = Argument::read(CONFIGURATION, q, joint.layout().configuration)?;
        evaluate(&joint, [q], &[6, k], |[q], out| {
            by_rows(k, out, |out| joint.twist_map(q, out))
        })
    }

    /// The pose of a body.
    pub fn pose_of<'py>(
        &self,
        q: Given<'_, 'py>,
        body: Option<&str>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built_body(q.py(), body, parameters)?;
        let q = Argument::read(CONFIGURATION, q, joint.layout().configuration)?;
        evaluate(&joint, [q], &[4, 4], |[q], out| {
            let pose = joint.pose(q);
            for i in 0..3 {
                for j in 0..3 {
                    out[4 * i + j] = pose.rotation[(i, j)];
                }
                out[4 * i + 3] = pose.translation[i];
            }
            out[15] = 1.0;
        })
    }

    /// Φ.
    pub fn retract_of<'py>(
        &self,
        q: Given<'_, 'py>,
        phi: Given<'_, 'py>,
        parameters: Parameters<'_, 'py>,
    ) -> PyResult<Arrays<'py>> {
        let joint = self.built(q.py(), parameters)?;
        let layout = joint.layout();
        let q = Argument::read(CONFIGURATION, q, layout.configuration)?;
        let phi = Argument::read("phi", phi, layout.freedoms)?;
        evaluate(
            &joint,
            [q, phi],
            &[layout.configuration],
            |[q, phi], out| joint.retract(q, phi, out),
        )
    }

    /// The joint as a body sees it, with values of its parameters.
    fn built_body(
        &self,
        py: Python<'_>,
        body: Option<&str>,
        parameters: Parameters<'_, '_>,
    ) -> PyResult<Shared> {
        let place = self.body(py, body)?;
        let first = self.built(py, parameters)?;
        let other = place
            .checked_sub(1)
            .and_then(|other| first.more().get(other).cloned());
        Ok(other.unwrap_or(first))
    }

    /// The joint with values of its parameters.
    fn built(&self, py: Python<'_>, parameters: Parameters<'_, '_>) -> PyResult<Shared> {
        let kind = self.kind(py)?;
        let known = kind.parameters();
        let mut faults = vec![];
        let mut values = vec![f64::NAN; known.len()];
        let mut given = vec![false; known.len()];
        for (name, value) in parameters.into_iter().flatten() {
            let name: String = name.extract()?;
            let Some(place) = known.iter().position(|own| own.name == name) else {
                faults.push(format!("it has no parameter `{name}`"));
                continue;
            };
            given[place] = true;
            match value.extract::<f64>() {
                Ok(number) => values[place] = number,
                Err(_) => faults.push(format!("{name} is {value:?}: it must be a number")),
            }
        }
        let missing = known.iter().zip(given).filter(|(_, given)| !given);
        faults.extend(
            missing.map(|(own, _)| {
                format!("its parameter `{}` ({}) is not given", own.name, own.unit)
            }),
        );
        if !faults.is_empty() {
            return Err(errors::argument(
                py,
                format!("joint `{}`: {}", kind.name(), faults.join("; ")),
            ));
        }
        kind.build(&values)
            .map_err(|error| errors::argument(py, error.to_string()))
    }
}

/// A square matrix or one of K columns, which `fill` writes column by column, row by row.
fn by_rows(columns: usize, out: &mut [f64], fill: impl FnOnce(&mut [f64])) {
    let mut given = vec![0.0; out.len()];
    fill(&mut given);
    let rows = out.len() / columns.max(1);
    for (place, entry) in out.iter_mut().enumerate() {
        *entry = given[place % columns * rows + place / columns];
    }
}

/// Evaluates `each` for every state of the arguments, of which the first is q, into an array of these last dimensions.
fn evaluate<'py, const A: usize>(
    joint: &Shared,
    arguments: [Argument<'py>; A],
    shape: &[usize],
    each: impl Fn([&[f64]; A], &mut [f64]),
) -> PyResult<Arrays<'py>> {
    let py = arguments[0].py();
    let batch = broadcast(py, &arguments)?;
    let count = size(&batch).ok_or_else(errors::memory)?;
    let width = shape.iter().product::<usize>();
    let mut room = Room::new(py, [&batch, shape].concat())?;
    let rows = arguments.each_ref().map(|argument| argument.rows(&batch));
    let numbers = room.numbers();
    for state in 0..count {
        if state % LOOK == LOOK - 1 {
            py.check_signals()?;
        }
        let own = rows.each_ref().map(|rows| rows.row(state));
        let out = numbers
            .get_mut(state * width..(state + 1) * width)
            .unwrap_or_default();
        let refuse = |message: String| errors::argument_of_state(py, &message, state, &batch);
        fault(&**joint, &own).map_or(Ok(()), |message| Err(refuse(message)))?;
        each(own, out);
        if !out.iter().all(|entry| entry.is_finite()) {
            return Err(refuse(no_value(&**joint)));
        }
    }
    room.array(py)
}

/// What is wrong with arguments, of which the first is q.
fn fault(joint: &dyn AnyJoint, arguments: &[&[f64]]) -> Option<String> {
    let all = arguments.iter().flat_map(|argument| argument.iter());
    if let Some(other) = all.copied().find(|entry| !entry.is_finite()) {
        return Some(format!("an argument holds {other}: it must be finite"));
    }
    let off = joint.residual(arguments.first()?);
    (off > FURTHEST).then(|| {
        let name = joint.name();
        format!(
            "q is off the manifold of joint `{name}` by {off:.1e}: it must be within {FURTHEST:e}"
        )
    })
}

fn no_value(joint: &dyn AnyJoint) -> String {
    let mut text = format!("joint `{}` has no value here", joint.name());
    if let [first, ..] = joint.singularities() {
        text.push_str(&format!(": its spec excepts {first}"));
    }
    text
}
