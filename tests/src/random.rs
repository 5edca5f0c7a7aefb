//! Seeded random mechanisms and states: trees of any joints, placed anywhere, with physical inertias.

use chacha20::ChaCha8Rng;
use hamel::erased::AnyJoint;
use hamel::mechanism::{Body, BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::registry::{JointEntry, JointRegistry};
use hamel::spatial::{MassProperties, Pose, so3};
use rand::{RngExt, SeedableRng};
use std::cell::RefCell;
use std::sync::Arc;

/// Longest ϕ from home, rad and m: most of a half turn.
const REACH: f64 = 2.5;

/// Slanted, m/s².
const GRAVITY: Vector3<f64> = Vector3::new(0.8, -1.1, -9.7);

/// A mechanism with a state and applied efforts.
#[derive(Clone, Debug)]
pub struct Case {
    /// Which one, for messages.
    pub seed: u64,
    /// The mechanism.
    pub mechanism: Arc<Mechanism>,
    /// All joints' Q.
    pub q: Vec<f64>,
    /// v̄, of order 1.
    pub speeds: Vec<f64>,
    /// v̄̇, of order 1.
    pub rates: Vec<f64>,
    /// τ, one entry per degree of freedom, of order 1.
    pub efforts: Vec<f64>,
}

/// Every joint of the library with parameters that it allows, no two alike: a new spec enters by itself.
pub fn library() -> Vec<Arc<dyn AnyJoint>> {
    let mut all: Vec<Arc<dyn AnyJoint>> = vec![];
    macro_rules! add {
        ($module:ident, $type:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
            all.push(hamel::erased::erase::<$type, $n, $k, $s, $c>($example));
        };
    }
    hamel_joints::for_each_joint!(add);
    all
}

/// Joints with curves in their specs: polynomials by pieces.
const WITH_CURVES: [&str; 2] = ["cam_follower", "rail"];

/// The [`library`] without joints that have curves: where a piece ends a derivative of high order jumps, and differences of order 6 across it tell nothing.
pub fn without_knots() -> Vec<Arc<dyn AnyJoint>> {
    let is_smooth = |joint: &Arc<dyn AnyJoint>| !WITH_CURVES.contains(&joint.name());
    library().into_iter().filter(is_smooth).collect()
}

/// Every joint of a registry with parameters near 0.7, no two alike.
///
/// # Panics
/// Where a joint refuses all choices of them.
pub fn kinds(registry: &JointRegistry) -> Vec<Arc<dyn AnyJoint>> {
    let build = |entry: &JointEntry| {
        let ascending: Vec<f64> = (0..entry.parameters.len())
            .map(|i| 0.7 + 0.15 * i as f64)
            .collect();
        let descending: Vec<f64> = ascending.iter().rev().copied().collect();
        // A second one that is much smaller than the others, as a crank beside its ground.
        let small_second: Vec<f64> = (0..entry.parameters.len())
            .map(|i| if i == 1 { 0.2 } else { 0.9 + 0.1 * i as f64 })
            .collect();
        // Each a third of the one before it: the first is longer than all others together.
        let thirds: Vec<f64> = (0..entry.parameters.len())
            .map(|i| 0.9 / 3.0_f64.powi(i as i32))
            .collect();
        let built = (entry.build)(&ascending)
            .or_else(|_| (entry.build)(&descending))
            .or_else(|_| (entry.build)(&small_second))
            .or_else(|_| (entry.build)(&thirds));
        built.unwrap_or_else(|error| panic!("{error}"))
    };
    registry.entries().map(build).collect()
}

/// `count` cases on trees of 1 to `largest` joints of the given kinds, each kind at the root of some of them.
pub fn cases(
    kinds: &[Arc<dyn AnyJoint>],
    largest: usize,
    count: u64,
) -> impl Iterator<Item = Case> + '_ {
    (0..count).map(move |seed| case(kinds, largest, seed))
}

fn case(kinds: &[Arc<dyn AnyJoint>], largest: usize, seed: u64) -> Case {
    let size = 1 + seed as usize % largest;
    let root = &kinds[seed as usize % kinds.len()];
    rooted(kinds, root, GRAVITY, size, seed)
}

/// As [`cases`], with needles for every other body: their moments are as 1 to 1e-5, about an axis of the joint's child frame.
pub fn slender_cases(
    kinds: &[Arc<dyn AnyJoint>],
    largest: usize,
    count: u64,
) -> impl Iterator<Item = Case> + '_ {
    cases(kinds, largest, count).map(slender)
}

fn slender(case: Case) -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let bodies = case.mechanism.bodies().iter().enumerate();
    let specs = bodies.map(|(index, body)| match index.is_multiple_of(2) {
        true => BodySpec {
            child_placement: Pose::identity(),
            mass: needle(&mut random),
            ..spec(body)
        },
        false => spec(body),
    });
    let gravity = *case.mechanism.gravity();
    let mechanism = Mechanism::new(gravity, specs.collect()).expect("valid by construction");
    Case {
        mechanism: Arc::new(mechanism),
        ..case
    }
}

/// What a body was made of.
fn spec(body: &Body) -> BodySpec {
    BodySpec {
        name: body.name().to_owned(),
        joint_name: body.joint_name().to_owned(),
        parent: body.parent(),
        joint: body.shared_joint(),
        placement: *body.placement(),
        child_placement: *body.child_placement(),
        mass: *body.mass(),
    }
}

fn needle(random: &mut ChaCha8Rng) -> MassProperties {
    let moments = Matrix3::from_diagonal(&Vector3::new(0.7, 0.700_003, 1e-5));
    let com = Vector3::new(0.0, 0.0, random.random_range(-1.0..1.0));
    MassProperties::new(1.5, com, moments).expect("physical by construction")
}

/// `count` cases without gravity: trees of 1 to `largest` joints, the first of them `root` and the others of the given kinds.
pub fn weightless<'a>(
    kinds: &'a [Arc<dyn AnyJoint>],
    root: &'a Arc<dyn AnyJoint>,
    largest: usize,
    count: u64,
) -> impl Iterator<Item = Case> + 'a {
    let size = move |seed: u64| 1 + seed as usize % largest;
    (0..count).map(move |seed| rooted(kinds, root, Vector3::zeros(), size(seed), seed))
}

/// A tree of `size` joints, random except for the first.
fn rooted(
    kinds: &[Arc<dyn AnyJoint>],
    root: &Arc<dyn AnyJoint>,
    gravity: Vector3<f64>,
    size: usize,
    seed: u64,
) -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut joints = vec![Arc::clone(root)];
    for _ in 1..size {
        joints.push(Arc::clone(&kinds[random.random_range(0..kinds.len())]));
    }
    let mechanism = tree_in(&mut random, gravity, &joints);
    moving(random, mechanism, seed)
}

/// A mechanism in a random state.
fn moving(mut random: ChaCha8Rng, mechanism: Arc<Mechanism>, seed: u64) -> Case {
    let layout = *mechanism.layout();
    Case {
        seed,
        q: configuration(&mut random, &mechanism),
        speeds: numbers(&mut random, layout.speeds),
        rates: numbers(&mut random, layout.speeds),
        efforts: numbers(&mut random, layout.freedoms),
        mechanism,
    }
}

/// Numbers in [−1, 1).
pub fn numbers(random: &mut ChaCha8Rng, size: usize) -> Vec<f64> {
    (0..size).map(|_| random.random_range(-1.0..1.0)).collect()
}

fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.random_range(-1.0..1.0))
}

/// A tree on the given joints in slanted gravity: half of the bodies hang on the one before, the others on any before.
///
/// # Panics
/// Never, for joints that a mechanism accepts.
pub fn tree(random: &mut ChaCha8Rng, joints: &[Arc<dyn AnyJoint>]) -> Arc<Mechanism> {
    tree_in(random, GRAVITY, joints)
}

/// As [`tree`], in a gravity of one's own.
///
/// # Panics
/// Never, for joints that a mechanism accepts and a finite gravity.
pub fn tree_in(
    random: &mut ChaCha8Rng,
    gravity: Vector3<f64>,
    joints: &[Arc<dyn AnyJoint>],
) -> Arc<Mechanism> {
    grow(random, gravity, joints, |random, last| {
        match random.random_bool(0.5) {
            true => random.random_range(0..=last),
            false => last,
        }
    })
}

/// `count` bodies in slanted gravity, each on the one before by the same joint.
///
/// # Panics
/// Never, for a joint that a mechanism accepts.
pub fn chain(random: &mut ChaCha8Rng, joint: &Arc<dyn AnyJoint>, count: usize) -> Arc<Mechanism> {
    grow(
        random,
        GRAVITY,
        &vec![Arc::clone(joint); count],
        |_, last| last,
    )
}

/// A case of a trunk of one or two bodies with two to six like limbs of up to three joints, and up to three fingers of one joint on each.
///
/// # Panics
/// Never, for joints that a mechanism accepts.
pub fn limbs(kinds: &[Arc<dyn AnyJoint>], seed: u64) -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut any = |most: usize| -> Vec<Arc<dyn AnyJoint>> {
        let count = random.random_range(1..=most);
        let joints = (0..count).map(|_| Arc::clone(&kinds[random.random_range(0..kinds.len())]));
        joints.collect()
    };
    let (trunk, limb, finger) = (any(2), any(3), any(1));
    let count = random.random_range(2..=6);
    let fingers = random.random_range(0..=3);
    let mut joints: Vec<Arc<dyn AnyJoint>> = vec![];
    let mut parents: Vec<usize> = vec![];
    let mut size = 0;
    let mut add = |own: &[Arc<dyn AnyJoint>], mut parent: usize| {
        for joint in own {
            joints.push(Arc::clone(joint));
            parents.push(parent);
            size += 1 + joint.more().len();
            parent = size - 1;
        }
        parent
    };
    let top = add(&trunk, 0);
    for _ in 0..count {
        let end = add(&limb, top);
        for _ in 0..fingers {
            add(&finger, end);
        }
    }
    // The first has none.
    let parents = RefCell::new(parents.into_iter().skip(1));
    let next = |_: &mut ChaCha8Rng, last| parents.borrow_mut().next().unwrap_or(last);
    let mechanism = grow(&mut random, GRAVITY, &joints, next);
    moving(random, mechanism, seed)
}

/// Bodies on the given joints; `parent` chooses among those up to the last.
fn grow(
    random: &mut ChaCha8Rng,
    gravity: Vector3<f64>,
    joints: &[Arc<dyn AnyJoint>],
    parent: impl Fn(&mut ChaCha8Rng, usize) -> usize,
) -> Arc<Mechanism> {
    let mut bodies: Vec<BodySpec> = Vec::new();
    for joint in joints {
        let index = bodies.len();
        let first = BodySpec {
            name: format!("body {index}"),
            joint_name: format!("{} {index}", joint.name()),
            parent: index.checked_sub(1).map(|last| parent(random, last)),
            joint: Arc::clone(joint),
            placement: pose(random),
            child_placement: pose(random),
            mass: mass(random),
        };
        bodies.push(first.clone());
        for joint in joint.more() {
            bodies.push(BodySpec {
                name: format!("body {}", bodies.len()),
                joint,
                child_placement: pose(random),
                mass: mass(random),
                ..first.clone()
            });
        }
    }
    Arc::new(Mechanism::new(gravity, bodies).expect("valid by construction"))
}

fn pose(random: &mut ChaCha8Rng) -> Pose<f64> {
    Pose::new(so3::exp(&(vector(random) * 1.8)), vector(random))
}

/// A body of point masses on its principal axes, its centre of mass away from the frame's origin.
fn mass(random: &mut ChaCha8Rng) -> MassProperties {
    let axes = so3::exp(&(vector(random) * 1.8));
    let second = vector(random).map(|entry| 0.05 + entry.abs());
    let principal = Matrix3::from_diagonal(&second.map(|entry| second.sum() - entry));
    let inertia = axes * principal * axes.transpose();
    let symmetric = (inertia + inertia.transpose()) * 0.5;
    let mass = random.random_range(0.5..2.5);
    MassProperties::new(mass, vector(random), symmetric).expect("physical by construction")
}

/// Least distance from a singular set, in the value of its function: nearer, derivatives of high order grow beyond what differences resolve.
const CLEARANCE: f64 = 0.3;

/// The same as part of the value at home, where that is less: of a function in lengths, its scale is theirs.
const PART_OF_HOME: f64 = 0.5;

/// Most configurations that are drawn for one joint.
const MOST_DRAWS: usize = 1000;

/// Φ(home, ϕ) for every joint, |ϕ| up to 2.5, away from where a joint ends.
///
/// # Panics
/// Where a joint cannot be moved from home.
pub fn configuration(random: &mut ChaCha8Rng, mechanism: &Mechanism) -> Vec<f64> {
    let mut draw = |index: usize, size: usize| {
        let mut phi = numbers(random, size);
        let norm = phi.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        let scale = random.random_range(0.0..REACH) / norm.max(1e-3);
        phi.iter_mut().for_each(|entry| *entry *= scale);
        // Where relations alone give Φ, it has a value for ϕ that is not too long.
        mechanism.configuration_from_local(index, &phi).ok()
    };
    let own = |(index, size): (usize, usize)| {
        let joint = mechanism.bodies()[index].joint();
        let clearance = CLEARANCE.min(PART_OF_HOME * at_home(joint));
        let is_clear = |q: &Vec<f64>| joint.singularity(q) >= clearance;
        let mut draws = std::iter::repeat_with(|| draw(index, size))
            .take(MOST_DRAWS)
            .flatten();
        draws
            .find(is_clear)
            .expect("a configuration that the joint can be moved to")
    };
    let joints = mechanism.joints();
    let sizes = joints.map(|(index, body)| (index, body.ranges().freedoms.len()));
    sizes.flat_map(own).collect()
}

/// [`AnyJoint::singularity`] at home.
fn at_home(joint: &dyn AnyJoint) -> f64 {
    let mut home = vec![0.0; joint.layout().configuration];
    joint.home(&mut home);
    joint.singularity(&home)
}
