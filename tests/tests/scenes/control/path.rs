//! A cart on its path, alone and with what it drags.

use super::{EXACT, largest, last, parse, run, scene, text};
use hamel::control::{ControlError, Curve, PathFollower, PathGains};
use hamel::integrate::{Method, Scheme};
use hamel::time_function::Law;
use std::sync::Arc;

const METHOD: Method = Method::controlled(Scheme::DormandPrince8, 1e-10);

#[test]
fn a_cart_comes_to_its_path_and_stays_there() {
    let scene = scene("cart_path");
    let (_, readings) = run(&scene, METHOD, scene.settings.t_end);
    // It begins 0.64 m from its target, looking elsewhere.
    assert!(readings[0].1[0] > 0.6 && readings[0].1[2].abs() > 1.0);
    // Errors across the path fade over 0.5 m, of which the path has 29 in 20 s: far below the integrator's 1e-10.
    let end = readings.last().expect("steps");
    assert!(end.1.iter().all(|error| error.abs() < 1e-8), "{end:?}");
}

/// From the path itself nothing but rounding is left, with the pendulum swinging.
#[test]
fn a_cart_on_its_path_leaves_it_by_rounding_alone() {
    let on_path = text("cart_path")
        .replace(
            "position = [-0.5, 0.4, 0.0], rotation_vector = [0.0, 0.0, -1.0]",
            "position = [0.0, 0.0, 0.0], rotation_vector = [0.0, 0.0, 0.7853981633974483]",
        )
        .replace(
            "joint = { type = \"cart\" }",
            "joint = { type = \"cart\" }\ninitial.speeds = [0.0, 1.1313708498984762]",
        )
        .replace(
            "at = { position = [0.0, 0.0, 0.6] }",
            "at = { position = [0.0, 0.0, 0.6] }\ninitial.phi = [1.0, 0.5, 0.0]",
        );
    // The path begins at the origin with the speeds (0.8, 0.8) m/s, straight.
    let scene = parse(&on_path);
    let (_, readings) = run(&scene, EXACT, 4.0);
    let error = largest(&readings, 0);
    // Ways of some metres, summed over a thousand steps with one rounding each; feedback holds what is left.
    assert!(error <= 2e-14, "{error:e}");
}

/// The tractor with its three trailers, whose axles are held by constraints that couple joints.
#[test]
fn a_tractor_with_trailers_follows() {
    let tractor = text("tractor_trailers");
    let tractor = tractor.replace("[simulation]", "[controller]\nkind = \"path\"\njoint = \"tractor\"\nx = { rate = 0.8 }\ny = { amplitude = 0.8, frequency = 0.5 }\ndistance = 0.6\nrate = 3.0\n\n[simulation]");
    let scene = parse(&tractor);
    let (_, readings) = run(&scene, METHOD, 15.0);
    assert!(largest(&readings, 0) > 0.1);
    assert!(last(&readings, 0) < 1e-7, "{:?}", readings.last());
}

#[test]
fn what_cannot_follow_is_refused() {
    let scene = scene("cart_path");
    let gains = PathGains {
        distance: 0.5,
        rate: 4.0,
    };
    let still = Curve {
        start: [0.0; 2],
        laws: [Law::default(); 2],
    };
    let make = |body, gains| PathFollower::new(Arc::clone(&scene.mechanism), body, still, gains);
    assert!(matches!(make(1, gains), Err(ControlError::Joint { .. })));
    let wrong = PathGains {
        distance: 0.0,
        ..gains
    };
    assert!(matches!(make(0, wrong), Err(ControlError::Value { .. })));
    let mut law = make(0, gains).expect("a cart");
    let mut efforts = vec![0.0; scene.mechanism.layout().freedoms];
    use hamel::control::Controller;
    let stands = law.efforts(1.0, &scene.configuration, &scene.speeds, &mut efforts);
    assert!(
        matches!(stands, Err(ControlError::PathStands { .. })),
        "{stands:?}"
    );
}
