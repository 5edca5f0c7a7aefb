//! What acts at joints and on bodies, given to the mechanism.

use super::forces::{Acting, Spring, Stiffness};
use crate::description::{BodyDescription, SceneDescription};
use crate::forces::{PointSpring, WrenchAxes, WrenchDescription};
use hamel::elements::{
    BodySpring, BodyWrench, Drive, Element, JointDamper, JointEffort, JointSpring, RotationSpring,
};
use hamel::mechanism::{Mechanism, MechanismError};
use std::sync::Arc;

/// The mechanism with its elements, rotors and drives; `acting` goes with the bodies of `description`.
pub(super) fn equip(
    mut mechanism: Mechanism,
    description: &SceneDescription,
    acting: &[Acting],
) -> Result<Mechanism, Vec<MechanismError>> {
    let elements = elements(&mechanism, description, acting);
    let drives = drives(description, acting);
    for (body, acting) in acting.iter().enumerate() {
        if !acting.armature.is_empty() {
            let with_rotor = mechanism.with_armature(body, &acting.armature);
            mechanism = with_rotor.map_err(|error| vec![error])?;
        }
    }
    mechanism.with_elements(elements)?.with_drives(drives)
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
        elements.push(Arc::new(body_wrench(index, wrench)));
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
    if !acting.effort.is_empty() {
        elements.push(Arc::new(JointEffort {
            name: format!("effort of joint `{joint}`"),
            body,
            efforts: acting.effort.clone(),
        }));
    }
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

fn body_wrench(index: usize, wrench: &WrenchDescription) -> BodyWrench {
    BodyWrench {
        name: format!("wrench {}", index + 1),
        body: wrench.body,
        point: wrench.point,
        force: wrench.force,
        moment: wrench.moment,
        axes: match wrench.axes {
            WrenchAxes::World => hamel::elements::WrenchAxes::World,
            WrenchAxes::Body => hamel::elements::WrenchAxes::Body,
        },
    }
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
