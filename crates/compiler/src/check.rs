//! What a scene and a model are refused for before any equation is written, and what is found in those that are.

use super::emit::Function;
use super::graph::{Cause, Fault};
use super::model::Model;
use hamel_codegen::derived::{Derived, KernelKind, Structure};
use hamel_runtime::mechanism::{RigidBody, check_bodies};
use hamel_scene::{BodyDescription, SceneDescription};

/// What is wrong with the bodies of a scene, in the words of the mechanism, and with what hangs on them.
pub(super) fn of_scene(scene: &SceneDescription) -> Vec<String> {
    let bodies: Vec<RigidBody<'_>> = scene.bodies.iter().map(rigid).collect();
    let wrong = check_bodies(&scene.gravity, &bodies);
    let mut reasons: Vec<String> = wrong.iter().map(ToString::to_string).collect();
    reasons.extend(of_indices(scene));
    reasons
}

/// A body as its mechanism is made from it, except for the joint.
fn rigid(body: &BodyDescription) -> RigidBody<'_> {
    RigidBody {
        name: &body.name.value,
        parent: body.parent,
        placement: &body.at,
        child_placement: &body.body_at,
        mass: &body.mass,
    }
}

/// Bodies that are named by their index and are not there.
fn of_indices(scene: &SceneDescription) -> Vec<String> {
    let count = scene.bodies.len();
    let springs = scene
        .springs
        .iter()
        .enumerate()
        .flat_map(|(index, spring)| {
            let ends = [spring.from.body, spring.to.body].into_iter().flatten();
            ends.map(move |body| (format!("spring {}", index + 1), body))
        });
    let wrenches = scene.wrenches.iter().enumerate();
    let wrenches = wrenches.map(|(index, wrench)| (format!("wrench {}", index + 1), wrench.body));
    let constraints = scene.constraints.iter();
    let constraints = constraints.map(|own| (format!("constraint `{}`", own.name.value), own.body));
    let all = springs.chain(wrenches).chain(constraints);
    let missing = all.filter(|(_, body)| *body >= count);
    missing
        .map(|(element, body)| {
            format!("{element}: there is no body of index {body}, the scene has {count}")
        })
        .collect()
}

/// Whether the bodies that a scene gives for a joint are those that its type carries, in their order, and hang as the first of them does.
pub(super) fn of_joint(group: &[BodyDescription], joint: &Derived) -> Result<(), String> {
    let Some((first, others)) = group.split_first() else {
        return Ok(());
    };
    let (name, kind) = (&first.joint.name.value, &first.joint.kind.value);
    let parts = group.iter().filter_map(|body| body.part.as_ref());
    let parts: Vec<&str> = parts.map(|part| part.name.value.as_str()).collect();
    let carried: Vec<&str> = match joint.more.is_empty() {
        true => vec![],
        false => joint.bodies().filter_map(Derived::body_name).collect(),
    };
    if parts != carried {
        return Err(format!(
            "joint `{name}`: a joint of type `{kind}` carries {}, and the scene gives it {}",
            listed(&carried),
            listed(&parts)
        ));
    }
    let different = |other: &BodyDescription| {
        let what = difference(first, other, joint)?;
        Some(format!(
            "body `{}`: its {what} is not that of `{}`, the first body of its joint `{name}`",
            other.name.value, first.name.value
        ))
    };
    others.iter().find_map(different).map_or(Ok(()), Err)
}

/// Names of bodies, none where a joint carries one.
fn listed(names: &[&str]) -> String {
    match names {
        [] => "one body without a name".to_owned(),
        names => format!("`{}`", names.join("`, `")),
    }
}

/// In what a body differs from the first one of its joint where it must not: relations are written for one frame.
fn difference(
    first: &BodyDescription,
    other: &BodyDescription,
    joint: &Derived,
) -> Option<&'static str> {
    let residual = joint.kernel(KernelKind::Residual);
    let has_relations = residual.is_some_and(|kernel| kernel.structure != Structure::Zero);
    if first.parent != other.parent {
        Some("parent")
    } else if first.at != other.at && has_relations {
        Some("placement")
    } else if first.joint != other.joint {
        Some("joint")
    } else {
        None
    }
}

/// Wrenches that change with time: compiled equations are not told the time. Efforts that do are handed to them in τ.
pub(super) fn of_time(scene: &SceneDescription) -> impl Iterator<Item = String> {
    let wrenches = scene.wrenches.iter().enumerate();
    let timed = wrenches.filter(|(_, wrench)| wrench.constant().is_none());
    timed.map(|(index, _)| {
        format!(
            "wrench {}: it changes with time, which is not compiled: simulate the scene as it is, or let an effort of a joint change with time",
            index + 1
        )
    })
}

/// What is not a number in a function that is to be written, each with the element that makes it.
pub(super) fn of_function(model: &Model, function: &Function) -> Vec<String> {
    let faults = function.graph.faults(&function.outputs);
    let mut reasons: Vec<String> = faults.iter().map(|fault| told(model, fault)).collect();
    reasons.dedup();
    reasons
}

fn told(model: &Model, fault: &Fault) -> String {
    let body = usize::try_from(fault.section)
        .ok()
        .and_then(|index| model.bodies.get(index));
    match (&fault.cause, &fault.element, body) {
        (Cause::Inertia(words), ..) => words.clone(),
        (cause, Some(element), _) => format!("{element} {cause}"),
        (cause, None, Some(body)) => format!(
            "body `{}` (joint `{}`): its {} {cause}",
            body.name, body.joint_name, fault.topic
        ),
        (cause, None, None) => format!("the scene {cause}"),
    }
}
