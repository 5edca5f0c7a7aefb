//! Compiled scenes with joints that carry several bodies: against the tree, and against the same mechanism with one body a joint.

use hamel::erased::AnyJoint;
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose, so3};
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::model::Model;
use hamel_downstream::joints::{ArmPair, ENTRIES};
use hamel_tests::compiled::{Point, model};
use hamel_tests::{c99, random};
use std::path::Path;
use std::sync::Arc;

fn registry() -> JointRegistry {
    let mut registry = hamel_joints::registry();
    registry
        .extend(ENTRIES.iter().copied())
        .expect("distinct names");
    registry
}

/// All joints that carry several bodies, and some that carry one.
fn kinds() -> Vec<Arc<dyn AnyJoint>> {
    let beside = ["revolute", "ball", "cart", "prismatic"];
    let mut kinds = random::kinds(&registry());
    kinds.retain(|joint| joint.bodies().len() > 1 || beside.contains(&joint.name()));
    assert!(kinds.len() >= 5 + beside.len());
    kinds
}

/// Each kind at the root of this many trees.
const ROUNDS: u64 = 6;

fn cases(largest: usize) -> Vec<random::Case> {
    let kinds = kinds();
    random::cases(&kinds, largest, ROUNDS * kinds.len() as u64).collect()
}

#[test]
fn random_trees_agree() {
    cases(7)
        .into_iter()
        .for_each(|case| Point::bare(case).agrees());
}

#[test]
fn random_trees_with_elements_agree() {
    cases(5)
        .into_iter()
        .for_each(|case| Point::with_elements(case).agrees());
}

#[test]
fn derivatives_of_random_trees_agree() {
    cases(4)
        .into_iter()
        .for_each(|case| Point::bare(case).derivatives_agree());
}

#[test]
fn derivatives_of_random_trees_with_elements_agree() {
    cases(3)
        .into_iter()
        .for_each(|case| Point::with_elements(case).derivatives_agree());
}

/// Distance of the hinges of a pair of links, m.
const LENGTH: f64 = 0.8;

/// A bob that turns freely, two links on it, a bob that turns freely on the first of them and a third link on the second; the links as one joint or as two.
fn arms(are_joined: bool) -> Arc<Mechanism> {
    let registry = hamel_joints::registry();
    let of_type = |name: &str| {
        let entry = registry.get(name).expect("a joint of the library");
        (entry.build)(&[]).expect("it has no parameters")
    };
    let mut bodies: Vec<BodySpec> = vec![];
    let mut hang = |parent: Option<usize>, joint: Arc<dyn AnyJoint>, placement: Pose<f64>| {
        let number = bodies.len() as f64;
        let child_placement = Pose::new(
            so3::exp(&Vector3::new(0.3 * number, -0.2, 0.5)),
            Vector3::new(0.1, 0.2 * number, -0.3),
        );
        bodies.push(BodySpec {
            name: format!("body {number}"),
            joint_name: format!("joint {number}"),
            parent,
            joint,
            placement,
            child_placement,
            mass: mass(number),
        });
        child_placement
    };
    let aside = Pose::new(
        so3::exp(&Vector3::new(0.4, 0.1, -0.6)),
        Vector3::new(0.5, -0.1, 0.2),
    );
    hang(None, of_type("ball"), aside);
    match are_joined {
        true => {
            let joint = hamel::erased::erase(ArmPair::new(LENGTH));
            let further = joint.more().remove(0);
            hang(Some(0), joint, aside);
            hang(Some(0), further, aside);
        }
        false => {
            let body = hang(Some(0), of_type("revolute"), aside);
            let hinge = Pose::from_translation(Vector3::new(LENGTH, 0.0, 0.0));
            hang(Some(1), of_type("revolute"), body.inverse().compose(&hinge));
        }
    }
    hang(Some(1), of_type("ball"), aside);
    hang(Some(2), of_type("revolute"), aside);
    let gravity = Vector3::new(0.3, -0.2, -9.81);
    Arc::new(Mechanism::new(gravity, bodies).expect("valid"))
}

fn mass(number: f64) -> MassProperties {
    let moments = Matrix3::from_diagonal(&Vector3::new(0.3, 0.4 + 0.05 * number, 0.5));
    let com = Vector3::new(0.1 * number, -0.2, 0.3);
    MassProperties::new(1.0 + 0.1 * number, com, moments).expect("physical")
}

#[test]
fn a_pair_of_hinges_is_one_joint_or_two() {
    let [joined, apart] = [true, false].map(arms);
    assert_eq!(joined.layout(), apart.layout());
    let model = model("pair", &joined);
    for seed in 0..4 {
        let point = || Point::random(model.clone(), &apart, seed);
        point().agrees();
        point().derivatives_agree();
    }
}

fn flops(model: &Model, kind: Kind) -> usize {
    let chosen = compile(model, kind, Loops::default()).expect("it is short");
    chosen.function.operations().flops()
}

#[test]
fn what_two_joints_take_one_takes_with_few_operations_more() {
    let [joined, apart] = [true, false].map(|are_joined| model("pair", &arms(are_joined)));
    for kind in Kind::ALL {
        let [one, two] = [&joined, &apart].map(|model| flops(model, kind));
        println!("{kind:?}: as one joint {one}, as two {two}");
    }
    let kinds = kinds();
    for case in random::cases(&kinds, 1, kinds.len() as u64) {
        let name = case.mechanism.bodies()[0].joint().name();
        let model = model(name, &case.mechanism);
        let tried = [Kind::ForwardDynamics, Kind::Speeds].map(|kind| compile(&model, kind, Loops::default()).expect("short").tried);
        println!("{name}: {tried:?}");
    }
    for (what, model) in [("one", &joined), ("two", &apart)] {
        let tried = [Kind::ForwardDynamics, Kind::Speeds].map(|kind| compile(model, kind, Loops::default()).expect("short").tried);
        println!("{what}: {tried:?}");
    }
}

/// One tree for each joint that carries several bodies, and the pair.
#[test]
fn modules_in_c_agree() {
    let kinds = kinds();
    let count = kinds.len() as u64;
    let trees = random::cases(&kinds, 3, count).filter(|case| {
        let root = &case.mechanism.bodies()[0];
        root.joint().bodies().len() > 1
    });
    let mechanisms = trees.map(|case| case.mechanism).chain([arms(true)]);
    let scenes = mechanisms.map(|mechanism| {
        let model = model("tree", &mechanism);
        (mechanism, model)
    });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c99");
    c99::agree(&folder, &scenes.collect::<Vec<_>>());
}
