//! Random mechanisms from the joints of this module, and random states of them.

use super::random::Random;
use super::{joints, several};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::{MassProperties, Pose, so3};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

pub fn pose(random: &mut Random) -> Pose<f64> {
    Pose::new(so3::exp(&random.rotation_vector()), random.vector())
}

/// A body of point masses, so that its inertia is physical.
pub fn mass(random: &mut Random) -> MassProperties {
    let rotation = so3::exp(&random.rotation_vector());
    let second = random.vector::<3>().map(|entry| 0.05 + entry.abs());
    let principal = Matrix3::from_diagonal(&Vector3::new(
        second.y + second.z,
        second.z + second.x,
        second.x + second.y,
    ));
    let inertia = rotation * principal * rotation.transpose();
    let symmetric = (inertia + inertia.transpose()) * 0.5;
    MassProperties::new(1.5 + random.next(), random.vector(), symmetric)
        .expect("physical by construction")
}

pub fn body(
    name: &str,
    parent: Option<usize>,
    joint: Arc<dyn AnyJoint>,
    placement: Pose<f64>,
    mass: MassProperties,
) -> BodySpec {
    BodySpec {
        name: name.into(),
        joint_name: format!("{name} joint"),
        parent,
        joint,
        placement,
        child_placement: Pose::identity(),
        mass,
    }
}

pub const GRAVITY: Vector3<f64> = Vector3::new(0.3, -0.2, -9.81);

/// A tree on the given joints: body i hangs on a random body before it.
pub fn tree(random: &mut Random, joints: &[Arc<dyn AnyJoint>]) -> Arc<Mechanism> {
    Arc::new(Mechanism::new(GRAVITY, specs(random, joints)).expect("valid by construction"))
}

/// [`tree`], with needles for bodies, every other one on the axis of its joint's child frame: their moments are as 1 to 1e-5.
pub fn slender_tree(random: &mut Random, joints: &[Arc<dyn AnyJoint>]) -> Arc<Mechanism> {
    let mut specs = specs(random, joints);
    for spec in specs.iter_mut().step_by(2) {
        let moments = Matrix3::from_diagonal(&Vector3::new(0.7, 0.700_003, 1e-5));
        let com = Vector3::new(0.0, 0.0, random.next());
        spec.mass = MassProperties::new(1.5, com, moments).expect("physical");
        spec.child_placement = Pose::identity();
    }
    Arc::new(Mechanism::new(GRAVITY, specs).expect("valid by construction"))
}

fn specs(random: &mut Random, joints: &[Arc<dyn AnyJoint>]) -> Vec<BodySpec> {
    let mut bodies: Vec<BodySpec> = Vec::new();
    for joint in joints {
        let before = bodies.len();
        let choice = ((random.next() + 1.0) * 0.5 * (before + 1) as f64) as usize;
        let parent = (before > 0).then(|| choice.min(before - 1));
        let mut spec = body(
            &format!("body {before}"),
            parent,
            Arc::clone(joint),
            pose(random),
            mass(random),
        );
        spec.child_placement = pose(random);
        for (place, joint) in joint.more().into_iter().enumerate() {
            bodies.push(BodySpec {
                name: format!("body {}", before + 1 + place),
                joint,
                child_placement: pose(random),
                mass: mass(random),
                ..spec.clone()
            });
        }
        bodies.insert(before, spec);
    }
    bodies
}

/// One to six joints, mixed, every type at the root of some tree; then others in which some joints carry several bodies.
pub fn trees() -> Vec<Arc<Mechanism>> {
    let mut trees = trees_of_single_bodies();
    trees.extend(trees_of_several());
    trees
}

/// [`trees`] whose joints carry one body each.
pub fn trees_of_single_bodies() -> Vec<Arc<Mechanism>> {
    mixed_trees(tree)
}

/// Joints that carry several bodies, among others, at the root and within.
fn trees_of_several() -> Vec<Arc<Mechanism>> {
    let all = [
        several::linkage(),
        joints::revolute(),
        several::carriage(),
        joints::ball(),
        joints::cart(),
    ];
    (0..10)
        .map(|seed| {
            let mut random = Random::new(50 + seed);
            let count = 1 + seed as usize % 5;
            let chosen: Vec<_> = (0..count)
                .map(|i| Arc::clone(&all[(2 * seed as usize + 3 * i) % all.len()]))
                .collect();
            tree(&mut random, &chosen)
        })
        .collect()
}

/// [`trees`] of [`slender_tree`]s.
pub fn slender_trees() -> Vec<Arc<Mechanism>> {
    mixed_trees(slender_tree)
}

fn mixed_trees(
    tree: impl Fn(&mut Random, &[Arc<dyn AnyJoint>]) -> Arc<Mechanism>,
) -> Vec<Arc<Mechanism>> {
    let all = [
        joints::revolute(),
        joints::ball(),
        joints::planar(),
        joints::planar_euclidean(),
        joints::cart(),
        joints::drift(),
    ];
    (0..12)
        .map(|seed| {
            let mut random = Random::new(seed);
            let count = 1 + seed as usize % 6;
            let chosen: Vec<_> = (0..count)
                .map(|i| Arc::clone(&all[(seed as usize + 5 * i) % all.len()]))
                .collect();
            tree(&mut random, &chosen)
        })
        .collect()
}

/// A configuration far from home on every joint.
pub fn configuration(random: &mut Random, mechanism: &Mechanism) -> Vec<f64> {
    mechanism
        .joints()
        .flat_map(|(i, body)| {
            let phi = random.vec(body.ranges().freedoms.len());
            mechanism.configuration_from_local(i, &phi).expect("finite")
        })
        .collect()
}
