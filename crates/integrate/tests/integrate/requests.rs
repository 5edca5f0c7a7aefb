//! What a caller asks for, gets, and is refused.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{GRAVITY, body, tree};
use crate::support::{distance, fixed_steps, options, run, start};
use hamel_integrate::{
    Estimate, Form, IntegrateError, Method, Options, Scheme, State, StepControl, StepFailure,
    Tableau, integrate, no_inputs, no_observer,
};
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Reference};
use hamel_runtime::mechanism::{Mechanism, StateError};
use hamel_runtime::spatial::{MassProperties, Pose};
use std::ops::ControlFlow;
use std::sync::Arc;

#[test]
fn sample_times_are_hit_exactly() {
    let mechanism = tree(&mut Random::new(4), &[joints::revolute(), joints::ball()]);
    let initial = State {
        time: 0.25,
        ..start(&mechanism, 8)
    };
    let samples = vec![0.25, 0.3, 0.3, 1.0 / 3.0, 0.7, 1.0];
    for method in [Method::rk4(0.01), Method::dormand_prince(1e-10)] {
        let options = Options {
            form: Form::Lagrangian,
            method,
            t_end: 1.0,
            samples: samples.clone(),
        };
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let (mut seen, mut last) = (Vec::new(), 0);
        let mut observer = |step: &hamel_integrate::Step<'_>| {
            seen.extend(step.sample.map(|_| step.time));
            last = step.number;
            ControlFlow::Continue(())
        };
        let solution = integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut no_inputs,
            &mut observer,
        )
        .expect("integrates");
        let times: Vec<_> = solution.samples.iter().map(|state| state.time).collect();
        assert_eq!(times, samples);
        assert_eq!(seen, [0.25, 0.3, 1.0 / 3.0, 0.7, 1.0]);
        assert_eq!(
            (
                solution.state.time,
                solution.statistics.steps,
                solution.stopped
            ),
            (1.0, last, false)
        );
        assert_eq!(&solution.state, &solution.samples[5]);
        assert_eq!(solution.samples[0], initial);
        // Landing on the way does not change the motion beyond the method's error.
        let direct = run(
            &mechanism,
            &initial,
            &Options {
                samples: Vec::new(),
                ..options
            },
        );
        assert!(distance(&direct.state, &solution.state) < 1e-7);
    }
}

#[test]
fn work_is_counted() {
    let mechanism = tree(&mut Random::new(4), &[joints::revolute()]);
    let initial = start(&mechanism, 8);
    let statistics = run(
        &mechanism,
        &initial,
        &options(Form::Lagrangian, Method::rk4(0.01), 1.0),
    )
    .statistics;
    assert_eq!(
        (
            statistics.steps,
            statistics.rejected,
            statistics.evaluations
        ),
        (100, 0, 1 + 4 * 100)
    );
    let statistics = run(
        &mechanism,
        &initial,
        &options(Form::Lagrangian, fixed_steps(0.01), 1.0),
    )
    .statistics;
    assert_eq!(
        (
            statistics.steps,
            statistics.rejected,
            statistics.evaluations
        ),
        (100, 0, 1 + 6 * 100)
    );
    // The last of its sixteen stages is for the estimate alone; the first is that of the state.
    let verner9 = Method::fixed(Scheme::Verner9, 0.01);
    let options_of = |method| options(Form::Lagrangian, method, 1.0);
    let statistics = run(&mechanism, &initial, &options_of(verner9)).statistics;
    assert_eq!(statistics.evaluations, 1 + 15 * 100);
    let rough = Method::Controlled {
        scheme: Scheme::DormandPrince,
        control: StepControl {
            tolerance: 1e-10,
            max_step: f64::INFINITY,
            first_step: Some(1.0),
        },
    };
    let statistics = run(&mechanism, &initial, &options(Form::Lagrangian, rough, 1.0)).statistics;
    assert!(statistics.rejected > 2);
    // Rounding is looked at in the first attempt and after two that were refused, by an evaluation each.
    assert_eq!(
        statistics.evaluations,
        1 + 6 * (statistics.steps + statistics.rejected) + 2
    );
}

#[test]
fn observer_ends_the_integration() {
    let mechanism = tree(&mut Random::new(4), &[joints::revolute()]);
    let initial = start(&mechanism, 8);
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    let options = options(Form::Hamiltonian, Method::rk4(0.01), 1.0);
    let mut observer = |step: &hamel_integrate::Step<'_>| {
        assert!(step.momenta.is_some());
        if step.number == 7 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observer,
    )
    .expect("integrates");
    assert!(solution.stopped);
    assert_eq!(solution.statistics.steps, 7);
    assert!((solution.state.time - 0.07).abs() < 1e-16);
}

fn refused(initial: &State, options: &Options) -> IntegrateError {
    let mechanism = tree(&mut Random::new(4), &[joints::revolute()]);
    let mut dynamics = Reference::new(mechanism);
    integrate(
        &mut dynamics,
        initial,
        options,
        &mut no_inputs,
        &mut no_observer,
    )
    .expect_err("refused")
}

#[test]
fn bad_requests_are_named() {
    let initial = State {
        time: 0.0,
        configuration: vec![0.0],
        speeds: vec![1.0],
    };
    let with = |method: Method, t_end: f64, samples: &[f64]| {
        let options = Options {
            form: Form::Lagrangian,
            method,
            t_end,
            samples: samples.to_vec(),
        };
        refused(&initial, &options).to_string()
    };
    let rk4 = Method::rk4(0.1);
    assert_eq!(
        with(rk4, -1.0, &[]),
        "t_end is -1 s: it lies before the initial time 0 s"
    );
    assert_eq!(with(rk4, f64::NAN, &[]), "t_end is NaN: it must be finite");
    assert_eq!(
        with(Method::rk4(0.0), 1.0, &[]),
        "dt is 0: it must be positive and finite"
    );
    assert_eq!(
        with(Method::dormand_prince(0.5), 1.0, &[]),
        "tolerance is 0.5: it must be between 1e-16 and 0.1"
    );
    assert_eq!(
        with(rk4, 1.0, &[0.5, 0.4]),
        "sample 1 is at 0.4 s: sample times ascend, and this one must lie between 0.5 s and 1 s"
    );
    let lost = State {
        speeds: vec![f64::NAN],
        ..initial.clone()
    };
    assert_eq!(
        refused(&lost, &options(Form::Lagrangian, rk4, 1.0)).to_string(),
        "initial state: joint `body 0 joint`: speeds entry `turn` is NaN, not a finite number"
    );
    let short = State {
        configuration: Vec::new(),
        ..initial
    };
    assert_eq!(
        refused(&short, &options(Form::Lagrangian, rk4, 1.0)).to_string(),
        "initial state: configuration of the mechanism has 0 entries: it must have 1"
    );
}

#[test]
fn steps_beyond_half_a_turn_are_refused() {
    let mechanism = tree(&mut Random::new(4), &[joints::ball()]);
    let mut initial = start(&mechanism, 1);
    initial.speeds = vec![40.0, 0.0, 0.0];
    let mut dynamics = Reference::new(mechanism);
    let error = integrate(
        &mut dynamics,
        &initial,
        &options(Form::Lagrangian, Method::rk4(0.1), 1.0),
        &mut no_inputs,
        &mut no_observer,
    )
    .expect_err("refused");
    let IntegrateError::Step { cause, .. } = &error else {
        panic!("another error: {error}");
    };
    assert!(matches!(&**cause, StepFailure::Turn { .. }), "{error}");
    assert!(error.to_string().ends_with("; take a smaller dt"));
}

/// An effort that ends the motion in finite time, and one that is no number.
#[test]
fn singular_motion_underflows_with_a_cause() {
    let mechanism = tree(&mut Random::new(4), &[joints::revolute()]);
    let initial = State {
        time: 0.0,
        configuration: vec![0.0],
        speeds: vec![1.0],
    };
    let mut dynamics = Reference::new(mechanism);
    // How long the motion was to go on has no influence on where it stops.
    let options = options(Form::Lagrangian, Method::dormand_prince(1e-8), 1e9);
    let mut blow_up = |_: f64, _: &[f64], speeds: &[f64], efforts: &mut [f64]| {
        efforts[0] = 100.0 * speeds[0].powi(3);
    };
    let error = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut blow_up,
        &mut no_observer,
    )
    .expect_err("blows up");
    assert!(
        matches!(error, IntegrateError::StepUnderflow { .. }),
        "{error}"
    );
    assert!(error.to_string().contains("`body 0 joint`"), "{error}");
    let mut wall = |time: f64, _: &[f64], _: &[f64], efforts: &mut [f64]| {
        efforts[0] = if time > 0.5 { f64::NAN } else { 0.0 };
    };
    let error = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut wall,
        &mut no_observer,
    )
    .expect_err("not a number");
    let IntegrateError::StepUnderflow { time, cause, .. } = &error else {
        panic!("another error: {error}");
    };
    assert!((time - 0.5).abs() < 1e-14);
    assert!(matches!(
        &**cause,
        StepFailure::State(StateError::NotFinite {
            quantity: "efforts",
            ..
        })
    ));
}

#[test]
fn singular_mass_is_an_error_of_the_initial_state() {
    let ghost = body(
        "ghost",
        None,
        joints::ball(),
        Pose::identity(),
        MassProperties::massless(),
    );
    let mechanism = Arc::new(Mechanism::new(GRAVITY, vec![ghost]).expect("valid"));
    let initial = start(&mechanism, 1);
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let options = options(form, Method::rk4(0.1), 1.0);
        let error = integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut no_inputs,
            &mut no_observer,
        )
        .expect_err("singular");
        let IntegrateError::AtState {
            time: 0.0, cause, ..
        } = &error
        else {
            panic!("another error: {error}");
        };
        let expected = matches!(
            &**cause,
            StepFailure::Dynamics(DynamicsError::SingularMass { .. })
        );
        assert!(expected, "{error}");
    }
    assert_eq!(dynamics.mechanism().bodies().len(), 1);
}

/// A tableau of the caller's is looked over before a step is taken.
#[test]
fn tableaus_that_are_none_are_refused() {
    const HEUN: Tableau = Tableau {
        order: 2,
        nodes: &[0.0, 1.0],
        matrix: &[&[], &[1.0]],
        weights: &[0.5, 0.5],
        estimate: Estimate::One(&[-0.5, 0.5]),
        first_same_as_last: false,
    };
    const SHORT_ROW: Tableau = Tableau {
        matrix: &[&[], &[]],
        ..HEUN
    };
    const FEW_WEIGHTS: Tableau = Tableau {
        weights: &[1.0],
        ..HEUN
    };
    const LONG_ESTIMATE: Tableau = Tableau {
        estimate: Estimate::One(&[0.5, 0.0, -0.5]),
        ..HEUN
    };
    const WRONG_NODE: Tableau = Tableau {
        nodes: &[0.0, 0.5],
        ..HEUN
    };
    const WRONG_WEIGHTS: Tableau = Tableau {
        weights: &[0.5, 0.6],
        ..HEUN
    };
    const EMPTY: Tableau = Tableau {
        nodes: &[],
        matrix: &[],
        weights: &[],
        ..HEUN
    };
    for own in [
        Tableau::RK4,
        Tableau::DORMAND_PRINCE,
        Tableau::DORMAND_PRINCE_8,
        Tableau::VERNER_9,
        HEUN,
    ] {
        assert_eq!(own.fault(), None);
    }
    let mechanism = tree(&mut Random::new(4), &[joints::revolute()]);
    let initial = start(&mechanism, 8);
    for (tableau, told) in [
        (&SHORT_ROW, "has 0 entries in row 1 where 1 are due"),
        (&FEW_WEIGHTS, "has 1 weights where 2 are due"),
        (
            &LONG_ESTIMATE,
            "has 3 weights of the estimate where 2 are due",
        ),
        (
            &WRONG_NODE,
            "has entries in row 1 that sum to 1.0 instead of 0.5",
        ),
        (&WRONG_WEIGHTS, "has weights that sum to 1.1 instead of 1.0"),
        (&EMPTY, "has 0 stages and order 2"),
    ] {
        let method = Method::fixed(Scheme::Explicit(tableau), 0.1);
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let options = options(Form::Lagrangian, method, 1.0);
        let refused = integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut no_inputs,
            &mut no_observer,
        );
        let error = refused.expect_err("no method").to_string();
        assert!(error.contains(told), "{error}");
    }
}
