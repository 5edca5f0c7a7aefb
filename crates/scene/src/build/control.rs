//! The controller of a scene, fitted to its mechanism.

use super::by_joint;
use super::state::Stand;
use crate::control::{
    Control, ControlLaw, ControllerDescription, Goal, GoalDescription, LawDescription,
    PortDescription, ReferenceDescription, ReferenceMotion, RegulatorDescription,
};
use crate::description::Position;
use crate::diagnostics::Diagnostic;
use crate::forces::PerFreedom;
use crate::read::Sink;
use crate::source::{Located, Span};
use hamel_control::{Port, PortReference, Pump, Weights};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::time_function::Law;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Looks the joints up in the mechanism, which begins at `q`, and tries the law over `t_end` (s); every error is noted.
pub(crate) fn control(
    description: &ControllerDescription,
    mechanism: &Arc<Mechanism>,
    (q, t_end): (&[f64], f64),
    sink: &mut Sink,
) -> Option<Control> {
    let fit = Fit {
        joints: by_joint(mechanism),
        mechanism,
        q,
    };
    let control = Control {
        period: description.period,
        kind: description.law.name(),
        law: fit.law(description, sink)?,
    };
    let tried = control.controller(mechanism, t_end);
    let refused = tried.map_err(|error| {
        let message = format!("controller: {error}");
        sink.push(Diagnostic::new(description.span.clone(), message));
    });
    refused.ok().map(|_| control)
}

/// The mechanism that the controller is fitted to.
struct Fit<'a> {
    mechanism: &'a Mechanism,
    /// Its bodies by the names of their joints.
    joints: HashMap<&'a str, usize>,
    q: &'a [f64],
}

impl Fit<'_> {
    fn law(&self, description: &ControllerDescription, sink: &mut Sink) -> Option<ControlLaw> {
        Some(match &description.law {
            LawDescription::ComputedTorque {
                error_dynamics,
                references,
            } => {
                let (start, laws) = self.reference(references, sink)?;
                let ports = self.port_references(references, sink)?;
                ControlLaw::ComputedTorque {
                    start,
                    laws,
                    ports,
                    error_dynamics: *error_dynamics,
                }
            }
            LawDescription::Lqr(regulator) => ControlLaw::Lqr(self.goal(regulator, sink)?),
            LawDescription::EnergyShaping { ports, goals, pump } => {
                let goal = self.configuration(goals, sink);
                let sound = ports_are_distinct(ports, sink);
                let ports: Vec<_> = ports.iter().map(|port| self.port(port, sink)).collect();
                let ports: Option<Vec<Port>> = ports.into_iter().collect();
                let ports = ports.filter(|_| sound);
                ControlLaw::EnergyShaping {
                    goal: goal?,
                    ports: ports?,
                    pump: Pump { gain: *pump },
                }
            }
            LawDescription::Path {
                joint,
                curve,
                gains,
            } => ControlLaw::Path {
                body: self.find(joint)?,
                curve: *curve,
                gains: *gains,
            },
            LawDescription::Mpc {
                regulator,
                horizon,
                limits,
            } => {
                let goal = self.goal(regulator, sink)?;
                let inputs = goal.weights.effort.len();
                ControlLaw::Mpc {
                    limits: spread("limits", limits, inputs, "input", sink)?,
                    goal,
                    horizon: *horizon,
                    // The parser asks for it.
                    period: description.period?,
                }
            }
        })
    }

    /// The body whose joint has that name; the parser has seen to it that there is one.
    fn find(&self, joint: &Located<String>) -> Option<usize> {
        self.joints.get(joint.value.as_str()).copied()
    }

    /// The configuration of the joint under `body` that `position` means.
    fn position(
        &self,
        body: usize,
        position: &Position,
        span: &Span,
        sink: &mut Sink,
    ) -> Option<Vec<f64>> {
        let owner = &self.mechanism.bodies()[body];
        let stand = Stand::of(owner.joint_name(), owner.shared_joint(), span);
        let found = stand.and_then(|stand| stand.configuration(position));
        found.map_err(|error| sink.push(error)).ok()
    }

    /// Start and speeds of all joints: those of the references, the others at rest where they begin.
    fn reference(
        &self,
        references: &[ReferenceDescription],
        sink: &mut Sink,
    ) -> Option<(Vec<f64>, Vec<Law>)> {
        let mut start = self.q.to_vec();
        let mut laws = vec![Law::default(); self.mechanism.layout().speeds];
        let mut sound = true;
        let names = references.iter().map(|reference| &reference.joint);
        sound &= unique(names, sink);
        for reference in references {
            let Some(body) = self.find(&reference.joint) else {
                sound = false;
                continue;
            };
            let ranges = self.mechanism.bodies()[body].ranges();
            let ReferenceMotion::Speeds {
                speeds: given,
                start: begin,
            } = &reference.motion
            else {
                continue;
            };
            if let Some(position) = begin {
                match self.position(body, position, &reference.joint.span, sink) {
                    Some(q) => start[ranges.configuration.clone()].copy_from_slice(&q),
                    None => sound = false,
                }
            }
            let own = &mut laws[ranges.speeds.clone()];
            if own.len() == given.value.len() {
                own.copy_from_slice(&given.value);
            } else {
                sound = false;
                let names = self.mechanism.bodies()[body].joint().speeds().join(", ");
                let (joint, found) = (&reference.joint.value, given.value.len());
                let message = format!(
                    "controller: `speeds` of joint `{joint}` has size {found}, not {}",
                    own.len()
                );
                let error = Diagnostic::new(given.span.clone(), message);
                sink.push(error.help(format!("its speeds are [{names}]")));
            }
        }
        sound.then_some((start, laws))
    }

    /// Home, except for the joints that have goals.
    fn configuration(&self, goals: &[GoalDescription], sink: &mut Sink) -> Option<Vec<f64>> {
        let mut q = self.mechanism.home();
        let mut sound = unique(goals.iter().map(|goal| &goal.joint), sink);
        for goal in goals {
            let found = self.find(&goal.joint).and_then(|body| {
                let own = self.position(body, &goal.position, &goal.joint.span, sink)?;
                let range = self.mechanism.bodies()[body].ranges().configuration.clone();
                q[range].copy_from_slice(&own);
                Some(())
            });
            sound &= found.is_some();
        }
        sound.then_some(q)
    }

    /// The index of a port of the joint under `body`.
    fn port_index(&self, body: usize, name: &Located<String>, sink: &mut Sink) -> Option<usize> {
        let owner = &self.mechanism.bodies()[body];
        let stand = Stand::of(owner.joint_name(), owner.shared_joint(), &name.span);
        let found = stand.and_then(|stand| stand.port(name));
        found.map_err(|error| sink.push(error)).ok()
    }

    /// Where ports are wanted; those without a start where they begin.
    fn port_references(
        &self,
        references: &[ReferenceDescription],
        sink: &mut Sink,
    ) -> Option<Vec<PortReference>> {
        let mut found = vec![];
        for reference in references {
            let ReferenceMotion::Ports(ports) = &reference.motion else {
                continue;
            };
            let body = self.find(&reference.joint)?;
            let owner = &self.mechanism.bodies()[body];
            for own in ports {
                let port = self.port_index(body, &own.name, sink);
                found.push(port.map(|port| PortReference {
                    body,
                    port,
                    start: own.start.unwrap_or_else(|| {
                        let q = owner.configuration(self.q);
                        owner.joint().port_value(q, port)
                    }),
                    law: own.law,
                }));
            }
        }
        found.into_iter().collect()
    }

    fn port(&self, port: &PortDescription, sink: &mut Sink) -> Option<Port> {
        let body = self.find(&port.joint)?;
        let named = port.port.as_ref();
        let index = named.map(|name| self.port_index(body, name, sink).ok_or(()));
        Some(Port {
            body,
            port: index.transpose().ok()?,
            spring: port.spring,
            damping: port.damping,
            limit: port.limit,
        })
    }

    fn goal(&self, regulator: &RegulatorDescription, sink: &mut Sink) -> Option<Goal> {
        let configuration = self.configuration(&regulator.goals, sink);
        let all: Vec<usize> = self.mechanism.joints().map(|(index, _)| index).collect();
        let actuated = match &regulator.actuated {
            None => Some(all),
            Some(names) => {
                let sound = unique(names.iter(), sink);
                let found: Vec<_> = names.iter().map(|name| self.find(name)).collect();
                let found: Option<Vec<usize>> = found.into_iter().collect();
                found.filter(|_| sound)
            }
        };
        let layout = self.mechanism.layout();
        let [position, speed, effort] = &regulator.weights;
        let position = spread(
            "weights.position",
            position,
            layout.freedoms,
            "degree of freedom",
            sink,
        );
        let speed = spread("weights.speed", speed, layout.speeds, "speed", sink);
        let actuated = actuated?;
        let freedoms = |&body: &usize| self.mechanism.bodies()[body].ranges().freedoms.len();
        let inputs = actuated.iter().map(freedoms).sum();
        let effort = spread("weights.effort", effort, inputs, "input", sink);
        Some(Goal {
            configuration: configuration?,
            actuated,
            weights: Weights {
                position: position?,
                speed: speed?,
                effort: effort?,
            },
        })
    }
}

/// Whether no joint, and no port of one, is named twice.
fn ports_are_distinct(ports: &[PortDescription], sink: &mut Sink) -> bool {
    let mut sound = true;
    for (n, port) in ports.iter().enumerate() {
        let is_same = |other: &&PortDescription| {
            let names = [port, *other].map(|own| own.port.as_ref().map(|name| &name.value));
            port.joint.value == other.joint.value && names[0] == names[1]
        };
        let Some(before) = ports[..n].iter().find(is_same) else {
            continue;
        };
        sound = false;
        let joint = &port.joint.value;
        let (what, span) = match &port.port {
            Some(name) => (
                format!("port `{}` of joint `{joint}`", name.value),
                &name.span,
            ),
            None => (format!("joint `{joint}`"), &port.joint.span),
        };
        let message = format!("controller: {what} is named twice");
        let place = before.port.as_ref().unwrap_or(&before.joint).span.clone();
        sink.push(Diagnostic::new(span.clone(), message).context(place, "here"));
    }
    sound
}

/// Whether no joint is named twice.
fn unique<'a>(names: impl Iterator<Item = &'a Located<String>>, sink: &mut Sink) -> bool {
    let mut seen: HashMap<&str, &Located<String>> = HashMap::new();
    let mut sound = true;
    for name in names {
        match seen.entry(&name.value) {
            Entry::Vacant(entry) => _ = entry.insert(name),
            Entry::Occupied(entry) => {
                sound = false;
                let message = format!("controller: joint `{}` is named twice", name.value);
                let error = Diagnostic::new(name.span.clone(), message);
                sink.push(error.context(entry.get().span.clone(), "here"));
            }
        }
    }
    sound
}

/// One number for each of `count` things.
fn spread(
    key: &str,
    numbers: &Located<PerFreedom>,
    count: usize,
    thing: &str,
    sink: &mut Sink,
) -> Option<Vec<f64>> {
    let found = numbers.value.spread(count);
    if let (None, PerFreedom::Each(list)) = (&found, &numbers.value) {
        let message = format!("controller: `{key}` has size {}, not {count}", list.len());
        let error = Diagnostic::new(numbers.span.clone(), message);
        sink.push(error.help(format!("it has one entry for each {thing}")));
    }
    found
}
