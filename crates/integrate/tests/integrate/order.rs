//! Errors fall with the step as the tableaus promise.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::tree;
use crate::support::{distance, mixed, options, run, start};
use hamel_integrate::{Form, Method, Scheme, integrate, no_observer};
use hamel_runtime::dynamics::Reference;
use std::sync::Arc;

#[test]
fn methods_have_their_order_in_both_forms() {
    let mechanism = mixed();
    let initial = start(&mechanism, 5);
    let reference = run(
        &mechanism,
        &initial,
        &options(
            Form::Lagrangian,
            Method::controlled(Scheme::Verner9, 1e-16),
            0.2,
        ),
    )
    .state;
    // Few enough steps that the error of the finer run stays far above rounding.
    let schemes = [
        (4.0, 10.0, Scheme::Rk4),
        (4.0, 10.0, Scheme::CommutatorFree4),
        (5.0, 10.0, Scheme::DormandPrince),
        (8.0, 1.0, Scheme::DormandPrince8),
        (9.0, 1.0, Scheme::Verner9),
        (2.0, 20.0, Scheme::Midpoint),
        (4.0, 10.0, Scheme::Gauss2),
        (6.0, 4.0, Scheme::Gauss3),
        (5.0, 10.0, Scheme::Radau5),
        (4.0, 10.0, Scheme::Exponential),
    ];
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let of_this_form =
            (form == Form::Hamiltonian).then_some((2.0, 20.0, Scheme::DiscreteGradient));
        for (order, steps, scheme) in schemes.into_iter().chain(of_this_form) {
            let error = |steps: f64| {
                let options = options(form, Method::fixed(scheme, 0.2 / steps), 0.2);
                distance(&run(&mechanism, &initial, &options).state, &reference)
            };
            let measured = (error(steps) / error(2.0 * steps)).log2();
            println!(
                "{form:?}, {}: order {measured:.2}, error {:e}",
                scheme.name(),
                error(2.0 * steps)
            );
            // Where the leading coefficient happens to be small, the next order shows: one more at most.
            assert!(
                measured > order - 0.2 && measured < order + 1.2,
                "{form:?}: order {measured} instead of {order}"
            );
        }
    }
}

#[test]
fn inputs_that_vary_in_time_keep_the_order() {
    let mechanism = tree(&mut Random::new(2), &[joints::ball(), joints::revolute()]);
    let initial = start(&mechanism, 3);
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    let mut end = |form: Form, method: Method| {
        let mut inputs = |time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]| {
            assert!(efforts.iter().all(|&effort| effort == 0.0));
            for (effort, speed) in efforts.iter_mut().zip(speeds) {
                *effort = (3.0 * time).cos() * q[1] - 0.5 * speed;
            }
        };
        let options = options(form, method, 0.5);
        integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut inputs,
            &mut no_observer,
        )
        .expect("integrates")
        .state
    };
    let reference = end(Form::Lagrangian, Method::dormand_prince(1e-13));
    let other = end(Form::Hamiltonian, Method::dormand_prince(1e-13));
    assert!(
        distance(&reference, &other) < 1e-11,
        "a hundred steps of 1e-13"
    );
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let coarse = distance(&end(form, Method::rk4(0.05)), &reference);
        let fine = distance(&end(form, Method::rk4(0.025)), &reference);
        assert!(
            ((coarse / fine).log2() - 4.0).abs() < 0.5,
            "{coarse:e} {fine:e}"
        );
    }
}
