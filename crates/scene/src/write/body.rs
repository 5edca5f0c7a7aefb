//! One `[[body]]`: a joint and what it carries.

use super::value::{key, list, number, rows, table, text};
use super::{entry, forces, pose};
use crate::description::{
    BodyDescription, InitialDescription, JointDescription, MimicDescription, Motion, Position,
    TwistFrame,
};
use crate::parse::WORLD;
use hamel_runtime::spatial::{MassProperties, split};

/// Appends a joint and the bodies that it carries, `group`, of which `first` is the first; parents are among `bodies`.
pub(super) fn bodies(
    out: &mut String,
    first: &BodyDescription,
    group: &[BodyDescription],
    bodies: &[BodyDescription],
) {
    let name = match &first.part {
        None => &first.name.value,
        Some(part) => {
            let own = first.name.value.strip_suffix(&part.name.value);
            own.and_then(|own| own.strip_suffix('.')).unwrap_or("")
        }
    };
    out.push_str("[[body]]\n");
    entry(out, "name", &text(name));
    entry(out, "parent", &text(name_of(first.parent, bodies)));
    if first.part.is_none() {
        let entries = mass(&first.mass);
        entries
            .iter()
            .for_each(|(key, value)| entry(out, key, value));
    }
    entry(out, "joint", &joint(&first.joint, name));
    if let Some(value) = pose::pose(&first.at) {
        entry(out, "at", &value);
    }
    if first.part.is_none()
        && let Some(value) = pose::pose(&first.body_at)
    {
        entry(out, "body_at", &value);
    }
    if let Some(value) = initial(&first.initial) {
        entry(out, "initial", &value);
    }
    if let Some(mimic) = &first.mimic {
        entry(out, "mimic", &self::mimic(&mimic.value));
    }
    forces::of_joint(out, &first.forces);
    for own in group {
        if let Some(part) = &own.part {
            let mut entries = mass(&own.mass);
            if own.at != first.at {
                let at = pose::pose(&own.at).unwrap_or_else(|| String::from("{}"));
                entries.push(("at", at));
            }
            entries.extend(pose::pose(&own.body_at).map(|value| ("body_at", value)));
            entry(
                out,
                &format!("bodies.{}", key(&part.name.value)),
                &table(&entries),
            );
        }
    }
}

fn mimic(mimic: &MimicDescription) -> String {
    let mut entries = vec![("joint", text(&mimic.joint.value))];
    let numbers = [
        ("multiplier", mimic.multiplier, 1.0),
        ("offset", mimic.offset, 0.0),
    ];
    let given = numbers
        .into_iter()
        .filter(|(_, value, default)| value != default);
    entries.extend(given.map(|(key, value, _)| (key, number(value))));
    table(&entries)
}

/// Name of a body of `bodies`, or of the world.
pub(super) fn name_of(body: Option<usize>, bodies: &[BodyDescription]) -> &str {
    // No body is called as one that is not there, so that a reader refuses it.
    let name = |index: usize| bodies.get(index).map_or("", |own| &own.name.value);
    body.map_or(WORLD, name)
}

fn mass(mass: &MassProperties) -> Vec<(&'static str, String)> {
    let mut entries = vec![("mass", number(mass.mass))];
    if mass.com != nalgebra::Vector3::zeros() {
        entries.push(("com", list(&mass.com)));
    }
    let i = &mass.inertia_com;
    if *i == i.transpose() {
        let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let six = places.map(|place| i[place]);
        entries.push(("inertia_xx_yy_zz_xy_xz_yz", list(&six)));
    } else {
        let matrix = i
            .row_iter()
            .map(|row| row.iter().copied().collect::<Vec<_>>());
        let matrix: Vec<_> = matrix.collect();
        entries.push(("inertia", rows(&matrix)));
    }
    entries
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
        Motion::Rates(rates) => {
            let rates = rates.value.iter();
            let rates = rates.map(|own| (own.name.value.as_str(), number(own.rate)));
            entries.push(("rates", table(&rates.collect::<Vec<_>>())));
        }
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
