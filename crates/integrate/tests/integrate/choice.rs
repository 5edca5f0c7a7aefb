//! The method chosen where springs are stiff, and the reason given.

use crate::support::{on_axis, options, run};
use hamel_integrate::{Choice, Form, Integration, Method, Scheme, State, Wanted};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::elements::{
    BodySpring, Element, JointDamper, JointEffort, JointLimit, JointSpring,
};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Steps of an explicit method in the time of one of a method that solves for them, in small mechanisms.
const DEARER: usize = 10;

/// A wheel of 1 kg m², 1 m of whose rim is tied by a spring of 1e6 N/m to a point 2 m ahead of it.
fn tied(length: f64) -> Arc<Mechanism> {
    let body = on_axis(Vector3::zeros(), Matrix3::identity());
    let spring = BodySpring {
        name: "rod".into(),
        bodies: [None, Some(0)],
        points: [Vector3::x() * 3.0, Vector3::x()],
        stiffness: 1e6,
        damping: 0.0,
        length,
    };
    with(vec![body], vec![Arc::new(spring)])
}

fn with(bodies: Vec<BodySpec>, elements: Vec<Arc<dyn Element>>) -> Arc<Mechanism> {
    let mechanism = Mechanism::new(Vector3::zeros(), bodies).expect("a mechanism");
    Arc::new(mechanism.with_elements(elements).expect("they fit"))
}

fn turned(angles: &[f64]) -> State {
    State {
        time: 0.0,
        configuration: angles.to_vec(),
        speeds: vec![0.0; angles.len()],
    }
}

fn chosen(mechanism: &Arc<Mechanism>, state: &State, is_bound: bool) -> Choice {
    let wanted = Wanted {
        tolerance: 1e-6,
        span: 1.0,
        is_bound,
    };
    let choice = Choice::new(mechanism, state, wanted).expect("a choice");
    println!("{}: {}", choice.scheme.name(), choice.reason);
    choice
}

/// Steps within a fiftieth of a second.
fn steps(mechanism: &Arc<Mechanism>, state: &State, scheme: Scheme) -> usize {
    let options = options(Form::Lagrangian, Method::controlled(scheme, 1e-6), 0.02);
    let steps = run(mechanism, state, &options).statistics.steps;
    println!("{}: {steps} steps", scheme.name());
    steps
}

#[test]
fn what_buckles_is_followed() {
    let (mechanism, state) = (tied(3.0), turned(&[1e-3]));
    let choice = chosen(&mechanism, &state, false);
    assert_eq!(choice.scheme, Scheme::DormandPrince8, "{}", choice.reason);
    assert!(choice.reason.starts_with("growing motion at joint `axis`"));
    let [own, exponential] =
        [choice.scheme, Scheme::Exponential].map(|scheme| steps(&mechanism, &state, scheme));
    assert!(own < DEARER * exponential);
}

/// At rest the rod is as long as it would be by itself: its force grows with the third power of the angle.
#[test]
fn springs_that_are_not_linear_are_followed() {
    let (mechanism, state) = (tied(2.0), turned(&[0.5]));
    let choice = chosen(&mechanism, &state, false);
    assert_eq!(choice.scheme, Scheme::DormandPrince8, "{}", choice.reason);
    assert!(choice.reason.starts_with("oscillation at joint `axis`"));
    assert!(choice.reason.contains("not linear enough"));
    let [own, exponential] =
        [choice.scheme, Scheme::Exponential].map(|scheme| steps(&mechanism, &state, scheme));
    assert!(own < DEARER * exponential);
}

/// What fades at 1e6 1/s would hold explicit methods to 3e-6 s, whatever else swings at 100 1/s.
#[test]
fn slow_oscillations_do_not_keep_radau_from_what_is_damped() {
    let wheel = |name: &str| BodySpec {
        name: name.into(),
        joint_name: format!("{name} axis"),
        ..on_axis(Vector3::zeros(), Matrix3::identity())
    };
    let swinging = JointSpring {
        name: "spring".into(),
        body: 0,
        stiffness: vec![1e4],
        rest: vec![0.0],
    };
    let fading = JointDamper {
        name: "damper".into(),
        body: 1,
        coefficients: vec![1e6],
    };
    let bodies = vec![wheel("swinging"), wheel("fading")];
    let mechanism = with(bodies, vec![Arc::new(swinging), Arc::new(fading)]);
    let state = State {
        speeds: vec![0.0, 0.1],
        ..turned(&[0.1, 0.0])
    };
    let choice = chosen(&mechanism, &state, true);
    assert_eq!(choice.scheme, Scheme::Radau5, "{}", choice.reason);
    assert!(
        choice
            .reason
            .contains("damped motion at joint `fading axis`")
    );
    let [own, explicit] =
        [choice.scheme, Scheme::DormandPrince8].map(|scheme| steps(&mechanism, &state, scheme));
    assert!(DEARER * own < explicit);
    // Unbound, the exponential method takes both exactly.
    assert_eq!(
        chosen(&mechanism, &state, false).scheme,
        Scheme::Exponential
    );
}

/// A wheel is driven onto a stiff stop and comes to rest on it: an explicit method up to there, Radau IIA on the stop, where steps of the explicit one would
/// be held to some 1e-4 s.
#[test]
fn the_choice_is_looked_at_again_on_the_way() {
    let drive: Arc<dyn Element> = Arc::new(JointEffort {
        name: "drive".into(),
        body: 0,
        efforts: vec![-9.81],
    });
    let stop: Arc<dyn Element> = Arc::new(JointLimit {
        port: None,
        name: "stop".into(),
        body: 0,
        lower: Some(0.0),
        upper: None,
        stiffness: 1e8,
        damping: 1e3,
    });
    let body = on_axis(Vector3::zeros(), Matrix3::identity());
    let mechanism = with(vec![body], vec![drive, stop]);
    let initial = State {
        time: 0.0,
        configuration: vec![1.0],
        speeds: vec![0.0],
    };
    let method = Method::controlled(Scheme::DormandPrince, 1e-6);
    let options = options(Form::Lagrangian, method, 40.0);
    let run = |is_open: bool| {
        let mut dynamics = Recursive::new(Arc::clone(&mechanism));
        let motion = Integration::new(&mut dynamics, &initial, &options);
        let motion = match is_open {
            true => motion.choosing(),
            false => motion,
        };
        motion.run().expect("it goes on")
    };
    let (kept, open) = (run(false), run(true));
    assert!(kept.method_changes.is_empty());
    let change = open.method_changes.first().expect("Radau IIA takes over");
    assert_eq!(change.scheme, Scheme::Radau5, "{}", change.reason);
    assert!(change.time > 0.4, "{}", change.time);
    // At rest where the stop carries the effort.
    let expected = -9.81 / 1e8;
    assert!((open.state.configuration[0] - expected).abs() < 1e-9);
    let (kept, open) = (kept.statistics, open.statistics);
    println!("{kept:?}, {open:?}");
    assert!(
        3 * open.evaluations < kept.evaluations,
        "{open:?}, {kept:?}"
    );
}
