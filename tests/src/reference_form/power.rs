//! Power balance: `dH/dt = yᵀτ`, in both forms and along the motion itself.

use super::{Point, points};
use crate::differences::{self, moved};
use crate::figures::Largest;
use hamel::dynamics::Dynamics;
use hamel::erased::AnyJoint;
use hamel::nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Powers of up to 50 degrees of freedom, each from sums over 50: 1000 roundings of 1.1e-16. The condition of M̄ does not enter, since
/// the residual of a solution with M̄ is small in forces.
const ROUNDING: f64 = 1e-13;

/// The sum of some powers over the sum of their sizes.
fn imbalance(powers: &[DVector<f64>]) -> f64 {
    let terms = || powers.iter().flat_map(|power| power.iter());
    terms().sum::<f64>().abs() / terms().map(|term| term.abs()).sum::<f64>()
}

/// `v̄ᵀM̄v̄̇ + ½ v̄ᵀṀ̄v̄ + ∂V/∂ϕᵀϕ̇ = vᵀτ`.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn lagrangian_form(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("power balance, Lagrangian form");
    for point in points(kinds) {
        let (expansion, speeds) = (&point.expansion, &point.speeds);
        let inertia = expansion.reduced_mass_matrix() * point.accelerations();
        let change = point.reduced_mass_rate() * speeds * 0.5;
        let powers = [
            speeds.component_mul(&inertia),
            speeds.component_mul(&change),
            expansion
                .potential_gradient
                .component_mul(&expansion.local_rate(&point.v)),
            -point.v.component_mul(&point.efforts),
        ];
        worst.meet(imbalance(&powers), point.case.seed);
    }
    worst.assert_within(ROUNDING);
}

/// `∂H̄/∂ϕᵀϕ̇ + ∂H̄/∂p̄ᵀp̄̇ = vᵀτ`, from the rates that the integrator sees.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn hamiltonian_form(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("power balance, port-Hamiltonian form");
    for mut point in points(kinds) {
        let size = point.speeds.len();
        let momenta = point.expansion.reduced_mass_matrix() * &point.speeds;
        let (mut speeds, mut rates) = (DVector::zeros(size), DVector::zeros(size));
        let efforts = point.case.efforts.clone();
        let outcome = point.reference.momentum_rates(
            &point.case.q,
            momenta.as_slice(),
            &mut |_, tau| tau.copy_from_slice(&efforts),
            speeds.as_mut_slice(),
            rates.as_mut_slice(),
        );
        outcome.expect("every body has mass");
        let v = &point.expansion.speed_basis * &speeds;
        let gradient = point.expansion.reduced_hamiltonian_gradient(&speeds);
        let powers = [
            gradient.component_mul(&point.expansion.local_rate(&v)),
            speeds.component_mul(&rates),
            -v.component_mul(&point.efforts),
        ];
        worst.meet(imbalance(&powers), point.case.seed);
    }
    worst.assert_within(ROUNDING);
}

/// The energy of the bodies, without any matrix, along the path that starts with ϕ̇ and v̄̇.
fn energy(point: &Point, local_rate: &DVector<f64>, rates: &DVector<f64>, t: f64) -> f64 {
    let phi = local_rate * t;
    let q = moved(&point.case.mechanism, &point.case.q, phi.as_slice());
    let speeds = &point.speeds + rates * t;
    let kinematics = point.case.mechanism.kinematics(&q, speeds.as_slice());
    kinematics.expect("sizes fit").energy()
}

/// Along the motion.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn along_the_motion(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("power balance by differences of the bodies' energy");
    for point in points(kinds) {
        let local_rate = point.expansion.local_rate(&point.v);
        let rates = point.accelerations();
        // The path is wanted over a time in which speeds change by a part of 1.
        let step = differences::FINE / rates.amax().max(1.0);
        let found = differences::derivative(step, |t| {
            DMatrix::from_element(1, 1, energy(&point, &local_rate, &rates, t))
        });
        let expected = point.v.dot(&point.efforts);
        let scale = energy(&point, &local_rate, &rates, 0.0).abs().max(100.0) / step;
        worst.meet((found[0] - expected).abs() / scale, point.case.seed);
    }
    // In units of E / h: a body's velocity rounds at each of up to 12 joints and counts twice in its energy, 24 ε; the
    // difference takes six such energies by weights whose sizes sum to 11/6. The truncation, h⁶ / 140 · 2⁷, is 1e-13 of
    // the power.
    worst.assert_within(24.0 * 11.0 / 6.0 * f64::EPSILON);
}
