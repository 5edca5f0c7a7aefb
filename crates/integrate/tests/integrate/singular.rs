//! Joints that are not global: approaches are measured, starts on a singular set refused, failures there explained.

use crate::common::polar::polar;
use crate::common::trees::body;
use crate::support::{options, run};
use hamel_integrate::{
    Form, IntegrateError, Method, Scheme, State, StepControl, integrate, no_inputs, no_observer,
};
use hamel_runtime::dynamics::Reference;
use hamel_runtime::mechanism::{Mechanism, MechanismErrors};
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A point of 1 kg without forces, in polar coordinates.
fn free_point(home: f64) -> Result<Arc<Mechanism>, MechanismErrors> {
    let mass = MassProperties::new(1.0, Vector3::zeros(), Matrix3::zeros()).expect("a point");
    let point = body("point", None, polar(home), Pose::identity(), mass);
    Mechanism::new(Vector3::zeros(), vec![point]).map(Arc::new)
}

/// At (2, 0) m, moving by 1 m/s towards a point `aside` m beside the centre.
fn towards_centre(aside: f64) -> State {
    let (sin, cos) = (aside / 2.0, (1.0 - aside * aside / 4.0).sqrt());
    State {
        time: 0.0,
        configuration: vec![2.0, 0.0],
        speeds: vec![-cos, sin / 2.0],
    }
}

/// A straight line passes the centre at its distance.
#[test]
fn the_nearest_approach_is_reported() {
    let mechanism = free_point(1.0).expect("valid");
    let aside = 0.01;
    let method = Method::Controlled {
        scheme: Scheme::DormandPrince,
        control: StepControl {
            tolerance: 1e-10,
            max_step: 1e-3,
            first_step: None,
        },
    };
    let solution = run(
        &mechanism,
        &towards_centre(aside),
        &options(Form::Lagrangian, method, 4.0),
    );
    let [approach] = solution.approaches.as_slice() else {
        panic!("one joint is watched: {:?}", solution.approaches);
    };
    // Steps of 1e-3 m miss the nearest point by half of that: by 5e-4²/(2·0.01) in distance.
    assert!(
        approach.value >= aside - 1e-8 && approach.value < aside + 2e-5,
        "{approach}"
    );
    assert!((approach.time - 2.0).abs() < 1e-3, "{approach}");
    assert_eq!(approach.joint, "point joint");
    assert!(
        approach
            .to_string()
            .starts_with("joint `point joint`: `r` comes to 1.0"),
        "{approach}"
    );
}

#[test]
fn a_start_on_a_singular_set_is_refused() {
    let errors = free_point(0.0).expect_err("singular at home");
    assert_eq!(
        errors[0].to_string(),
        "joint `point joint`: it is singular where `r` is 0, and at home the least of these is 0"
    );
    let mechanism = free_point(1.0).expect("valid");
    let error = mechanism
        .check_configuration(&[0.0, 0.3])
        .expect_err("r = 0");
    assert_eq!(
        error.to_string(),
        "joint `point joint`: it is singular where `r` is 0, and the least of these is 0"
    );
}

/// Straight through the centre: a step of 0.25 s lands on r = 0, where M is singular.
#[test]
fn a_failure_on_a_singular_set_names_it() {
    // In doubles the weights of the method add up to the number before 1.
    let initial = State {
        configuration: vec![0.25_f64.next_down(), 0.0],
        ..towards_centre(0.0)
    };
    let mut dynamics = Reference::new(free_point(1.0).expect("valid"));
    let error = integrate(
        &mut dynamics,
        &initial,
        &options(Form::Lagrangian, Method::rk4(0.25), 4.0),
        &mut no_inputs,
        &mut no_observer,
    )
    .expect_err("singular on the way");
    let near = match &error {
        IntegrateError::Step { near, .. } | IntegrateError::AtState { near, .. } => near,
        other => panic!("another error: {other}"),
    };
    assert!(near.0.is_some());
    let text = error.to_string();
    assert!(
        text.contains("; joint `point joint` is singular where `r` is 0, and it is "),
        "{text}"
    );
}

#[test]
fn extreme_times_have_exponents() {
    let mechanism = free_point(1.0).expect("valid");
    let at = |time: f64, t_end: f64| {
        let initial = State {
            time,
            ..towards_centre(0.5)
        };
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let options = options(Form::Lagrangian, Method::rk4(0.1), t_end);
        integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut no_inputs,
            &mut no_observer,
        )
        .expect_err("the end lies before the start")
        .to_string()
    };
    assert_eq!(
        at(1e200, -1e-200),
        "t_end is -1e-200 s: it lies before the initial time 1e200 s"
    );
    assert_eq!(
        at(2.5, 0.0),
        "t_end is 0 s: it lies before the initial time 2.5 s"
    );
}
