//! The equations themselves: (24), (26), (34) and (37) against Newton–Euler, (27) and (35) against (24) and (34).

use super::{Point, points};
use crate::figures::{Largest, difference, size};
use hamel::erased::AnyJoint;
use hamel::nalgebra::DVector;
use std::sync::Arc;

/// Bound of relative errors: each side sums some hundred products a degree of freedom over 12 bodies, and intermediate terms on arms
/// of several metres exceed the largest of the equation up to tenfold; 1000 roundings of 1.1e-16.
const ROUNDING: f64 = 1e-13;

/// Difference of two vectors relative to the largest of the terms.
fn relative(found: &DVector<f64>, expected: &DVector<f64>, terms: &[&DVector<f64>]) -> f64 {
    let largest = terms
        .iter()
        .map(|term| size(term.as_slice()))
        .fold(0.0, f64::max);
    difference(found.as_slice(), expected.as_slice()) / largest.max(size(expected.as_slice()))
}

/// (24) and (26): `M v̇ + Ĉv + N̂` is what the joints exert, constraint forces included, for all degrees of freedom.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn theorem_2_is_newton_euler(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("M v̇ + Ĉv + N̂ against Newton–Euler");
    for point in points(kinds) {
        let expansion = &point.expansion;
        let inertia = &expansion.mass_matrix * &point.v_rate;
        let coriolis = expansion.coriolis_matrix(&point.v) * &point.v;
        let weight = expansion.potential_forces();
        let (recursion, _) = point.newton_euler(&point.rates);
        let mut expected = DVector::zeros(point.v.len());
        recursion
            .joint_efforts(&point.case.q, expected.as_mut_slice())
            .expect("sizes fit");
        let found = &inertia + &coriolis + &weight;
        worst.meet(
            relative(&found, &expected, &[&inertia, &coriolis, &weight]),
            point.case.seed,
        );
    }
    worst.assert_within(ROUNDING);
}

/// (34): `M̄ v̄̇ + C̄ v̄ + S̄ᵀN̂ = S̄ᵀτ`.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn theorem_3_is_newton_euler(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("M̄ v̄̇ + C̄v̄ + S̄ᵀN̂ against Newton–Euler");
    for point in points(kinds) {
        let expansion = &point.expansion;
        let inertia = expansion.reduced_mass_matrix() * &point.rates;
        let coriolis = expansion.reduced_coriolis_matrix(&point.speeds) * &point.speeds;
        let weight = expansion.reduced_potential_forces();
        let (_, expected) = point.newton_euler(&point.rates);
        let found = &inertia + &coriolis + &weight;
        worst.meet(
            relative(&found, &expected, &[&inertia, &coriolis, &weight]),
            point.case.seed,
        );
    }
    worst.assert_within(ROUNDING);
}

/// (27) is (24): `ṗ = M v̇ + Ṁ v`, with τ and the constraint forces on the right.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn hamiltonian_form_of_theorem_2(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("ṗ of (27) against d/dt (M v)");
    for point in points(kinds) {
        let expansion = &point.expansion;
        let (recursion, _) = point.newton_euler(&point.rates);
        let mut efforts = DVector::zeros(point.v.len());
        recursion
            .joint_efforts(&point.case.q, efforts.as_mut_slice())
            .expect("sizes fit");
        let found = expansion.momentum_rate(&point.v, &efforts);
        let inertia = &expansion.mass_matrix * &point.v_rate;
        let change = expansion.mass_matrix_rate(&point.v) * &point.v;
        worst.meet(
            relative(
                &found,
                &(&inertia + &change),
                &[&inertia, &change, &efforts],
            ),
            point.case.seed,
        );
    }
    worst.assert_within(ROUNDING);
}

/// (35) and (36) are (34): `p̄̇ = M̄ v̄̇ + d/dt(M̄) v̄` under random efforts, through [`hamel::dynamics::Dynamics`].
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn hamiltonian_form_of_theorem_3(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("p̄̇ of (35) against d/dt (M̄ v̄)");
    for point in points(kinds) {
        let inertia = point.expansion.reduced_mass_matrix() * point.accelerations();
        let change = point.reduced_mass_rate() * &point.speeds;
        let found = point
            .expansion
            .reduced_momentum_rate(&point.speeds, &point.efforts);
        worst.meet(
            relative(&found, &(&inertia + &change), &[&inertia, &change]),
            point.case.seed,
        );
    }
    worst.assert_within(ROUNDING);
}

/// The largest over the smallest eigenvalue of M.
fn condition(point: &Point) -> f64 {
    let eigenvalues = point.expansion.mass_matrix.symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}

/// λ of (37) is the joint wrench's part: `λ = (AᵀA)⁻¹ Aᵀ (X^cᵀF − τ)`.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn constraint_forces_are_those_of_the_joint_wrench(kinds: &[Arc<dyn AnyJoint>]) {
    let mut worst = Largest::new("λ of (37) against the joint wrench, over the condition of M");
    for point in points(kinds).filter(|point| point.expansion.constraint.ncols() > 0) {
        let (recursion, _) = point.newton_euler(&point.accelerations());
        let mut expected = DVector::zeros(point.expansion.constraint.ncols());
        recursion
            .constraint_force(&point.case.q, &point.case.efforts, expected.as_mut_slice())
            .expect("independent");
        let found = point
            .reference
            .constraint_force(&point.case.q, &point.case.speeds, &point.case.efforts)
            .expect("regular");
        let coriolis = point.expansion.coriolis_matrix(&point.v) * &point.v;
        let weight = point.expansion.potential_forces();
        let error = relative(&found, &expected, &[&coriolis, &weight, &point.efforts]);
        worst.meet(error / condition(&point), point.case.seed);
    }
    // (37) solves with M, so that its rounding grows with the condition of M; n ε with n up to 50 degrees of freedom.
    worst.assert_within(50.0 * f64::EPSILON);
}
