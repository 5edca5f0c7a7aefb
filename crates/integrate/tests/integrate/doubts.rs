//! Estimates of errors that are right are not called doubtful: beside friction, held inputs, limits that give way, oscillations that steps follow.

use crate::stiff::wheel;
use crate::support::{at, distance, estimate, on_axis, options, run};
use hamel_integrate::{
    Form, GlobalError, Integration, Method, Observer, Options, Scheme, Solution, State,
};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::elements::{JointFriction, JointLimit, TimedEffort};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::time_function::{Expression, TimeFunction};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

const EXPLICIT: [Scheme; 3] = [
    Scheme::DormandPrince,
    Scheme::DormandPrince8,
    Scheme::Verner9,
];

/// The estimate is not in doubt, and of the order of the error, or both are rounding.
fn assert_right(case: &str, error: f64, told: &GlobalError) {
    let total = told.end.total();
    println!("{case}: {error:e}, told {:?}, {:?}", told.end, told.doubt);
    assert_eq!(told.doubt, None, "{case}");
    let is_right = total < 30.0 * error.max(1e-15) && total > error / 30.0;
    assert!(is_right, "{case}: {error:e}, told {total:e}");
}

fn with_friction(mechanism: &Mechanism, friction: f64) -> Arc<Mechanism> {
    let friction = JointFriction {
        name: "friction".into(),
        body: 0,
        port: None,
        sliding: friction,
        sticking: friction,
    };
    let mechanism = Mechanism::clone(mechanism).with_frictions(vec![friction]);
    Arc::new(mechanism.expect("it fits"))
}

/// Errors of a motion beside one that is far more accurate.
fn compare(mechanism: &Arc<Mechanism>, initial: &State, (method, t_end): (Method, f64)) {
    let own = options(Form::Lagrangian, method, t_end);
    let found = run(mechanism, initial, &own);
    let told = estimate(mechanism, initial, &own, &found);
    let exact = options(
        Form::Lagrangian,
        Method::controlled(Scheme::Verner9, 1e-15),
        t_end,
    );
    let error = distance(&found.state, &run(mechanism, initial, &exact).state);
    let tolerance = method.control().map_or(0.0, |control| control.tolerance);
    let case = format!("{} to {tolerance:e}", method.scheme().name());
    assert_right(&case, error, &told);
}

/// From x = 1, at ω = 1, friction of 0.16 takes 0.32 of each half-swing: turns at −0.68 and 0.36, and rest at −0.04.
#[test]
fn a_joint_that_comes_to_rest_leaves_no_doubt() {
    let mechanism = with_friction(&wheel(1.0, 0.0), 0.16);
    let initial = at(&[1.0], &[0.0]);
    for scheme in EXPLICIT {
        for tolerance in [1e-4, 1e-8, 1e-12] {
            let options = options(
                Form::Lagrangian,
                Method::controlled(scheme, tolerance),
                20.0,
            );
            let found = run(&mechanism, &initial, &options);
            let told = estimate(&mechanism, &initial, &options, &found);
            let error = (found.state.configuration[0] + 0.04).abs();
            assert_right(&format!("{} to {tolerance:e}", scheme.name()), error, &told);
        }
    }
}

/// The joint sticks at first. The neighbour that tells of rounding begins with a speed, and so sticks once more.
#[test]
fn a_neighbour_may_go_through_other_pieces() {
    let timed = TimedEffort {
        name: "effort".into(),
        body: 0,
        efforts: vec![TimeFunction::Expression(Arc::new(
            Expression::new("2*sin(t)").expect("a formula"),
        ))],
    };
    let mechanism = Mechanism::clone(&wheel(3.0, 0.0)).with_timed_efforts(vec![timed]);
    let mechanism = with_friction(&mechanism.expect("it fits"), 0.8);
    for scheme in EXPLICIT {
        let method = Method::controlled(scheme, 1e-12);
        compare(&mechanism, &at(&[0.0], &[0.0]), (method, 5.0));
    }
}

const PERIOD: f64 = 0.05;

/// `q̈ = −4 q + u` where u is held.
fn held(mechanism: &Arc<Mechanism>, start: &State, options: &Options) -> Solution {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let integration = Integration::new(&mut dynamics, start, options)
        .inputs(|_, q, v, efforts| efforts[0] = effort(q[0], v[0]))
        .held(PERIOD);
    integration.run().expect("it moves")
}

fn effort(q: f64, v: f64) -> f64 {
    -3.0 * q - v
}

/// The tolerance allows longer steps than the period, so that motions of other tolerances have the same steps.
#[test]
fn inputs_that_are_held_leave_no_doubt() {
    let (mechanism, initial) = (wheel(4.0, 0.0), at(&[1.0], &[0.5]));
    let count = 40;
    let (mut q, mut v) = (1.0, 0.5);
    for _ in 0..count {
        let rest = effort(q, v) / 4.0;
        let (sin, cos) = (2.0 * PERIOD).sin_cos();
        (q, v) = (
            rest + (q - rest) * cos + 0.5 * v * sin,
            v * cos - 2.0 * (q - rest) * sin,
        );
    }
    for (scheme, tolerance) in [
        (Scheme::DormandPrince, 1e-4),
        (Scheme::DormandPrince, 1e-6),
        (Scheme::Radau5, 1e-4),
    ] {
        let method = Method::controlled(scheme, tolerance);
        let options = options(Form::Lagrangian, method, PERIOD * f64::from(count));
        let found = held(&mechanism, &initial, &options);
        let mut own = Recursive::new(Arc::clone(&mechanism));
        let mut companion = |start: &State, options: &Options, observer: &mut Observer<'_>| {
            let mut dynamics = Recursive::new(Arc::clone(&mechanism));
            let integration = Integration::new(&mut dynamics, start, options)
                .inputs(|_, q, v, efforts| efforts[0] = effort(q[0], v[0]))
                .held(PERIOD)
                .observer(observer);
            integration.run().map_err(|error| error.to_string())
        };
        let told = GlobalError::estimate(&mut own, &initial, &options, &found, &mut companion);
        let error = distance(&found.state, &at(&[q], &[v]));
        assert_right(&format!("{} to {tolerance:e}", scheme.name()), error, &told);
    }
}

/// Errors of methods of high order do not fall evenly with the tolerance where something bends.
#[test]
fn a_limit_that_gives_way_leaves_no_doubt() {
    let limit = JointLimit {
        name: "limit".into(),
        body: 0,
        port: None,
        lower: Some(-0.5),
        upper: Some(0.3),
        stiffness: 200.0,
        damping: 0.3,
    };
    let mechanism = Mechanism::clone(&wheel(1.0, 0.02)).with_elements(vec![Arc::new(limit)]);
    let mechanism = Arc::new(mechanism.expect("it fits"));
    for scheme in [Scheme::DormandPrince8, Scheme::Verner9] {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let method = Method::controlled(scheme, tolerance);
            compare(&mechanism, &at(&[0.0], &[2.0]), (method, 6.0));
        }
    }
}

/// At a tolerance near rounding, the steps of the exponential method are far shorter than the swing.
#[test]
fn oscillations_that_steps_follow_leave_no_doubt() {
    let body = on_axis(Vector3::x() * 0.5, Matrix3::identity() * 0.1);
    let mechanism = Mechanism::new(Vector3::y() * -9.81, vec![body]).expect("a mechanism");
    let mechanism = Arc::new(mechanism);
    let method = Method::controlled(Scheme::Exponential, 1e-12);
    compare(&mechanism, &at(&[0.4], &[0.0]), (method, 2.0));
}
