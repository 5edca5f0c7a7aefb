//! Ports of joints in the `[controller]` table: where they are wanted, and where energy goes in and out.

use super::{Joints, joint, law, not_negative, or, positive};
use crate::control::{PortDescription, PortReferenceDescription};
use crate::read::{Fields, Sink, Value};
use hamel_control::PortSpring;

/// Where the ports of a joint are wanted, each under its name.
pub(super) fn references(
    value: &Value<'_>,
    sink: &mut Sink,
) -> Option<Vec<PortReferenceDescription>> {
    let named = value.table(sink)?.unclaimed().into_iter();
    let each = named.map(|(name, value)| {
        let mut fields = value.table(sink)?;
        let start = match fields.optional("start") {
            Some(start) => start.number(sink).map(|start| Some(start.value)),
            None => Some(None),
        };
        let law = law(&mut fields, sink);
        fields.finish(sink);
        Some(PortReferenceDescription {
            name,
            start: start?,
            law: law?,
        })
    });
    let all: Vec<_> = each.collect();
    all.into_iter().collect()
}

/// A joint, or one port of it, by which energy goes in and out.
pub(super) fn port(
    fields: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<PortDescription> {
    let joint = joint(fields, joints, sink);
    let named = match fields.optional("port") {
        Some(port) => port.text(sink).map(Some),
        None => Some(None),
    };
    let stiffness = or(fields, "stiffness", 0.0, not_negative, sink);
    let kind = match fields.optional("kind") {
        Some(kind) => kind.choice(&["log", "trace"], sink),
        None => Some("log"),
    };
    let damping = or(fields, "damping", 0.0, not_negative, sink);
    let limit = or(fields, "limit", f64::INFINITY, positive, sink);
    Some(PortDescription {
        joint: joint?,
        port: named?,
        spring: match kind? {
            "trace" => PortSpring::Trace(stiffness?),
            _ => PortSpring::Log(stiffness?),
        },
        damping: damping?,
        limit: limit?,
    })
}
