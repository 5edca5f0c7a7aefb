//! Mechanisms as the scene compiler takes them, and what it makes of them in double precision.

use hamel::mechanism::{Body as TreeBody, Mechanism};
use hamel_codegen::derived::Derived;
use hamel_codegen::scene::functions::{Kind, compile};
use hamel_codegen::scene::graph::Argument;
use hamel_codegen::scene::model::{Body, Model};
use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

/// The library's joints, derived once.
static JOINTS: LazyLock<BTreeMap<&'static str, Arc<Derived>>> = LazyLock::new(|| {
    let derive = |(name, text)| {
        let derived = hamel_codegen::derive(text, &format!("{name}.joint"));
        (
            name,
            Arc::new(derived.unwrap_or_else(|errors| panic!("{errors}"))),
        )
    };
    hamel_joints::specs().map(derive).collect()
});

/// The joint type of the library.
pub fn joint(name: &str) -> Option<Arc<Derived>> {
    JOINTS.get(name).cloned()
}

/// A mechanism of the library's joints on which gravity alone acts.
///
/// # Panics
/// Where a joint is not of the library.
pub fn model(name: &str, mechanism: &Mechanism) -> Model {
    Model {
        name: name.to_owned(),
        gravity: *mechanism.gravity(),
        bodies: mechanism.bodies().iter().map(body).collect(),
    }
}

fn body(body: &TreeBody) -> Body {
    let mut parameters = vec![];
    body.joint()
        .parameters(&mut |_, value| parameters.push(value));
    let kind = body.joint().name();
    Body {
        name: body.name().to_owned(),
        joint_name: body.joint_name().to_owned(),
        parent: body.parent(),
        joint: joint(kind).unwrap_or_else(|| panic!("`{kind}` is not of the library")),
        parameters,
        placement: *body.placement(),
        child_placement: *body.child_placement(),
        mass: *body.mass(),
        armature: vec![],
        damping: vec![],
        effort: vec![],
    }
}

/// The values of a compiled function at a state.
pub fn evaluate(model: &Model, kind: Kind, q: &[f64], speeds: &[f64], inputs: &[f64]) -> Vec<f64> {
    let function = compile(model, kind).function;
    function
        .graph
        .evaluate(&function.outputs, |argument| match argument {
            Argument::Configuration => q.to_vec(),
            Argument::Speeds => speeds.to_vec(),
            Argument::Efforts | Argument::Accelerations => inputs.to_vec(),
            Argument::Momenta => vec![],
        })
}
