//! What acts on a mechanism: elements of every kind, rotors, drives.

use super::random::Random;
use hamel_runtime::elements::{
    BodySpring, BodyWrench, Drive, Element, JointDamper, JointEffort, JointSpring, RotationSpring,
    WrenchAxes,
};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::time_function::Law;
use nalgebra::Matrix3;
use std::sync::Arc;

/// A spring at every joint, in its local coordinates and in its rotation, and one from every body to its parent.
pub fn springs(random: &mut Random, mechanism: &Mechanism) -> Vec<Arc<dyn Element>> {
    let mut elements: Vec<Arc<dyn Element>> = Vec::new();
    for (body, owner) in mechanism.bodies().iter().enumerate() {
        let size = owner.ranges().freedoms.len();
        let half = random.vec(size * size);
        let product = |i: usize, j: usize| -> f64 {
            (0..size)
                .map(|k| half[i * size + k] * half[j * size + k])
                .sum()
        };
        elements.push(Arc::new(JointSpring {
            name: format!("spring {body}"),
            body,
            stiffness: (0..size * size)
                .map(|n| product(n / size, n % size))
                .collect(),
            rest: owner.home(),
        }));
        elements.push(Arc::new(RotationSpring {
            name: format!("rotation spring {body}"),
            body,
            stiffness: 1.7,
            rest: Matrix3::identity(),
        }));
        elements.push(Arc::new(BodySpring {
            name: format!("rope {body}"),
            bodies: [owner.parent(), Some(body)],
            points: [random.vector(), random.vector()],
            stiffness: 3.0,
            damping: 0.0,
            length: 0.4,
        }));
    }
    elements
}

/// [`springs`], and beside them dampers, constant efforts and wrenches of both kinds at every body.
pub fn losses(random: &mut Random, mechanism: &Mechanism) -> Vec<Arc<dyn Element>> {
    let mut elements = springs(random, mechanism);
    for (body, owner) in mechanism.bodies().iter().enumerate() {
        let size = owner.ranges().freedoms.len();
        elements.push(Arc::new(JointDamper {
            name: format!("damper {body}"),
            body,
            coefficients: random.vec(size).into_iter().map(f64::abs).collect(),
        }));
        elements.push(Arc::new(JointEffort {
            name: format!("motor {body}"),
            body,
            efforts: random.vec(size),
        }));
        for axes in [WrenchAxes::World, WrenchAxes::Body] {
            elements.push(Arc::new(BodyWrench {
                name: format!("push {body}"),
                body,
                point: random.vector(),
                force: random.vector(),
                moment: random.vector(),
                axes,
            }));
        }
    }
    elements
}

/// The mechanism with `elements`, and a rotor at every joint that can have one.
pub fn equipped(
    seed: u64,
    mechanism: &Mechanism,
    elements: fn(&mut Random, &Mechanism) -> Vec<Arc<dyn Element>>,
) -> Mechanism {
    let mut random = Random::new(300 + seed);
    let elements = elements(&mut random, mechanism);
    let mut equipped = mechanism
        .clone()
        .with_elements(elements)
        .expect("elements fit");
    for body in 0..mechanism.bodies().len() {
        let size = mechanism.bodies()[body].ranges().freedoms.len();
        let inertia: Vec<f64> = random.vec(size).into_iter().map(f64::abs).collect();
        // Nonholonomic joints refuse, as they should.
        if let Ok(with_rotor) = equipped.clone().with_armature(body, &inertia) {
            equipped = with_rotor;
        }
    }
    equipped
}

/// The mechanism with its last holonomic joint driven, if it has one.
pub fn driven(mechanism: Mechanism) -> Mechanism {
    let holonomic = |body: usize| {
        let structures = mechanism.bodies()[body].joint().structures();
        structures.speed_basis.is_identity()
    };
    let Some(body) = (0..mechanism.bodies().len())
        .rev()
        .find(|&body| holonomic(body))
    else {
        return mechanism;
    };
    let size = mechanism.bodies()[body].ranges().freedoms.len();
    let law = Law {
        rate: 0.3,
        amplitude: 0.2,
        frequency: 2.0,
        phase: 0.4,
    };
    let drive = Drive {
        name: "drive".into(),
        body,
        laws: vec![law.into(); size],
    };
    mechanism.with_drives(vec![drive]).expect("fits")
}
