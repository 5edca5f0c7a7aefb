//! Linkages, gears and parallel robots, of the library and of this crate, against Gauss's principle in 256 bits, from their specs alone: accelerations of all bodies by the tree and by the reference
//! form, and efforts of inverse dynamics at them; and their energy over ten seconds.

mod energy;
mod held_out;

use hamel::dynamics::{Dynamics, Frame, MassMatrix, Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::mechanism::{BodySpec, Mechanism, NamedFrame};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose};
use hamel_codegen::derived::Derived;
use hamel_tests::figures::Largest;
use hamel_tests::gauss::{Acceleration, Gauss, Ground, Inertia};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6xX, Vector3};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// States of each joint.
const STATES: u64 = 8;

/// Joints by name, and the folders of their specs.
struct Source {
    registry: JointRegistry,
    folders: Vec<PathBuf>,
}

impl Source {
    /// The library's joints and those of this crate.
    fn new() -> Self {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        Self {
            registry: crate::common::registry(),
            folders: vec![here.join("../../joint-specs"), here.join("joints")],
        }
    }

    fn derived(&self, name: &str) -> Derived {
        let mut folders = self.folders.iter();
        let folder = folders.find(|folder| folder.join(format!("{name}.joint")).exists());
        hamel_tests::derived_in(folder.expect("a spec"), name)
    }
}

/// A joint on the ground.
struct Case<'a> {
    name: &'a str,
    parameters: &'a [f64],
    /// Local coordinates of its states are below this.
    reach: f64,
    /// What keeps its velocities beside its relations.
    ground: &'a [Ground],
    /// The moment of inertia of a rotor that turns as fast as a stored scalar changes, and the place of its effort.
    rotor: Option<(&'a str, usize, f64)>,
}

/// Mass properties of the n-th body, without symmetry.
fn inertia(n: usize) -> Inertia {
    let n = n as f64;
    let centre = Vector3::new(0.05 + 0.02 * n, 0.03, -0.01 * n % 0.05);
    let about = Matrix3::new(
        0.02,
        1e-3,
        5e-4,
        1e-3,
        0.03,
        -2e-3,
        5e-4,
        -2e-3,
        0.025 + 0.003 * (n % 5.0),
    );
    (0.8 + 0.3 * n, centre, about)
}

/// A joint on the ground, with a frame in the centre of mass of each body.
fn mechanism(source: &Source, case: &Case<'_>, gravity: Vector3<f64>) -> Arc<Mechanism> {
    let Case {
        name, parameters, ..
    } = *case;
    let entry = source.registry.get(name).expect("registered");
    let first = (entry.build)(parameters).unwrap_or_else(|error| panic!("{name}: {error}"));
    let joints = std::iter::once(first.clone()).chain(first.more());
    let bodies = joints.enumerate().map(|(n, joint)| {
        let (mass, centre, about) = inertia(n);
        BodySpec {
            name: format!("body {n}"),
            joint_name: name.into(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::new(mass, centre, about).expect("valid"),
        }
    });
    let bodies: Vec<BodySpec> = bodies.collect();
    let frames = bodies.iter().enumerate().map(|(n, body)| NamedFrame {
        name: format!("com {n}"),
        body: Some(n),
        at: Pose::from_translation(body.mass.com),
    });
    let frames = frames.collect();
    let mechanism = Mechanism::new(gravity, bodies).unwrap_or_else(|errors| panic!("{errors:?}"));
    let mechanism = mechanism.with_frames(frames).expect("they fit");
    Arc::new(match case.rotor {
        None => mechanism,
        Some((_, place, inertia)) => {
            let mut armature = vec![0.0; mechanism.layout().freedoms];
            armature[place] = inertia;
            mechanism
                .with_armature(0, &armature)
                .expect("it is a speed")
        }
    })
}

/// The same accelerations of bodies by the runtime, at these v̄̇.
fn accelerations(
    mechanism: &Arc<Mechanism>,
    (q, speeds): (&[f64], &[f64]),
    rates: &[f64],
) -> Vec<Acceleration> {
    let mut recursive = Recursive::new(Arc::clone(mechanism));
    let readings = recursive.readings(q, speeds).expect("sizes fit");
    let rates = DVector::from_column_slice(rates);
    let of_body = |index: usize| {
        let frame = readings.frame(index).expect("a frame");
        let mut jacobian = Matrix6xX::zeros(rates.len());
        let written = frame.jacobian(Frame::WorldAligned, jacobian.as_mut_slice());
        written.expect("sizes fit");
        let rate = jacobian * &rates + frame.jacobian_rate_product(Frame::WorldAligned);
        let angular = frame.pose().rotation.transpose() * rate.fixed_rows::<3>(0);
        [angular, rate.fixed_rows::<3>(3).into_owned()]
    };
    (0..mechanism.bodies().len()).map(of_body).collect()
}

/// By what an error of Q is multiplied: the condition of the mass matrix, and how much faster dependent coordinates move than independent ones, twice, since
/// accelerations hold squares of rates.
fn condition(mechanism: &Arc<Mechanism>, q: &[f64]) -> f64 {
    let mut mass = MassMatrix::new(mechanism);
    let mut recursive = Recursive::new(Arc::clone(mechanism));
    recursive.mass_matrix(q, &mut mass).expect("sizes fit");
    let values = mass.matrix().singular_values();
    let joint = mechanism.bodies()[0].joint();
    let count = joint.layout().speeds;
    let mut basis = DMatrix::zeros(q.len(), count);
    for (n, mut column) in basis.column_iter_mut().enumerate() {
        let mut speeds = vec![0.0; count];
        speeds[n] = 1.0;
        column.copy_from_slice(&rates(joint, q, &speeds));
    }
    values.max() / values.min() * basis.amax().max(1.0).powi(2)
}

/// Q̇ at these v̄, by v = S̄ v̄.
fn rates(joint: &dyn AnyJoint, q: &[f64], speeds: &[f64]) -> Vec<f64> {
    let mut basis = DMatrix::zeros(joint.layout().freedoms, speeds.len());
    joint.speed_basis(q, basis.as_mut_slice());
    let velocity = basis * DVector::from_column_slice(speeds);
    let mut rates = vec![0.0; q.len()];
    joint.configuration_rate(q, velocity.as_slice(), &mut rates);
    rates
}

/// A number in [−1, 1) by its place.
fn random(seed: u64) -> f64 {
    let mixed = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Holds the joint to the principle at all its states.
fn check(source: &Source, case: &Case<'_>) {
    let Case { name, reach, .. } = *case;
    let derived = source.derived(name);
    let mut gauss = Gauss::new(&derived, case.parameters, case.ground);
    if let Some((coordinate, _, inertia)) = case.rotor {
        gauss = gauss.with_rotor(coordinate, inertia);
    }
    let gravity = Vector3::new(0.7, -0.9, -9.7);
    let mechanism = mechanism(source, case, gravity);
    let joint = mechanism.bodies()[0].joint();
    let (freedoms, count) = (joint.layout().freedoms, joint.layout().speeds);
    let inertias: Vec<Inertia> = (0..mechanism.bodies().len()).map(inertia).collect();
    let mut worst = [
        Largest::new("accelerations, tree"),
        Largest::new("accelerations, reference form"),
        Largest::new("inverse dynamics"),
    ];
    for state in 0..STATES {
        let draw = |kind: u64, n: usize| random(1000 * state + 100 * kind + n as u64);
        let phi: Vec<f64> = (0..freedoms).map(|n| reach * draw(1, n)).collect();
        let speeds: Vec<f64> = (0..count).map(|n| 2.0 * draw(2, n)).collect();
        let mut q = vec![0.0; mechanism.home().len()];
        joint.retract(&mechanism.home(), &phi, &mut q);
        let moving = rates(joint, &q, &speeds);
        let expected = gauss.accelerations((&q, &moving), &inertias, &gravity);
        let size = expected
            .iter()
            .flatten()
            .map(Vector3::amax)
            .fold(1.0, f64::max);
        let unit = f64::EPSILON * condition(&mechanism, &q) * size;
        let forms: [Box<dyn Dynamics>; 2] = [
            Box::new(Recursive::new(Arc::clone(&mechanism))),
            Box::new(Reference::new(Arc::clone(&mechanism))),
        ];
        for (mut form, worst) in forms.into_iter().zip(&mut worst) {
            let mut rates = vec![0.0; count];
            let solved = form.forward_dynamics(&q, &speeds, &vec![0.0; freedoms], &mut rates);
            solved.unwrap_or_else(|error| panic!("{name}: {error}"));
            let found = accelerations(&mechanism, (&q, &speeds), &rates);
            let pairs = found.iter().flatten().zip(expected.iter().flatten());
            let error = pairs.map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            worst.meet(error / unit, format!("state {state} of {name}"));
        }
        let mut tree = Recursive::new(Arc::clone(&mechanism));
        let (mut rates, mut back) = (vec![0.0; count], vec![0.0; count]);
        let efforts: Vec<f64> = (0..freedoms).map(|n| draw(3, n)).collect();
        tree.forward_dynamics(&q, &speeds, &efforts, &mut rates)
            .expect("regular");
        tree.inverse_dynamics(&q, &speeds, &rates, &mut back)
            .expect("sizes fit");
        let mut reduced = vec![0.0; count];
        joint.reduce_efforts(&q, &efforts, &mut reduced);
        let error = reduced
            .iter()
            .zip(&back)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        worst[2].meet(error / unit, format!("state {state} of {name}"));
    }
    // Errors of single roundings, by the condition: as the projected equations may have them.
    worst.iter().for_each(|worst| worst.assert_within(10.0));
    energy::is_kept(&self::mechanism(source, case, Vector3::zeros()), case);
}

/// A joint of the library or of this crate.
fn check_on(name: &str, parameters: &[f64], reach: f64, ground: &[Ground]) {
    let case = Case {
        name,
        parameters,
        reach,
        ground,
        rotor: None,
    };
    check(&Source::new(), &case);
}

macro_rules! tests {
    ($($name:ident: $parameters:expr, $reach:expr;)*) => {$(
        #[test]
        fn $name() {
            check_on(stringify!($name), &$parameters, $reach, &[]);
        }
    )*};
}

tests! {
    cam_follower: [0.2], 0.5;
    crank_coupler: [0.9, 0.4, 1.1, 1.2], 0.5;
    crank_rocker: [0.9, 0.4, 1.1, 1.2], 0.5;
    delta: [0.2, 0.35, 0.74], 0.1;
    differential: [2.0], 0.5;
    five_bar: [0.3, 0.2, 0.3, 0.22, 0.28], 0.1;
    five_bar_left: [0.3, 0.2, 0.3, 0.22, 0.28], 0.1;
    five_bar_rods: [0.3, 0.2, 0.3, 0.22, 0.28], 0.1;
    four_bar: [0.9, 0.4, 1.1, 1.2], 0.5;
    geared_revolute: [5.5], 0.5;
    parallel_ankle: [0.25, 0.04, 0.05, 0.06, 0.25], 0.2;
    rail: [2.0, 0.3, 0.2], 0.3;
    rollers: [0.3], 0.5;
    scissor: [0.4], 0.2;
    slider_crank: [0.12, 0.35, 0.05], 0.5;
    stewart: [0.7, 0.4], 0.2;
    three_rrr: [0.9, 0.3, 0.5, 0.3], 0.1;
    wishbone: [0.35, 0.28, 0.2, 0.2, 0.35, 0.1], 0.2;
}

/// The origin of the chassis, in the middle of its axle, does not move along it.
const REAR_AXLE: Ground = Ground::Holds {
    body: 0,
    ahead: None,
    axle: 0,
};

fn rolls(wheel: usize) -> Ground {
    let radius = "radius";
    Ground::Rolls { wheel, radius }
}

/// Bodies: chassis, wheels at the front left, front right, rear left and rear right.
#[test]
fn car() {
    let front = Ground::Holds {
        body: 0,
        ahead: Some("base"),
        axle: 1,
    };
    let ground = [REAR_AXLE, front, rolls(1), rolls(2), rolls(3), rolls(4)];
    check_on("car", &[2.7, 0.8, 0.33], 0.5, &ground);
}

/// Bodies: chassis, left and right wheel.
#[test]
fn differential_drive() {
    let ground = [REAR_AXLE, rolls(1), rolls(2)];
    check_on("differential_drive", &[0.2, 0.08], 0.5, &ground);
}
