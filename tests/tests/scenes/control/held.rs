//! Inputs that are held: taken at the instants of a period, and constant in between.

use super::scene;
use hamel::dynamics::Recursive;
use hamel::integrate::{
    Form, IntegrateError, Method, Options, integrate, integrate_held, no_observer,
};
use hamel_scene::Scene;
use std::sync::Arc;

fn options(form: Form, method: Method, t_end: f64, samples: &[f64]) -> Options {
    Options {
        form,
        method,
        t_end,
        samples: samples.to_vec(),
    }
}

/// A law that depends on all of its arguments.
fn law(time: f64, q: &[f64], v: &[f64], tau: &mut [f64]) {
    for (i, tau) in tau.iter_mut().enumerate() {
        *tau = (3.0 * time).cos() - 4.0 * q[i] - 0.5 * v[i];
    }
}

const METHODS: [Method; 2] = [Method::rk4(1e-3), Method::dormand_prince(1e-12)];

/// The same as one integration after the other, each with constant inputs.
#[test]
fn held_inputs_are_those_of_one_integration_for_each_period() {
    let scene = scene("ball_pendulum_upright");
    let (period, periods) = (0.03, 20);
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        for method in METHODS {
            let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
            let mut instants = Vec::new();
            let mut inputs = |t: f64, q: &[f64], v: &[f64], tau: &mut [f64]| {
                instants.push(t);
                law(t, q, v, tau);
            };
            // Samples between the instants, on them, and as near to them as rounding allows.
            let samples = [0.01, 0.06, 0.09 - 1e-17, 0.3, 0.57, 0.6];
            let options_of_all = options(form, method, period * f64::from(periods), &samples);
            let solution = integrate_held(
                &mut dynamics,
                &scene.start(),
                &options_of_all,
                period,
                &mut inputs,
                &mut no_observer,
            );
            let solution = solution.expect("the motion is smooth");
            let wanted: Vec<f64> = (0..=periods).map(|k| period * f64::from(k)).collect();
            assert_eq!(instants.len(), wanted.len());
            for (found, wanted) in instants.iter().zip(&wanted) {
                assert!((found - wanted).abs() <= 1e-15, "{found} {wanted}");
            }
            assert_eq!(solution.samples.len(), samples.len());

            let mut state = scene.start();
            for k in 1..=periods {
                let mut held = [0.0; 3];
                law(state.time, &state.configuration, &state.speeds, &mut held);
                let next = options(form, method, period * f64::from(k), &[]);
                let mut inputs =
                    |_: f64, _: &[f64], _: &[f64], tau: &mut [f64]| tau.copy_from_slice(&held);
                let moved = integrate(&mut dynamics, &state, &next, &mut inputs, &mut no_observer);
                state = moved.expect("the motion is smooth").state;
            }
            let pairs = state
                .configuration
                .iter()
                .zip(&solution.state.configuration);
            let away = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Steps differ by where they are cut for samples, and the tolerance is 1e-12 a step, of 60; rk4 at 1 ms errs by 1e-11 over it.
            assert!(away <= 1e-8, "{form:?} {method:?}: {away:e}");
        }
    }
}

#[test]
fn periods_out_of_range_are_refused() {
    let scene = scene("ball_pendulum_upright");
    for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = integrate_held(
            &mut Recursive::new(Arc::clone(&scene.mechanism)),
            &scene.start(),
            &options(Form::Lagrangian, METHODS[0], 1.0, &[]),
            period,
            &mut law,
            &mut no_observer,
        );
        let option = refused.expect_err("out of range");
        assert!(
            matches!(
                option,
                IntegrateError::Option {
                    option: "period",
                    ..
                }
            ),
            "{option}"
        );
    }
}

/// A double integrator with ω = 10 rad/s and ζ = 1 is stable up to 0.1 s (Jury). The regulator of the pendulum brings it back at some 4 1/s.
#[test]
fn periods_over_which_deviations_grow_are_refused() {
    for (name, kind, refused, taken) in [
        ("panda7_tracking", "computed_torque", 0.11, 0.09),
        ("ball_pendulum_upright", "lqr", 2.0, 0.01),
    ] {
        let kind = format!("kind = \"{kind}\"");
        let with = |period: f64| {
            let text = super::text(name).replace(&kind, &format!("{kind}\nperiod = {period:?}"));
            Scene::parse(&text, "scene.toml", &hamel_joints::registry())
        };
        let told = with(refused).expect_err("deviations grow").to_string();
        let period = format!("the period of {refused} s is too long");
        assert!(
            told.contains(&period) && told.contains("Make it less than"),
            "{told}"
        );
        assert!(with(taken).is_ok(), "{name}");
    }
}
