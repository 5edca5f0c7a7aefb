//! Joints that carry several bodies, against the inertia that a motor at the one degree of freedom feels: that of all bodies, by plane geometry.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector2, Vector3};
use std::sync::Arc;

/// Effort at the degree of freedom.
const EFFORT: f64 = 0.7;
/// Rounding of a sum of a few products, times a margin for the linkage near its dead points.
const ROUNDING: f64 = 1e-12;

/// A body that moves in a plane.
#[derive(Clone, Copy)]
struct Plate {
    /// kg
    mass: f64,
    /// In the body's frame, m.
    centre: [f64; 2],
    /// About the centre of mass, kg·m².
    inertia: f64,
}

/// The bodies of one joint, without gravity.
fn carried(joint: &str, parameters: &[f64], plates: &[Plate]) -> Arc<Mechanism> {
    let mut registry = JointRegistry::new();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let first = (registry.get(joint).expect("registered").build)(parameters).expect("it closes");
    let names = AnyJoint::bodies(&*first);
    assert_eq!(names.len(), plates.len());
    let joints = std::iter::once(first.clone()).chain(first.more());
    let bodies = names.iter().zip(joints).zip(plates);
    let bodies = bodies.map(|((name, joint), plate)| {
        let centre = Vector3::new(plate.centre[0], plate.centre[1], 0.0);
        let moments = Matrix3::from_diagonal(&Vector3::new(0.3, 0.3, plate.inertia));
        BodySpec {
            name: (*name).into(),
            joint_name: "linkage".into(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::new(plate.mass, centre, moments).expect("valid"),
        }
    });
    let mechanism = Mechanism::new(Vector3::zeros(), bodies.collect());
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

/// The acceleration from rest is the effort by the inertia, in both forms.
fn assert_inertia(mechanism: &Arc<Mechanism>, q: &[f64], inertia: f64) {
    let forms: [&mut dyn Dynamics; 2] = [
        &mut Recursive::new(Arc::clone(mechanism)),
        &mut Reference::new(Arc::clone(mechanism)),
    ];
    for dynamics in forms {
        let mut found = [0.0];
        dynamics
            .forward_dynamics(q, &[0.0], &[EFFORT], &mut found)
            .expect("regular");
        let error = found[0] * inertia / EFFORT - 1.0;
        assert!(error.abs() < ROUNDING, "at {q:?}: {error:e}");
    }
}

#[test]
fn a_rotor_counts_by_the_square_of_its_ratio() {
    let (ratio, shaft, rotor) = (5.5, 0.4, 0.02);
    let plate = |inertia| Plate {
        mass: 0.3,
        centre: [0.0, 0.0],
        inertia,
    };
    let mechanism = carried("geared_rotor", &[ratio], &[plate(shaft), plate(rotor)]);
    assert_inertia(&mechanism, &[0.3], shaft + ratio * ratio * rotor);
}

fn turned(angle: f64, [x, y]: [f64; 2]) -> Vector2<f64> {
    let (s, c) = angle.sin_cos();
    Vector2::new(c * x - s * y, s * x + c * y)
}

/// A vector turned by a quarter.
fn across(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// The inertia of a plate that turns at a rate about a pin which moves.
fn felt(plate: Plate, angle: f64, rate: f64, pin_speed: Vector2<f64>) -> f64 {
    let speed = pin_speed + across(turned(angle, plate.centre)) * rate;
    plate.inertia * rate * rate + plate.mass * speed.norm_squared()
}

const PLATES: [Plate; 3] = [
    Plate {
        mass: 0.4,
        centre: [0.1, 0.05],
        inertia: 0.02,
    },
    Plate {
        mass: 0.7,
        centre: [0.45, 0.2],
        inertia: 0.08,
    },
    Plate {
        mass: 0.9,
        centre: [-0.3, 0.6],
        inertia: 0.15,
    },
];

#[test]
fn all_links_of_a_four_bar_move_with_the_crank() {
    let links = [0.9, 0.4, 1.1, 1.2];
    let [ground, crank, coupler, rocker] = links;
    let mechanism = carried("crank_rocker", &links, &PLATES);
    for step in 0..12 {
        let a = f64::from(step) * 0.55;
        let pin = turned(a, [crank, 0.0]);
        // The triangle of coupler, rocker and the line from the crank's pin to the rocker's.
        let line = Vector2::new(ground, 0.0) - pin;
        let distance = line.norm();
        let cosine = (coupler * coupler + distance * distance - rocker * rocker)
            / (2.0 * coupler * distance);
        let b = line.y.atan2(line.x) + cosine.acos();
        let arm = turned(b, [coupler, 0.0]);
        let side = pin + arm - Vector2::new(ground, 0.0);
        let c = side.y.atan2(side.x);
        // The end of the coupler moves across the rocker alone.
        let speed = across(pin);
        let b_rate = -side.dot(&speed) / side.dot(&across(arm));
        let end = speed + across(arm) * b_rate;
        let c_rate = side.perp(&end) / (rocker * rocker);
        let inertia = felt(PLATES[0], a, 1.0, Vector2::zeros())
            + felt(PLATES[1], b, b_rate, speed)
            + felt(PLATES[2], c, c_rate, Vector2::zeros());
        let q = [a, b, c].map(|angle| [angle.cos(), angle.sin()]);
        assert_inertia(&mechanism, q.as_flattened(), inertia);
    }
}

#[test]
fn the_slider_moves_with_crank_and_rod() {
    let [rod, crank, offset] = [1.1, 0.4, 0.2];
    let mechanism = carried("slider_crank_links", &[rod, crank, offset], &PLATES);
    for step in 0..12 {
        let a = f64::from(step) * 0.55;
        let pin = turned(a, [crank, 0.0]);
        let b = ((offset - pin.y) / rod).asin();
        let arm = turned(b, [rod, 0.0]);
        let speed = across(pin);
        // The end of the rod stays on the slide.
        let b_rate = -speed.y / arm.x;
        let slide = speed + across(arm) * b_rate;
        let inertia = felt(PLATES[0], a, 1.0, Vector2::zeros())
            + felt(PLATES[1], b, b_rate, speed)
            + PLATES[2].mass * slide.norm_squared();
        let q = [a.cos(), a.sin(), b.cos(), b.sin(), pin.x + arm.x];
        assert_inertia(&mechanism, &q, inertia);
    }
}
