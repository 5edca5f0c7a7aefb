//! Joints that carry several bodies: two hinges as one joint are two joints.

use super::flops;
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose, so3};
use hamel_compiler::JointType;
use hamel_compiler::functions::Kind;
use hamel_compiler::model::Model;
use hamel_tests::compiled::{self, Functions, Point};
use std::rc::Rc;
use std::sync::Arc;

/// Distance of the hinges, m.
const LENGTH: f64 = 0.8;

/// Two hinges in series.
const HINGES: &str = "hamel = 1;
    joint hinges(length: m > 0) {
        config first: R1, second: R1;
        bodies upper, lower;
        H.upper = rot_z(first);
        H.lower = rot_z(first) * trans_x(length) * rot_z(second);
    }";

/// A base on a ball joint, two links in series on it, a bob on a ball joint on the first of them and a third link on the second.
fn arms() -> Arc<Mechanism> {
    let registry = hamel_joints::registry();
    let mut bodies: Vec<BodySpec> = vec![];
    let mut hang = |parent: Option<usize>, kind: &str, placement: Pose<f64>| {
        let entry = registry.get(kind).expect("a joint of the library");
        let number = bodies.len() as f64;
        let moments = Vector3::new(0.3, 0.4 + 0.05 * number, 0.5);
        let com = Vector3::new(0.1 * number, -0.2, 0.3);
        let mass = MassProperties::new(1.0 + 0.1 * number, com, Matrix3::from_diagonal(&moments));
        let child_placement = Pose::new(
            so3::exp(&Vector3::new(0.3 * number, -0.2, 0.5)),
            Vector3::new(0.1, 0.2 * number, -0.3),
        );
        bodies.push(BodySpec {
            name: format!("body {number}"),
            joint_name: format!("joint {number}"),
            parent,
            joint: (entry.build)(&[]).expect("it has no parameters"),
            placement,
            child_placement,
            mass: mass.expect("physical"),
        });
        child_placement
    };
    let aside = Pose::new(
        so3::exp(&Vector3::new(0.4, 0.1, -0.6)),
        Vector3::new(0.5, -0.1, 0.2),
    );
    hang(None, "ball", aside);
    let upper = hang(Some(0), "revolute", aside);
    let hinge = Pose::from_translation(Vector3::new(LENGTH, 0.0, 0.0));
    hang(Some(1), "revolute", upper.inverse().compose(&hinge));
    hang(Some(1), "ball", aside);
    hang(Some(2), "revolute", aside);
    let gravity = Vector3::new(0.3, -0.2, -9.81);
    Arc::new(Mechanism::new(gravity, bodies).expect("valid"))
}

/// The same with both links on one joint, and as it is.
fn joined_and_apart() -> [Model; 2] {
    let apart = compiled::model("hinges", &arms());
    let derived = hamel_codegen::derive(HINGES, "hinges.joint");
    let derived = derived.unwrap_or_else(|errors| panic!("{errors}"));
    let joint = Rc::new(JointType::new(derived).expect("its products take little work"));
    let mut joined = apart.clone();
    let (parent, placement) = (joined.bodies[1].parent, joined.bodies[1].placement);
    let types = [Rc::clone(&joint), Rc::clone(&joint.more[0])];
    for (body, joint) in joined.bodies[1..].iter_mut().zip(types) {
        body.joint = joint;
        body.parameters = vec![LENGTH];
        (body.parent, body.placement) = (parent, placement);
    }
    assert_eq!(joined.sizes(), apart.sizes());
    [joined, apart]
}

#[test]
fn two_hinges_are_one_joint_or_two() {
    let mechanism = arms();
    let [joined, _] = joined_and_apart();
    let functions = Functions::new(&joined);
    for seed in 0..4 {
        let point = || Point::random(joined.clone(), &mechanism, seed);
        point().agrees_with(&functions);
        point().derivatives_agree_with(&functions);
    }
}

/// Operations counted when this was written, as one joint and as two: the second link is seen from the base there, and its mass, which two joints move to the
/// first link, stays.
#[test]
fn two_hinges_as_one_joint_take_few_operations_more() {
    let counts = [
        (Kind::ForwardDynamics, 2567, 2184),
        (Kind::InverseDynamics, 1125, 933),
        (Kind::MomentumRates, 2658, 2230),
        (Kind::ForwardDerivatives, 10_212, 9180),
        (Kind::InverseDerivatives, 6644, 5727),
    ];
    let [joined, apart] = joined_and_apart();
    for (kind, one, two) in counts {
        let found = [&joined, &apart].map(|model| flops(model, kind));
        assert!(found[0] <= one && found[1] <= two, "{kind:?}: {found:?}");
    }
}

/// The mechanism of two joints, and the model of it with one.
pub fn hinges() -> (Arc<Mechanism>, Model) {
    let [joined, _] = joined_and_apart();
    (arms(), joined)
}
