//! The states of all bodies, where a joint may carry several of them: the first has the joint's state, the others have none of their own.

use super::forces::Acting;
use super::state::{State, state};
use crate::description::{BodyDescription, JointDescription, Part};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::suggest::{all_of, nearest};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::registry::JointRegistry;

/// Builds the joints and solves for their states, one entry a body.
pub(crate) fn states(
    bodies: &[BodyDescription],
    registry: &JointRegistry,
    sink: &mut Sink,
) -> Option<Vec<State>> {
    let mut states: Vec<Option<State>> = Vec::with_capacity(bodies.len());
    let groups = bodies.chunk_by(|_, next| !next.leads());
    for group in groups {
        let Some(first) = group.first() else { continue };
        let own = state(&first.joint, &first.initial, &first.forces, registry, sink);
        let own = own.filter(|own| {
            let parts: Vec<&Part> = group.iter().filter_map(|own| own.part.as_ref()).collect();
            let refused = refusal(&first.joint, &*own.joint, &parts);
            let sound = refused.is_none();
            refused.into_iter().for_each(|error| sink.push(error));
            sound
        });
        let more = own.as_ref().map_or_else(Vec::new, |own| own.joint.more());
        states.push(own);
        let further = more.into_iter().map(|joint| {
            Some(State {
                joint,
                configuration: Vec::new(),
                speeds: Vec::new(),
                acting: Acting::default(),
            })
        });
        states.extend(further);
    }
    states.into_iter().collect()
}

/// What is wrong with the bodies that are given for a joint.
fn refusal(
    description: &JointDescription,
    joint: &dyn AnyJoint,
    parts: &[&Part],
) -> Option<Diagnostic> {
    let (name, kind, bodies) = (&description.name.value, joint.name(), joint.bodies());
    let carries = format!(
        "a joint of type `{kind}` carries the bodies {}",
        all_of(bodies.iter().copied())
    );
    if bodies.len() <= 1 {
        let first = parts.first()?;
        let message = format!("joint `{name}`: a joint of type `{kind}` carries one body alone");
        let error = Diagnostic::new(first.name.span.clone(), message);
        return Some(error.help("give `mass` and `inertia` beside `joint`, without `bodies`"));
    }
    if parts.is_empty() {
        let message = format!("joint `{name}`: {carries}");
        let error = Diagnostic::new(description.span.clone(), message);
        return Some(
            error.help(
                "give each of them, in this order: `bodies.NAME = { mass = …, inertia = … }`",
            ),
        );
    }
    let unknown = parts
        .iter()
        .find(|part| !bodies.contains(&part.name.value.as_str()));
    if let Some(part) = unknown {
        let given = &part.name.value;
        let message = format!("joint `{name}`: a joint of type `{kind}` carries no body `{given}`");
        let error = Diagnostic::new(part.name.span.clone(), message);
        return Some(match nearest(given, bodies.iter().copied()) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None => error.help(carries),
        });
    }
    let missing = bodies
        .iter()
        .find(|body| parts.iter().all(|part| part.name.value != **body));
    if let Some(body) = missing {
        let message = format!("joint `{name}`: its body `{body}` is missing");
        let error = Diagnostic::new(description.span.clone(), message);
        return Some(error.help(carries));
    }
    let given = parts.iter().map(|part| part.name.value.as_str());
    let (misplaced, _) = parts
        .iter()
        .zip(bodies)
        .find(|(part, body)| part.name.value != **body)?;
    let message = format!(
        "joint `{name}`: its bodies are given in the order {}",
        given.collect::<Vec<_>>().join(", ")
    );
    let error = Diagnostic::new(misplaced.name.span.clone(), message);
    Some(error.help(format!("{carries}, in this order")))
}
