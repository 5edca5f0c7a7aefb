//! Robots in URDF whose loops are closed by `<loop>`, as the oracle knows them.
//!
//! Q has the independent angles first, the others in the order of the bodies by their depth in the tree.

use super::linkages::{about, hinge};
use super::oracle::{Held, Linkage, Placed, inertia};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::Vector3;
use hamel::spatial::MassProperties;
use hamel_scene::urdf;
use std::path::Path;
use std::sync::Arc;

/// The robot's mechanism; `bodies` are its links in the oracle's order, which have the oracle's masses.
fn mechanism(linkage: &Linkage, bodies: &[&str]) -> Arc<Mechanism> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf/loops");
    let options = urdf::Options {
        gravity: Vector3::from(linkage.gravity),
        ..urdf::Options::default()
    };
    let import = urdf::load(folder.join(format!("{}.urdf", linkage.joint)), &options);
    let mut scene = import.unwrap_or_else(|errors| panic!("{errors}")).scene;
    for body in &mut scene.bodies {
        let number = bodies.iter().position(|name| *name == body.name.value);
        let (mass, centre, moments) = inertia(number.expect("a link of the oracle"));
        body.mass = MassProperties::new(mass, centre, moments).expect("valid");
    }
    let built = scene.build(&hamel_joints::registry());
    built.unwrap_or_else(|errors| panic!("{errors}")).mechanism
}

fn turned(axis: usize, angle: f64) -> hamel::nalgebra::Matrix3<f64> {
    about(axis, [angle.cos(), angle.sin()])
}

/// A frame at a point of another, turned about an axis.
fn on((rotation, at): Placed, point: [f64; 3], axis: usize, angle: f64) -> Placed {
    let own = rotation * turned(axis, angle);
    (own, at + rotation * Vector3::from(point))
}

const GROUND: Placed = (
    hamel::nalgebra::Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    Vector3::new(0.0, 0.0, 0.0),
);

pub(super) fn rssr() -> (Linkage, Arc<Mechanism>) {
    let zero = [0.0; 3];
    let held = [
        hinge(None, zero, Some(0), zero, 2),
        hinge(Some(0), [0.15, 0.0, 0.02], Some(1), zero, 1),
        hinge(Some(1), zero, Some(2), zero, 2),
        hinge(None, [0.5, 0.1, 0.05], Some(3), zero, 1),
    ];
    let mut held = held.concat();
    held.push(Held::Pin(
        Some(2),
        [0.55, 0.0, 0.0],
        Some(3),
        [0.0, 0.0, 0.35],
    ));
    let linkage = Linkage {
        joint: "rssr",
        parameters: &[],
        placed: |q| {
            let crank = on(GROUND, [0.0; 3], 2, q[0]);
            let cross = on(crank, [0.15, 0.0, 0.02], 1, q[2]);
            let rod = on(cross, [0.0; 3], 2, q[3]);
            vec![crank, cross, rod, on(GROUND, [0.5, 0.1, 0.05], 1, q[1])]
        },
        held,
        driven: vec![(0, [0.0, 0.0, 1.0])],
        speeds: &[2.0],
        gravity: [0.3, -0.4, -5.0],
    };
    let mechanism = mechanism(&linkage, &["crank", "cross", "rod", "rocker"]);
    (linkage, mechanism)
}

pub(super) fn ankle() -> (Linkage, Arc<Mechanism>) {
    let zero = [0.0; 3];
    let mut held = vec![];
    for (n, side) in [(0, 0.04), (1, -0.04)] {
        held.extend(hinge(None, [0.0, side, 0.25], Some(n), zero, 1));
    }
    held.extend(hinge(None, zero, Some(2), zero, 1));
    held.extend(hinge(Some(2), zero, Some(3), zero, 0));
    for (n, side) in [(0, 0.04), (1, -0.04)] {
        let (cross, rod) = (4 + 2 * n, 5 + 2 * n);
        held.extend(hinge(Some(n), [-0.05, 0.0, 0.0], Some(cross), zero, 1));
        held.extend(hinge(Some(cross), zero, Some(rod), zero, 0));
        let heel = [-0.06, side, 0.0];
        held.push(Held::Pin(Some(rod), [0.0, 0.0, -0.26], Some(3), heel));
    }
    let linkage = Linkage {
        joint: "ankle",
        parameters: &[],
        placed: |q| {
            let [left, right, pitch, roll, left_u, right_u, left_w, right_w] = q else {
                return vec![];
            };
            let left = on(GROUND, [0.0, 0.04, 0.25], 1, *left);
            let right = on(GROUND, [0.0, -0.04, 0.25], 1, *right);
            let cross = on(GROUND, [0.0; 3], 1, *pitch);
            let foot = on(cross, [0.0; 3], 0, *roll);
            let end = [-0.05, 0.0, 0.0];
            let (first, second) = (on(left, end, 1, *left_u), on(right, end, 1, *right_u));
            let rods = [
                on(first, [0.0; 3], 0, *left_w),
                on(second, [0.0; 3], 0, *right_w),
            ];
            vec![left, right, cross, foot, first, rods[0], second, rods[1]]
        },
        held,
        driven: vec![(0, [0.0, 1.0, 0.0]), (1, [0.0, 1.0, 0.0])],
        speeds: &[0.5, -0.3],
        gravity: [-4.0, 0.5, -3.0],
    };
    let bodies = [
        "left",
        "right",
        "cross",
        "foot",
        "left_cross",
        "left_rod",
        "right_cross",
        "right_rod",
    ];
    let mechanism = mechanism(&linkage, &bodies);
    (linkage, mechanism)
}
