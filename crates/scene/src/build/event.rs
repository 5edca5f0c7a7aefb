//! The events of a scene, fitted to its joints: whether these have what events name shows without a mechanism, which may not come about for other mistakes.

use super::by_joint;
use crate::diagnostics::Diagnostic;
use crate::event::{EventDescription, PortOf, Quantity, QuantityDescription, SceneEvent};
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::{nearest, one_of};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{Body, Mechanism};
use std::sync::Arc;

/// The events with the indices of their quantities; `None` where a joint has no such quantity, of which [`check`] notes the error.
pub(super) fn events(
    descriptions: &[EventDescription],
    mechanism: &Mechanism,
) -> Option<Vec<SceneEvent>> {
    let joints = by_joint(mechanism);
    // The parser has seen to it that there is one.
    let find = |joint: &Located<String>| {
        let index = *joints.get(joint.value.as_str())?;
        Some((index, mechanism.bodies().get(index)?))
    };
    let event = |description: &EventDescription| {
        Some(SceneEvent {
            name: description.name.value.clone(),
            quantity: quantity(&description.quantity, &find)?,
            value: description.value,
            direction: description.direction,
            stops: description.stops,
        })
    };
    descriptions.iter().map(event).collect()
}

/// Notes each event whose joint has no such quantity; `joint` finds those that could be built.
pub(crate) fn check(
    descriptions: &[EventDescription],
    joint: impl Fn(&str) -> Option<Arc<dyn AnyJoint>>,
    sink: &mut Sink,
) {
    let own = descriptions
        .iter()
        .filter_map(|event| Named::of(&event.quantity));
    for named in own {
        if let Some(joint) = joint(&named.joint.value)
            && let Err(error) = named.place(&*joint)
        {
            sink.push(error);
        }
    }
}

fn quantity<'a>(
    description: &QuantityDescription,
    find: &impl Fn(&Located<String>) -> Option<(usize, &'a Body)>,
) -> Option<Quantity> {
    let named = match description {
        QuantityDescription::Point(point) => return Some(Quantity::Point(*point)),
        _ => Named::of(description)?,
    };
    let (index, body) = find(named.joint)?;
    let place = named.place(body.joint()).ok()?;
    let port = || PortOf {
        body: index,
        port: place,
        wraps: body.joint().ports()[place].wraps,
    };
    Some(match named.kind {
        NameOf::Coordinate => Quantity::Coordinate(body.ranges().configuration.start + place),
        NameOf::Speed => Quantity::Speed(body.ranges().speeds.start + place),
        NameOf::Port => Quantity::Port(port()),
        NameOf::Rate => Quantity::Rate(port()),
    })
}

/// Of what a quantity has the name.
#[derive(Clone, Copy, Debug)]
enum NameOf {
    Coordinate,
    Speed,
    Port,
    Rate,
}

/// A quantity that a joint has by name.
struct Named<'a> {
    kind: NameOf,
    joint: &'a Located<String>,
    name: &'a Located<String>,
}

impl<'a> Named<'a> {
    fn of(description: &'a QuantityDescription) -> Option<Self> {
        let (kind, joint, name) = match description {
            QuantityDescription::Point(_) => return None,
            QuantityDescription::Coordinate { joint, name } => (NameOf::Coordinate, joint, name),
            QuantityDescription::Speed { joint, name } => (NameOf::Speed, joint, name),
            QuantityDescription::Port { joint, name } => (NameOf::Port, joint, name),
            QuantityDescription::Rate { joint, name } => (NameOf::Rate, joint, name),
        };
        Some(Self { kind, joint, name })
    }

    /// Its place among those of the joint.
    fn place(&self, joint: &dyn AnyJoint) -> Result<usize, Diagnostic> {
        let ports = || joint.ports().iter().map(|port| port.name).collect();
        let (key, names): (&str, Vec<&str>) = match self.kind {
            NameOf::Coordinate => ("coordinate", joint.coordinates().to_vec()),
            NameOf::Speed => ("speed", joint.speeds().to_vec()),
            NameOf::Port => ("port", ports()),
            NameOf::Rate => ("rate", ports()),
        };
        let place = names.iter().position(|known| *known == self.name.value);
        place.ok_or_else(|| self.unknown(key, &names))
    }

    fn unknown(&self, key: &str, names: &[&str]) -> Diagnostic {
        let message = format!(
            "`{key}` is {:?}, which joint `{}` does not have",
            self.name.value, self.joint.value
        );
        let error = Diagnostic::new(self.name.span.clone(), message);
        let known = names.iter().copied();
        match nearest(&self.name.value, known.clone()) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None if names.is_empty() => error.help("joints of its type have no ports"),
            None => error.help(format!("a {key} of it is {}", one_of(known))),
        }
    }
}
