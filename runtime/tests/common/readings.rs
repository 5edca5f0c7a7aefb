//! All that a form of the dynamics says of one state, for comparing it with another form.

use hamel_runtime::dynamics::Dynamics;
use nalgebra::DVector;

/// The largest difference is below `rounding` times the largest entry, or times 1 where that is less.
pub fn assert_same(found: &[f64], expected: &[f64], rounding: f64, what: &str) {
    let (found, expected) = (
        DVector::from_column_slice(found),
        DVector::from_column_slice(expected),
    );
    let error = (&found - &expected).amax() / expected.amax().max(1.0);
    assert!(error < rounding, "{what}: {error:e}");
}

/// Accelerations, momenta, speeds, momentum rates and energy, one after the other.
pub fn readings(dynamics: &mut dyn Dynamics, q: &[f64], v: &[f64], tau: &[f64]) -> Vec<f64> {
    let mut all = Vec::new();
    let mut out = vec![0.0; v.len()];
    dynamics
        .forward_dynamics(q, v, tau, &mut out)
        .expect("regular");
    all.extend(&out);
    let mut momenta = vec![0.0; v.len()];
    dynamics.momenta(q, v, &mut momenta).expect("sizes fit");
    all.extend(&momenta);
    let mut speeds = vec![0.0; v.len()];
    let mut efforts = |_: &[f64], into: &mut [f64]| into.copy_from_slice(tau);
    dynamics
        .momentum_rates(q, &momenta, &mut efforts, &mut speeds, &mut out)
        .expect("regular");
    all.extend(&speeds);
    all.extend(&out);
    all.push(dynamics.hamiltonian(q, &momenta).expect("regular"));
    all
}
