//! Loops that come to where their dependent joints do not follow: they stop there by name, whatever moves them.

use super::super::trials::{FORMS, scene};
use hamel::dynamics::Recursive;
use hamel::integrate::{
    Form, IntegrateError, Method, Options, Scheme, Step, StepFailure, integrate, no_inputs,
};
use hamel_scene::Scene;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;

fn body(name: &str, parent: &str, x: [f64; 2], initial: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 1.0\ncom = [0.05, 0.02, 0.01]\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.01, 0.012, 0.014, 0.001, -0.001, 0.0005]\njoint = {{ type = \"revolute\" }}\n\
         at.position = [{:?}, {:?}, 0.0]\ninitial = {{ {initial} }}\n",
        x[0], x[1]
    )
}

fn closure(
    name: &str,
    [first, second]: [&str; 2],
    [x, y]: [f64; 2],
    at: f64,
    more: &str,
) -> String {
    format!(
        "[[loop]]\nname = \"{name}\"\ntype = \"revolute\"\npredecessor = {{ body = \"{first}\", at.position = [{at:?}, 0.0, 0.0] }}\n\
         successor = {{ body = \"{second}\", at.position = [{x:?}, {y:?}, 0.0] }}\n{more}\n"
    )
}

/// Five links in a plane, of two loops: a rod of the first carries one of the second.
fn two_loops() -> Scene {
    let mut text = body("a", "world", [0.0; 2], "phi = [1.2], speeds = [3.0]");
    for (name, parent, at, phi) in [
        ("b", "a", [0.2, 0.0], -1.0),
        ("c", "world", [0.5, 0.0], 1.5),
        ("d", "b", [0.3, 0.2], 0.0),
        ("e", "world", [1.0, 0.1], 1.7),
    ] {
        let initial = format!("phi = [{phi:?}]");
        text += &body(name, parent, at, &initial);
    }
    let [first, second] = [
        [0.276_073_169_872_334_05, 0.006_042_268_532_022_443],
        [0.461_283_284_283_325_55, 0.124_815_603_211_477_55],
    ];
    // Of the crank, of the rod that carries the other and of the last link, it is the rod whose rate is v.
    _ = write!(
        text,
        "{}{}",
        closure("first", ["b", "c"], first, 0.45, "independent = [\"b\"]"),
        closure("second", ["d", "e"], second, 0.5, "")
    );
    scene(&text)
}

/// A parallelogram at an angle of its cranks, whose rate is 3 rad/s one way or the other.
fn parallelogram(angle: f64, speed: f64) -> Scene {
    let turned = |angle: f64| format!("phi = [{angle:?}]");
    let initial = format!("phi = [{angle:?}], speeds = [{speed:?}]");
    scene(&format!(
        "{}{}{}{}",
        body("a", "world", [0.0; 2], &initial),
        body("b", "a", [0.2, 0.0], &turned(-angle)),
        body("c", "world", [0.5, 0.0], &turned(angle)),
        closure("l", ["b", "c"], [0.2, 0.0], 0.5, "independent = [\"a\"]")
    ))
}

/// How a motion ends, and the number of its steps.
fn moved(scene: &Scene, form: Form, method: Method) -> (IntegrateError, usize) {
    let options = Options {
        form,
        method,
        t_end: 2.0,
        samples: vec![],
    };
    let mut steps = 0;
    let mut observer = |step: &Step<'_>| {
        steps = step.number;
        match steps < 30_000 {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let ended = integrate(
        &mut dynamics,
        &scene.start(),
        &options,
        &mut no_inputs,
        &mut observer,
    );
    let Err(error) = ended else {
        panic!("{form:?}, {method:?}: it goes on");
    };
    (error, steps)
}

/// Methods that take long steps, by their size or their tolerance.
const LONG: [Method; 9] = [
    Method::fixed(Scheme::Rk4, 1e-3),
    Method::fixed(Scheme::Rk4, 3e-2),
    Method::fixed(Scheme::CommutatorFree4, 1e-3),
    Method::fixed(Scheme::Midpoint, 1e-3),
    Method::fixed(Scheme::Gauss3, 1e-2),
    Method::controlled(Scheme::DormandPrince, 0.1),
    Method::controlled(Scheme::DormandPrince, 0.05),
    Method::controlled(Scheme::DormandPrince8, 0.1),
    Method::controlled(Scheme::Exponential, 1e-2),
];

/// Φ stays on its branch, so that a step over the end leads back as it came: it is not seen in ϕ.
#[test]
fn steps_do_not_lead_back_from_an_end() {
    let scene = two_loops();
    let exact = moved(&scene, FORMS[0], Method::controlled(Scheme::Verner9, 1e-12)).0;
    let IntegrateError::Excluded(exact) = exact else {
        panic!("{exact}");
    };
    for form in FORMS {
        for method in LONG {
            let (error, steps) = moved(&scene, form, method);
            eprintln!("{form:?}, {method:?}: {steps} steps, {error}");
            let (joint, time) = match &error {
                IntegrateError::Excluded(end) => (&end.joint, end.time),
                // Steps of fixed size that are too long near the end.
                IntegrateError::Step { time, cause, .. } => match &**cause {
                    StepFailure::NotClosed { joint }
                    | StepFailure::Excluded { joint, .. }
                    | StepFailure::NoConvergence { joint, .. } => (joint, *time),
                    _ => panic!("{form:?}, {method:?}: {error}"),
                },
                _ => panic!("{form:?}, {method:?}: {error}"),
            };
            assert_eq!(joint, "first+second", "{form:?}, {method:?}");
            // The longest step but one: what is long is not accurate.
            let away = (time - exact.time).abs();
            assert!(away < 6e-2, "{form:?}, {method:?}: {time} s");
        }
    }
}

/// Away from the fold and into it; what it ends by is a part of the linkage, not of where it began.
#[test]
fn a_parallelogram_that_begins_nearly_folded_ends_where_it_folds() {
    for (speed, expected) in [(3.0, std::f64::consts::PI - 1e-3), (-3.0, 1e-3)] {
        let scene = parallelogram(1e-3, speed);
        for form in FORMS {
            for method in [
                Method::controlled(Scheme::DormandPrince, 1e-8),
                Method::controlled(Scheme::DormandPrince8, 1e-10),
                Method::controlled(Scheme::Exponential, 1e-8),
                Method::controlled(Scheme::Radau5, 1e-8),
            ] {
                let (error, steps) = moved(&scene, form, method);
                eprintln!("{speed} rad/s, {form:?}, {method:?}: {steps} steps, {error}");
                let IntegrateError::Excluded(end) = error else {
                    panic!("{speed} rad/s, {form:?}, {method:?}: {error}");
                };
                // Both cranks turn at one rate and the coupler at none, so that the energy keeps the rate except for the coupler's own inertia, which does not turn.
                let away = end.time * 3.0 - expected;
                assert!(away.abs() < 5e-4, "{speed} rad/s, {form:?}: {away}");
            }
        }
    }
}
