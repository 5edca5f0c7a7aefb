//! What acts at joints of a loop, and scenes that say in TOML what is closed.

use crate::trials::{FORMS, fine_methods, run, scene, times};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, integrate, no_inputs, no_observer};
use hamel_scene::Scene;
use std::sync::Arc;

fn parsed(text: &str) -> Scene {
    scene(text)
}

fn body(name: &str, parent: &str, keys: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 0.7\ncom = [0.1, 0.02, 0.0]\njoint = {{ type = \"revolute\" }}\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.001, 0.004, 0.0045, 0.0, 0.0, 0.0]\n{keys}\n"
    )
}

/// A parallelogram of cranks of 0.2 m, 0.3 m apart: both turn by the same angle, and its coupler does not turn.
fn parallelogram(at_crank: &str, at_rocker: &str) -> Scene {
    // A joint whose motion is prescribed has no speed of its own.
    let speed = if at_crank.contains("motion") {
        ""
    } else {
        ", speeds = [0.4]"
    };
    closed_parallelogram(
        &format!("initial = {{ phi = [0.8]{speed} }}\n{at_crank}"),
        &format!("initial = {{ phi = [0.8] }}\n{at_rocker}"),
    )
}

/// The parallelogram with these lines in the tables of its crank and its rocker.
fn closed_parallelogram(crank: &str, rocker: &str) -> Scene {
    let bodies = body("crank", "world", crank)
        + &body(
            "coupler",
            "crank",
            "at.position = [0.2, 0.0, 0.0]\ninitial = { phi = [-0.8] }",
        )
        + &body(
            "rocker",
            "world",
            &format!("at.position = [0.3, 0.0, 0.0]\n{rocker}"),
        );
    parsed(&format!(
        "{bodies}[[loop]]\nname = \"closed\"\ntype = \"revolute\"\nindependent = [\"crank\"]\n\
         predecessor = {{ body = \"coupler\", at.position = [0.3, 0.0, 0.0] }}\nsuccessor = {{ body = \"rocker\", at.position = [0.2, 0.0, 0.0] }}\n"
    ))
}

/// The same at the crank and at the rocker, which turns with it.
#[test]
fn what_acts_at_a_joint_of_a_loop_acts_on_all_of_it() {
    for acting in [
        "effort = [\"0.03 * sin(3 * t)\"]",
        "spring = { stiffness = 0.1, rest = { phi = [0.5] } }\ndamping = 0.01",
        "armature = 0.03\neffort = [0.02]",
        "effort = [0.05]\nlimit = { upper = 1.0, stiffness = 30.0, damping = 0.2 }",
        "effort = [\"0.05 * cos(2 * t)\"]\nfriction = 0.02",
    ] {
        let [at_crank, at_rocker] = [parallelogram(acting, ""), parallelogram("", acting)];
        for form in FORMS {
            let [_, _, method, ..] = fine_methods(1e-3);
            let samples = times(0.9);
            let [expected, found] =
                [&at_crank, &at_rocker].map(|scene| run(scene, form, method, &samples));
            let pairs = found.samples.iter().zip(&expected.samples);
            let away = pairs.map(|(a, b)| (a.configuration[0] - b.configuration[0]).abs());
            let away = away.fold(0.0, f64::max);
            // Steps of both are held to 1e-12, some hundred of them; where friction holds and lets go, to their time.
            eprintln!(
                "{acting}, {form:?}: {away:e}, {} steps",
                found.statistics.steps
            );
            assert!(away < 1e-9, "{acting}, {form:?}: {away:e}");
        }
    }
}

#[test]
fn a_prescribed_motion_drives_the_loop() {
    let driven = parallelogram(
        "motion = { speeds = [{ amplitude = 0.4, frequency = 2.0 }] }",
        "",
    );
    let [method, ..] = fine_methods(1e-3);
    for state in &run(&driven, FORMS[0], method, &times(2.0)).samples {
        let [crank, rocker, coupler] = [0, 1, 2].map(|k| state.configuration[k]);
        // The Newton steps of Φ end at a few roundings of the relations, which the dependent columns of condition 10 carry over.
        assert!((crank - rocker).abs() < 1e-13 && (crank + coupler).abs() < 1e-13);
    }
}

/// `y_b + y_c = 2 y_a − 0.3`: three turns in a row of which the sum is held, on the sliders of a differential.
#[test]
fn sums_of_positions_are_coupled() {
    let bodies = body("a", "world", "initial = { speeds = [0.5] }")
        + &body("b", "world", "at.position = [0.0, 0.4, 0.0]")
        + &body("c", "b", "at.position = [0.2, 0.0, 0.0]");
    let found = parsed(&format!(
        "{bodies}[[coupling]]\nname = \"sum\"\npredecessor = \"a\"\nsuccessor = \"c\"\nratio = 2.0\noffset = -0.3\nindependent = [\"a\", \"b\"]\n"
    ));
    for form in FORMS {
        let [method, ..] = fine_methods(1e-3);
        let solution = run(&found, form, method, &times(3.0));
        for state in &solution.samples {
            let [a, b, c] = [0, 1, 2].map(|k| state.configuration[k]);
            assert!((b + c - 2.0 * a + 0.3).abs() < 1e-14, "{a} {b} {c}");
        }
    }
}

/// A rate that is given where the joint is not independent says what the others are.
#[test]
fn rates_of_dependent_joints_give_speeds() {
    let given = closed_parallelogram(
        "initial = { phi = [0.8] }",
        "initial = { phi = [0.8], speeds = [0.7] }",
    );
    assert!((given.speeds[0] - 0.7).abs() < 1e-14, "{:?}", given.speeds);
}

/// A parallelogram that folds flat has another branch there: it stops by name, and soon.
#[test]
fn a_parallelogram_stops_where_it_folds_flat() {
    let scene = parallelogram("effort = [0.2]", "");
    let options = Options {
        form: Form::Lagrangian,
        method: Method::controlled(Scheme::Verner9, 1e-12),
        t_end: 5.0,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let (inputs, observer) = (&mut no_inputs, &mut no_observer);
    let stopped = integrate(&mut dynamics, &scene.start(), &options, inputs, observer);
    let stopped = stopped.expect_err("it folds flat").to_string();
    assert!(
        stopped.contains(
            "joint `closed` comes to a configuration that its spec excludes, where `det ∂g/∂y of the dependent coordinates = 0` is 0"
        ),
        "{stopped}"
    );
}
