//! The law suite catches false kernels: each kernel of two joints is made wrong, everywhere and at places that are easily missed.
//!
//! Kernels are planted together, except for those by which the suite itself gets about. One by one, minutes:
//! `cargo test --package hamel-downstream --test downstream plants -- --ignored`.

use hamel_downstream::held_out::SphereSteer;
use hamel_joints::FallingDisk;
use hamel_tests::laws::search::{Effort, KERNELS, Plant, Planted, Where, search};
use std::path::Path;

/// By these the suite moves from one configuration to the next: alone, so that a wrong one does not make others look wrong.
const MOVING: [&str; 3] = ["home", "retract", "project"];

fn all_others() -> &'static [&'static str] {
    let others = KERNELS
        .iter()
        .copied()
        .filter(|kernel| !MOVING.contains(kernel));
    others.collect::<Vec<_>>().leak()
}

/// A disk whose point of contact and radius lie anywhere: Q is a rotation and a point of the plane, numbers 9 and 10.
fn falling_disk(plant: Plant) -> Vec<&'static str> {
    let derived = hamel_tests::derived("falling_disk");
    let build = |values: &[f64]| Planted {
        joint: FallingDisk::new(values[0]),
        plant,
    };
    let found = search::<_, 11, 5, 3, 2>(&derived, build, &[0.7], Effort::PLAIN);
    found.broken().into_iter().map(|(name, _)| name).collect()
}

/// A point that moves on both halves of a sphere: Q is a direction, its z axis is not 0.
fn sphere_steer(plant: Plant) -> Vec<&'static str> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../codegen/tests/held-out");
    let derived = hamel_tests::derived_in(&folder, "sphere_steer");
    let build = |values: &[f64]| Planted {
        joint: SphereSteer::new(values[0]),
        plant,
    };
    let found = search::<_, 3, 2, 1, 1>(&derived, build, &[0.7], Effort::PLAIN);
    found.broken().into_iter().map(|(name, _)| name).collect()
}

type Subject = fn(Plant) -> Vec<&'static str>;

/// The places of the disk: a feature 1e-3 wide 5 m from home, one of 1e-9, what is 1 km away, and radii below 0.1 mm.
const DISK: [Where; 5] = [
    Where::Everywhere,
    Where::Narrow {
        scalar: 9,
        at: 5.0,
        sharp: 1e6,
    },
    Where::Narrow {
        scalar: 10,
        at: -37.2,
        sharp: 1e18,
    },
    Where::Beyond(9, 1000.0),
    Where::Below(0, 1e-4),
];

/// The places of the sphere: the half without home, and a circle 1e-4 wide.
const SPHERE: [Where; 4] = [
    Where::Everywhere,
    Where::Side(2),
    Where::Narrow {
        scalar: 0,
        at: 0.3,
        sharp: 1e8,
    },
    Where::Below(0, 1e-4),
];

/// Kernels planted together are all named; what is not planted is not.
fn is_caught(subject: Subject, kernels: &'static [&'static str], place: Where) {
    // Home has no configuration to depend on, and the suite starts there.
    let applies =
        |kernel: &&str| *kernel != "home" || matches!(place, Where::Everywhere | Where::Below(..));
    let planted: Vec<&str> = kernels.iter().copied().filter(applies).collect();
    if planted.is_empty() {
        return;
    }
    let broken = subject(Plant { kernels, place });
    let missed: Vec<&&str> = planted
        .iter()
        .filter(|kernel| !broken.contains(kernel))
        .collect();
    assert!(missed.is_empty(), "not caught {place:?}: {missed:?}");
}

fn together(subject: Subject, places: &[Where]) {
    for place in places {
        is_caught(subject, all_others(), *place);
        for kernel in &MOVING {
            is_caught(subject, std::slice::from_ref(kernel), *place);
        }
    }
}

fn one_by_one(subject: Subject, places: &[Where]) {
    for place in places {
        for kernel in &KERNELS {
            is_caught(subject, std::slice::from_ref(kernel), *place);
        }
    }
}

#[test]
fn true_kernels_are_not_accused() {
    let plant = Plant {
        kernels: &[],
        place: Where::Everywhere,
    };
    assert_eq!(falling_disk(plant), Vec::<&str>::new());
    assert_eq!(sphere_steer(plant), Vec::<&str>::new());
}

#[test]
fn false_kernels_of_a_rolling_joint_are_caught() {
    together(falling_disk, &DISK);
}

#[test]
fn false_kernels_of_a_joint_in_two_parts_are_caught() {
    together(sphere_steer, &SPHERE);
}

#[test]
#[ignore = "minutes: each kernel at each place alone"]
fn each_false_kernel_is_caught_alone() {
    one_by_one(falling_disk, &DISK);
    one_by_one(sphere_steer, &SPHERE);
}
