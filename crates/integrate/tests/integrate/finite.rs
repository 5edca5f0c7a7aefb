//! A kernel without a value stops the motion: the error names the joint, what has no value, and when, whatever takes the step.

use crate::common::joints;
use crate::common::trees::{GRAVITY, body};
use crate::common::wall::{Kernel, wall};
use crate::support::options;
use hamel_compiled::{Compiled, Equations, InLanes};
use hamel_integrate::{
    Event, Form, IntegrateError, Integration, Method, Sampling, Scheme, State, StepControl,
};
use hamel_runtime::dynamics::{Dynamics, Recursive, Reference, Refined};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::cell::RefCell;
use std::sync::Arc;

/// When the slider comes to its end, s: from 0.5 m at 1 m/s, with nothing that acts along it.
const END: f64 = 0.5;

/// A turntable, the slider on it along the axis of the turntable, and a pendulum that hangs on it: the joint at fault is neither first nor last.
fn mechanism(kernel: Kernel) -> Arc<Mechanism> {
    let mass = || {
        MassProperties::new(1.0, Vector3::new(0.1, 0.0, 0.0), Matrix3::identity() * 0.1)
            .expect("a body")
    };
    // The slider's x along the turntable's z, which is level, so that gravity does not act along it.
    let upright = Matrix3::new(0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0);
    let level = Pose::from_rotation(Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0));
    let bodies = vec![
        body("table", None, joints::revolute(), level, mass()),
        body(
            "slide",
            Some(0),
            wall(kernel),
            Pose::from_rotation(upright),
            mass(),
        ),
        body("tip", Some(1), joints::revolute(), Pose::identity(), mass()),
    ];
    Arc::new(Mechanism::new(GRAVITY, bodies).expect("regular at home"))
}

fn state() -> State {
    State {
        time: 0.0,
        configuration: vec![0.0, 0.5, 0.0],
        speeds: vec![0.0, 1.0, 0.0],
    }
}

fn methods() -> Vec<Method> {
    let fixed = Scheme::ALL
        .into_iter()
        .map(|scheme| Method::fixed(scheme, 0.03));
    let controlled = Scheme::ALL.into_iter().filter(Scheme::has_estimate);
    let controlled = controlled.map(|scheme| Method::Controlled {
        scheme,
        control: StepControl {
            tolerance: 1e-6,
            max_step: 0.05,
            first_step: None,
        },
    });
    fixed.chain(controlled).collect()
}

/// Whether the error says which joint, and what of it, at a time just before its end.
fn check(error: &IntegrateError, told: &str) {
    let (time, cause) = match error {
        IntegrateError::AtState { time, cause, .. }
        | IntegrateError::Step { time, cause, .. }
        | IntegrateError::StepUnderflow { time, cause, .. } => (*time, cause.to_string()),
        other => panic!("{told}: another error: {other}"),
    };
    assert!(cause.contains("`slide joint`"), "{told}: {cause}");
    assert!(cause.contains("finite"), "{told}: {cause}");
    assert!(!cause.contains("mass matrix"), "{told}: {cause}");
    assert!(error.to_string().contains(" s"), "{told}: {error}");
    // Gravity has a part along the slider, of 0.3 m/s² at most, that moves the end of the way by some hundredths; a step is 0.05 s long.
    assert!((time - END).abs() < 0.12, "{told}: {error}");
}

fn run(
    dynamics: &mut dyn Dynamics,
    form: Form,
    method: Method,
    sampling: Sampling,
) -> IntegrateError {
    let (initial, options) = (state(), options(form, method, 2.0));
    let moved = Integration::new(dynamics, &initial, &options)
        .sampling(sampling)
        .event(Event::new("never", |_, q, _| q[1] - 5.0))
        .inputs(|_, q, _, efforts| efforts[0] = -q[0])
        .run();
    moved
        .map(|_| ())
        .expect_err("there is no way beyond the end")
}

#[test]
fn every_method_ends_where_a_kernel_of_a_joint_has_no_value() {
    for kernel in Kernel::ALL {
        let mechanism = mechanism(kernel);
        for method in methods() {
            for &form in method.scheme().forms() {
                let told = format!("{kernel:?}, {method:?}, {form:?}");
                let mut tree = Recursive::new(Arc::clone(&mechanism));
                check(&run(&mut tree, form, method, Sampling::Dense), &told);
            }
        }
    }
}

#[test]
fn all_forms_of_the_dynamics_say_so() {
    for kernel in Kernel::ALL {
        let mechanism = mechanism(kernel);
        let forms: [Box<dyn Dynamics>; 2] = [
            Box::new(Refined::new(Arc::clone(&mechanism))),
            Box::new(Reference::new(Arc::clone(&mechanism))),
        ];
        for (number, mut dynamics) in forms.into_iter().enumerate() {
            for form in [Form::Lagrangian, Form::Hamiltonian] {
                let method = Method::rk4(0.03);
                let told = format!("{kernel:?}, form {number}, {form:?}");
                check(&run(&mut *dynamics, form, method, Sampling::Landing), &told);
            }
        }
    }
}

thread_local! {
    /// What stands for compiled code here: equations of motion that say nothing of why they fail.
    static CODE: RefCell<Option<Recursive>> = const { RefCell::new(None) };
}

fn forward(q: &[f64], speeds: &[f64], efforts: &[f64], rates: &mut [f64]) {
    CODE.with_borrow_mut(|code| {
        let done = code
            .as_mut()
            .map(|code| code.forward_dynamics(q, speeds, efforts, rates));
        if !matches!(done, Some(Ok(()))) {
            rates.fill(f64::NAN);
        }
    });
}

const EQUATIONS: Equations = Equations {
    scene: "wall",
    configuration: 3,
    freedoms: 3,
    speeds: 3,
    forward_dynamics: Some(forward),
    inverse_dynamics: None,
    momenta: None,
    speeds_from_momenta: None,
    momentum_rates: None,
    hamiltonian: None,
    forward_dynamics_derivatives: None,
    inverse_dynamics_derivatives: None,
    forward_dynamics_second_derivatives: None,
    inverse_dynamics_second_derivatives: None,
    forward_slopes: 0,
    mass_matrix: None,
    inverse_mass_matrix: None,
    in_lanes: InLanes::NONE,
};

#[test]
fn compiled_equations_leave_it_to_the_tree() {
    for kernel in Kernel::ALL {
        let mechanism = mechanism(kernel);
        CODE.set(Some(Recursive::new(Arc::clone(&mechanism))));
        let mut compiled = Compiled::new(mechanism, &EQUATIONS).expect("the same equations");
        for method in [Method::rk4(0.03), Method::dormand_prince(1e-6)] {
            let told = format!("{kernel:?}, {method:?}");
            let error = run(&mut compiled, Form::Lagrangian, method, Sampling::Landing);
            check(&error, &told);
        }
    }
}

#[test]
fn a_first_state_without_value_is_told() {
    let mechanism = mechanism(Kernel::Pose);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let initial = State {
        configuration: vec![0.0, 1.5, 0.0],
        ..state()
    };
    let options = options(Form::Lagrangian, Method::rk4(0.1), 1.0);
    let error = Integration::new(&mut dynamics, &initial, &options)
        .check()
        .expect_err("beyond the end");
    assert_eq!(
        error.to_string(),
        "at 0 s: the pose of joint `slide joint` is not finite"
    );
}
