//! Events: where functions of the state cross zero.

use crate::common::joints;
use crate::common::trees::body;
use crate::support::options;
use hamel_integrate::{
    Crossing, Event, Form, IntegrateError, Integration, Method, Options, Sampling, Scheme,
    Solution, State,
};
use hamel_runtime::dynamics::Reference;
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use std::sync::Arc;

const GRAVITY: f64 = 9.81;

/// A body in the plane: angle, x, y; gravity along −y.
fn stone() -> Arc<Mechanism> {
    let mass = MassProperties::new(2.0, Vector3::zeros(), Matrix3::identity()).expect("physical");
    let joint = joints::planar_euclidean();
    let stone = body("stone", None, joint, Pose::identity(), mass);
    let gravity = Vector3::new(0.0, -GRAVITY, 0.0);
    Arc::new(Mechanism::new(gravity, vec![stone]).expect("one body"))
}

/// At height `y` (m), with an upward speed (m/s).
fn at(time: f64, y: f64, speed: f64) -> State {
    State {
        time,
        configuration: vec![0.0, 0.0, y],
        speeds: vec![0.0, 1.0, speed],
    }
}

fn watch(
    mechanism: &Arc<Mechanism>,
    initial: &State,
    options: &Options,
    events: Vec<Event<'_>>,
) -> Result<Solution, IntegrateError> {
    let mut dynamics = Reference::new(Arc::clone(mechanism));
    let integration = Integration::new(&mut dynamics, initial, options);
    let integration = events
        .into_iter()
        .fold(integration, |all, event| all.event(event));
    integration.run()
}

fn told(events: &[Crossing]) -> Vec<(&str, bool)> {
    let told = events.iter().map(|event| (&*event.name, event.rising));
    told.collect()
}

fn assert_times(events: &[Crossing], expected: &[f64], tolerance: f64) {
    assert_eq!(events.len(), expected.len(), "{events:?}");
    for (event, expected) in events.iter().zip(expected) {
        let error = (event.state.time - expected).abs();
        println!("{}: {error:e}", event.name);
        assert!(error < tolerance, "{}: {error:e}", event.name);
    }
}

/// A throw is a parabola, which every scheme of order 2 and more takes without error: two steps of 0.7 s, all crossings in the first.
#[test]
fn crossings_of_a_throw_come_in_order_and_to_rounding() {
    let (speed, level) = (5.0, 1.0);
    let root = f64::sqrt(speed * speed - 2.0 * GRAVITY * level);
    let times = [
        (speed - root) / GRAVITY,
        speed / GRAVITY,
        (speed + root) / GRAVITY,
    ];
    for scheme in Scheme::ALL {
        for &form in scheme.forms() {
            println!("{form:?}, {}", scheme.name());
            let options = options(form, Method::fixed(scheme, 1.0), 2.0);
            let events = vec![
                Event::new("apex", |_, _, v| v[2]),
                Event::new("level", |_, q, _| q[2] - level),
                Event::new("past", |time, _, _| time + 1.0),
            ];
            let found = watch(&stone(), &at(0.0, 0.0, speed), &options, events);
            let events = found.expect("integrates").events;
            assert_eq!(
                told(&events),
                [("level", true), ("apex", false), ("level", false)]
            );
            // Heights of metres cross the level at 2 m/s; their rounding is multiplied by the coefficients of a scheme, in DOP853 by up to 50.
            assert_times(&events, &times, 4e-14);
            // Where a crossing is told it has happened.
            assert!(events[1].state.speeds[2] <= 0.0 && events[0].state.configuration[2] >= level);
        }
    }
}

#[test]
fn only_the_direction_asked_for_counts() {
    let options = options(Form::Lagrangian, Method::rk4(0.3), 2.0);
    let level = |_: f64, q: &[f64], _: &[f64]| q[2] - 1.0;
    let events = vec![
        Event::new("up", level).rising(),
        Event::new("down", level).falling(),
        Event::new("both", level),
    ];
    let found = watch(&stone(), &at(0.0, 0.0, 5.0), &options, events);
    let events = found.expect("integrates").events;
    // At one time they come in the order in which they were given.
    let expected = [
        ("up", true),
        ("both", true),
        ("down", false),
        ("both", false),
    ];
    assert_eq!(told(&events), expected);
    assert_eq!(events[3].event, 2);
}

/// K(k), the complete elliptic integral of the first kind, by the arithmetic-geometric mean.
fn elliptic(modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - modulus * modulus).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
    }
    0.5 * PI / a
}

/// A pendulum from 2 rad passes its lowest point after a quarter of `4 K(sin 1) / ω₀`, and so on.
#[test]
fn a_pendulum_passes_its_lowest_point_on_time() {
    let com = Vector3::new(0.0, -0.5, 0.0);
    let mass = MassProperties::new(3.0, com, Matrix3::identity() * 0.1).expect("physical");
    let bob = body("bob", None, joints::revolute(), Pose::identity(), mass);
    let gravity = Vector3::new(0.0, -GRAVITY, 0.0);
    let mechanism = Arc::new(Mechanism::new(gravity, vec![bob]).expect("one body"));
    let initial = State {
        time: 0.0,
        configuration: vec![2.0],
        speeds: vec![0.0],
    };
    let omega = f64::sqrt(3.0 * GRAVITY * 0.5 / (0.1 + 3.0 * 0.25));
    let quarter = elliptic(1.0_f64.sin()) / omega;
    let schemes = [
        (Scheme::DormandPrince, 1e-12),
        (Scheme::DormandPrince8, 1e-13),
        (Scheme::Verner9, 1e-14),
        (Scheme::Radau5, 1e-13),
    ];
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        for (scheme, tolerance) in schemes {
            let options = options(form, Method::controlled(scheme, tolerance), 4.9 * quarter);
            let events = vec![
                Event::new("bottom", |_, q, _| q[0]),
                Event::new("rest", |_, _, v| v[0]),
            ];
            let found = watch(&mechanism, &initial, &options, events).expect("integrates");
            let expected = [1.0, 2.0, 3.0, 4.0].map(|count| count * quarter);
            println!("{form:?}, {}: {:?}", scheme.name(), found.statistics);
            assert_eq!(
                told(&found.events),
                [
                    ("bottom", false),
                    ("rest", true),
                    ("bottom", true),
                    ("rest", false)
                ]
            );
            // Hundreds of steps of 1e-12 at most, at speeds and accelerations of several units.
            assert_times(&found.events, &expected, 1e-10);
        }
    }
}

#[test]
fn what_starts_at_zero_or_only_touches_it_crosses_nothing() {
    let speed = 3.0;
    // Twice this is the fall time, and the steps do not know of it.
    let apex = speed * speed / (2.0 * GRAVITY);
    let events = || {
        vec![
            Event::new("ground", |_, q, _| q[2]),
            Event::new("apex touched", |_, q, _| q[2] - apex - 1e-12),
            Event::new("nothing", |_, _, _| 0.0),
        ]
    };
    for method in [Method::rk4(0.11), Method::dormand_prince(1e-9)] {
        let options = options(Form::Lagrangian, method, 1.0);
        let found = watch(&stone(), &at(0.0, 0.0, speed), &options, events());
        let found = found.expect("integrates").events;
        assert_eq!(told(&found), [("ground", false)]);
        // At 3 m/s, to rounding of a metre.
        assert_times(&found, &[2.0 * speed / GRAVITY], 4e-15);
    }
}

#[test]
fn a_stopping_event_ends_it_there() {
    let speed = 5.0;
    let landing = 2.0 * speed / GRAVITY;
    for sampling in [Sampling::Landing, Sampling::Dense] {
        let options = Options {
            samples: vec![0.0, 0.4, 1.0, 1.1],
            ..options(Form::Hamiltonian, Method::rk4(0.8), 2.0)
        };
        let (initial, mechanism) = (at(0.0, 0.0, speed), stone());
        let mut last = 0.0;
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let solution = Integration::new(&mut dynamics, &initial, &options)
            .sampling(sampling)
            .observer(|step| {
                last = step.time;
                std::ops::ControlFlow::Continue(())
            })
            .event(Event::new("landing", |_, q, _| q[2]).falling().stopping())
            .event(Event::new("later", |t, _, _| t - landing - 1e-3))
            .event(Event::new("sooner", |t, _, _| t - landing + 1e-3))
            .run()
            .expect("integrates");
        assert!(solution.stopped);
        assert_eq!(
            told(&solution.events),
            [("sooner", true), ("landing", false)]
        );
        assert_eq!(solution.state, solution.events[1].state);
        let times: Vec<_> = solution.samples.iter().map(|state| state.time).collect();
        assert_eq!(times, [0.0, 0.4, 1.0]);
        // At 5 m/s, to rounding of a metre.
        assert!((solution.state.time - landing).abs() < 1e-15);
        assert_eq!(last, 1.0, "nothing is shown beyond the landing");
    }
}

/// The end of a step, the sample there and the event that ends it are one instant.
#[test]
fn what_ends_on_a_sample_has_that_sample() {
    for sampling in [Sampling::Landing, Sampling::Dense] {
        let options = Options {
            samples: vec![0.25, 0.5, 0.75],
            ..options(Form::Lagrangian, Method::rk4(0.25), 1.0)
        };
        let (initial, mechanism) = (at(0.0, 0.0, 1.0), stone());
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        // Positive at 0.5 s, which is the last time at which the root can be told from it.
        let event = Event::new("half", |t, _, _| t - 0.5 + 1e-17).stopping();
        let motion = Integration::new(&mut dynamics, &initial, &options);
        let solution = motion.sampling(sampling).event(event).run();
        let solution = solution.expect("integrates");
        assert_eq!(solution.state.time, 0.5);
        let times: Vec<_> = solution.samples.iter().map(|state| state.time).collect();
        assert_eq!(times, [0.25, 0.5]);
    }
}

/// A ball that keeps half of its speed: the n-th flight lasts `2 · 2⁻ⁿ v₀/g`.
#[test]
fn a_ball_bounces_by_restarts() {
    let drop = f64::sqrt(2.0 / GRAVITY);
    let (mut state, mut expected) = (at(0.0, 1.0, 0.0), drop);
    for bounce in 1..20 {
        // The first step is a hundredth of that: short against the flight, as steps must be.
        let end = expected + drop * 0.5_f64.powi(bounce);
        let options = options(Form::Lagrangian, Method::dormand_prince(1e-10), end);
        let ground = Event::new("ground", |_, q, _| q[2]).falling().stopping();
        let solution = watch(&stone(), &state, &options, vec![ground]).expect("integrates");
        assert_eq!(solution.events.len(), 1);
        let error = (solution.state.time - expected).abs();
        // The speeds keep their relative error, and times that of the sum.
        assert!(error < 1e-14, "bounce {bounce}: {error:e}");
        let speed = -0.5 * solution.state.speeds[2];
        expected += 2.0 * drop * 0.5_f64.powi(bounce);
        state = at(solution.state.time, 0.0, speed);
    }
}

#[test]
fn a_function_that_is_not_finite_is_refused_by_name() {
    let options = options(Form::Lagrangian, Method::rk4(0.5), 2.0);
    let of = |event: Event<'_>| {
        let found = watch(&stone(), &at(0.0, 0.0, 3.0), &options, vec![event]);
        found.expect_err("not a number").to_string()
    };
    assert_eq!(
        of(Event::new("root", |_, q, _| (q[2] - 1e-3).sqrt())),
        "at 0 s: the function of event `root` is NaN: it must be finite"
    );
    assert_eq!(
        of(Event::new("pole", |t, _, _| 1.0 / (1.0 - t))),
        "at 1 s: the function of event `pole` is inf: it must be finite"
    );
}
