//! What acts at joints and on bodies, given to the mechanism.

use super::forces::{Acting, Spring, Stiffness};
use crate::description::{BodyDescription, SceneDescription};
use crate::forces::{LimitKind, PointSpring, PortForces, WrenchAxes, WrenchDescription};
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Recursive};
use hamel_runtime::elements::{
    BodySpring, BodyWrench, Drive, Element, JointDamper, JointEffort, JointFriction, JointLimit,
    JointSpring, JointStop, LimitOf, PointConstraint, PortEffort, PortSpring, RotationSpring,
    TimedEffort, TimedWrench,
};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{Mechanism, MechanismErrors, NamedFrame};
use hamel_runtime::time_function::TimeFunction;
use std::sync::Arc;

/// The mechanism with its elements, rotors, drives, friction, limits and named frames; `acting` goes with the bodies of `description`.
pub(super) fn equip(
    mut mechanism: Mechanism,
    description: &SceneDescription,
    acting: &[Acting],
) -> Result<Mechanism, MechanismErrors> {
    let elements = elements(&mechanism, description, acting);
    let drives = drives(description, acting);
    for (body, acting) in acting.iter().enumerate() {
        if !acting.armature.is_empty() {
            let with_rotor = mechanism.with_armature(body, &acting.armature);
            mechanism = with_rotor?;
        }
        let rotors = acting.port_armature(mechanism.bodies()[body].joint().ports().len());
        if rotors.iter().any(|inertia| *inertia > 0.0) {
            mechanism = mechanism.with_port_armature(body, &rotors)?;
        }
    }
    let frames = description.frames.iter().map(|frame| NamedFrame {
        name: frame.name.value.clone(),
        body: frame.body,
        at: frame.at,
    });
    mechanism
        .with_elements(elements)?
        .with_drives(drives)?
        .with_frictions(frictions(description, acting))?
        .with_stops(stops(description, acting))?
        .with_timed_efforts(timed_efforts(description, acting))?
        .with_frames(frames.collect())
}

/// The mechanism with the constraints that couple its joints, independent at `q`.
pub(super) fn couple(
    mechanism: Mechanism,
    description: &SceneDescription,
    q: &[f64],
) -> Result<Mechanism, MechanismErrors> {
    if description.constraints.is_empty() {
        return Ok(mechanism);
    }
    let constraints = description.constraints.iter();
    let constraints = constraints.map(|constraint| PointConstraint {
        name: constraint.name.value.clone(),
        body: constraint.body,
        point: constraint.point,
        direction: constraint.direction,
    });
    mechanism.with_constraints(constraints.collect(), q)
}

/// The speeds of joints that constraints make depend on others, where the scene leaves them at rest.
///
/// A scene that gives such a speed is taken at its word: whoever simulates checks it.
pub(super) fn complete(
    mechanism: &Arc<Mechanism>,
    q: &[f64],
    speeds: &mut [f64],
) -> Result<(), DynamicsError> {
    let dependent = mechanism.dependent_speeds();
    if dependent.is_empty() || dependent.iter().any(|&speed| speeds[speed] != 0.0) {
        return Ok(());
    }
    Recursive::new(Arc::clone(mechanism)).complete_speeds(q, speeds)
}

fn elements(
    mechanism: &Mechanism,
    description: &SceneDescription,
    acting: &[Acting],
) -> Vec<Arc<dyn Element>> {
    let mut elements: Vec<Arc<dyn Element>> = Vec::new();
    for (body, (owner, acting)) in description.bodies.iter().zip(acting).enumerate() {
        at_joint(mechanism, body, owner, acting, &mut elements);
    }
    for (index, spring) in description.springs.iter().enumerate() {
        elements.push(Arc::new(point_spring(index, spring)));
    }
    for (index, wrench) in description.wrenches.iter().enumerate() {
        elements.push(body_wrench(index, wrench));
    }
    elements
}

fn at_joint(
    mechanism: &Mechanism,
    body: usize,
    owner: &BodyDescription,
    acting: &Acting,
    elements: &mut Vec<Arc<dyn Element>>,
) {
    let joint = &owner.joint.name.value;
    if let Some(spring) = &acting.spring {
        elements.push(joint_spring(mechanism, body, joint, spring));
    }
    if !acting.damping.is_empty() {
        elements.push(Arc::new(JointDamper {
            name: format!("damping of joint `{joint}`"),
            body,
            coefficients: acting.damping.clone(),
        }));
    }
    if let Some(efforts) = constant(&acting.effort)
        && !efforts.is_empty()
    {
        elements.push(Arc::new(JointEffort {
            name: format!("effort of joint `{joint}`"),
            body,
            efforts,
        }));
    }
    for (port, forces) in &acting.ports {
        let joint_type = mechanism.bodies()[body].joint();
        let home = joint_type.port_value(&home(joint_type), *port);
        at_port((body, *port), joint, (forces, home), elements);
    }
    for limit in acting.limit.iter().chain(&acting.further_limits) {
        let LimitKind::Compliant { stiffness, damping } = limit.kind else {
            continue;
        };
        elements.push(Arc::new(JointLimit {
            name: format!("limit of joint `{joint}`"),
            body,
            port: None,
            lower: limit.lower,
            upper: limit.upper,
            stiffness,
            damping,
        }));
    }
}

fn at_port(
    (body, port): (usize, usize),
    joint: &str,
    (forces, home): (&PortForces, f64),
    elements: &mut Vec<Arc<dyn Element>>,
) {
    let name = |what: &str| forces.element(what, joint);
    if let Some(effort) = &forces.effort {
        elements.push(Arc::new(PortEffort {
            name: name("effort"),
            body,
            port,
            effort: effort.clone(),
        }));
    }
    if forces.spring.is_some() || forces.damping > 0.0 {
        let spring = forces.spring.unwrap_or_default();
        elements.push(Arc::new(PortSpring {
            name: name("spring"),
            body,
            port,
            stiffness: spring.stiffness,
            damping: forces.damping,
            rest: spring.rest.unwrap_or(home),
        }));
    }
    if let Some(limit) = forces.compliant_limit(joint, (body, port)) {
        elements.push(Arc::new(limit));
    }
}

/// The Q of a joint from which its spec starts.
fn home(joint: &dyn AnyJoint) -> Vec<f64> {
    let mut home = vec![0.0; joint.layout().configuration];
    joint.home(&mut home);
    home
}

/// The efforts of a joint, if none of them changes with time.
fn constant(efforts: &[TimeFunction]) -> Option<Vec<f64>> {
    efforts.iter().map(TimeFunction::constant).collect()
}

/// Efforts of joints of which some change with time.
fn timed_efforts(description: &SceneDescription, acting: &[Acting]) -> Vec<TimedEffort> {
    let joints = description.bodies.iter().zip(acting).enumerate();
    let timed = joints.filter(|(_, (_, acting))| constant(&acting.effort).is_none());
    let efforts = timed.map(|(body, (owner, acting))| TimedEffort {
        name: format!("effort of joint `{}`", owner.joint.name.value),
        body,
        efforts: acting.effort.clone(),
    });
    efforts.collect()
}

fn joint_spring(
    mechanism: &Mechanism,
    body: usize,
    joint: &str,
    spring: &Spring,
) -> Arc<dyn Element> {
    let name = format!("spring of joint `{joint}`");
    match &spring.stiffness {
        Stiffness::Log(matrix) => Arc::new(JointSpring {
            name,
            body,
            stiffness: matrix.transpose().as_slice().to_vec(),
            rest: spring.rest.clone(),
        }),
        Stiffness::Trace(stiffness) => Arc::new(RotationSpring {
            name,
            body,
            stiffness: *stiffness,
            rest: mechanism.bodies()[body].joint().pose(&spring.rest).rotation,
        }),
    }
}

fn point_spring(index: usize, spring: &PointSpring) -> BodySpring {
    BodySpring {
        name: format!("spring {}", index + 1),
        bodies: [spring.from.body, spring.to.body],
        points: [spring.from.point, spring.to.point],
        stiffness: spring.stiffness,
        damping: spring.damping,
        length: spring.length,
    }
}

fn body_wrench(index: usize, wrench: &WrenchDescription) -> Arc<dyn Element> {
    let name = format!("wrench {}", index + 1);
    let (body, point) = (wrench.body, wrench.point);
    let axes = match wrench.axes {
        WrenchAxes::World => hamel_runtime::elements::WrenchAxes::World,
        WrenchAxes::Body => hamel_runtime::elements::WrenchAxes::Body,
    };
    if let Some([force, moment]) = wrench.constant() {
        return Arc::new(BodyWrench {
            name,
            body,
            point,
            force,
            moment,
            axes,
        });
    }
    let ([fx, fy, fz], [mx, my, mz]) = (wrench.force.clone(), wrench.moment.clone());
    Arc::new(TimedWrench {
        name,
        body,
        point,
        entries: [fx, fy, fz, mx, my, mz],
        axes,
    })
}

fn drives(description: &SceneDescription, acting: &[Acting]) -> Vec<Drive> {
    let joints = description.bodies.iter().zip(acting).enumerate();
    let driven = joints.filter(|(_, (_, acting))| !acting.motion.is_empty());
    let drives = driven.map(|(body, (owner, acting))| Drive {
        name: format!("motion of joint `{}`", owner.joint.name.value),
        body,
        laws: acting.motion.clone(),
    });
    drives.collect()
}

fn frictions(description: &SceneDescription, acting: &[Acting]) -> Vec<JointFriction> {
    let joints = description.bodies.iter().zip(acting).enumerate();
    let frictions = joints.flat_map(|(body, (owner, acting))| {
        let joint = &owner.joint.name.value;
        let own = acting.friction.iter();
        let own = own.map(|own| (None, format!("friction of joint `{joint}`"), *own));
        let at_ports = acting.ports.iter().filter_map(|(port, forces)| {
            let friction = forces.friction.as_ref()?.value;
            Some((Some(*port), forces.element("friction", joint), friction))
        });
        let all: Vec<_> = own.chain(at_ports).collect();
        all.into_iter()
            .map(move |(port, name, friction)| JointFriction {
                name,
                body,
                port,
                sliding: friction.sliding,
                sticking: friction.sticking,
            })
    });
    frictions.collect()
}

fn stops(description: &SceneDescription, acting: &[Acting]) -> Vec<JointStop> {
    let joints = description.bodies.iter().zip(acting).enumerate();
    let stops = joints.filter_map(|(body, (owner, acting))| {
        let limit = acting.limit?;
        let LimitKind::Impact { restitution } = limit.kind else {
            return None;
        };
        Some(JointStop {
            name: format!("limit of joint `{}`", owner.joint.name.value),
            body,
            lower: limit.lower,
            upper: limit.upper,
            restitution,
            of: owner.forces.limit_of.each_ref().map(|own| {
                let own = own.as_ref()?;
                Some(LimitOf {
                    joint: own.joint.clone(),
                    is_upper: own.is_upper,
                })
            }),
        })
    });
    stops.collect()
}
