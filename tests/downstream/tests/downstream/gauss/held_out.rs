//! The same for joints that the generator's tests hold out: what rolls and what is steered, by what its contacts keep of velocities.

use super::{Case, Source, check};
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::Expr;
use hamel_tests::gauss::{Ground, coordinate, parameter, pose};
use std::path::Path;

fn source() -> Source {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../codegen/tests/held-out");
    Source {
        registry: hamel_downstream::held_out(),
        folders: vec![folder],
    }
}

/// Checks a joint of one body.
fn check_held_out(name: &str, parameters: &[f64], reach: f64, ground: &[Ground]) {
    let case = Case {
        name,
        parameters,
        reach,
        ground,
        rotor: None,
    };
    check(&source(), &case);
}

#[test]
fn grashof_coupler() {
    check_held_out("grashof_coupler", &[0.9, 0.4, 1.1, 1.2], 0.5, &[]);
}

#[test]
fn polynomial_knee() {
    check_held_out("polynomial_knee", &[], 0.5, &[]);
}

#[test]
fn lemniscate() {
    check_held_out("lemniscate", &[0.7], 0.3, &[]);
}

/// The contact is at rest: a radius from the centre of the ball towards that of the sphere.
#[test]
fn ball_over_sphere() {
    let point = |joint: &Derived| {
        let centre = pose(joint, 0).1.entries();
        let [base, radius] = ["base", "radius"].map(|name| parameter(joint, name));
        let share = &radius * &(&base + &radius).recip().expect("not 0");
        [0, 1, 2].map(|i| -&(&share * &centre[i]))
    };
    check_held_out(
        "ball_over_sphere",
        &[0.9, 0.4],
        0.4,
        &[Ground::Sticks { point }],
    );
}

/// The contact is at rest: a radius from the centre of the ball away from the axis.
#[test]
fn ball_along_bore() {
    let point = |joint: &Derived| {
        let radius = parameter(joint, "radius");
        let [c, s] = ["u_c", "u_s"].map(|name| coordinate(joint, name));
        [&radius * &c, &radius * &s, Expr::integer(0)]
    };
    check_held_out(
        "ball_along_bore",
        &[0.9, 0.4],
        0.4,
        &[Ground::Sticks { point }],
    );
}

/// The contact is at rest: a radius from the centre of the ball, across the side of the cone.
#[test]
fn ball_over_cone() {
    let point = |joint: &Derived| {
        let [radius, half] = ["radius", "half"].map(|name| parameter(joint, name));
        let [c, s] = ["u_c", "u_s"].map(|name| coordinate(joint, name));
        let outward = [&half.cos() * &c, &half.cos() * &s, half.sin()];
        outward.map(|entry| -&(&radius * &entry))
    };
    check_held_out(
        "ball_over_cone",
        &[0.2, 0.6],
        0.4,
        &[Ground::Sticks { point }],
    );
}

/// A vector in axes of the body, in those of the joint.
fn turned(joint: &Derived, [x, y]: [Expr; 2]) -> [Expr; 3] {
    let rotation = pose(joint, 0).0;
    [0, 1, 2].map(|i| &(rotation.at(i, 0) * &x) + &(rotation.at(i, 1) * &y))
}

fn origin(_: &Derived) -> [Expr; 3] {
    [0; 3].map(Expr::integer)
}

fn ahead(joint: &Derived) -> [Expr; 3] {
    turned(joint, [1, 0].map(Expr::integer))
}

fn aside(joint: &Derived) -> [Expr; 3] {
    turned(joint, [0, 1].map(Expr::integer))
}

/// Neither axle slides along itself. A rotor carries the inertia of steering.
#[test]
fn car_steering() {
    let front = |joint: &Derived| turned(joint, [parameter(joint, "base"), Expr::integer(0)]);
    let axle = |joint: &Derived| {
        let steer = coordinate(joint, "steer");
        turned(joint, [-&steer.sin(), steer.cos()])
    };
    let ground = [(origin as _, aside as _), (front as _, axle as _)];
    let ground = ground.map(|(point, along)| Ground::Drives {
        point,
        along,
        by: None,
    });
    let case = Case {
        name: "car_steering",
        parameters: &[2.5],
        reach: 0.5,
        ground: &ground,
        rotor: Some(("steer", 3, 0.4)),
    };
    check(&source(), &case);
}

fn half(joint: &Derived) -> Expr {
    &parameter(joint, "track") * &Expr::fraction(1, 2)
}

/// The axle does not slide along itself, and each of its ends moves ahead as fast as its wheel rolls.
#[test]
fn differential_drive() {
    let left = |joint: &Derived| turned(joint, [Expr::integer(0), half(joint)]);
    let right = |joint: &Derived| turned(joint, [Expr::integer(0), -&half(joint)]);
    let ground = [
        Ground::Drives {
            point: origin,
            along: aside,
            by: None,
        },
        Ground::Drives {
            point: left,
            along: ahead,
            by: Some(("left", "radius")),
        },
        Ground::Drives {
            point: right,
            along: ahead,
            by: Some(("right", "radius")),
        },
    ];
    check_held_out("differential_drive", &[0.15, 0.6], 0.5, &ground);
}
