//! From what a scene file says to what is compiled, with all that cannot be compiled named at once.

use super::acting::{Held, port_of};
use super::check;
use super::coupled::{self, Types};
use super::model::{Body, Coupling, Elements, Model};
use super::products::JointType;
use hamel_runtime::elements::{BodySpring, BodyWrench, JointLimit, WrenchAxes};
use hamel_scene::{
    BodyDescription, JointDescription, LimitKind, PointSpring, SceneDescription, WrenchDescription,
};
use std::cell::RefCell;
use std::rc::Rc;

/// Why a scene cannot be compiled: one line for each reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The scene.
    pub scene: String,
    /// The reasons, each with the element that it is about.
    pub reasons: Vec<String>,
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the scene `{}` cannot be compiled:", self.scene)?;
        self.reasons
            .iter()
            .try_for_each(|reason| write!(f, "\n  {reason}"))
    }
}

impl std::error::Error for Refused {}

impl Model {
    /// The model of a scene; `joints` finds a joint type by its name. Couplings of mimic joints are derived here.
    ///
    /// # Errors
    /// Mimic joints that make no coupling, joint types that are not found, parameters that do not fit them, and what the scene has that the compiler does not write.
    pub fn new(
        scene: &SceneDescription,
        joints: impl Fn(&str) -> Option<Rc<JointType>>,
    ) -> Result<Self, Refused> {
        let refused = |reasons| Refused {
            scene: scene.name.clone(),
            reasons,
        };
        let coupled = scene.coupled().map_err(|errors| {
            let errors = errors.errors().iter();
            refused(errors.map(|error| error.message().to_owned()).collect())
        })?;
        let mut scene = coupled.into_owned();
        let types = RefCell::new(Types::default());
        let joints = |joint: &JointDescription| found(joint, &joints, &types);
        number(&mut scene);
        let scene = &scene;
        let mut reasons = check::of_scene(scene);
        if !reasons.is_empty() {
            return Err(refused(reasons));
        }
        reasons.extend(check::of_time(scene));
        let mut elements = Elements {
            springs: scene.springs.iter().enumerate().map(spring).collect(),
            wrenches: scene
                .wrenches
                .iter()
                .enumerate()
                .filter_map(wrench)
                .collect(),
            limits: scene.bodies.iter().enumerate().flat_map(limits).collect(),
            ..Elements::default()
        };
        let mut bodies: Vec<Body> = vec![];
        let mut first = 0;
        for group in scene.bodies.chunk_by(|_, next| !next.leads()) {
            match of_joint((first, group), joints, &mut elements) {
                Ok(own) => bodies.extend(own),
                Err(more) => reasons.extend(more),
            }
            first += group.len();
        }
        if !reasons.is_empty() {
            return Err(refused(reasons));
        }
        let mut model = Self {
            name: scene.name.clone(),
            gravity: scene.gravity,
            bodies,
            elements,
            coupling: Coupling::default(),
        };
        model.couple(scene).map_err(refused)?;
        Ok(model)
    }
}

/// Gives couplings the parameters of their specs.
fn number(scene: &mut SceneDescription) {
    for body in &mut scene.bodies {
        if let Some(coupling) = &body.joint.coupling {
            body.joint.parameters = coupled::spec(coupling).parameters;
        }
    }
}

/// The type of a joint: of its name, or of its links where it is a coupling.
fn found(
    joint: &JointDescription,
    joints: impl Fn(&str) -> Option<Rc<JointType>>,
    types: &RefCell<Types>,
) -> Result<Rc<JointType>, String> {
    let (name, kind) = (&joint.name.value, &joint.kind.value);
    match &joint.coupling {
        Some(coupling) => types
            .borrow_mut()
            .of(coupling)
            .map_err(|reason| format!("joint `{name}`: its coupling cannot be derived: {reason}")),
        None => joints(kind)
            .ok_or_else(|| format!("joint `{name}`: there is no spec of the joint type `{kind}`")),
    }
}

/// The bodies of one joint, and its spring among the elements; `group` are all that the scene gives for it, the first of them with its index.
fn of_joint(
    (index, group): (usize, &[BodyDescription]),
    joints: impl Fn(&JointDescription) -> Result<Rc<JointType>, String>,
    elements: &mut Elements,
) -> Result<Vec<Body>, Vec<String>> {
    let Some(first) = group.first() else {
        return Ok(vec![]);
    };
    let joint = joints(&first.joint).map_err(|reason| vec![reason])?;
    check::of_joint(group, &joint.derived).map_err(|reason| vec![reason])?;
    let types = std::iter::once(&joint).chain(&joint.more);
    let bodies = group.iter().zip(types);
    let bodies = bodies.map(|(body, joint)| {
        let own = compiled(body, Rc::clone(joint))?;
        let driven = first.forces.motion.is_some();
        Ok(Body { driven, ..own })
    });
    let bodies: Vec<Body> = bodies.collect::<Result<_, Vec<String>>>()?;
    let held = Held {
        what: "spring",
        index,
        body: first,
        joint: &joint,
        parameters: &bodies[0].parameters,
    };
    held.add_spring(elements).map_err(|reason| vec![reason])?;
    held.add_ports(elements)?;
    Ok(bodies)
}

fn spring((index, spring): (usize, &PointSpring)) -> BodySpring {
    BodySpring {
        name: format!("spring {}", index + 1),
        bodies: [spring.from.body, spring.to.body],
        points: [spring.from.point, spring.to.point],
        stiffness: spring.stiffness,
        damping: spring.damping,
        length: spring.length,
    }
}

/// A constant wrench; any other is refused before.
fn wrench((index, wrench): (usize, &WrenchDescription)) -> Option<BodyWrench> {
    let [force, moment] = wrench.constant()?;
    Some(BodyWrench {
        name: format!("wrench {}", index + 1),
        body: wrench.body,
        point: wrench.point,
        force,
        moment,
        axes: match wrench.axes {
            hamel_scene::WrenchAxes::World => WrenchAxes::World,
            hamel_scene::WrenchAxes::Body => WrenchAxes::Body,
        },
    })
}

/// Stops that give way; impacts are no part of the equations.
fn limits((index, body): (usize, &BodyDescription)) -> impl Iterator<Item = JointLimit> {
    let forces = &body.forces;
    let all = forces.limit.iter().chain(&forces.further_limits);
    all.filter_map(move |limit| {
        let LimitKind::Compliant { stiffness, damping } = limit.value.kind else {
            return None;
        };
        Some(JointLimit {
            name: format!("limit of joint `{}`", body.joint.name.value),
            body: index,
            port: None,
            lower: limit.value.lower,
            upper: limit.value.upper,
            stiffness,
            damping,
        })
    })
}

/// Inertias of rotors at ports, one a port, if there are any. Of ports that are not there it is said elsewhere.
fn port_armature(body: &BodyDescription, joint: &JointType) -> Vec<f64> {
    let rotors = body.forces.ports.iter().filter(|own| own.armature > 0.0);
    let mut inertias = vec![];
    for own in rotors {
        if let Some(port) = port_of(body, joint, &own.name.value) {
            inertias.resize(inertias.len().max(port + 1), 0.0);
            inertias[port] = own.armature;
        }
    }
    inertias
}

fn compiled(body: &BodyDescription, joint: Rc<JointType>) -> Result<Body, Vec<String>> {
    let name = &body.joint.name.value;
    let mut reasons = vec![];
    let forces = &body.forces;
    let freedoms = joint.derived.shape.freedoms;
    let mut spread = |what: &str, given: Option<&hamel_scene::PerFreedom>| {
        let numbers = given.map_or(Some(vec![]), |given| given.spread(freedoms));
        numbers.unwrap_or_else(|| {
            reasons.push(format!(
                "joint `{name}`: {what} must have {freedoms} number(s)"
            ));
            vec![]
        })
    };
    let damping = spread("damping", forces.damping.as_ref().map(|found| &found.value));
    let armature = spread(
        "armature",
        forces.armature.as_ref().map(|found| &found.value),
    );
    let port_armature = port_armature(body, &joint);
    // Efforts that change with time come in with τ.
    let effort = forces.constant_effort().unwrap_or_default();
    let shape = joint.derived.shape;
    if forces.limit.is_some() && (shape.configuration, shape.freedoms, shape.speeds) != (1, 1, 1) {
        reasons.push(format!(
            "joint `{name}`: a limit needs a single coordinate whose rate is the speed, and `{}` has none",
            body.joint.kind.value
        ));
    }
    let is_nonholonomic = joint.derived.shape.constraints > 0;
    let freedoms = joint.derived.spec.freedoms.value.iter().enumerate();
    let rotors = freedoms.zip(&armature).filter(|(_, rotor)| **rotor != 0.0);
    let elsewhere =
        rotors.filter(|((k, _), _)| is_nonholonomic && !joint.derived.rate_is_a_speed(*k));
    let elsewhere: Vec<String> = elsewhere
        .map(|((_, freedom), _)| format!("`{}`", freedom.name))
        .collect();
    if !elsewhere.is_empty() {
        reasons.push(format!(
            "joint `{name}`: a nonholonomic joint such as `{}` can have an armature only at degrees of freedom whose rate is one of its speeds, not at {}",
            body.joint.kind.value,
            elsewhere.join(", ")
        ));
    }
    let parameters = parameters(body, &joint, &mut reasons);
    match reasons.is_empty() {
        false => Err(reasons),
        true => Ok(Body {
            name: body.name.value.clone(),
            joint_name: name.clone(),
            parent: body.parent,
            joint,
            parameters,
            placement: body.at,
            child_placement: body.body_at,
            mass: body.mass,
            armature,
            port_armature,
            damping,
            effort,
            driven: forces.motion.is_some(),
        }),
    }
}

/// The values of a joint's parameters in the order of its spec.
fn parameters(body: &BodyDescription, joint: &JointType, reasons: &mut Vec<String>) -> Vec<f64> {
    let name = &body.joint.name.value;
    let known: Vec<&str> = joint
        .derived
        .spec
        .parameters
        .iter()
        .map(|known| known.symbol.name())
        .collect();
    for (given, _) in &body.joint.parameters {
        if !known.contains(&given.value.as_str()) {
            reasons.push(format!(
                "joint `{name}`: its type has no parameter `{}`",
                given.value
            ));
        }
    }
    let value = |known: &&str| {
        let given = body
            .joint
            .parameters
            .iter()
            .find(|(given, _)| given.value == **known);
        given.map(|(_, value)| *value).or_else(|| {
            reasons.push(format!("joint `{name}`: parameter `{known}` is missing"));
            None
        })
    };
    known.iter().filter_map(value).collect()
}
