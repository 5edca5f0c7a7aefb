//! Errors as they are told beside those of closed forms: transients, samples that cut steps, motions that begin at rest.

use crate::stiff::wheel;
use crate::support::{at, estimate, on_axis, options, run};
use hamel_integrate::{Choice, Form, GlobalError, Method, Options, Scheme, State, Wanted};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

fn told(
    mechanism: &Arc<Mechanism>,
    initial: &State,
    options: &Options,
) -> (Vec<State>, GlobalError) {
    let found = run(mechanism, initial, options);
    let told = estimate(mechanism, initial, options, &found);
    (found.samples, told)
}

fn sampled(method: Method, t_end: f64, count: u32) -> Options {
    let samples = (1..=count).map(|k| t_end * f64::from(k) / f64::from(count));
    Options {
        samples: samples.collect(),
        ..options(Form::Lagrangian, method, t_end)
    }
}

/// `ẍ = −100 x − 25 ẋ` with x = 1, ẋ = 5 is 5/3 e^(−5t) − 2/3 e^(−20t): its error is largest at the first sample, of 20, and a thousandth of that at the end.
#[test]
fn samples_in_a_transient_have_its_error() {
    let (mechanism, initial) = (wheel(100.0, 25.0), at(&[1.0], &[5.0]));
    for method in [Method::rk4(0.02), Method::fixed(Scheme::Gauss2, 0.02)] {
        let (samples, told) = told(&mechanism, &initial, &sampled(method, 2.0, 20));
        for (sample, told) in samples.iter().zip(&told.samples).take(2) {
            let [slow, fast] = [-5.0, -20.0].map(|rate: f64| (rate * sample.time).exp());
            let angle = (5.0 * slow - 2.0 * fast) / 3.0 - sample.configuration[0];
            let speed = (-25.0 * slow + 40.0 * fast) / 3.0 - sample.speeds[0];
            let (error, told) = (angle.abs().max(speed.abs()), told.total());
            println!("{}: {error:e}, told {told:e}", sample.time);
            assert!(
                told > 0.1 * error && told < 30.0 * error,
                "{error:e}, told {told:e}"
            );
        }
    }
}

/// A hundred samples a turn and a half, one or two steps each: the tolerance would have steps of a fifth of a turn.
#[test]
fn samples_that_cut_steps_are_known() {
    let (mechanism, initial) = (wheel(1.0, 0.0), at(&[0.5], &[0.0]));
    let (t_end, count) = (10.0, 100);
    for (scheme, tolerance) in [
        (Scheme::Verner9, 1e-4),
        (Scheme::DormandPrince8, 1e-4),
        (Scheme::DormandPrince8, 1e-6),
    ] {
        let options = sampled(Method::controlled(scheme, tolerance), t_end, count);
        let (samples, told) = told(&mechanism, &initial, &options);
        let last = samples.last().expect("samples");
        let error = (0.5 * t_end.cos() - last.configuration[0]).abs();
        let told = told.end.total();
        println!(
            "{} to {tolerance:e}: {error:e}, told {told:e}",
            scheme.name()
        );
        // Steps are far shorter than those of the tolerance, and so are errors.
        assert!(
            told < 1e-4 * tolerance && told > 0.03 * error,
            "{error:e}, told {told:e}"
        );
    }
}

/// Two pendulums that are let go move as those that have next to no speed: both are as sensitive.
#[test]
fn what_begins_at_rest_has_a_conditioning() {
    let inertia = Matrix3::identity() * 0.1;
    let link = |name: &str, parent: Option<usize>, along: f64| BodySpec {
        name: name.into(),
        joint_name: format!("{name} axis"),
        parent,
        placement: Pose::from_translation(Vector3::x() * along),
        ..on_axis(Vector3::x(), inertia)
    };
    let bodies = vec![link("upper", None, 0.0), link("lower", Some(0), 1.0)];
    let mechanism = Mechanism::new(Vector3::new(0.0, -9.81, 0.0), bodies).expect("a mechanism");
    let mechanism = Arc::new(mechanism);
    let method = Method::controlled(Scheme::Verner9, 1e-12);
    let conditioning = |speed: f64| {
        let initial = at(&[1.5, 0.7], &[speed, speed]);
        let (_, told) = told(&mechanism, &initial, &sampled(method, 10.0, 10));
        println!("{speed:e}: {:?}, {:?}", told.end, told.conditioning);
        told.conditioning.expect("it is found")
    };
    let [rest, slow] = [0.0, 1e-9].map(conditioning);
    assert!(
        rest > 10.0 && (0.1..10.0).contains(&(rest / slow)),
        "{rest:e}, {slow:e}"
    );
    // Where nothing ever moves there is none.
    let (_, still) = told(
        &wheel(1.0, 1.0),
        &at(&[0.0], &[0.0]),
        &sampled(method, 1.0, 3),
    );
    assert_eq!(still.conditioning, None);
}

/// One oscillator is linear, however slow: the exponential method takes it in a few steps.
#[test]
fn a_slow_linear_spring_is_taken_exactly() {
    let wanted = Wanted {
        tolerance: 1e-8,
        span: 20.0,
        is_bound: false,
    };
    let (mechanism, initial) = (wheel(24.0, 0.0), at(&[0.5], &[1.0]));
    let choice = Choice::new(&mechanism, &initial, wanted).expect("a choice");
    assert_eq!(choice.scheme, Scheme::Exponential, "{}", choice.reason);
    let steps = |scheme| {
        let method = Method::controlled(scheme, wanted.tolerance);
        run(
            &mechanism,
            &initial,
            &options(Form::Lagrangian, method, wanted.span),
        )
        .statistics
        .steps
    };
    assert!(10 * steps(Scheme::Exponential) < steps(Scheme::Verner9));
}
