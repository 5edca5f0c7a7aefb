//! Second derivatives of the dynamics against dual numbers of dual numbers.

use super::robots;
use hamel::dynamics::{
    DynamicsError, ForwardSecondDerivatives, InverseSecondDerivatives, Recursive,
};
use hamel_tests::derivatives::{Equipped, bare_and_equipped, library_kernels, second};
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// Every kind of joint at the root of some tree.
const TREES: u64 = 80;

/// Bare, and with elements of all kinds and rotors at every joint: all pairs of coordinates are moved along, so that trees and robots are small.
fn all() -> Vec<Equipped> {
    let kinds = library();
    let robots = || robots().filter(|case| case.mechanism.bodies().len() < 9);
    let bare = cases(&kinds, 5, TREES).chain(robots());
    bare_and_equipped(bare, cases(&kinds, 4, TREES).chain(robots()))
}

#[test]
fn inverse_dynamics() {
    second::inverse_dynamics(all(), library_kernels);
}

#[test]
fn forward_dynamics() {
    second::forward_dynamics(all(), library_kernels);
}

/// Where S is not that of an identity at every ϕ, derivatives along one direction after the other are not the Hessian: the laws above see it in many cases.
#[test]
fn charts_of_joints_count() {
    let shares = all()
        .iter()
        .map(second::share_of_charts)
        .collect::<Vec<f64>>();
    let count = shares.iter().filter(|share| **share > 1e-3).count();
    assert!(count > shares.len() / 3, "{count} of {}", shares.len());
}

/// What was filled in for one state leaves nothing behind for the next.
#[test]
fn results_are_used_again() {
    for Equipped { case, .. } in all().into_iter().step_by(7) {
        let still = vec![0.0; case.speeds.len()];
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut entries = |speeds: &[&[f64]]| {
            let mut inverse = InverseSecondDerivatives::new(&case.mechanism);
            let mut forward = ForwardSecondDerivatives::new(&case.mechanism);
            for v in speeds {
                dynamics
                    .inverse_dynamics_second_derivatives(&case.q, v, &case.rates, v, &mut inverse)
                    .expect("covered");
                dynamics
                    .forward_dynamics_second_derivatives(&case.q, v, &case.efforts, v, &mut forward)
                    .expect("covered");
            }
            [inverse.hessian(), forward.hessian()].map(|matrix| matrix.entries().to_vec())
        };
        let once = entries(&[&still]);
        let again = entries(&[&case.speeds, &still]);
        assert!(once == again, "case {}", case.seed);
    }
}

fn refusal(found: Result<(), DynamicsError>) -> String {
    found.expect_err("refused").to_string()
}

#[test]
fn sizes_are_told() {
    let case = cases(&library(), 3, 3).last().expect("three bodies");
    let Case {
        mechanism,
        q,
        speeds,
        rates,
        efforts,
        ..
    } = case;
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let mut inverse = InverseSecondDerivatives::new(&mechanism);
    let mut forward = ForwardSecondDerivatives::new(&mechanism);
    let short = &speeds[1..];
    for message in [
        refusal(dynamics.inverse_dynamics_second_derivatives(
            &q,
            &speeds,
            &rates,
            short,
            &mut inverse,
        )),
        refusal(dynamics.forward_dynamics_second_derivatives(
            &q,
            &speeds,
            &efforts,
            short,
            &mut forward,
        )),
    ] {
        assert!(message.contains("weights"), "{message}");
    }
    let size = forward.hessian().rows();
    let mut product = vec![0.0; size];
    let message = refusal(forward.times(&vec![0.0; size + 1], &mut product));
    assert!(message.contains("direction"), "{message}");
    let message = refusal(inverse.times(&vec![0.0; inverse.hessian().rows()], &mut []));
    assert!(message.contains("result"), "{message}");
    let other = cases(&library(), 4, 4).last().expect("four bodies");
    let mut foreign = InverseSecondDerivatives::new(&other.mechanism);
    let found =
        dynamics.inverse_dynamics_second_derivatives(&q, &speeds, &rates, &rates, &mut foreign);
    assert_eq!(found, Err(DynamicsError::ForeignResults));
}
