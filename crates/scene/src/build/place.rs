//! Maps errors of a mechanism to their places in the scene file.

use crate::description::SceneDescription;
use crate::diagnostics::Diagnostic;
use crate::source::{Located, Span};
use hamel_runtime::dynamics::DynamicsError;
use hamel_runtime::elements::ElementError;
use hamel_runtime::mechanism::MechanismError;
use std::cell::OnceCell;
use std::collections::HashMap;

/// Where the elements of a scene stand. There may be as many errors as elements: names are looked up in tables, made for the first error.
pub(super) struct Places<'a> {
    description: &'a SceneDescription,
    bodies: OnceCell<Spans<'a>>,
    joints: OnceCell<Spans<'a>>,
    frames: OnceCell<Spans<'a>>,
    constraints: OnceCell<Spans<'a>>,
}

type Spans<'a> = HashMap<&'a str, &'a Span>;

impl<'a> Places<'a> {
    /// The places in the text of `description`.
    pub(super) fn new(description: &'a SceneDescription) -> Self {
        Self {
            description,
            bodies: OnceCell::new(),
            joints: OnceCell::new(),
            frames: OnceCell::new(),
            constraints: OnceCell::new(),
        }
    }

    /// What the mechanism refuses, at the body, joint, frame or constraint that it names.
    pub(super) fn refused(&self, error: &MechanismError) -> Diagnostic {
        let span = match error {
            MechanismError::DependentConstraint { constraint, .. } => self.constraint(constraint),
            MechanismError::Element(ElementError::Joint { joint, .. })
            | MechanismError::Assembly { joint, .. }
            | MechanismError::Home { joint, .. }
            | MechanismError::Layout { joint, .. }
            | MechanismError::Singular { joint, .. }
            | MechanismError::RankDeficient { joint, .. } => self.joint(joint),
            MechanismError::DuplicateName { body, .. }
            | MechanismError::Parent { body, .. }
            | MechanismError::Overflow { body, .. }
            | MechanismError::Several { body, .. }
            | MechanismError::Placement { body, .. }
            | MechanismError::Mass { body, .. } => self.body(body),
            MechanismError::Frame { frame, .. } => self.frame(frame),
            MechanismError::Element(ElementError::Value { element, .. }) => {
                self.constraint(element).or_else(|| self.joint_of(element))
            }
            // Of gravity, of all constraints together, or of the configuration.
            _ => None,
        };
        at(span, error.to_string())
    }

    /// What keeps the speeds from being found that constraints make depend on others.
    pub(super) fn undetermined(&self, error: &DynamicsError) -> Diagnostic {
        let span = match error {
            DynamicsError::Coupling { constraint, .. }
            | DynamicsError::ConstraintViolated { constraint, .. } => self.constraint(constraint),
            _ => None,
        };
        at(span, error.to_string())
    }

    fn body(&self, name: &str) -> Option<Span> {
        let names = || self.description.bodies.iter().map(|body| &body.name);
        found(&self.bodies, names, name)
    }

    fn joint(&self, name: &str) -> Option<Span> {
        let names = || self.description.bodies.iter().map(|body| &body.joint.name);
        found(&self.joints, names, name)
    }

    /// The joint at which an element acts: the name of the element ends with it.
    fn joint_of(&self, element: &str) -> Option<Span> {
        let mut names = self.description.bodies.iter().map(|body| &body.joint.name);
        let own = names.find(|name| element.ends_with(&format!("of joint `{}`", name.value)));
        own.map(|name| name.span.clone())
    }

    fn frame(&self, name: &str) -> Option<Span> {
        let names = || self.description.frames.iter().map(|frame| &frame.name);
        found(&self.frames, names, name)
    }

    fn constraint(&self, name: &str) -> Option<Span> {
        let names = || self.description.constraints.iter().map(|c| &c.name);
        found(&self.constraints, names, name)
    }
}

fn at(span: Option<Span>, message: String) -> Diagnostic {
    match span {
        Some(span) => Diagnostic::new(span, message),
        None => Diagnostic::without_place(message),
    }
}

/// The place of `name` among `names`, of which `table` is made.
fn found<'a, I: Iterator<Item = &'a Located<String>>>(
    table: &OnceCell<Spans<'a>>,
    names: impl FnOnce() -> I,
    name: &str,
) -> Option<Span> {
    let table = table.get_or_init(|| names().map(|n| (n.value.as_str(), &n.span)).collect());
    table.get(name).map(|&span| span.clone())
}
