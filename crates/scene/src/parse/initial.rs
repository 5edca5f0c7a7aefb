//! The `initial` state of a body's joint.

use super::placement;
use crate::description::{
    InitialDescription, Motion, PortRate, Position, TwistDescription, TwistFrame,
};
use crate::read::{Fields, Sink, Value};
use crate::source::Located;
use nalgebra::{Vector3, Vector6};

/// Reads `initial`; home and rest where it is absent.
pub(super) fn initial(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<InitialDescription> {
    let Some(value) = fields.optional("initial") else {
        return Some(InitialDescription::default());
    };
    let mut initial = value.table(sink)?;
    let position = position(&mut initial, sink);
    let motion = motion(&mut initial, sink);
    initial.finish(sink);
    Some(InitialDescription {
        position: position?,
        motion: motion?,
    })
}

/// Where a joint stands; home where nothing is given.
pub(super) fn position(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Position> {
    match fields.at_most_one(&["configuration", "phi", "pose"], sink) {
        None => Some(Position::Home),
        Some((0, value)) => Some(Position::Configuration(value.numbers(sink)?)),
        Some((1, value)) => Some(Position::Phi(value.numbers(sink)?)),
        Some((_, value)) => Some(Position::Pose(placement::pose(&value, sink)?)),
    }
}

fn motion(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Motion> {
    match fields.at_most_one(&["velocity", "speeds", "twist", "rates"], sink) {
        None => Some(Motion::Rest),
        Some((0, value)) => Some(Motion::Velocity(value.numbers(sink)?)),
        Some((1, value)) => Some(Motion::Speeds(value.numbers(sink)?)),
        Some((2, value)) => Some(Motion::Twist(twist(&value, sink)?)),
        Some((_, value)) => Some(Motion::Rates(rates(&value, sink)?)),
    }
}

/// Rates of ports, each under its name.
fn rates(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Vec<PortRate>>> {
    let named = value.table(sink)?.unclaimed();
    let all: Vec<_> = named
        .into_iter()
        .map(|(name, value)| {
            let rate = value.number(sink)?.value;
            Some(PortRate { name, rate })
        })
        .collect();
    let rates: Option<Vec<_>> = all.into_iter().collect();
    Some(Located::new(rates?, value.span()))
}

fn twist(value: &Value<'_>, sink: &mut Sink) -> Option<Located<TwistDescription>> {
    let mut fields = value.table(sink)?;
    let angular = part(&mut fields, "angular", sink);
    let linear = part(&mut fields, "linear", sink);
    let frame = fields.required("frame", sink);
    let frame = frame.and_then(|frame| twist_frame(&frame, sink));
    fields.finish(sink);
    let (angular, linear) = (angular?, linear?);
    let twist = TwistDescription {
        twist: Vector6::new(
            angular.x, angular.y, angular.z, linear.x, linear.y, linear.z,
        ),
        frame: frame?,
    };
    Some(Located::new(twist, value.span()))
}

/// One part of a twist, 0 where it is absent.
fn part(fields: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<Vector3<f64>> {
    match fields.optional(key) {
        Some(value) => Some(value.vector(sink)?.value),
        None => Some(Vector3::zeros()),
    }
}

fn twist_frame(value: &Value<'_>, sink: &mut Sink) -> Option<TwistFrame> {
    match value.choice(&TwistFrame::NAMES, sink)? {
        "child" => Some(TwistFrame::Child),
        _ => Some(TwistFrame::Parent),
    }
}
