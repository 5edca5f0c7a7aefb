//! What acts at joints that follow others, against one joint alone.

use crate::trials::{FORMS, fine_methods, run, scene, slide, times};
use hamel::integrate::Form;
use hamel_scene::Scene;

/// Two slides along one line, of which one follows the other by −2 q + 0.3, with everything that can act at either.
fn slides(leader: &str, follower: &str) -> Scene {
    let body = |name: &str, mass: f64, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"world\"\nmass = {mass:?}\njoint = {{ type = \"prismatic\" }}\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\n{keys}\n"
        )
    };
    let mimic = "mimic = { joint = \"a\", multiplier = -2.0, offset = 0.3 }\n";
    scene(&(body("b", 0.5, &format!("{mimic}{follower}")) + &body("a", 1.0, leader)))
}

/// At a leader, at its follower, and at one slide of 2 kg that does as both: its armature of 1 kg makes the mass of 1 kg and four times 0.5 kg.
const ACTING: [[&str; 3]; 6] = [
    // 8 (q − 0.1) − 2 · 3 (−2 q + 0.3 − 0.5) = 20 (q + 0.02).
    [
        "spring = { stiffness = 8.0, rest = { phi = [0.1] } }\ndamping = 0.5\narmature = 0.25",
        "spring = { stiffness = 3.0, rest = { phi = [0.5] } }\ndamping = 0.2\narmature = 0.5",
        "spring = { stiffness = 20.0, rest = { phi = [-0.02] } }\ndamping = 1.3\narmature = 3.25",
    ],
    [
        "effort = [\"0.3 * sin(3 * t)\"]",
        "effort = [\"0.2 * cos(t)\"]",
        "effort = [\"0.3 * sin(3 * t) - 0.4 * cos(t)\"]\narmature = 1.0",
    ],
    [
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.12, stiffness = 300.0, damping = 0.2 }",
        "",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.12, stiffness = 300.0, damping = 0.2 }\narmature = 1.0",
    ],
    // The follower is at 0.1 where its leader is at 0.1.
    [
        "effort = [\"4 * cos(5 * t)\"]",
        "limit = { lower = 0.1, stiffness = 80.0, damping = 0.1 }",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.1, stiffness = 320.0, damping = 0.2 }\narmature = 1.0",
    ],
    [
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { lower = -0.5, upper = 0.3, restitution = 0.5 }",
        "limit = { lower = 0.1, restitution = 0.5 }",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { lower = -0.5, upper = 0.1, restitution = 0.5 }\narmature = 1.0",
    ],
    [
        "effort = [\"2 * cos(2 * t)\"]\nfriction = 0.3",
        "friction = { sliding = 0.2, sticking = 0.4 }",
        "effort = [\"2 * cos(2 * t)\"]\nfriction = { sliding = 0.7, sticking = 1.1 }\narmature = 1.0",
    ],
];

/// What acts at a follower acts at what it follows, times the multiplier; stiffness, damping and inertia times its square.
#[test]
fn what_acts_at_a_follower_acts_at_what_it_follows() {
    const START: &str = "initial = { phi = [0.05], speeds = [0.3] }";
    for [leader, follower, alone] in ACTING {
        let coupled = slides(&format!("{START}\n{leader}"), follower);
        let alone = slide(&format!("{START}\n{alone}"));
        for form in FORMS {
            let [method, ..] = fine_methods(1e-3);
            let samples = times(2.0);
            let [found, expected] =
                [&coupled, &alone].map(|scene| run(scene, form, method, &samples));
            let pairs = found.samples.iter().zip(&expected.samples);
            let away = pairs.map(|(a, b)| (a.configuration[0] - b.configuration[0]).abs());
            let away = away.fold(0.0, f64::max);
            // Steps of both are held to 1e-12, some hundred of them, and impacts part what is near by a factor of ten.
            assert!(away < 1e-9, "{leader}, {follower}, {form:?}: {away:e}");
        }
    }
}

#[test]
fn a_prescribed_motion_is_that_of_the_follower_too() {
    let driven = slides(
        "motion = { speeds = [{ amplitude = 0.4, frequency = 2.0 }] }",
        "",
    );
    let [method, ..] = fine_methods(1e-3);
    let found = run(&driven, Form::Lagrangian, method, &times(2.0));
    let index = driven.mechanism.body_index("b").expect("the follower");
    for state in &found.samples {
        let bodies = driven
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        let bodies = bodies.expect("finite");
        let twice = -2.0 * state.speeds[0];
        assert!((bodies.bodies[index].twist[5] - twice).abs() < 1e-15);
        let place = -2.0 * state.configuration[0] + 0.3;
        assert!((bodies.bodies[index].pose.translation.z - place).abs() < 1e-15);
    }
}
