//! Where in the text stands what the mechanism refuses.

use crate::description::SceneDescription;
use crate::diagnostics::Diagnostic;
use crate::source::{Located, Span};
use hamel::dynamics::DynamicsError;
use hamel::elements::ElementError;
use hamel::mechanism::MechanismError;

/// What the mechanism refuses, at the body, joint, frame or constraint that it names.
pub(super) fn refused(description: &SceneDescription, error: &MechanismError) -> Diagnostic {
    let span = match error {
        MechanismError::DependentConstraint { constraint, .. } => {
            constraint_named(description, constraint)
        }
        MechanismError::Element(ElementError::Joint { joint, .. })
        | MechanismError::Home { joint, .. }
        | MechanismError::Singular { joint, .. }
        | MechanismError::RankDeficient { joint, .. } => named(
            description.bodies.iter().map(|body| &body.joint.name),
            joint,
        ),
        MechanismError::DuplicateName { body, .. }
        | MechanismError::Parent { body, .. }
        | MechanismError::Placement { body, .. }
        | MechanismError::Mass { body, .. } => {
            named(description.bodies.iter().map(|body| &body.name), body)
        }
        MechanismError::Frame { frame, .. } => {
            named(description.frames.iter().map(|frame| &frame.name), frame)
        }
        MechanismError::Element(ElementError::Value { element, .. }) => {
            constraint_named(description, element)
        }
        MechanismError::Gravity { .. }
        | MechanismError::Configuration(_)
        | MechanismError::Element(_) => None,
    };
    at(span, error.to_string())
}

/// What keeps the speeds from being found that constraints make depend on others.
pub(super) fn undetermined(description: &SceneDescription, error: &DynamicsError) -> Diagnostic {
    let span = match error {
        DynamicsError::Coupling { constraint, .. }
        | DynamicsError::ConstraintViolated { constraint, .. } => {
            constraint_named(description, constraint)
        }
        _ => None,
    };
    at(span, error.to_string())
}

fn at(span: Option<Span>, message: String) -> Diagnostic {
    match span {
        Some(span) => Diagnostic::new(span, message),
        None => Diagnostic::without_place(message),
    }
}

fn constraint_named(description: &SceneDescription, name: &str) -> Option<Span> {
    named(description.constraints.iter().map(|c| &c.name), name)
}

/// The place of `name` among `names`.
fn named<'a>(mut names: impl Iterator<Item = &'a Located<String>>, name: &str) -> Option<Span> {
    names
        .find(|found| found.value == name)
        .map(|found| found.span.clone())
}
