//! Discrete gradients keep the energy balance; symmetric methods let the energy swing without a drift.

use crate::support::{mixed, options, start};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Scheme, State, Step, integrate, no_inputs};
use hamel::mechanism::Mechanism;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The largest change of the energy over a run, as a part of the largest kinetic energy.
fn drift(mechanism: &Arc<Mechanism>, initial: &State, scheme: Scheme, dt: f64, t_end: f64) -> f64 {
    let first = mechanism
        .kinematics(&initial.configuration, &initial.speeds)
        .expect("sizes fit");
    let (mut worst, mut kinetic) = (0.0_f64, 0.0_f64);
    let mut observe = |step: &Step<'_>| {
        let now = mechanism
            .kinematics(step.configuration, step.speeds)
            .expect("sizes fit");
        worst = worst.max((now.energy() - first.energy()).abs());
        kinetic = kinetic.max(now.kinetic_energy());
        ControlFlow::Continue(())
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let options = options(Form::Hamiltonian, Method::fixed(scheme, dt), t_end);
    integrate(
        &mut dynamics,
        initial,
        &options,
        &mut no_inputs,
        &mut observe,
    )
    .expect("integrates");
    worst / kinetic
}

#[test]
fn discrete_gradients_keep_the_energy() {
    let mechanism = mixed();
    for (seed, dt) in [(5, 0.02), (6, 0.005)] {
        let initial = start(&mechanism, seed);
        let kept = drift(&mechanism, &initial, Scheme::DiscreteGradient, dt, 2.0);
        let plain = drift(&mechanism, &initial, Scheme::Midpoint, dt, 2.0);
        println!("{dt}: {kept:e}, midpoint {plain:e}");
        // Sums of eleven speeds and five bodies, evaluated here in another way than there.
        assert!(kept < 1e-13, "{kept:e}");
        assert!(plain > 1e-7, "{plain:e}: a case that says nothing");
    }
}
