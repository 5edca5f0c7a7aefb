//! Φ by relations, and projection along them, on a circle, where both have closed forms.

use super::{along_tangent, retract};
use crate::finite::project_by_displacements;
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
