//! The matrices: M, its derivatives, Ĉ and Ĉ′.

use super::{LARGEST, Point, TREES, points};
use crate::differences;
use crate::figures::Largest;
use crate::random::{Case, cases};
use hamel::erased::AnyJoint;
use hamel::nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;
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
        // A height that is a small difference of lengths carries their rounding; the gradient is of their size.
        let size = terms.max(point.expansion.potential_gradient.amax());
        potential.meet(
            (point.expansion.potential - expected).abs() / size,
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
    let mut laws = [
        Largest::new("∂M/∂ϕ against differences"),
        Largest::new("∂V/∂ϕ against differences"),
        Largest::new("∂S̄/∂ϕ against differences"),
    ];
    let cases: Vec<Case> = cases(kinds, LARGEST, TREES).collect();
    let errors = cases.into_par_iter().map(Point::new);
    let errors = errors.flat_map_iter(|point| gradient_errors(&point));
    for (errors, place) in errors.collect::<Vec<_>>() {
        for (law, error) in laws.iter_mut().zip(errors) {
            law.meet(error, &place);
        }
    }
    // Rounding of M, some 10 ε, over h = 1/256: 6e-13, and three terms of it.
    laws.iter().for_each(|law| law.assert_within(2e-12));
}

/// Errors of ∂M/∂ϕ, ∂V/∂ϕ and ∂S̄/∂ϕ for each entry of ϕ, beyond what differences leave; and the place.
fn gradient_errors(point: &Point) -> Vec<([f64; 3], String)> {
    let (mechanism, expansion) = (&point.case.mechanism, &point.expansion);
    let (k, s) = expansion.speed_basis.shape();
    // M, S̄ and V side by side, so that each moved configuration is expanded once.
    let all = |q: &[f64]| {
        let moved = point.reference.expansion(q).expect("sizes fit");
        let mut all = DMatrix::zeros(k, k + s + 1);
        all.view_mut((0, 0), (k, k)).copy_from(&moved.mass_matrix);
        all.view_mut((0, k), (k, s)).copy_from(&moved.speed_basis);
        all[(0, k + s)] = moved.potential;
        all
    };
    let at = |step| differences::gradient_with(step, mechanism, &point.case.q, all);
    let (coarse, fine) = (at(differences::STEP), at(differences::STEP / 2.0));
    let errors = |(index, (slice, coarse)): (usize, (&DMatrix<f64>, &DMatrix<f64>))| {
        // Half the step leaves 1/64 of the truncation, so that the difference of both is 63 times what is left; twice that for
        // the orders above. A wrong derivative is as wrong at both steps, and gains nothing.
        let truncation = (slice - coarse).map(|change| change.abs() / 31.0);
        let beyond = |error: &DMatrix<f64>, (row, column): (usize, usize)| {
            let allowed = truncation.view((row, column), error.shape());
            let excess = error.zip_map(&allowed, |error, allowed| error.abs() - allowed);
            // Not f64::max, which would drop a NaN.
            let larger = |most: f64, x: &f64| if *x <= most { most } else { *x };
            excess.iter().fold(0.0, larger)
        };
        let mass = slice.view((0, 0), (k, k)) - &expansion.mass_matrix_gradient[index];
        let potential = slice[(0, k + s)] - expansion.potential_gradient[index];
        let basis = slice.view((0, k), (k, s)) - &expansion.speed_basis_gradient[index];
        let gradient = &expansion.potential_gradient;
        let errors = [
            beyond(&mass, (0, 0)) / expansion.mass_matrix.amax(),
            beyond(&DMatrix::from_element(1, 1, potential), (0, k + s))
                / gradient.amax().max(expansion.potential.abs()),
            beyond(&basis, (0, k)),
        ];
        (errors, format!("case {}, ϕ_{index}", point.case.seed))
    };
    fine.iter().zip(&coarse).enumerate().map(errors).collect()
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
