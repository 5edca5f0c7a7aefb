//! One `[[body]]`: a body and its joint, or a joint and the bodies that it carries.

use super::{BodyDraft, elastic, forces, initial, joint, mass, placement};
use crate::description::{MimicDescription, Part};
use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink, Value};
use crate::source::Located;
use hamel_runtime::spatial::Pose;

/// Name by which a body's `parent` means the inertial frame.
pub(crate) const WORLD: &str = "world";

/// Reads a body, or all bodies of a joint that carries several: those under `bodies`, each with its mass and `body_at`.
pub(super) fn bodies(mut fields: Fields<'_>, sink: &mut Sink) -> Vec<BodyDraft> {
    match fields.optional("bodies") {
        None => vec![body(fields, sink)],
        Some(value) => parts(fields, &value, sink),
    }
}

/// Reads the bodies of a joint, under `value`; the first of them has what belongs to the joint.
fn parts(mut fields: Fields<'_>, value: &Value<'_>, sink: &mut Sink) -> Vec<BodyDraft> {
    let name = name(&mut fields, sink);
    if let Some(name) = &name {
        fields.set_owner(format!("joint `{}`: ", name.value));
    }
    let parent = fields.required("parent", sink);
    let parent = parent.and_then(|parent| parent.text(sink));
    let joint = joint::joint(&mut fields, name.as_ref(), sink);
    let at = pose(&mut fields, "at", sink);
    let mut initial = Some(initial::initial(&mut fields, sink));
    let mut forces = Some(forces::forces(&mut fields, sink));
    let mut all = Vec::new();
    let tables = value.table(sink).map(|bodies| bodies.unclaimed());
    for (number, (key, value)) in tables.into_iter().flatten().enumerate() {
        let called = |name: &Located<String>| {
            Located::new(format!("{}.{}", name.value, key.value), key.span.clone())
        };
        let Some(mut own) = value.table(sink) else {
            continue;
        };
        let full = name.as_ref().map(called);
        if let Some(full) = &full {
            own.set_owner(format!("body `{}`: ", full.value));
        }
        all.push(BodyDraft {
            name: full,
            parent: parent.clone(),
            mass: mass::mass(&mut own, sink),
            joint: joint.clone(),
            at: own_pose(&mut own, "at", sink).unwrap_or(at),
            body_at: pose(&mut own, "body_at", sink),
            initial: initial.take().unwrap_or_else(|| Some(Default::default())),
            forces: forces.take().unwrap_or_else(|| Some(Default::default())),
            elastic: None,
            motor: None,
            mimic: None,
            part: Some(Part { name: key, number }),
        });
        own.finish(sink);
    }
    if all.is_empty() && sink.len() == 0 {
        let error = Diagnostic::new(value.span(), format!("{}`bodies` is empty", fields.owner()));
        sink.push(
            error.help("give each body of the joint: `bodies.NAME = { mass = …, inertia = … }`"),
        );
    }
    fields.finish(sink);
    all
}

/// Reads a body that its joint carries alone.
fn body(mut fields: Fields<'_>, sink: &mut Sink) -> BodyDraft {
    let name = name(&mut fields, sink);
    if let Some(name) = &name {
        fields.set_owner(format!("body `{}`: ", name.value));
    }
    let draft = BodyDraft {
        parent: fields
            .required("parent", sink)
            .and_then(|parent| parent.text(sink)),
        mass: mass::mass(&mut fields, sink),
        joint: joint::joint(&mut fields, name.as_ref(), sink),
        at: pose(&mut fields, "at", sink),
        body_at: pose(&mut fields, "body_at", sink),
        initial: initial::initial(&mut fields, sink),
        forces: forces::forces(&mut fields, sink),
        elastic: fields
            .optional("elastic")
            .and_then(|value| elastic::elastic(&value, sink)),
        motor: None,
        mimic: fields
            .optional("mimic")
            .and_then(|value| mimic(&value, sink)),
        part: None,
        name,
    };
    fields.finish(sink);
    draft
}

/// What the joint follows.
fn mimic(value: &Value<'_>, sink: &mut Sink) -> Option<Located<MimicDescription>> {
    let mut fields = value.table(sink)?;
    let joint = fields.required("joint", sink);
    let joint = joint.and_then(|joint| joint.text(sink));
    let mut number = |key, default| match fields.optional(key) {
        Some(value) => value.number(sink).map(|number| number.value),
        None => Some(default),
    };
    let (multiplier, offset) = (number("multiplier", 1.0), number("offset", 0.0));
    fields.finish(sink);
    let mimic = MimicDescription {
        joint: joint?,
        multiplier: multiplier?,
        offset: offset?,
    };
    Some(Located::new(mimic, value.span()))
}

fn name(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Located<String>> {
    let name = fields.required("name", sink)?.text(sink)?;
    if name.value.is_empty() || name.value == WORLD {
        let message = format!("{}`name` may not be {:?}", fields.owner(), name.value);
        let error = Diagnostic::new(name.span, message);
        sink.push(error.help(format!(
            "`{WORLD}` is the inertial frame; every body has a name of its own"
        )));
        return None;
    }
    Some(name)
}

/// The pose under `key`; the identity where it is absent or in error.
fn pose(fields: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Pose<f64> {
    own_pose(fields, key, sink).unwrap_or_else(Pose::identity)
}

/// The pose under `key`; `None` where it is absent or in error.
fn own_pose(fields: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<Pose<f64>> {
    let value = fields.optional(key)?;
    placement::pose(&value, sink).map(|pose| pose.value)
}
