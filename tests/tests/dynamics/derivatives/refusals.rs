//! What derivatives do not cover is refused by name.

use hamel::dynamics::{
    Dynamics, DynamicsError, HamiltonianDerivatives, InverseDerivatives, Recursive,
};
use hamel::elements::{Action, Element, ElementError, View};
use hamel::mechanism::Mechanism;
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// An element that does not say how what it exerts changes.
#[derive(Debug)]
struct Silent;

impl Element for Silent {
    fn name(&self) -> &str {
        "silent"
    }

    fn check(&self, _: &Mechanism) -> Result<(), ElementError> {
        Ok(())
    }

    fn act(&self, _: &View<'_>, _: &mut Action<'_>) {}

    fn energy(&self, _: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, _: &View<'_>) -> f64 {
        0.0
    }
}

/// The message of the refusal; the mechanism itself moves.
fn refusal(case: &Case, mechanism: Mechanism) -> String {
    let mechanism = Arc::new(mechanism);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let mut rates = case.rates.clone();
    let moved = dynamics.forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates);
    moved.expect("it moves");
    let mut out = HamiltonianDerivatives::new(&mechanism);
    let refused = dynamics.hamiltonian_derivatives(&case.q, &case.speeds, &case.efforts, &mut out);
    let error = refused.expect_err("refused");
    assert!(matches!(error, DynamicsError::NotDifferentiable { .. }));
    error.to_string()
}

#[test]
fn what_is_not_covered_is_refused_by_name() {
    let case = cases(&library(), 2, 2).last().expect("two bodies");
    let mechanism = (*case.mechanism).clone();
    let silent = mechanism.with_elements(vec![Arc::new(Silent)]);
    let message = refusal(&case, silent.expect("it fits"));
    assert!(message.contains("`silent`"), "{message}");
    let other = cases(&library(), 3, 3).last().expect("three bodies");
    let mut out = InverseDerivatives::new(&other.mechanism);
    let refused = Recursive::new(Arc::clone(&case.mechanism)).inverse_dynamics_derivatives(
        &case.q,
        &case.speeds,
        &case.rates,
        &mut out,
    );
    assert_eq!(refused, Err(DynamicsError::ForeignResults));
}
