//! One `[[body]]`.

use super::value::{list, number, rows, table, text};
use super::{entry, forces, pose};
use crate::description::{
    BodyDescription, InitialDescription, JointDescription, Motion, Position, TwistFrame,
};
use crate::parse::WORLD;
use hamel_runtime::spatial::{MassProperties, split};

/// Appends a body of `bodies`.
pub(super) fn body(out: &mut String, body: &BodyDescription, bodies: &[BodyDescription]) {
    out.push_str("[[body]]\n");
    entry(out, "name", &text(&body.name.value));
    entry(out, "parent", &text(name_of(body.parent, bodies)));
    mass(out, &body.mass);
    entry(out, "joint", &joint(&body.joint, &body.name.value));
    for (key, pose) in [("at", &body.at), ("body_at", &body.body_at)] {
        if let Some(value) = pose::pose(pose) {
            entry(out, key, &value);
        }
    }
    if let Some(value) = initial(&body.initial) {
        entry(out, "initial", &value);
    }
    forces::of_joint(out, &body.forces);
}

/// Name of a body of `bodies`, or of the world.
pub(super) fn name_of(body: Option<usize>, bodies: &[BodyDescription]) -> &str {
    // No body is called as one that is not there, so that a reader refuses it.
    let name = |index: usize| bodies.get(index).map_or("", |own| &own.name.value);
    body.map_or(WORLD, name)
}

fn mass(out: &mut String, mass: &MassProperties) {
    entry(out, "mass", &number(mass.mass));
    if mass.com != nalgebra::Vector3::zeros() {
        entry(out, "com", &list(&mass.com));
    }
    let i = &mass.inertia_com;
    if *i == i.transpose() {
        let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let six = places.map(|place| i[place]);
        entry(out, "inertia_xx_yy_zz_xy_xz_yz", &list(&six));
    } else {
        let matrix = i
            .row_iter()
            .map(|row| row.iter().copied().collect::<Vec<_>>());
        let matrix: Vec<_> = matrix.collect();
        entry(out, "inertia", &rows(&matrix));
    }
}

fn joint(joint: &JointDescription, body: &str) -> String {
    let mut entries = vec![("type", text(&joint.kind.value))];
    if joint.name.value != body {
        entries.push(("name", text(&joint.name.value)));
    }
    let parameters = joint.parameters.iter();
    entries.extend(parameters.map(|(key, value)| (key.value.as_str(), number(*value))));
    table(&entries)
}

fn initial(initial: &InitialDescription) -> Option<String> {
    let mut entries = Vec::new();
    entries.extend(position(&initial.position));
    match &initial.motion {
        Motion::Rest => {}
        Motion::Velocity(velocity) => entries.push(("velocity", list(&velocity.value))),
        Motion::Speeds(speeds) => entries.push(("speeds", list(&speeds.value))),
        Motion::Twist(twist) => {
            let (angular, linear) = split(&twist.value.twist);
            let frame = match twist.value.frame {
                TwistFrame::Child => "child",
                TwistFrame::Parent => "parent",
            };
            let twist = [
                ("angular", list(&angular)),
                ("linear", list(&linear)),
                ("frame", text(frame)),
            ];
            entries.push(("twist", table(&twist)));
        }
    }
    (!entries.is_empty()).then(|| table(&entries))
}

/// Key and value of a position; `None` at home.
pub(super) fn position(position: &Position) -> Option<(&'static str, String)> {
    match position {
        Position::Home => None,
        Position::Configuration(q) => Some(("configuration", list(&q.value))),
        Position::Phi(phi) => Some(("phi", list(&phi.value))),
        Position::Pose(pose) => {
            let value = pose::pose(&pose.value).unwrap_or_else(|| String::from("{}"));
            Some(("pose", value))
        }
    }
}
