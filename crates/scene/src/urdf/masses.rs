//! What the links of each body weigh together, and whether a rigid body can.

use super::document::place;
use super::lenient;
use super::robot::Robot;
use crate::description::BodyDescription;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::mass::sum;
use hamel_runtime::spatial::{MassError, MassProperties};

/// A link as a part of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The link, as a place in the file.
    pub(super) link: usize,
    /// Its mass properties in the body frame.
    pub(super) mass: MassProperties,
}

/// Adds up the parts of each body, and checks the sums; a lenient reader replaces those that no rigid body has.
pub(super) fn settle(
    robot: &Robot<'_, '_>,
    (bodies, parts): (&mut [BodyDescription], &[Vec<Part>]),
    is_lenient: bool,
    notices: &mut Notices,
    sink: &mut Sink,
) {
    for (body, parts) in bodies.iter_mut().zip(parts) {
        let masses: Vec<MassProperties> = parts.iter().map(|part| part.mass).collect();
        body.mass = sum(&masses);
        if body.mass.check().is_ok() {
            tell_odd(robot, parts, notices);
            continue;
        }
        if is_lenient {
            body.mass = sum(&lenient::balance(robot, parts, notices));
        }
        if let Err(error) = body.mass.check() {
            sink.push(refusal(robot, body, parts, &error));
        }
    }
}

fn refusal(
    robot: &Robot<'_, '_>,
    body: &BodyDescription,
    parts: &[Part],
    error: &MassError,
) -> Diagnostic {
    let culprit = parts.iter().find(|part| part.mass.check().is_err());
    let link = culprit.or(parts.first()).map_or(0, |part| part.link);
    let message = format!("link `{}`: {error}", robot.links[link].name);
    let refusal = Diagnostic::new(place(robot.links[link].node, "inertial", ""), message);
    match parts.len() {
        1 => refusal,
        count => refusal.help(format!(
            "this is the sum over the {count} links that fixed joints join to body `{}`",
            body.name.value
        )),
    }
}

/// A link that no rigid body could be by itself may still be part of one that is.
fn tell_odd(robot: &Robot<'_, '_>, parts: &[Part], notices: &mut Notices) {
    let message =
        "no rigid body has such an inertia, but the body that the link is part of is sound";
    for part in parts.iter().filter(|part| part.mass.check().is_err()) {
        let name = robot.links[part.link].name;
        notices.add(message, format!("link `{name}`"));
    }
}
