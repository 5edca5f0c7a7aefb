//! The events of a scene, fitted to its mechanism.

use super::by_joint;
use crate::diagnostics::Diagnostic;
use crate::event::{EventDescription, PortOf, Quantity, QuantityDescription, SceneEvent};
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::{nearest, one_of};
use hamel_runtime::mechanism::{Body, Mechanism};
use std::ops::Range;

/// Looks the joints up in the mechanism; every error is noted.
pub(super) fn events(
    descriptions: &[EventDescription],
    mechanism: &Mechanism,
    sink: &mut Sink,
) -> Option<Vec<SceneEvent>> {
    let joints = by_joint(mechanism);
    // The parser has seen to it that there is one.
    let find = |joint: &Located<String>| {
        let index = *joints.get(joint.value.as_str())?;
        Some((index, mechanism.bodies().get(index)?))
    };
    let found: Vec<_> = descriptions
        .iter()
        .map(|description| {
            Some(SceneEvent {
                name: description.name.value.clone(),
                quantity: quantity(&description.quantity, &find, sink)?,
                value: description.value,
                direction: description.direction,
                stops: description.stops,
            })
        })
        .collect();
    found.into_iter().collect()
}

fn quantity<'a>(
    description: &QuantityDescription,
    find: &impl Fn(&Located<String>) -> Option<(usize, &'a Body)>,
    sink: &mut Sink,
) -> Option<Quantity> {
    match description {
        QuantityDescription::Point(point) => Some(Quantity::Point(*point)),
        QuantityDescription::Coordinate { joint, name } => {
            let (_, body) = find(joint)?;
            let own = (body.joint().coordinates(), &body.ranges().configuration);
            entry(body, "coordinate", name, own, sink).map(Quantity::Coordinate)
        }
        QuantityDescription::Speed { joint, name } => {
            let (_, body) = find(joint)?;
            let own = (body.joint().speeds(), &body.ranges().speeds);
            entry(body, "speed", name, own, sink).map(Quantity::Speed)
        }
        QuantityDescription::Port { joint, name } => {
            port(find(joint)?, "port", name, sink).map(Quantity::Port)
        }
        QuantityDescription::Rate { joint, name } => {
            port(find(joint)?, "rate", name, sink).map(Quantity::Rate)
        }
    }
}

/// The port called `name`.
fn port(
    (index, body): (usize, &Body),
    key: &str,
    name: &Located<String>,
    sink: &mut Sink,
) -> Option<PortOf> {
    let ports = body.joint().ports();
    let names: Vec<&str> = ports.iter().map(|port| port.name).collect();
    let port = entry(body, key, name, (&names, &(0..ports.len())), sink)?;
    Some(PortOf {
        body: index,
        port,
        wraps: ports[port].wraps,
    })
}

/// The index, among those of all joints, of the entry called `name`.
fn entry(
    body: &Body,
    key: &str,
    name: &Located<String>,
    (names, range): (&[&str], &Range<usize>),
    sink: &mut Sink,
) -> Option<usize> {
    if let Some(place) = names.iter().position(|known| *known == name.value) {
        return Some(range.start + place);
    }
    let joint = body.joint_name();
    let message = format!(
        "`{key}` is {:?}, which joint `{joint}` does not have",
        name.value
    );
    let error = Diagnostic::new(name.span.clone(), message);
    let known = names.iter().copied();
    sink.push(match nearest(&name.value, known.clone()) {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None if names.is_empty() => error.help("joints of its type have no ports"),
        None => error.help(format!("a {key} of it is {}", one_of(known))),
    });
    None
}
