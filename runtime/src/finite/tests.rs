//! Finite maps against closed forms: Cayley's map on SO(3), the sphere with normalisation, an ellipsoid, redundant relations.

use super::{
    differential, differential_inverse, inverse, least_absolute, least_absolute_beside,
    least_squares, local, project,
};
use crate::scalar::{Dual, Extended, Scalar};
use crate::spatial::{hat, so3};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use num_traits::One;

type Vector9<T> = SVector<T, 9>;

fn numbers<T: Scalar, const D: usize>(values: [f64; D]) -> SVector<T, D> {
    SVector::from(values.map(T::from_f64))
}

fn rows<T: Scalar>(matrix: &Matrix3<T>) -> Vector9<T> {
    SVector::from_fn(|n, _| matrix[(n / 3, n % 3)])
}

fn matrix<T: Scalar>(q: &Vector9<T>) -> Matrix3<T> {
    Matrix3::from_fn(|i, j| q[3 * i + j])
}

fn largest<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> f64 {
    matrix.iter().fold(0.0, |most: f64, entry| {
        assert!(entry.is_finite(), "{matrix}");
        most.max(entry.abs())
    })
}

/// Cayley's map `Q (I + ϕ~/2)(I − ϕ~/2)⁻¹ = Q (I + (ϕ~ + ϕ~²/2) / (1 + ϕ²/4))`.
fn cayley<T: Scalar>(q: &Vector9<T>, phi: &Vector3<T>) -> Vector9<T> {
    let (half, quarter) = (T::from_f64(0.5), T::from_f64(0.25));
    let cross = hat(phi);
    let scale = T::one() / (T::one() + phi.dot(phi) * quarter);
    rows(&(matrix(q) * (Matrix3::identity() + (cross + cross * cross * half) * scale)))
}

fn cayley_local<T: Scalar>(q: &Vector9<T>, target: &Vector9<T>) -> Vector3<T> {
    local(q, target, cayley)
}

/// The rotation by `angle` about the unit vector `axis` is Cayley's map of `2 tan(angle/2) axis`.
fn cayley_of_angle(axis: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    axis * (2.0 * (0.5 * angle).tan())
}

fn base() -> Vector9<f64> {
    rows(&so3::exp(&Vector3::new(0.4, -0.7, 1.1)))
}

#[test]
fn least_squares_solves_what_normal_equations_cannot() {
    // Läuchli's matrix: its normal equations are singular in double precision, its condition is 1.4e9.
    let small = 1e-9;
    let f = SMatrix::<f64, 3, 2>::new(1.0, 1.0, small, 0.0, 0.0, small);
    let expected = SVector::<f64, 2>::new(0.75, -0.25);
    let found = least_squares(&f, &(f * expected));
    // 4 eps times the condition.
    assert!(largest(&(found - expected)) < 4.0 * f64::EPSILON * 1.5e9);
}

#[test]
fn a_number_that_is_not_finite_leaves_no_result() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..9 {
            let mut matrix = Matrix3::new(2.0, 0.5, 0.0, 0.0, 3.0, 0.5, 0.0, 0.0, 1.0);
            matrix[place] = wrong;
            let found = least_squares(&matrix, &Vector3::new(1.0, 2.0, 3.0));
            let lost = found.iter().any(|entry| !entry.is_finite());
            assert!(lost, "{wrong} at {place}: {found}");
        }
    }
}

#[test]
fn inverses_need_no_pivots() {
    // A zero where elimination would divide first.
    let a = Matrix3::new(0.0, 2.0, 0.0, 0.0, 0.0, -4.0, 1.0, 0.5, 0.0);
    let product = inverse(&a) * a;
    assert!(largest(&(product - Matrix3::identity())) < 8.0 * f64::EPSILON);
    assert!(
        inverse(&SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 4.0))
            .iter()
            .any(|entry| !entry.is_finite() || entry.abs() > 1e15)
    );
}

#[test]
fn local_inverts_cayley_at_every_angle() {
    let axis = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    for angle in [1e-300, 1e-160, 1e-12, 1e-3, 0.5, 1.5, 2.5, 3.0, 3.1, 3.1413] {
        let expected = cayley_of_angle(&axis, angle);
        let found = cayley_local(&base(), &cayley(&base(), &expected));
        // Rounding of the stored scalars, 1e-16 each, moves ϕ by dϕ/dangle = 1 + ϕ²/4 times as much.
        let bound = 16.0 * f64::EPSILON * (1.0 + 0.25 * expected.norm_squared());
        assert!(largest(&(found - expected)) < bound, "{angle}: {found}");
    }
}

#[test]
fn local_keeps_tiny_displacements_exact() {
    // Home Q = I: the target holds the displacement beside zeros, and all its digits.
    let home = rows(&Matrix3::identity());
    let expected = Vector3::new(3e-290, -4e-291, 5e-292);
    let found = cayley_local(&home, &cayley(&home, &expected));
    assert!(largest(&((found - expected) / 3e-290)) < 4.0 * f64::EPSILON);
}

#[test]
fn local_fails_with_nan_only() {
    // A half turn is out of Cayley's reach; a reflection is no rotation; NaN stays NaN.
    let half_turn =
        rows(&(matrix(&base()) * so3::exp(&Vector3::new(0.0, core::f64::consts::PI, 0.0))));
    let mut broken = base();
    broken[4] = f64::NAN;
    for target in [half_turn, -base(), broken] {
        assert!(
            cayley_local(&base(), &target)
                .iter()
                .all(|entry| entry.is_nan())
        );
    }
}

#[test]
fn single_precision_has_its_own_bounds() {
    let home = rows(&Matrix3::<f32>::identity());
    let expected = Vector3::new(0.7f32, -0.2, 0.4);
    let found = cayley_local(&home, &cayley(&home, &expected));
    // Half a dozen roundings of numbers near 1.
    assert!(
        (found - expected)
            .iter()
            .all(|e| e.abs() < 8.0 * f32::EPSILON),
        "{found}"
    );
}

#[test]
fn longer_numbers_have_their_own_bounds() {
    let home = rows(&Matrix3::<Extended>::identity());
    let third = Extended::one() / Extended::from_f64(3.0);
    let expected = Vector3::new(third, -third, third * third);
    let missing = cayley_local(&home, &cayley(&home, &expected)) - expected;
    // Half a dozen roundings of numbers near 1.
    assert!(
        missing
            .iter()
            .all(|e| e.high().abs() < 8.0 * Extended::epsilon().high()),
        "{missing:?}"
    );
}

/// Derivatives of the inverse, first and second, against its closed form: ϕ(t) = Cayley's vector of a path.
#[test]
fn derivatives_of_local_are_exact() {
    let path = |t: Dual<Dual<f64>>| {
        let number = |x: f64| Dual::constant(Dual::constant(x));
        Vector3::new(
            number(0.3) + t * number(0.8),
            t * t - number(0.4),
            number(0.5) - t,
        )
    };
    let t = Dual::new(Dual::variable(0.6), Dual::constant(1.0));
    let q = base().map(|entry| Dual::constant(Dual::constant(entry)));
    let (expected, found) = (path(t), cayley_local(&q, &cayley(&q, &path(t))));
    let parts = |x: Dual<Dual<f64>>| {
        [
            x.value.value,
            x.derivative().value,
            x.derivative().derivative(),
        ]
    };
    for (expected, found) in expected.iter().zip(&found) {
        for (expected, found) in parts(*expected).into_iter().zip(parts(*found)) {
            // Second derivatives of a product of nine numbers below 3.
            assert!(
                (expected - found).abs() < 1e-13,
                "{expected} against {found}"
            );
        }
    }
}

/// Derivative of the inverse along a change of the target, against central differences of the inverse.
#[test]
fn derivatives_of_local_are_those_of_its_values() {
    let target = |t: f64| cayley(&base(), &Vector3::new(0.3 + t, 0.5 * t, -0.7 + t * t));
    let (t, step) = (0.2, 1e-4);
    let difference = (cayley_local(&base(), &target(t + step))
        - cayley_local(&base(), &target(t - step)))
        / (2.0 * step);
    let speed = (target(t + step) - target(t - step)) / (2.0 * step);
    let q = base().map(Dual::constant);
    let moving = SVector::from_fn(|i, _| Dual::new(target(t)[i], speed[i]));
    let derivative = cayley_local(&q, &moving).map(|entry| entry.derivative());
    // Truncation step² and rounding eps/step, with factors below 10.
    assert!(largest(&(derivative - difference)) < 1e-7);
}

/// `D = (I − ϕ~/2) / (1 + ϕ²/4)` for Cayley's map in child axes.
#[test]
fn differential_of_cayley_is_its_closed_form() {
    let phi = Vector3::new(0.9, -1.4, 0.3);
    let expected = (Matrix3::identity() - hat(&phi) * 0.5) / (1.0 + 0.25 * phi.norm_squared());
    let found = differential(&base(), &phi, cayley);
    // A dozen roundings of numbers below 3.
    assert!(
        largest(&(found - expected)) < 16.0 * f64::EPSILON,
        "{found}"
    );
    let rate = Vector3::new(0.2, -0.5, 1.7);
    let back = expected * differential_inverse(&base(), &phi, &rate, cayley);
    assert!(
        largest(&(back - rate)) < 64.0 * f64::EPSILON,
        "condition of D is 2"
    );
}

/// Two coordinates of the sphere about a point u, with normalisation: Φ(u, ϕ) = (u + ϕ₁ a + ϕ₂ b) / |…|.
fn on_sphere<T: Scalar>(u: &Vector3<T>, phi: &SVector<T, 2>) -> Vector3<T> {
    let helper = Vector3::new(T::one(), T::zero(), T::zero());
    let a = u.cross(&helper);
    let b = u.cross(&a);
    let sum = u + a * phi[0] + b * phi[1];
    sum / sum.dot(&sum).sqrt()
}

#[test]
fn local_inverts_a_map_of_the_sphere() {
    let u = Vector3::new(1.0, 2.0, -2.0) / 3.0;
    for expected in [[0.3, -0.6], [2.0, 1.5], [-1e-9, 1e-12], [0.0, 40.0]] {
        let expected = SVector::from(expected);
        let found = local(&u, &on_sphere(&u, &expected), on_sphere);
        // A gnomonic map: rounding of the target grows by 1 + |ϕ|².
        let bound = 16.0 * f64::EPSILON * (1.0 + expected.norm_squared());
        assert!(largest(&(found - expected)) < bound, "{found}");
    }
}

const AXES: [f64; 3] = [2.0, 1.0, 0.5];

/// `x²/a² + y²/b² + z²/c² − 1`.
fn ellipsoid<T: Scalar>(q: &Vector3<T>) -> SVector<T, 1> {
    let sum = (0..3).fold(-T::one(), |sum, i| {
        let ratio = q[i] / T::from_f64(AXES[i]);
        sum + ratio * ratio
    });
    SVector::from([sum])
}

fn ellipsoid_gradient<T: Scalar>(q: &Vector3<T>) -> SMatrix<T, 1, 3> {
    SMatrix::from_fn(|_, i| {
        let axis = T::from_f64(AXES[i]);
        (q[i] + q[i]) / (axis * axis)
    })
}

fn on_ellipsoid<T: Scalar>(q: &Vector3<T>) -> Vector3<T> {
    project(q, 1, ellipsoid)
}

#[test]
fn projection_finds_the_nearest_point_to_second_order() {
    let on_it = Vector3::new(2.0 * 0.6, 0.0, 0.5 * 0.8);
    let normal = ellipsoid_gradient(&on_it).transpose().normalize();
    for distance in [1e-12, 1e-9, 1e-6, 1e-3, 0.1] {
        let found = on_ellipsoid(&(on_it + normal * distance));
        assert!(largest(&ellipsoid(&found)) < 8.0 * f64::EPSILON);
        // Curvature of the ellipsoid, at most 4, times the square of the distance.
        assert!((found - on_it).norm() < 8.0 * (distance * distance + f64::EPSILON));
    }
    // The gradient vanishes at the centre: no direction leads to the ellipsoid.
    let from_centre: Vector3<f64> = on_ellipsoid(&Vector3::zeros());
    assert!(from_centre.iter().all(|entry| entry.is_nan()));
}

#[test]
fn projection_works_in_other_scalars() {
    let single = on_ellipsoid(&numbers::<f32, 3>([1.3, 0.2, 0.35]));
    let double = on_ellipsoid(&Vector3::new(1.3, 0.2, 0.35));
    let apart = single.map(f64::from) - double;
    assert!(largest(&apart) < 8.0 * f64::from(f32::EPSILON));
    let moving = Vector3::new(
        Dual::variable(1.3),
        Dual::constant(0.2),
        Dual::constant(0.35),
    );
    let derivative = on_ellipsoid(&moving).map(|entry| entry.derivative());
    let at = |t: f64| on_ellipsoid(&Vector3::new(1.3 + t, 0.2, 0.35));
    let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
    // Truncation 1e-8, rounding eps/step 1e-12.
    assert!(largest(&(derivative - difference)) < 1e-7);
    // The projected point stays on the ellipsoid: its rate is tangent to it.
    assert!((ellipsoid_gradient(&double) * derivative).norm() < 1e-14);
}

/// RᵀR = I, RRᵀ = I: twelve relations of rank six, in nine scalars.
fn orthonormality<T: Scalar>(q: &Vector9<T>) -> SVector<T, 12> {
    let r = matrix(q);
    let (columns, rows) = (r.transpose() * r, r * r.transpose());
    let mut relations = SVector::zeros();
    for (n, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
        .into_iter()
        .enumerate()
    {
        let identity = if i == j { T::one() } else { T::zero() };
        relations[n] = columns[(i, j)] - identity;
        relations[n + 6] = rows[(i, j)] - identity;
    }
    relations
}

#[test]
fn redundant_relations_are_no_obstacle() {
    let rotation = base();
    for size in [0.0, 1e-12, 1e-8, 1e-4, 0.05] {
        let noise = Vector9::from_fn(|i, _| size * (0.3 * i as f64 - 1.1).sin());
        let found = project(&(rotation + noise), 6, orthonormality);
        assert!(
            largest(&orthonormality(&found)) < 8.0 * f64::EPSILON,
            "{size}"
        );
        let nearest = rows(&so3::nearest(&matrix(&(rotation + noise))));
        if size < 1e-3 {
            // Nearest to second order; the polar iteration of `nearest` is exact below 1e-4.
            assert!(largest(&(found - nearest)) < 8.0 * (size * size + f64::EPSILON));
        }
    }
}

#[test]
fn a_reflection_is_not_projected_to_a_rotation() {
    // With det R = 1 as the seventh relation, six of which are independent.
    fn relations<T: Scalar>(q: &Vector9<T>) -> SVector<T, 7> {
        let all = orthonormality(q);
        let r = matrix(q);
        let determinant = r.column(0).cross(&r.column(1)).dot(&r.column(2));
        SVector::from_fn(|n, _| {
            if n < 6 {
                all[n]
            } else {
                determinant - T::one()
            }
        })
    }
    let projected = |q: &Vector9<f64>| project(q, 6, relations);
    assert!(largest(&relations(&projected(&(base() * 1.001)))) < 8.0 * f64::EPSILON);
    assert!(projected(&-base()).iter().all(|entry| entry.is_nan()));
}

#[test]
fn the_distance_to_a_locus_is_the_least() {
    assert_eq!(least_absolute::<f64, 0>([]), f64::INFINITY);
    assert_eq!(least_absolute([3.0, -0.5, 2.0]), 0.5);
    assert!(least_absolute([3.0, f64::NAN, 2.0]).is_nan());
    assert!(least_absolute([f64::INFINITY, 1.0]).is_nan());
    assert_eq!(least_absolute_beside([-2.0, 3.0], [1.0, 4.0]), 2.0);
    assert_eq!(least_absolute_beside([2.0], [1.0, -1e-300]), 0.0);
    assert_eq!(least_absolute_beside([f64::NAN], [-1.0]), 0.0);
    assert_eq!(least_absolute_beside([2.0], [f64::NAN]), 0.0);
    assert_eq!(
        least_absolute([Dual::constant(2.0), Dual::new(-1.0, 4.0)]),
        Dual::new(1.0, -4.0)
    );
}
