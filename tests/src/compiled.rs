//! Mechanisms as the scene compiler takes them, and what it makes of them in double precision.

use hamel::mechanism::{Body as TreeBody, Mechanism};
use hamel_codegen::derived::Derived;
use hamel_codegen::scene::functions::{Kind, Loops, compile_with};
use hamel_codegen::scene::graph::Argument;
use hamel_codegen::scene::model::{Body, Model};
use hamel_codegen::scene::prune::{Pruning, prune};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

thread_local! {
    /// The library's joints, each derived when it is first asked for.
    static JOINTS: RefCell<BTreeMap<&'static str, Rc<Derived>>> = RefCell::default();
}

/// The joint type of the library.
///
/// # Panics
/// Where its spec is not sound.
pub fn joint(name: &str) -> Option<Rc<Derived>> {
    let (name, text) = hamel_joints::specs().find(|(known, _)| *known == name)?;
    JOINTS.with_borrow_mut(|joints| {
        let entry = joints.entry(name).or_insert_with(|| {
            let derived = hamel_codegen::derive(text, &format!("{name}.joint"));
            Rc::new(derived.unwrap_or_else(|errors| panic!("{errors}")))
        });
        Some(Rc::clone(entry))
    })
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
pub fn evaluate(
    model: &Model,
    (kind, loops): (Kind, Loops),
    q: &[f64],
    speeds: &[f64],
    inputs: &[f64],
) -> Vec<f64> {
    let links = prune(model, Pruning::ALL);
    let function = compile_with(model, &links, kind, loops).function;
    function.evaluate(|argument| match argument {
        Argument::Configuration => q.to_vec(),
        Argument::Speeds => speeds.to_vec(),
        Argument::Efforts | Argument::Accelerations => inputs.to_vec(),
        Argument::Momenta => vec![],
    })
}
