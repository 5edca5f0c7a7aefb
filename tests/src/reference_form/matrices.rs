//! The matrices: M, its derivatives, Ĉ and Ĉ′.

use super::points;
use crate::differences;
use crate::figures::Largest;
use hamel::erased::AnyJoint;
use hamel::nalgebra::{Cholesky, DMatrix};
use std::sync::Arc;

/// Sums over 12 bodies of products of 6-vectors, cancelling tenfold at most: 1000 roundings of 1.1e-16.
const ROUNDING: f64 = 1e-13;

/// Mass matrix is symmetric positive and gives the kinetic energy.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn mass_matrix_is_symmetric_positive_and_gives_the_kinetic_energy(kinds: &[Arc<dyn AnyJoint>]) {
    let mut symmetry = Largest::new("M − Mᵀ");
    let mut energy = Largest::new("½ vᵀMv against the kinetic energy of the bodies");
    let mut potential = Largest::new("V against the potential energy of the bodies");
    for point in points(kinds) {
        let (case, mass) = (&point.case, &point.expansion.mass_matrix);
        symmetry.meet((mass - mass.transpose()).amax() / mass.amax(), case.seed);
        assert!(
            Cholesky::new(mass.clone()).is_some(),
            "M of case {} is not positive",
            case.seed
        );
        let kinematics = case
            .mechanism
            .kinematics(&case.q, &case.speeds)
            .expect("sizes fit");
        let expected = kinematics.kinetic_energy();
        let found = 0.5 * point.v.dot(&(mass * &point.v));
        energy.meet((found - expected).abs() / expected, case.seed);
        let terms: f64 = kinematics
            .bodies
            .iter()
            .map(|body| body.potential_energy.abs())
            .sum();
        let expected = kinematics.potential_energy();
        potential.meet(
            (point.expansion.potential - expected).abs() / terms,
            case.seed,
        );
    }
    symmetry.assert_within(ROUNDING);
    energy.assert_within(ROUNDING);
    potential.assert_within(ROUNDING);
}

/// ∂M/∂ϕ, ∂V/∂ϕ and ∂S̄/∂ϕ against differences through Φ.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn derivatives_in_phi_are_those_of_differences(kinds: &[Arc<dyn AnyJoint>]) {
    let mut mass = Largest::new("∂M/∂ϕ against differences");
    let mut potential = Largest::new("∂V/∂ϕ against differences");
    let mut basis = Largest::new("∂S̄/∂ϕ against differences");
    for point in points(kinds) {
        let (mechanism, expansion) = (&point.case.mechanism, &point.expansion);
        let (k, s) = expansion.speed_basis.shape();
        // M, S̄ and V side by side, so that each moved configuration is expanded once.
        let found = differences::gradient(mechanism, &point.case.q, |q| {
            let moved = point.reference.expansion(q).expect("sizes fit");
            let mut all = DMatrix::zeros(k, k + s + 1);
            all.view_mut((0, 0), (k, k)).copy_from(&moved.mass_matrix);
            all.view_mut((0, k), (k, s)).copy_from(&moved.speed_basis);
            all[(0, k + s)] = moved.potential;
            all
        });
        for (index, slice) in found.iter().enumerate() {
            let place = format!("case {}, ϕ_{index}", point.case.seed);
            let error = slice.view((0, 0), (k, k)) - &expansion.mass_matrix_gradient[index];
            mass.meet(error.amax() / expansion.mass_matrix.amax(), &place);
            let error = slice.view((0, k), (k, s)) - &expansion.speed_basis_gradient[index];
            basis.meet(error.amax(), &place);
            let error = slice[(0, k + s)] - expansion.potential_gradient[index];
            potential.meet(
                error.abs()
                    / expansion
                        .potential_gradient
                        .amax()
                        .max(expansion.potential.abs()),
                &place,
            );
        }
    }
    // Rounding of M, some 10 ε, over h = 1/128: 3e-13. Truncation h⁶ f⁽⁷⁾ / 140 with f⁽⁷⁾ = 2⁷ f for products of two
    // entries of a rotation: 2e-13.
    mass.assert_within(2e-12);
    potential.assert_within(2e-12);
    basis.assert_within(2e-12);
}

/// `vᵀ(Ṁ − 2Ĉ)v = 0` for that v; `Ĉ′v = Ĉv`, and `Ṁ − 2Ĉ′` is skew, which `Ṁ − 2Ĉ` is not.
///
/// # Panics
/// With the figure and the case, where it does not hold.
pub fn coriolis_matrices(kinds: &[Arc<dyn AnyJoint>]) {
    let mut power = Largest::new("vᵀ(Ṁ − 2Ĉ)v");
    let mut action = Largest::new("Ĉ′v − Ĉv");
    let mut skew = Largest::new("symmetric part of Ṁ − 2Ĉ′");
    let mut not_skew: f64 = 0.0;
    for point in points(kinds) {
        let (expansion, v, seed) = (&point.expansion, &point.v, point.case.seed);
        let coriolis = expansion.coriolis_matrix(v);
        let compatible = expansion.coriolis_matrix_skew(v);
        let rate = expansion.mass_matrix_rate(v);
        let terms = rate.amax().max(2.0 * coriolis.amax()).max(1e-3);
        let rest = &rate - &coriolis * 2.0;
        power.meet(v.dot(&(&rest * v)).abs() / (terms * v.norm_squared()), seed);
        not_skew = not_skew.max((&rest + rest.transpose()).amax() / terms);
        action.meet(
            ((&compatible - &coriolis) * v).amax() / (terms * v.norm()),
            seed,
        );
        let rest = rate - compatible * 2.0;
        skew.meet((&rest + rest.transpose()).amax() / terms, seed);
    }
    power.assert_within(ROUNDING);
    action.assert_within(ROUNDING);
    skew.assert_within(ROUNDING);
    assert!(not_skew > 1e-2, "the suite does not tell Ĉ of (26) from Ĉ′");
}
