//! `[[event]]`: what is to be noticed on the way.

use super::controller::{Joints, known};
use super::elements::{Bodies, name, vector};
use super::rotation;
use crate::event::{
    CONSEQUENCE_NAMES, DIRECTION_NAMES, EventDescription, PointAlong, QuantityDescription,
};
use crate::read::{Fields, Sink, Value};
use hamel_integrate::Direction;

/// Reads one event.
pub(super) fn event(
    fields: &mut Fields<'_>,
    bodies: &Bodies<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<EventDescription> {
    let name = name(fields, "event", sink);
    let quantity = match fields.exactly_one(&["body", "joint"], sink) {
        Some((0, body)) => point(fields, &body, bodies, sink),
        Some((_, joint)) => of_joint(fields, &joint, joints, sink),
        None => None,
    };
    let value = match fields.optional("value") {
        Some(value) => value.number(sink).map(|value| value.value),
        None => Some(0.0),
    };
    let direction = choice(fields, "direction", &DIRECTION_NAMES, sink);
    let stops = choice(fields, "then", &CONSEQUENCE_NAMES, sink);
    Some(EventDescription {
        name: name?,
        quantity: quantity?,
        value: value?,
        direction: match direction? {
            "rising" => Direction::Rising,
            "falling" => Direction::Falling,
            _ => Direction::Any,
        },
        stops: stops? == "stop",
    })
}

/// The choice of `key`; the first of `names` where it is absent.
fn choice(
    fields: &mut Fields<'_>,
    key: &'static str,
    names: &[&'static str],
    sink: &mut Sink,
) -> Option<&'static str> {
    match fields.optional(key) {
        Some(value) => value.choice(names, sink),
        None => names.first().copied(),
    }
}

fn point(
    fields: &mut Fields<'_>,
    body: &Value<'_>,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<QuantityDescription> {
    let body = bodies.find_moving(body, "no point of it crosses anything", sink);
    let point = vector(fields, "point", sink);
    let along = fields.required("along", sink).and_then(|along| {
        let vector = along.vector(sink)?;
        rotation::unit(&along.path(), vector, sink)
    });
    Some(QuantityDescription::Point(PointAlong {
        body: body?,
        point: point?,
        along: along?,
    }))
}

fn of_joint(
    fields: &mut Fields<'_>,
    joint: &Value<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<QuantityDescription> {
    let joint = known(joint, joints, sink);
    let entry = fields.exactly_one(&["coordinate", "speed", "port", "rate"], sink);
    let (kind, value) = entry?;
    let (joint, name) = (joint?, value.text(sink)?);
    Some(match kind {
        0 => QuantityDescription::Coordinate { joint, name },
        1 => QuantityDescription::Speed { joint, name },
        2 => QuantityDescription::Port { joint, name },
        _ => QuantityDescription::Rate { joint, name },
    })
}
