//! Linkages of the library written as robots with loops: the same bodies on the same motions.

use super::{begin, build, import};
use crate::linkages::accelerations;
use crate::trials::{FORMS, run, times};
use hamel::dynamics::{Recursive, Reference};
use hamel::integrate::{Method, Scheme};
use hamel_scene::Scene;
use std::sync::Arc;

/// The bodies as in the robots.
const BODIES: [[&str; 2]; 3] = [
    [
        "crank",
        "mass = 1.3, com = [0.05, 0.01, 0.0], inertia_xx_yy_zz_xy_xz_yz = [0.002, 0.004, 0.0055, 0.0, 0.0, 0.0]",
    ],
    [
        "",
        "mass = 0.8, com = [0.16, -0.02, 0.0], inertia_xx_yy_zz_xy_xz_yz = [0.001, 0.0095, 0.0101, 0.0, 0.0, 0.0]",
    ],
    [
        "",
        "mass = 1.9, com = [0.1, 0.02, 0.0], inertia_xx_yy_zz_xy_xz_yz = [0.004, 0.003, 0.005, 0.0002, 0.0, 0.0]",
    ],
];

fn of_library(joint: &str, [second, third]: [&str; 2], rate: &str) -> Scene {
    let [crank, other, last] = BODIES.map(|[_, keys]| keys);
    let text = format!(
        "hamel = 1\ngravity = [0.0, -9.81, 0.0]\n[[body]]\nname = \"linkage\"\nparent = \"world\"\njoint = {joint}\ninitial = {{ {rate} }}\n\
         bodies.crank = {{ {crank} }}\nbodies.{second} = {{ {other} }}\nbodies.{third} = {{ {last} }}\n"
    );
    Scene::parse(&text, "library", &hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// The direction of a unit vector in Q.
fn angle(q: &[f64], n: usize) -> f64 {
    q[2 * n + 1].atan2(q[2 * n])
}

/// Each linkage of the library, and the robot at the same start.
fn pairs() -> [(&'static str, Scene, Scene); 2] {
    let four_bar = of_library(
        "{ type = \"four_bar\", ground = 0.3, crank = 0.12, coupler = 0.35, rocker = 0.25 }",
        ["coupler", "rocker"],
        "rates.crank = 6.0",
    );
    let q = &four_bar.configuration;
    let [a, b, c] = [0, 1, 2].map(|n| angle(q, n));
    let mut robot = import("four_bar", [0.0, -9.81, 0.0]).scene;
    begin(
        &mut robot,
        &[
            ("a", Some(a), Some(6.0)),
            ("b", Some(b - a), None),
            ("c", Some(c), None),
        ],
    );
    let slider = of_library(
        "{ type = \"slider_crank\", crank = 0.12, rod = 0.35, offset = 0.04 }",
        ["rod", "slider"],
        "speeds = [5.0]",
    );
    let q = &slider.configuration;
    let [a, b] = [0, 1].map(|n| angle(q, n));
    let mut other = import("slider_crank", [0.0, -9.81, 0.0]).scene;
    begin(
        &mut other,
        &[
            ("a", Some(a), Some(5.0)),
            ("b", Some(b - a), None),
            ("c", Some(-b), None),
        ],
    );
    [
        ("four_bar", four_bar, build(&robot)),
        ("slider_crank", slider, build(&other)),
    ]
}

/// The place of the robot's body among those of the library's joint, by the end of its name.
fn order(library: &Scene, robot: &Scene) -> Vec<usize> {
    let names = library.mechanism.bodies().iter().map(|body| {
        let name = body.name().rsplit('.').next().unwrap_or("");
        robot
            .mechanism
            .body_index(name)
            .expect("a body of that name")
    });
    names.collect()
}

/// Ten roundings of the largest acceleration, times the condition of the dependent columns, below 10.
const ROUNDING: f64 = 100.0 * f64::EPSILON;

#[test]
fn accelerations_are_those_of_the_library() {
    for (name, library, robot) in pairs() {
        let places = order(&library, &robot);
        let expected = accelerations(
            &library,
            &mut Recursive::new(Arc::clone(&library.mechanism)),
        );
        let size = expected
            .iter()
            .flatten()
            .map(|own| own.amax())
            .fold(1.0, f64::max);
        let found = [
            accelerations(&robot, &mut Recursive::new(Arc::clone(&robot.mechanism))),
            accelerations(&robot, &mut Reference::new(Arc::clone(&robot.mechanism))),
        ];
        for found in found {
            for (expected, place) in expected.iter().zip(&places) {
                for (a, b) in found[*place].iter().zip(expected) {
                    let error = (a - b).amax() / size;
                    assert!(error < ROUNDING, "{name}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn motions_are_those_of_the_library() {
    for (name, library, robot) in pairs() {
        let places = order(&library, &robot);
        for form in FORMS {
            let method = Method::controlled(Scheme::Verner9, 1e-13);
            let samples = times(2.0);
            let [expected, found] = [&library, &robot].map(|scene| {
                let solution = run(scene, form, method, &samples);
                let poses = solution.samples.iter().map(|state| {
                    let found = scene
                        .mechanism
                        .kinematics(&state.configuration, &state.speeds);
                    let bodies = found.expect("finite").bodies.into_iter();
                    bodies.map(|body| body.pose.matrix()).collect::<Vec<_>>()
                });
                poses.collect::<Vec<_>>()
            });
            let away = expected.iter().zip(&found).flat_map(|(expected, found)| {
                let places = places.iter().zip(expected);
                places.map(|(place, own)| (found[*place] - own).amax())
            });
            let away = away.fold(0.0, f64::max);
            eprintln!("{name}, {form:?}: {away:e} m");
            // A few hundred steps of 1e-13, in a motion of ten turns in which neighbours part linearly.
            assert!(away < 1e-10, "{name}, {form:?}: {away:e}");
        }
    }
}
