//! The `joint` of a body: type, name and parameters, whatever these are.

use crate::description::JointDescription;
use crate::read::{Fields, Sink};
use crate::source::Located;

/// Reads a joint. It is called as its body is, where it has no name of its own.
pub(super) fn joint(
    fields: &mut Fields<'_>,
    body: Option<&Located<String>>,
    sink: &mut Sink,
) -> Option<JointDescription> {
    let mut joint = fields.required("joint", sink)?.table(sink)?;
    let kind = joint
        .required("type", sink)
        .and_then(|kind| kind.text(sink));
    let name = match joint.optional("name") {
        Some(name) => name.text(sink),
        None => body.cloned(),
    };
    let mut parameters = Vec::new();
    for (key, value) in joint.unclaimed() {
        parameters.push((key, value.number(sink)?.value));
    }
    Some(JointDescription {
        name: name?,
        kind: kind?,
        parameters,
        coupling: None,
        span: joint.span(),
    })
}
