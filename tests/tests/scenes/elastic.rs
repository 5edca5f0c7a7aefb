//! Motors behind springs and backlash, against closed forms of two inertias.

use super::trials::{FORMS, error, fine_methods, run, scene, times};
use hamel::integrate::{Method, Scheme};
use hamel_scene::Scene;
use std::f64::consts::PI;

/// A rotor of 2e-5 kg m² behind a gear of 100 is 0.2 kg m² at the joint; the link has 0.5 kg m².
const MOTOR: f64 = 0.2;
const LINK: f64 = 0.5;
const STIFFNESS: f64 = 30.0;

fn driven(effort: &str, more: &str) -> Scene {
    scene(&format!(
        "[[body]]\nname = \"link\"\nparent = \"world\"\nmass = 1.0\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.5, 0.5, 0.5, 0.0, 0.0, 0.0]\n\
         joint = {{ type = \"revolute\", name = \"elbow\" }}\n\
         elastic = {{ stiffness = {STIFFNESS}, rotor = 2e-5, ratio = 100.0{more} }}\n\
         effort = [{effort}]\ninitial.speeds = [0.7]\n"
    ))
}

/// `ω² = k (1/J_m + 1/J_l)`.
fn frequency() -> f64 {
    (STIFFNESS * (1.0 / MOTOR + 1.0 / LINK)).sqrt()
}

/// Coordinates and speeds from what the effort makes of the momentum (both of its integrals), the deflection and its rate; both inertias begin at `rate`.
fn both(momentum: (f64, f64), deflection: (f64, f64), rate: f64, t: f64) -> (Vec<f64>, Vec<f64>) {
    let all = MOTOR + LINK;
    let motor = |total: f64, turn: f64| (total - LINK * turn) / all;
    let angle = motor(momentum.1 + all * rate * t, deflection.0);
    let speed = motor(momentum.0 + all * rate, deflection.1);
    (vec![angle, deflection.0], vec![speed, deflection.1])
}

/// An effort of 3 N m on the motor from 0.4 s on: the deflection swings about `−τ/(J_m ω²)`.
#[test]
fn a_motor_drives_its_link_through_a_spring() {
    let scene = driven("\"3*step(t - 0.4)\"", "");
    let names: Vec<&str> = scene
        .mechanism
        .bodies()
        .iter()
        .map(|b| b.joint_name())
        .collect();
    assert_eq!(names, ["elbow.motor", "elbow"]);
    let expected = |t: f64| {
        let (w, past) = (frequency(), (t - 0.4).max(0.0));
        let rest = 3.0 / (MOTOR * w * w);
        let deflection = (
            -rest * (1.0 - (w * past).cos()),
            -rest * w * (w * past).sin(),
        );
        both((3.0 * past, 1.5 * past * past), deflection, 0.7, t)
    };
    for form in FORMS {
        for method in fine_methods(5e-3) {
            let found = error(&run(&scene, form, method, &times(2.0)), expected);
            println!("{form:?}, {method:?}: {found:.1e}");
            assert!(found < 1e-9, "{form:?}, {method:?}: {found:e}");
        }
    }
}

/// A constant effort on the motor: it flies freely through half the backlash, is thrown back by the spring, returns, and so on. The link stands
/// still until the first contact.
#[test]
fn backlash_is_free_flight_between_stops() {
    let (effort, backlash) = (3.0, 0.02);
    let scene = driven("3.0", ", backlash = 0.02");
    let w = frequency();
    let pull = effort / MOTOR;
    // x: the deflection beyond its stop, in the sense in which the motor runs ahead.
    let first = (backlash / pull).sqrt();
    let speed = pull * first;
    let rest = pull / (w * w);
    let contact = 2.0 / w * (PI - (speed / (rest * w)).atan());
    let period = contact + 2.0 * speed / pull;
    let expected = |t: f64| {
        let past = t - first;
        let (x, v) = if past < 0.0 {
            (-0.5 * backlash + 0.5 * pull * t * t, pull * t)
        } else {
            let rest_of = past - (past / period).floor() * period;
            match rest_of - contact {
                free if free >= 0.0 => (
                    -speed * free + 0.5 * pull * free * free,
                    -speed + pull * free,
                ),
                _ => {
                    let (sin, cos) = (w * rest_of).sin_cos();
                    (
                        rest * (1.0 - cos) + speed / w * sin,
                        rest * w * sin + speed * cos,
                    )
                }
            }
        };
        let deflection = (-x - 0.5 * backlash, -v);
        both((effort * t, 0.5 * effort * t * t), deflection, 0.7, t)
    };
    for form in FORMS {
        for scheme in [Scheme::DormandPrince8, Scheme::Verner9, Scheme::Radau5] {
            let method = Method::controlled(scheme, 1e-13);
            let found = error(&run(&scene, form, method, &times(1.0)), expected);
            println!("{form:?}, {scheme:?}: {found:.1e}");
            assert!(found < 1e-9, "{form:?}, {scheme:?}: {found:e}");
        }
    }
}
