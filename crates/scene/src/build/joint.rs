//! A joint from the registry, by the name of its type and its parameters.

use crate::description::JointDescription;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::suggest::{all_of, nearest};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::joint::LinkFault;
use hamel_runtime::registry::{JointEntry, JointRegistry};
use std::sync::Arc;

/// Builds the joint: of its type, or of its links where it is a coupling.
pub(crate) fn joint(
    description: &JointDescription,
    registry: &JointRegistry,
    sink: &mut Sink,
) -> Option<Arc<dyn AnyJoint>> {
    if let Some(coupling) = &description.coupling {
        let refuse = |error: LinkFault| {
            let message = format!("joint `{}`: {error}", description.name.value);
            sink.push(Diagnostic::new(description.span.clone(), message));
        };
        return coupling.joint().map_err(refuse).ok();
    }
    let Some(entry) = registry.get(&description.kind.value) else {
        sink.push(unknown_type(description, registry));
        return None;
    };
    let errors_before = sink.len();
    refuse_unknown_parameters(description, entry, sink);
    let values = parameter_values(description, entry, sink);
    if sink.len() > errors_before {
        return None;
    }
    registry
        .build(entry.name, &values)?
        .map_err(|error| {
            let message = format!("joint `{}`: {error}", description.name.value);
            sink.push(Diagnostic::new(description.span.clone(), message));
        })
        .ok()
}

fn unknown_type(description: &JointDescription, registry: &JointRegistry) -> Diagnostic {
    let (name, kind) = (&description.name.value, &description.kind);
    let message = format!("joint `{name}`: there is no joint type `{}`", kind.value);
    let error = Diagnostic::new(kind.span.clone(), message);
    match nearest(&kind.value, registry.names()) {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None => error.help(format!("joint types are {}", all_of(registry.names()))),
    }
}

fn refuse_unknown_parameters(description: &JointDescription, entry: &JointEntry, sink: &mut Sink) {
    let known = || entry.parameters.iter().map(|parameter| parameter.name);
    for (key, _) in &description.parameters {
        if known().any(|name| name == key.value) {
            continue;
        }
        let message = format!(
            "joint `{}`: the type `{}` has no parameter `{}`",
            description.name.value, entry.name, key.value
        );
        let error = Diagnostic::new(key.span.clone(), message);
        sink.push(match nearest(&key.value, known()) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None if entry.parameters.is_empty() => error.label("it takes no parameter"),
            None => error.help(format!("its parameters are {}", all_of(known()))),
        });
    }
}

/// The values in the order of the entry; a missing one is an error.
fn parameter_values(
    description: &JointDescription,
    entry: &JointEntry,
    sink: &mut Sink,
) -> Vec<f64> {
    let mut values = Vec::with_capacity(entry.parameters.len());
    for parameter in entry.parameters {
        let given = description.parameters.iter();
        match given.clone().find(|(key, _)| key.value == parameter.name) {
            Some((_, value)) => values.push(*value),
            None => {
                let message = format!(
                    "joint `{}`: the type `{}` needs the parameter `{}`",
                    description.name.value, entry.name, parameter.name
                );
                let error = Diagnostic::new(description.span.clone(), message);
                sink.push(error.help(match parameter.description {
                    "" => format!("its unit is {}", parameter.unit),
                    described => format!("{}, {}", described.trim_end_matches('.'), parameter.unit),
                }));
            }
        }
    }
    values
}
