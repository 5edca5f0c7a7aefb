//! What goes wrong with a model.

use hamel_control::ControlError;
use hamel_integrate::{Doubt, IntegrateError};
use hamel_runtime::dynamics::{DynamicsError, PinError};
use hamel_runtime::mechanism::{MechanismErrors, StateError};
use hamel_runtime::registry::DuplicateJoint;
use hamel_runtime::shown::Number;
use hamel_scene::suggest::nearest;
use hamel_scene::{Diagnostics, SampleError};
use std::fmt::{Debug, Display, Formatter};

/// Why a model cannot be made, asked or moved. `Debug` prints the same text as `Display`, because that is what a failing `main` shows.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Mistakes in a scene or a robot file, each with its line.
    #[error(transparent)]
    Scene(#[from] Diagnostics),
    /// Mistakes in bodies that were made by hand, one a line.
    #[error("{}", lines(.0))]
    Bodies(Vec<BodyError>),
    /// Bodies that make no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismErrors),
    /// A state of the wrong size, or with numbers that are none.
    #[error(transparent)]
    State(#[from] StateError),
    /// Equations of motion without a solution.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// Forces at pins that are not known.
    #[error(transparent)]
    Pins(#[from] PinError),
    /// A motion that cannot begin or go on.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
    /// A controller that cannot be made.
    #[error("controller: {0}")]
    Controller(ControlError),
    /// A controller that has no efforts on the way.
    #[error("at {time} s: controller: {cause}", time = Number(*.time))]
    Control {
        /// When, s.
        time: f64,
        /// Why.
        cause: ControlError,
    },
    /// An accuracy that no tolerance reaches.
    #[error(
        "an error of at most {wanted:.1e} was asked for, and the least estimated is {error:.1e}, of which {rounding:.1e} is rounding in doubles{}",
        not_reliable(.doubt.as_ref())
    )]
    Accuracy {
        /// The error that was asked for.
        wanted: f64,
        /// The least one found, as estimated.
        error: f64,
        /// The part of it that is rounding.
        rounding: f64,
        /// Why the estimate is not reliable, if it is not.
        doubt: Option<Doubt>,
    },
    /// Samples that cannot be taken.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// Joint types of one name.
    #[error(transparent)]
    Registry(#[from] DuplicateJoint),
    /// A name that the model does not have.
    #[error(transparent)]
    Name(#[from] UnknownName),
}

impl Debug for Error {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

/// What is wrong with a body that was made by hand.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("body `{body}`: {reason}")]
pub struct BodyError {
    /// The body.
    pub body: String,
    /// What is wrong.
    pub reason: String,
}

/// A name that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownName {
    /// What was looked for: `joint or body`, `frame or body`.
    pub kind: &'static str,
    /// The name.
    pub name: String,
    /// The one that it most likely means.
    pub nearest: Option<String>,
}

impl UnknownName {
    /// `name` is none of `known`.
    pub(crate) fn new<'a>(
        kind: &'static str,
        name: &str,
        known: impl Iterator<Item = &'a str>,
    ) -> Self {
        Self {
            kind,
            name: name.to_owned(),
            nearest: nearest(name, known).map(str::to_owned),
        }
    }
}

impl Display for UnknownName {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "the model has no {} `{}`", self.kind, self.name)?;
        match &self.nearest {
            Some(nearest) => write!(f, "; did you mean `{nearest}`?"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for UnknownName {}

fn lines(errors: &[BodyError]) -> String {
    let lines: Vec<String> = errors.iter().map(BodyError::to_string).collect();
    lines.join("\n")
}

fn not_reliable(doubt: Option<&Doubt>) -> String {
    doubt.map_or_else(String::new, |doubt| {
        format!("; the estimate is not reliable: {doubt}")
    })
}
