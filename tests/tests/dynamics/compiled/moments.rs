//! Moments of inertia that are small beside a body's others keep their digits, alone and carried.

use hamel::dynamics::{MassMatrix, Recursive};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_compiler::functions::{Kind, Loops};
use hamel_tests::compiled::{self, Functions};
use std::sync::Arc;

/// Principal moments of slender bodies, round and flat, with the small one last.
const SLENDER: [[f64; 3]; 5] = [
    [0.7, 0.7, 1e-10],
    [0.700_003, 0.7, 3e-6],
    [1.000_001, 1.0, 1e-6],
    [0.350_000_07, 0.35, 7e-8],
    [1.000_000_000_1, 1.0, 1e-10],
];

/// Roundings of a sum of some ten terms none of which is larger than what they add up to.
const ROUNDINGS: f64 = 10.0 * f64::EPSILON;

/// A slender body on a hinge along it, on a bearer if there is one.
fn body(joint: &str, parent: Option<usize>, moments: [f64; 3]) -> BodySpec {
    let registry = hamel_joints::registry();
    let entry = registry.get(joint).expect("a joint of the library");
    let inertia = Matrix3::from_diagonal(&Vector3::from(moments));
    BodySpec {
        name: format!("{joint} body"),
        joint_name: joint.to_owned(),
        parent,
        joint: (entry.build)(&[]).expect("it has no parameters"),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(1.5, Vector3::zeros(), inertia).expect("rigid bodies have them"),
    }
}

/// M̄ at home in single entries, compiled and by the tree.
fn small_entry(bodies: Vec<BodySpec>) -> [f64; 2] {
    let mechanism = Mechanism::new(Vector3::zeros(), bodies).expect("it is sound");
    let mechanism = Arc::new(mechanism);
    let q = mechanism.home();
    let model = compiled::model("slender", &mechanism);
    let found = Functions::new(&model).evaluate((Kind::MassMatrix, Loops::Never), &q, &[], &[]);
    let mut mass = MassMatrix::new(&mechanism);
    let mut tree = Recursive::new(mechanism);
    tree.mass_matrix(&q, &mut mass).expect("sizes fit");
    [found[0], mass.matrix()[(0, 0)]]
}

#[test]
fn small_moments_keep_their_digits() {
    for moments in SLENDER {
        let small = moments[2];
        for [found, by_tree] in [
            small_entry(vec![body("revolute", None, moments)]),
            small_entry(vec![
                body("revolute", None, moments),
                body("ball_child", Some(0), moments),
            ])
            .map(|both| both / 2.0),
        ] {
            for value in [found, by_tree] {
                let error = (value / small - 1.0).abs();
                assert!(error <= ROUNDINGS, "{moments:?}: {value} is off by {error}");
            }
        }
    }
}
