//! What derivatives do not cover is refused by name.

use hamel::dynamics::{
    Dynamics, DynamicsError, ForwardSecondDerivatives, HamiltonianDerivatives, InverseDerivatives,
    InverseSecondDerivatives, Recursive,
};
use hamel::elements::{Action, Element, ElementError, PointConstraint, Slope, Slopes, View};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::Vector3;
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// An element that does not say how what it exerts changes, or changes once.
#[derive(Debug)]
struct Silent {
    has_slope: bool,
}

impl Slope for Silent {
    fn add_slopes(&self, _: &View<'_>, _: &mut Slopes<'_>) {}
}

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

    fn slope(&self) -> Option<&dyn Slope> {
        self.has_slope.then_some(self)
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
    let silent = mechanism.with_elements(vec![Arc::new(Silent { has_slope: false })]);
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

#[test]
fn what_second_derivatives_do_not_cover_is_refused_by_name() {
    let case = cases(&library(), 2, 2).last().expect("two bodies");
    let (q, v, tau, mechanism) = (&case.q, &case.speeds, &case.efforts, &case.mechanism);
    let silent: Arc<dyn Element> = Arc::new(Silent { has_slope: true });
    let silent = (**mechanism).clone().with_elements(vec![silent]);
    let silent = Arc::new(silent.expect("it fits"));
    let mut out = InverseSecondDerivatives::new(&silent);
    let refused = Recursive::new(Arc::clone(&silent)).inverse_dynamics_second_derivatives(
        q,
        v,
        &case.rates,
        v,
        &mut out,
    );
    let error = refused.expect_err("refused");
    assert!(matches!(
        error,
        DynamicsError::NotTwiceDifferentiable { .. }
    ));
    assert!(error.to_string().contains("`silent`"), "{error}");
    let edge = PointConstraint {
        name: "edge".to_owned(),
        body: mechanism.bodies().len() - 1,
        point: Vector3::new(0.3, -0.2, 0.5),
        direction: Vector3::new(0.6, 0.5, -0.4),
    };
    let edged = (**mechanism).clone().with_constraints(vec![edge], q);
    let edged = Arc::new(edged.expect("it fits"));
    let mut out = ForwardSecondDerivatives::new(&edged);
    let refused = Recursive::new(Arc::clone(&edged))
        .forward_dynamics_second_derivatives(q, v, tau, v, &mut out);
    let error = refused.expect_err("refused");
    assert!(matches!(
        error,
        DynamicsError::NotTwiceDifferentiable { .. }
    ));
    assert!(error.to_string().contains("`edge`"), "{error}");
}
