//! Errors as they are told beside those of closed forms: transients, samples that cut steps, motions that begin at rest,
//! bodies far from the origin of the world, forces that are faster than steps, rounding that grows.

use crate::common::joints;
use crate::stiff::wheel;
use crate::support::{at, distance, estimate, on_axis, options, run};
use hamel_integrate::{Choice, Doubt, Form, GlobalError, Method, Options, Scheme, State, Wanted};
use hamel_runtime::elements::{BodySpring, TimedEffort};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::Pose;
use hamel_runtime::time_function::{Expression, Law, TimeFunction};
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

/// Two bodies on a spring, so far away along x.
fn far_away(away: f64) -> (Arc<Mechanism>, State) {
    let body = |name: &str, along: f64| BodySpec {
        name: name.into(),
        joint_name: format!("{name} joint"),
        joint: joints::planar(),
        placement: Pose::from_translation(Vector3::x() * (away + along)),
        ..on_axis(Vector3::zeros(), Matrix3::identity() * 0.1)
    };
    let spring = BodySpring {
        name: "spring".into(),
        bodies: [Some(0), Some(1)],
        points: [Vector3::y() * 0.1, Vector3::x() * 0.2],
        stiffness: 100.0,
        damping: 0.0,
        length: 1.0,
    };
    let bodies = vec![body("near", 0.0), body("far", 2.5)];
    let mechanism = Mechanism::new(Vector3::zeros(), bodies).expect("a mechanism");
    let mechanism = mechanism.with_elements(vec![Arc::new(spring)]);
    let mechanism = Arc::new(mechanism.expect("it fits"));
    let initial = at(&mechanism.home(), &[0.0, 0.0, 0.0, 0.3, 0.5, 0.4]);
    (mechanism, initial)
}

/// Positions in the world are rounded to 1e-7 m at 1e9 m, and the spring makes accelerations of that: without them the motion is the one about the origin.
#[test]
fn rounding_of_positions_far_away_is_told() {
    let t_end = 1.5;
    let (near, initial) = far_away(0.0);
    let exact = Method::controlled(Scheme::Verner9, 1e-14);
    let exact = run(&near, &initial, &options(Form::Lagrangian, exact, t_end)).state;
    let cases = [
        (1e5, Scheme::DormandPrince8, 1e-8),
        (1e5, Scheme::Verner9, 1e-10),
        (1e7, Scheme::DormandPrince8, 1e-8),
        (1e9, Scheme::DormandPrince8, 1e-8),
    ];
    for (away, scheme, tolerance) in cases {
        let (mechanism, initial) = far_away(away);
        let method = Method::controlled(scheme, tolerance);
        let options = options(Form::Lagrangian, method, t_end);
        let found = run(&mechanism, &initial, &options);
        let told = estimate(&mechanism, &initial, &options, &found);
        let error = distance(&found.state, &exact);
        let (steps, name) = (found.statistics.steps, scheme.name());
        println!("{away:e} m, {name} to {tolerance:e}: {error:e}, told {told:?}, {steps} steps");
        // One rounding of each number stands for all that the motion makes.
        assert!(
            told.doubt.is_some() || error < 30.0 * told.end.total(),
            "{away:e} m, {name}: {error:e}, told {:e}",
            told.end.total()
        );
        // Rounding does not make steps ever shorter.
        assert!(steps < 1000, "{away:e} m, {name}: {steps}");
    }
}

/// A wheel of 1 kg m² without springs, under an effort.
fn driven(effort: TimeFunction) -> Arc<Mechanism> {
    let timed = TimedEffort {
        name: "effort".into(),
        body: 0,
        efforts: vec![effort],
    };
    let mechanism = Mechanism::clone(&wheel(0.0, 0.0)).with_timed_efforts(vec![timed]);
    Arc::new(mechanism.expect("it fits"))
}

/// Steps of a period see a sine as a constant, as those of two and four periods do: the motion is wrong, and companions are as wrong.
#[test]
fn an_effort_that_is_faster_than_fixed_steps_makes_an_estimate_doubtful() {
    let frequency = 100.0;
    let mechanism = driven(TimeFunction::Sine(Law {
        rate: 0.0,
        amplitude: 1.0 / frequency,
        frequency,
        phase: 0.4,
    }));
    let period = core::f64::consts::TAU / frequency;
    for method in [
        Method::rk4,
        |dt| Method::fixed(Scheme::Midpoint, dt),
        |dt| Method::fixed(Scheme::Gauss3, dt),
    ] {
        let doubt = |parts: f64| {
            let options = options(Form::Lagrangian, method(period / parts), 40.0 * period);
            let initial = at(&[0.0], &[0.0]);
            let found = run(&mechanism, &initial, &options);
            let speed = ((100.0 * 40.0 * period + 0.4).sin() - 0.4_f64.sin()) / frequency;
            let error = (found.state.speeds[0] - speed).abs();
            let told = estimate(&mechanism, &initial, &options, &found);
            println!("{parts}: {error:e}, told {:?}, {:?}", told.end, told.doubt);
            told.doubt
        };
        let is_unseen = |parts| matches!(doubt(parts), Some(Doubt::Unseen { count: 1.. }));
        assert!(is_unseen(1.0) && is_unseen(0.5) && is_unseen(1.37));
        assert!(!is_unseen(20.0));
    }
}

/// Under step control no step passes over a period, however small the effort is beside the tolerance: it would be taken for a constant one.
#[test]
fn no_controlled_step_passes_over_a_period() {
    let frequency = 1e4;
    let text = format!("1e-3*cos({frequency}*t)");
    let expression = Expression::new(&text).expect("a formula");
    let mechanism = driven(TimeFunction::Expression(Arc::new(expression)));
    // There the speed is largest: a step that takes the effort for a constant makes 1e-3 of it.
    let t_end = 1591.25 * core::f64::consts::TAU / frequency;
    for scheme in [Scheme::DormandPrince, Scheme::Verner9, Scheme::Radau5] {
        let method = Method::controlled(scheme, 1e-3);
        let options = options(Form::Lagrangian, method, t_end);
        let found = run(&mechanism, &at(&[0.0], &[0.0]), &options);
        let periods = frequency * t_end / core::f64::consts::TAU;
        let steps = found.statistics.steps as f64;
        // A quarter of a step is compared with a cubic to half a per cent: that is 0.9 periods in a step.
        assert!(steps > 0.9 * periods, "{}: {steps}", scheme.name());
        let error = (found.state.speeds[0] - 1e-3 * (frequency * t_end).sin() / frequency).abs();
        // The amplitude of the speed.
        assert!(error < 1e-7, "{}: {error:e}", scheme.name());
    }
}

/// The speed after a pulse is its area, √π. Near 50 s the time is rounded to 7e-15 s, which is 7e-12 of a pulse of a millisecond, at each of its steps; a
/// smaller tolerance does not make more of it.
#[test]
fn a_late_pulse_has_the_accuracy_of_the_time_at_any_tolerance() {
    let expression = Expression::new("1000*exp(-((t - 50)/0.001)^2)").expect("a formula");
    let mechanism = driven(TimeFunction::Expression(Arc::new(expression)));
    for scheme in [Scheme::DormandPrince8, Scheme::Verner9] {
        for tolerance in [1e-11, 1e-12, 1e-13, 1e-14, 1e-15] {
            let method = Method::controlled(scheme, tolerance);
            let options = options(Form::Lagrangian, method, 60.0);
            let found = run(&mechanism, &at(&[0.1], &[0.3]), &options);
            let speed = 0.3 + core::f64::consts::PI.sqrt();
            let error = (found.state.speeds[0] - speed).abs();
            println!(
                "{} to {tolerance:e}: {error:e}, {} steps",
                scheme.name(),
                found.statistics.steps
            );
            // Some ten steps, and as many roundings as the largest slope of the pulse has over its mean.
            assert!(
                error < 2e-10,
                "{} to {tolerance:e}: {error:e}",
                scheme.name()
            );
        }
    }
}

/// A body that turns about its axis of intermediate inertia but for a millionth leaves it and comes back again and again: how it does, its rounding decides, which two methods make
/// differently.
#[test]
fn rounding_along_an_unstable_axis_is_told() {
    let body = BodySpec {
        joint: joints::ball(),
        ..on_axis(
            Vector3::zeros(),
            Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0)),
        )
    };
    let mechanism = Mechanism::new(Vector3::zeros(), vec![body]).expect("a mechanism");
    let mechanism = Arc::new(mechanism);
    let initial = at(&mechanism.home(), &[5e-6, 5.0, 5e-6]);
    for t_end in [17.0, 30.0] {
        let motions = [(Scheme::DormandPrince8, 1e-12), (Scheme::Verner9, 1e-13)];
        let [(a, told_a), (b, told_b)] = motions.map(|(scheme, tolerance)| {
            let method = Method::controlled(scheme, tolerance);
            let options = options(Form::Lagrangian, method, t_end);
            let found = run(&mechanism, &initial, &options);
            let told = estimate(&mechanism, &initial, &options, &found);
            println!("{t_end} s, {}: {told:?}", scheme.name());
            (found.state, told)
        });
        let apart = distance(&a, &b);
        let told = told_a.end.total().max(told_b.end.total());
        println!("{t_end} s: {apart:e} apart, told {told:e}");
        let is_doubted = told_a.doubt.is_some() || told_b.doubt.is_some();
        assert!(
            is_doubted || apart < 10.0 * told,
            "{apart:e}, told {told:e}"
        );
    }
}
