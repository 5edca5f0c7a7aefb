//! The `[controller]`.

use super::body::position;
use super::entry;
use super::forces::{per_freedom, speed};
use super::value::{key, number, table, text};
use crate::control::{
    ControllerDescription, GoalDescription, LawDescription, PortDescription, ReferenceDescription,
    ReferenceMotion, RegulatorDescription,
};
use hamel_control::PortSpring;
use hamel_runtime::time_function::Law;

/// Appends the controller.
pub(super) fn controller(out: &mut String, controller: &ControllerDescription) {
    out.push_str("\n[controller]\n");
    entry(out, "kind", &text(controller.law.name()));
    if let Some(period) = controller.period {
        entry(out, "period", &number(period));
    }
    match &controller.law {
        LawDescription::ComputedTorque {
            error_dynamics,
            references,
        } => {
            entry(out, "frequency", &number(error_dynamics.frequency));
            entry(out, "damping_ratio", &number(error_dynamics.damping_ratio));
            references.iter().for_each(|found| reference(out, found));
        }
        LawDescription::Lqr(found) => regulator(out, found),
        LawDescription::EnergyShaping { ports, goals, pump } => {
            entry(out, "pump", &number(*pump));
            ports.iter().for_each(|found| port(out, found));
            goals.iter().for_each(|found| goal(out, found));
        }
        LawDescription::Path {
            joint,
            curve,
            gains,
        } => {
            entry(out, "joint", &text(&joint.value));
            for (key, place) in [("x", 0), ("y", 1)] {
                let value = coordinate(Some(curve.start[place]), &curve.laws[place]);
                entry(out, key, &value);
            }
            entry(out, "distance", &number(gains.distance));
            entry(out, "rate", &number(gains.rate));
        }
        LawDescription::Mpc {
            regulator: found,
            horizon,
            limits,
        } => {
            entry(out, "horizon", &horizon.to_string());
            entry(out, "limits", &per_freedom(&limits.value));
            regulator(out, found);
        }
    }
}

fn reference(out: &mut String, reference: &ReferenceDescription) {
    out.push_str("\n[[controller.reference]]\n");
    entry(out, "joint", &text(&reference.joint.value));
    let (speeds, start) = match &reference.motion {
        ReferenceMotion::Speeds { speeds, start } => (speeds, start),
        ReferenceMotion::Ports(ports) => {
            for port in ports {
                let name = format!("ports.{}", key(&port.name.value));
                entry(out, &name, &coordinate(port.start, &port.law));
            }
            return;
        }
    };
    let speeds: Vec<String> = speeds.value.iter().map(speed).collect();
    entry(out, "speeds", &format!("[{}]", speeds.join(", ")));
    if let Some(start) = start {
        let entries: Vec<_> = position(start).into_iter().collect();
        let value = match entries.is_empty() {
            true => String::from("{}"),
            false => table(&entries),
        };
        entry(out, "start", &value);
    }
}

/// The keys of a regulator, and after them its tables.
fn regulator(out: &mut String, regulator: &RegulatorDescription) {
    if let Some(actuated) = &regulator.actuated {
        let names: Vec<String> = actuated.iter().map(|name| text(&name.value)).collect();
        entry(out, "actuated", &format!("[{}]", names.join(", ")));
    }
    let [position, speed, effort] = &regulator.weights;
    let weights = [
        ("position", per_freedom(&position.value)),
        ("speed", per_freedom(&speed.value)),
        ("effort", per_freedom(&effort.value)),
    ];
    entry(out, "weights", &table(&weights));
    regulator.goals.iter().for_each(|found| goal(out, found));
}

fn goal(out: &mut String, goal: &GoalDescription) {
    out.push_str("\n[[controller.goal]]\n");
    entry(out, "joint", &text(&goal.joint.value));
    if let Some((key, value)) = position(&goal.position) {
        entry(out, key, &value);
    }
}

fn port(out: &mut String, port: &PortDescription) {
    out.push_str("\n[[controller.port]]\n");
    entry(out, "joint", &text(&port.joint.value));
    if let Some(name) = &port.port {
        entry(out, "port", &text(&name.value));
    }
    let (stiffness, kind) = match port.spring {
        PortSpring::Log(stiffness) => (stiffness, "log"),
        PortSpring::Trace(stiffness) => (stiffness, "trace"),
    };
    entry(out, "stiffness", &number(stiffness));
    entry(out, "kind", &text(kind));
    entry(out, "damping", &number(port.damping));
    if port.limit.is_finite() {
        entry(out, "limit", &number(port.limit));
    }
}

fn coordinate(start: Option<f64>, law: &Law) -> String {
    let mut entries = vec![
        ("rate", number(law.rate)),
        ("amplitude", number(law.amplitude)),
        ("frequency", number(law.frequency)),
        ("phase", number(law.phase)),
    ];
    if let Some(start) = start {
        entries.insert(0, ("start", number(start)));
    }
    table(&entries)
}
