//! One `[[body]]`.

use super::{BodyDraft, elastic, forces, initial, joint, mass, placement};
use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink};
use crate::source::Located;
use hamel_runtime::spatial::Pose;

/// Name by which a body's `parent` means the inertial frame.
pub(crate) const WORLD: &str = "world";

/// Reads a body.
pub(super) fn body(mut fields: Fields<'_>, sink: &mut Sink) -> BodyDraft {
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
        name,
    };
    fields.finish(sink);
    draft
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
    fields
        .optional(key)
        .and_then(|value| placement::pose(&value, sink))
        .map_or_else(Pose::identity, |pose| pose.value)
}
