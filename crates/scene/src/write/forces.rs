//! What acts at joints and on bodies, what is forbidden to them, and named frames.

use super::body::{name_of, position};
use super::value::{key, list, number, rows, table, text};
use super::{entry, pose, time};
use crate::description::SceneDescription;
use crate::event::{
    CONSEQUENCE_NAMES, DIRECTION_NAMES, EventDescription, PointAlong, QuantityDescription,
};
use crate::forces::{
    BodyPoint, FrictionDescription, JointForces, JointSpring, LimitDescription, LimitKind,
    PerFreedom, PortForces, SpringEnergy, WrenchAxes,
};
use hamel_integrate::Direction;
use hamel_runtime::time_function::Law;

/// Appends the keys of a body that say what acts at its joint.
pub(super) fn of_joint(out: &mut String, forces: &JointForces) {
    if let Some(found) = &forces.spring {
        entry(out, "spring", &spring(&found.value));
    }
    if let Some(damping) = &forces.damping {
        entry(out, "damping", &per_freedom(&damping.value));
    }
    if let Some(armature) = &forces.armature {
        entry(out, "armature", &per_freedom(&armature.value));
    }
    if let Some(effort) = &forces.effort {
        entry(out, "effort", &time::functions(&effort.value));
    }
    if let Some(motion) = &forces.motion {
        let speeds = time::functions(&motion.value);
        entry(out, "motion", &table(&[("speeds", speeds)]));
    }
    if let Some(friction) = &forces.friction {
        entry(out, "friction", &self::friction(&friction.value));
    }
    if let Some(limit) = &forces.limit {
        entry(out, "limit", &self::limit(&limit.value));
    }
    for forces in &forces.ports {
        let name = format!("ports.{}", key(&forces.name.value));
        entry(out, &name, &port(forces));
    }
}

fn port(forces: &PortForces) -> String {
    let mut entries = Vec::new();
    if let Some(effort) = &forces.effort {
        entries.push(("effort", time::function(effort)));
    }
    if let Some(spring) = forces.spring {
        let mut own = vec![("stiffness", number(spring.stiffness))];
        own.extend(spring.rest.map(|rest| ("rest", number(rest))));
        entries.push(("spring", table(&own)));
    }
    if forces.damping > 0.0 {
        entries.push(("damping", number(forces.damping)));
    }
    if forces.armature > 0.0 {
        entries.push(("armature", number(forces.armature)));
    }
    if let Some(own) = &forces.friction {
        entries.push(("friction", friction(&own.value)));
    }
    if let Some(own) = &forces.limit {
        entries.push(("limit", limit(&own.value)));
    }
    table(&entries)
}

fn friction(friction: &FrictionDescription) -> String {
    if friction.sliding == friction.sticking {
        return number(friction.sliding);
    }
    table(&[
        ("sliding", number(friction.sliding)),
        ("sticking", number(friction.sticking)),
    ])
}

fn limit(limit: &LimitDescription) -> String {
    let ends = [("lower", limit.lower), ("upper", limit.upper)];
    let ends = ends
        .into_iter()
        .filter_map(|(key, end)| Some((key, number(end?))));
    let mut entries: Vec<_> = ends.collect();
    match limit.kind {
        LimitKind::Impact { restitution } => entries.push(("restitution", number(restitution))),
        LimitKind::Compliant { stiffness, damping } => {
            entries.push(("stiffness", number(stiffness)));
            entries.push(("damping", number(damping)));
        }
    }
    table(&entries)
}

fn spring(spring: &JointSpring) -> String {
    let (stiffness, kind) = match &spring.energy {
        SpringEnergy::Diagonal(stiffness) => (per_freedom(stiffness), "log"),
        SpringEnergy::Full(matrix) => {
            let matrix: Vec<Vec<f64>> = matrix
                .row_iter()
                .map(|row| row.iter().copied().collect())
                .collect();
            (rows(&matrix), "log")
        }
        SpringEnergy::Trace(stiffness) => (number(*stiffness), "trace"),
    };
    let mut entries = vec![("stiffness", stiffness)];
    if kind != "log" {
        entries.push(("kind", text(kind)));
    }
    if let Some(rest) = position(&spring.rest) {
        entries.push(("rest", table(&[rest])));
    }
    table(&entries)
}

pub(super) fn per_freedom(numbers: &PerFreedom) -> String {
    match numbers {
        PerFreedom::All(one) => number(*one),
        PerFreedom::Each(several) => list(several),
    }
}

pub(super) fn speed(speed: &Law) -> String {
    // A table that sways by nothing may still say how: it is kept as it was given.
    if [speed.amplitude, speed.frequency, speed.phase] == [0.0; 3] {
        return number(speed.rate);
    }
    table(&[
        ("rate", number(speed.rate)),
        ("amplitude", number(speed.amplitude)),
        ("frequency", number(speed.frequency)),
        ("phase", number(speed.phase)),
    ])
}

/// Appends frames, springs, wrenches, constraints and events.
pub(super) fn elements(out: &mut String, scene: &SceneDescription) {
    let bodies = &scene.bodies;
    for frame in &scene.frames {
        out.push_str("\n[[frame]]\n");
        entry(out, "name", &text(&frame.name.value));
        entry(out, "body", &text(name_of(frame.body, bodies)));
        if let Some(at) = pose::pose(&frame.at) {
            entry(out, "at", &at);
        }
    }
    let end = |end: &BodyPoint| {
        let body = text(name_of(end.body, bodies));
        table(&[("body", body), ("point", list(&end.point))])
    };
    for spring in &scene.springs {
        out.push_str("\n[[spring]]\n");
        entry(out, "from", &end(&spring.from));
        entry(out, "to", &end(&spring.to));
        entry(out, "stiffness", &number(spring.stiffness));
        entry(out, "damping", &number(spring.damping));
        entry(out, "length", &number(spring.length));
    }
    for wrench in &scene.wrenches {
        out.push_str("\n[[wrench]]\n");
        entry(out, "body", &text(name_of(Some(wrench.body), bodies)));
        entry(out, "point", &list(&wrench.point));
        entry(out, "force", &time::functions(&wrench.force));
        entry(out, "moment", &time::functions(&wrench.moment));
        let axes = match wrench.axes {
            WrenchAxes::World => "world",
            WrenchAxes::Body => "body",
        };
        entry(out, "axes", &text(axes));
    }
    for constraint in &scene.constraints {
        out.push_str("\n[[constraint]]\n");
        entry(out, "name", &text(&constraint.name.value));
        entry(out, "body", &text(name_of(Some(constraint.body), bodies)));
        entry(out, "point", &list(&constraint.point));
        entry(out, "direction", &list(&constraint.direction));
    }
    for event in &scene.events {
        out.push_str("\n[[event]]\n");
        self::event(out, event, scene);
    }
}

fn event(out: &mut String, event: &EventDescription, scene: &SceneDescription) {
    entry(out, "name", &text(&event.name.value));
    match &event.quantity {
        QuantityDescription::Point(PointAlong { body, point, along }) => {
            entry(out, "body", &text(name_of(Some(*body), &scene.bodies)));
            entry(out, "point", &list(point));
            entry(out, "along", &list(along));
        }
        QuantityDescription::Coordinate { joint, name } => {
            entry(out, "joint", &text(&joint.value));
            entry(out, "coordinate", &text(&name.value));
        }
        QuantityDescription::Speed { joint, name } => {
            entry(out, "joint", &text(&joint.value));
            entry(out, "speed", &text(&name.value));
        }
        QuantityDescription::Port { joint, name } => {
            entry(out, "joint", &text(&joint.value));
            entry(out, "port", &text(&name.value));
        }
        QuantityDescription::Rate { joint, name } => {
            entry(out, "joint", &text(&joint.value));
            entry(out, "rate", &text(&name.value));
        }
    }
    entry(out, "value", &number(event.value));
    let [any, rising, falling] = DIRECTION_NAMES;
    let direction = match event.direction {
        Direction::Any => any,
        Direction::Rising => rising,
        Direction::Falling => falling,
    };
    entry(out, "direction", &text(direction));
    let [record, stop] = CONSEQUENCE_NAMES;
    entry(out, "then", &text(if event.stops { stop } else { record }));
}
