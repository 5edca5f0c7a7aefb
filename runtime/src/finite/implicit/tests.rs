//! Φ by relations, and projection along them, on a circle, where both have closed forms.

use super::{along_tangent, retract};
use crate::finite::{assemble, project_by_displacements};
use crate::scalar::{Dual, Extended, Scalar};
use nalgebra::{SMatrix, SVector};
use num_traits::{One, Zero};

fn largest(vector: &SVector<f64, 2>) -> f64 {
    assert!(vector.iter().all(|entry| entry.is_finite()), "{vector}");
    vector.amax()
}

/// `|q|² = 1` in the plane, and its derivatives.
fn circle<T: Scalar>(q: &SVector<T, 2>) -> (SVector<T, 1>, SMatrix<T, 1, 2>) {
    let square = q[0].mul_add(q[0], q[1].mul_add(q[1], -T::one()));
    (SVector::from([square]), (q + q).transpose())
}

/// Along the tangent, and back along the radius.
fn along_circle<T: Scalar>(q: &SVector<T, 2>, phi: &SVector<T, 1>) -> SVector<T, 2> {
    retract(phi, circle_bases(q), |xi| q + xi, |q, _| circle(q))
}

fn circle_bases<T: Scalar>(q: &SVector<T, 2>) -> (SMatrix<T, 2, 1>, SMatrix<T, 2, 1>) {
    (SVector::from([-q[1], q[0]]), *q)
}

/// `√(1 − ϕ²) q + ϕ b` for the unit tangent b.
fn along_circle_in_closed_form<T: Scalar>(q: &SVector<T, 2>, phi: T) -> SVector<T, 2> {
    q * (T::one() - phi * phi).sqrt() + circle_bases(q).0 * phi
}

#[test]
fn relations_lead_back_to_the_manifold() {
    let q = SVector::from([0.6, -0.8]);
    for phi in [0.0, 1e-300, 1e-9, 0.1, -0.5, 0.9] {
        let found = along_circle(&q, &SVector::from([phi]));
        let expected = along_circle_in_closed_form(&q, phi);
        // Half a dozen roundings, by which λ moves 1 / √(1 − ϕ²) times as much.
        let allowed = 4.0 * f64::EPSILON / (1.0 - phi * phi).sqrt();
        assert!(largest(&(found - expected)) < allowed, "{phi}: {found}");
        let bases = circle_bases(&q);
        let back = along_tangent(&(found - q), bases)[0];
        assert!((back - phi).abs() < allowed, "{phi}: {back}");
    }
    // No radius leads back from beyond the ends of the circle.
    for phi in [1.1, 40.0, f64::NAN] {
        let beyond = along_circle(&q, &SVector::from([phi]));
        assert!(beyond.iter().all(|entry| entry.is_nan()), "{phi}");
    }
}

/// Derivatives to third order, and longer numbers.
#[test]
fn relations_are_solved_in_other_scalars() {
    type Third = Dual<Dual<Dual<f64>>>;
    let number = |x: f64| Third::constant(Dual::constant(Dual::constant(x)));
    let q = SVector::from([number(0.6), number(-0.8)]);
    let phi = Dual::new(
        Dual::new(Dual::variable(0.5), Dual::constant(1.0)),
        Dual::constant(Dual::constant(1.0)),
    );
    let found = along_circle(&q, &SVector::from([phi]));
    let expected = along_circle_in_closed_form(&q, phi);
    for (found, expected) in found.iter().zip(&expected) {
        let missing = *found - *expected;
        let parts = [missing.value, missing.derivative()];
        let parts = parts.map(|part| [part.value, part.derivative()]);
        for part in parts.as_flattened() {
            for part in [part.value, part.derivative()] {
                // The third derivative is 3 ϕ / (1 − ϕ²)^(5/2) = 3.1, of terms up to three times as large.
                assert!(part.abs() < 64.0 * f64::EPSILON, "{missing:?}");
            }
        }
    }
    let [third, zero] = [Extended::one() / Extended::from_f64(3.0), Extended::zero()];
    let q = SVector::from([Extended::one(), zero]);
    let missing =
        along_circle(&q, &SVector::from([third])) - along_circle_in_closed_form(&q, third);
    for entry in &missing {
        assert!(entry.high().abs() < 8.0 * Extended::epsilon().high());
    }
}

#[test]
fn projection_by_displacements_takes_the_shortest() {
    let projected =
        |q: &SVector<f64, 2>| project_by_displacements(q, |q, xi| q + xi, circle::<f64>);
    for distance in [-0.6, -1e-9, 0.0, 1e-12, 1e-3, 3.0] {
        let found = projected(&(SVector::from([0.6, -0.8]) * (1.0 + distance)));
        let missing = found - SVector::from([0.6, -0.8]);
        assert!(
            largest(&missing) < 4.0 * f64::EPSILON,
            "{distance}: {found}"
        );
    }
    // At the centre no direction leads to the circle.
    let centre = projected(&SVector::zeros());
    assert!(centre.iter().all(|entry| entry.is_nan()));
}

/// A crank of 0.12 whose rod of 0.121 ends on a slide, by their angles: `crank sin a = rod sin b`.
fn slider_crank<T: Scalar>(q: &SVector<T, 2>) -> (SVector<T, 1>, SMatrix<T, 1, 2>) {
    let [(sin_a, cos_a), (sin_b, cos_b)] = [q[0].sin_cos(), q[1].sin_cos()];
    let [crank, rod] = [0.12, 0.121].map(T::from_f64);
    let gradient = SMatrix::from([[crank * cos_a], [-rod * cos_b]]);
    (SVector::from([crank * sin_a - rod * sin_b]), gradient)
}

/// The rod nearly stands across the slide where the crank is upright: from there on Newton's method finds the slider on either side.
#[test]
fn the_branch_is_kept_or_there_is_no_result() {
    let (turn, rod) = (SVector::from([1.0, 0.0]), SVector::from([0.0, 1.0]));
    for start in 0..60 {
        let a = 0.025 * f64::from(start);
        let q = SVector::from([a, (0.12 / 0.121 * a.sin()).asin()]);
        let gradient = slider_crank(&q).1;
        let along = SMatrix::<f64, 2, 1>::from(turn - rod * (gradient[0] / gradient[1]));
        for step in 1..60 {
            let phi = SVector::from([0.05 * f64::from(step)]);
            let found = retract(&phi, (along, rod), |xi| q + xi, |q, _| slider_crank(q));
            // Before the rod is steep every step is found, long ones as well.
            let is_short = a + phi[0] < 1.2;
            let is_none = found[0].is_nan() && !is_short;
            assert!(is_none || found[1].cos() > 0.0, "{a} {phi}: {found}");
        }
    }
}

/// A guess with the slider on the right means a configuration with the slider there, however far it is.
#[test]
fn linkages_are_assembled_on_the_branch_of_the_guess() {
    let relations = |q: &SVector<Dual<f64>, 2>| slider_crank(q).0;
    let across = |q: &SVector<f64, 2>| slider_crank(q).1.fixed_columns::<1>(1).into_owned();
    for a in 0..30 {
        for b in -14..15 {
            let guess = SVector::from([0.1 * f64::from(a), 0.1 * f64::from(b)]);
            let found = assemble(&guess, 1, relations, across);
            assert!(found[1].cos() > 0.0, "{guess}: {found}");
            assert!(slider_crank(&found).0[0].abs() < f64::EPSILON, "{found}");
        }
    }
}
