//! Mechanisms as the scene compiler takes them, and what it makes of them in double precision.

mod functions;
mod point;
mod second;
mod slopes;

pub use functions::Functions;
pub use point::{Evaluate, Point};

use crate::random;
use chacha20::ChaCha8Rng;
use hamel::elements::{
    BodySpring, BodyWrench, Drive, Element, JointSpring, PointConstraint, PortEffort, PortSpring,
    RotationSpring, WrenchAxes,
};
use hamel::mechanism::{Body as TreeBody, Mechanism};
use hamel::nalgebra::{DMatrix, Vector3};
use hamel::time_function::Law;
use hamel_codegen::derived::{Derived, KernelKind, Method};
use hamel_compiler::JointType;
use hamel_compiler::model::{Body, Coupling, Elements, Model};
use rand::RngExt;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::{Arc, LazyLock, Mutex};

/// The library's joints, each derived when it is first asked for.
static DERIVED: LazyLock<BTreeMap<&'static str, Mutex<Option<Derived>>>> = LazyLock::new(|| {
    hamel_joints::specs()
        .map(|(name, _)| (name, Mutex::default()))
        .collect()
});

thread_local! {
    /// Their types, which are not shared by threads.
    static JOINTS: RefCell<BTreeMap<&'static str, Rc<JointType>>> = RefCell::default();
}

/// The joint type of the library.
///
/// # Panics
/// Where its spec is not sound.
pub fn joint(name: &str) -> Option<Rc<JointType>> {
    let (name, _) = hamel_joints::specs().find(|(known, _)| *known == name)?;
    JOINTS.with_borrow_mut(|joints| {
        let entry = joints.entry(name).or_insert_with(|| {
            let mut derived = DERIVED[name].lock().expect("no derivation panics");
            let derived = derived.get_or_insert_with(|| crate::derived(name));
            Rc::new(JointType::new(derived.clone()).expect("its products take little work"))
        });
        Some(Rc::clone(entry))
    })
}

/// The joint type of a spec in a folder.
///
/// # Panics
/// Where it is missing or not sound.
pub fn joint_in(folder: &Path, name: &str) -> Rc<JointType> {
    let derived = crate::derived_in(folder, name);
    Rc::new(JointType::new(derived).expect("its products take little work"))
}

/// A mechanism of the library's joints on which gravity alone acts, with its rotors and drives.
///
/// # Panics
/// Where a joint is not of the library.
pub fn model(name: &str, mechanism: &Mechanism) -> Model {
    model_on(name, mechanism, joint)
}

/// The same on joints that `joint` knows.
///
/// # Panics
/// Where it does not know one.
pub fn model_on(
    name: &str,
    mechanism: &Mechanism,
    joint: impl Fn(&str) -> Option<Rc<JointType>>,
) -> Model {
    let bodies = mechanism.bodies().iter().enumerate();
    Model {
        name: name.to_owned(),
        gravity: *mechanism.gravity(),
        bodies: bodies
            .map(|(index, owner)| {
                let kind = owner.joint().name();
                let first = joint(kind).unwrap_or_else(|| panic!("`{kind}` is not known"));
                body(
                    owner,
                    &first,
                    [mechanism.armature(index), mechanism.port_armature(index)],
                    mechanism.is_driven(index),
                )
            })
            .collect(),
        elements: Elements::default(),
        coupling: Coupling {
            constraints: mechanism.constraints().to_vec(),
            dependent: mechanism.dependent_speeds().to_vec(),
        },
    }
}

fn body(body: &TreeBody, first: &Rc<JointType>, rotors: [&[f64]; 2], driven: bool) -> Body {
    let mut parameters = vec![];
    body.joint()
        .parameters(&mut |_, value| parameters.push(value));
    Body {
        name: body.name().to_owned(),
        joint_name: body.joint_name().to_owned(),
        parent: body.parent(),
        joint: match body.joint().body().checked_sub(1) {
            None => Rc::clone(first),
            Some(further) => Rc::clone(&first.more[further]),
        },
        parameters,
        placement: *body.placement(),
        child_placement: *body.child_placement(),
        mass: *body.mass(),
        armature: rotors[0].to_vec(),
        port_armature: rotors[1].to_vec(),
        damping: vec![],
        effort: vec![],
        driven,
    }
}

/// Random elements for a mechanism: springs of both kinds at half of its joints each, in local coordinates where these have a closed form, springs between points of every third body and of any
/// other or the world, and wrenches in both axes.
pub fn elements(random: &mut ChaCha8Rng, mechanism: &Mechanism) -> Elements {
    let mut elements = Elements::default();
    for (body, owner) in mechanism.joints() {
        let rest = random::configuration(random, mechanism);
        let rest = owner.configuration(&rest).to_vec();
        if random.random_bool(0.5) && has_closed_coordinates(owner.joint().name()) {
            let size = owner.ranges().freedoms.len();
            let root = DMatrix::from_vec(size, size, random::numbers(random, size * size));
            let stiffness = match random.random_bool(0.5) {
                true => &root * root.transpose(),
                false => DMatrix::identity(size, size) * 0.8,
            };
            elements.joint_springs.push(JointSpring {
                name: format!("spring {body}"),
                body,
                stiffness: stiffness.as_slice().to_vec(),
                rest: rest.clone(),
            });
        }
        if random.random_bool(0.5) {
            elements.rotation_springs.push(RotationSpring {
                name: format!("rotation spring {body}"),
                body,
                stiffness: random.random_range(0.5..2.0),
                rest: owner.joint().pose(&rest).rotation,
            });
        }
    }
    at_ports(random, mechanism, &mut elements);
    let count = mechanism.bodies().len();
    for body in (0..count).step_by(3) {
        let other = random.random_range(0..=count);
        let mut of = |some: f64| if random.random_bool(0.5) { some } else { 0.0 };
        let (stiffness, damping, length) = (of(2.0), of(0.7), of(0.6));
        elements.springs.push(BodySpring {
            name: format!("spring of {body}"),
            bodies: [(other < count).then_some(other), Some(body)],
            points: [vector(random), vector(random)],
            stiffness,
            damping,
            length,
        });
        elements.wrenches.push(BodyWrench {
            name: format!("wrench on {body}"),
            body,
            point: vector(random),
            force: vector(random),
            moment: vector(random),
            axes: match random.random_bool(0.5) {
                true => WrenchAxes::World,
                false => WrenchAxes::Body,
            },
        });
    }
    elements
}

/// An effort and a spring with a damper at each port.
pub fn at_ports(random: &mut ChaCha8Rng, mechanism: &Mechanism, elements: &mut Elements) {
    for (body, owner) in mechanism.joints() {
        for (port, named) in owner.joint().ports().iter().enumerate() {
            let mut number = || random.random_range(-1.0..1.0);
            let name = format!("{} of {body}", named.name);
            elements.port_efforts.push(PortEffort {
                name: name.clone(),
                body,
                port,
                effort: number().into(),
            });
            elements.port_springs.push(PortSpring {
                name,
                body,
                port,
                stiffness: 2.0 + number(),
                damping: 1.0 + number(),
                rest: number(),
            });
        }
    }
}

/// Whether the local coordinates of a joint have a closed form: springs in others are not compiled.
fn has_closed_coordinates(name: &str) -> bool {
    let joint = joint(name).unwrap_or_else(|| panic!("`{name}` is not of the library"));
    let kernels = [KernelKind::Local, KernelKind::RetractDifferentialInverse];
    kernels.into_iter().all(|kind| {
        let kernel = joint.derived.kernel(kind);
        kernel.is_some_and(|kernel| kernel.method == Method::Formula)
    })
}

fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_vec(random::numbers(random, 3))
}

/// The mechanism with these elements.
///
/// # Panics
/// Where one does not fit it.
pub fn equipped(mechanism: &Mechanism, elements: &Elements) -> Arc<Mechanism> {
    let mut all: Vec<Arc<dyn Element>> = vec![];
    for spring in &elements.joint_springs {
        all.push(Arc::new(spring.clone()));
    }
    for spring in &elements.rotation_springs {
        all.push(Arc::new(spring.clone()));
    }
    for spring in &elements.springs {
        all.push(Arc::new(spring.clone()));
    }
    for wrench in &elements.wrenches {
        all.push(Arc::new(wrench.clone()));
    }
    for effort in &elements.port_efforts {
        all.push(Arc::new(effort.clone()));
    }
    for spring in &elements.port_springs {
        all.push(Arc::new(spring.clone()));
    }
    let equipped = mechanism.clone().with_elements(all);
    Arc::new(equipped.unwrap_or_else(|errors| panic!("{errors:?}")))
}

/// The mechanism with random rotors at half of its holonomic joints.
///
/// # Panics
/// Never: they fit.
pub fn geared(random: &mut ChaCha8Rng, mechanism: &Mechanism) -> Mechanism {
    let mut geared = mechanism.clone();
    for (body, owner) in mechanism.joints() {
        let layout = owner.joint().layout();
        if layout.constraints == 0 && random.random_bool(0.5) {
            let rotors = random::numbers(random, layout.freedoms);
            let rotors: Vec<f64> = rotors.into_iter().map(f64::abs).collect();
            let with = geared.with_armature(body, &rotors);
            geared = with.unwrap_or_else(|error| panic!("{error}"));
        }
        let ports = owner.joint().ports().len();
        if ports > 0 && body % 2 == 0 {
            let with = geared.with_port_armature(body, &vec![0.4; ports]);
            geared = with.unwrap_or_else(|error| panic!("{error}"));
        }
    }
    geared
}

/// The mechanism with drives at a quarter of its joints.
///
/// # Panics
/// Never: they fit.
pub fn driven(random: &mut ChaCha8Rng, mechanism: &Mechanism) -> Mechanism {
    let mut drives = vec![];
    for (body, owner) in mechanism.joints() {
        if random.random_bool(0.25) {
            drives.push(Drive {
                name: format!("drive of {body}"),
                body,
                laws: vec![Law::default().into(); owner.joint().layout().speeds],
            });
        }
    }
    let driven = mechanism.clone().with_drives(drives);
    driven.unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// The mechanism with up to five constraints on points of any of its bodies, where its joints leave that many speeds free at `q`.
pub fn coupled(random: &mut ChaCha8Rng, mechanism: Mechanism, q: &[f64]) -> Mechanism {
    let count = mechanism.bodies().len();
    let mut coupled = mechanism;
    for _ in 0..5 {
        let mut constraints = coupled.constraints().to_vec();
        constraints.push(PointConstraint {
            name: format!("constraint {}", constraints.len()),
            body: random.random_range(0..count),
            point: vector(random),
            direction: vector(random),
        });
        if let Ok(more) = coupled.clone().with_constraints(constraints, q) {
            coupled = more;
        }
    }
    coupled
}
