//! MPC: limits are kept, and the pole stays up where feedback that is only cut off lets it fall.

use super::{run, scene};
use hamel::control::{Controller, Equilibrium, Feedback, Regulator, Weights};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, State, integrate_held, no_observer};
use hamel_scene::Scene;
use std::sync::Arc;

const LIMIT: f64 = 8.0;
const METHOD: Method = Method::controlled(Scheme::DormandPrince, 1e-8);

/// Efforts of a controller at each period, and where the motion ends.
fn held(scene: &Scene, controller: &mut dyn Controller, limit: f64) -> (Vec<Vec<f64>>, State) {
    let mut feedback = Feedback::new(controller);
    let mut efforts = Vec::new();
    let initial = scene.start();
    let options = Options {
        form: Form::Lagrangian,
        method: METHOD,
        t_end: scene.settings.t_end,
        samples: Vec::new(),
    };
    let solution = integrate_held(
        &mut Recursive::new(Arc::clone(&scene.mechanism)),
        &initial,
        &options,
        0.04,
        &mut |t, q, v, tau: &mut [f64]| {
            feedback.fill(t, q, v, tau);
            tau.iter_mut().for_each(|u| *u = u.clamp(-limit, limit));
            efforts.push(tau.to_vec());
        },
        &mut no_observer,
    );
    assert_eq!(feedback.failure(), None);
    (efforts, solution.expect("the motion is smooth").state)
}

/// The pole's two angles.
fn tilt(state: &State) -> f64 {
    state.configuration[2].hypot(state.configuration[3])
}

#[test]
fn limits_are_kept_and_the_pole_comes_upright() {
    let scene = scene("balance_mpc");
    let (_, readings) = run(&scene, METHOD, scene.settings.t_end);
    let end = readings.last().expect("steps");
    assert!(readings[0].1[0] >= 0.55);
    // It is caught, not swung round: a falling pole would reach 10 rad/s.
    assert!(super::largest(&readings, 1) < 5.0);
    assert!(end.1[0] < 2e-3 && end.1[1] < 2e-3, "{end:?}");

    let (efforts, state) = held(&scene, &mut *super::controller(&scene), f64::INFINITY);
    assert!(tilt(&state) < 2e-3);
    let largest = efforts
        .iter()
        .flatten()
        .fold(0.0_f64, |most, u| most.max(u.abs()));
    // Limits bind, and are kept exactly: what the solver's tolerance lets out is cut off.
    assert!(largest > 0.99 * LIMIT && largest <= LIMIT, "{largest}");
    assert!(efforts.iter().all(|tau| tau[2] == 0.0 && tau[3] == 0.0));
}

/// The optimal linear feedback of the same weights, its forces cut off at the limit, loses the pole; without limit it holds it.
#[test]
fn feedback_that_is_cut_off_lets_the_pole_fall() {
    let scene = scene("balance_mpc");
    let goal = scene.mechanism.home();
    let equilibrium = Equilibrium::new(Arc::clone(&scene.mechanism), goal, &[0, 1]);
    let equilibrium = equilibrium.expect("upright is an equilibrium");
    let weights = Weights {
        position: vec![10.0, 10.0, 100.0, 100.0],
        speed: vec![1.0; 4],
        effort: vec![0.1; 2],
    };
    let regulator = Regulator::new(equilibrium, &weights).expect("within reach");
    let (_, free) = held(&scene, &mut regulator.clone(), f64::INFINITY);
    assert!(tilt(&free) < 0.05, "{free:?}");
    let (_, cut) = held(&scene, &mut regulator.clone(), LIMIT);
    assert!(tilt(&cut) > 1.0, "{cut:?}");
}

/// A damper of 1e3 N s/m stops a slide of 1.3 kg within a millisecond or so, and turns the pole; steps of 0.04 s would throw both off.
#[test]
fn periods_that_steps_cannot_foresee_are_refused() {
    let damped = super::text("balance_mpc").replace(
        "body_at = { axis = [-1.0, 0.0, 0.0] }",
        "body_at = { axis = [-1.0, 0.0, 0.0] }\ndamping = 1e3",
    );
    let refused = Scene::parse(&damped, "scene.toml", &hamel_joints::registry());
    let told = refused.expect_err("the period is too long").to_string();
    for part in ["joint `cardan`", "period of 0.04 s", "2.785", "at most"] {
        assert!(told.contains(part), "{part}: {told}");
    }
}
