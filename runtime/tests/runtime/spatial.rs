//! Spatial algebra: the laws that twists, wrenches, poses and inertias obey.

use crate::common::random::Random;
use crate::common::trees::{mass, pose};
use hamel_runtime::spatial::{
    MassError, MassProperties, Pose, PoseError, SpatialInertia, bracket, bracket_dual_product,
    bracket_product, hat, join, se3, so3, split, vee,
};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// A few dozen roundings of entries of order 1 to 10.
const ROUNDING: f64 = 1e-13;

#[test]
fn hat_is_the_cross_product_and_vee_its_inverse() {
    let mut random = Random::new(1);
    let (a, b) = (random.vector::<3>(), random.vector::<3>());
    assert_eq!(hat(&a) * b, a.cross(&b));
    assert_eq!(vee(&hat(&a)), a);
    let twist = random.vector::<6>();
    let (angular, linear) = split(&twist);
    assert_eq!(join(&angular, &linear), twist);
}

#[test]
fn poses_are_a_group_that_adjoint_represents() {
    let mut random = Random::new(2);
    let (a, b) = (pose(&mut random), pose(&mut random));
    let identity = a * a.inverse();
    assert!((identity.matrix() - Pose::identity().matrix()).amax() < ROUNDING);
    assert!(((a * b).matrix() - a.matrix() * b.matrix()).amax() < ROUNDING);
    assert!(((a * b).adjoint() - a.adjoint() * b.adjoint()).amax() < ROUNDING);
    let point = random.vector::<3>();
    let expected = a.matrix() * point.push(1.0);
    assert!((a.transform_point(&point) - expected.xyz()).amax() < ROUNDING);
}

#[test]
fn twists_and_wrenches_go_with_adjoint_and_its_dual() {
    let mut random = Random::new(3);
    let (h, twist, wrench) = (
        pose(&mut random),
        random.vector::<6>(),
        random.vector::<6>(),
    );
    let adjoint = h.adjoint();
    let dual = h.inverse().adjoint().transpose();
    assert!((h.act_twist(&twist) - adjoint * twist).amax() < ROUNDING);
    assert!((h.act_twist_inverse(&(adjoint * twist)) - twist).amax() < ROUNDING);
    assert!((h.act_wrench(&wrench) - dual * wrench).amax() < ROUNDING);
    assert!((h.act_wrench_inverse(&(dual * wrench)) - wrench).amax() < ROUNDING);
    let power = h.act_twist(&twist).dot(&h.act_wrench(&wrench));
    assert!(
        (power - twist.dot(&wrench)).abs() < ROUNDING,
        "power does not depend on the frame"
    );
    let columns = h.act_twist_columns(&Matrix6::identity());
    assert!((columns - adjoint).amax() < ROUNDING);
    assert!((h.act_wrench_columns(&Matrix6::identity()) - dual).amax() < ROUNDING);
    assert!((h.act_twist_inverse_columns(&adjoint) - Matrix6::identity()).amax() < ROUNDING);
}

#[test]
fn bracket_is_a_lie_bracket() {
    let mut random = Random::new(4);
    let [a, b, c] = [(); 3].map(|()| random.vector::<6>());
    assert_eq!(bracket_product(&a, &a), Vector6::zeros());
    assert!((bracket_product(&a, &b) - bracket(&a) * b).amax() < ROUNDING);
    assert!((bracket_dual_product(&a, &b) - bracket(&a).transpose() * b).amax() < ROUNDING);
    let jacobi = bracket_product(&a, &bracket_product(&b, &c))
        + bracket_product(&b, &bracket_product(&c, &a))
        + bracket_product(&c, &bracket_product(&a, &b));
    assert!(jacobi.amax() < ROUNDING);
    let h = pose(&mut random);
    let moved = bracket_product(&h.act_twist(&a), &h.act_twist(&b));
    assert!((moved - h.act_twist(&bracket_product(&a, &b))).amax() < ROUNDING);
}

/// The exponential by its series, whose terms fall below rounding for norms up to ten.
fn exponential(matrix: &Matrix6<f64>) -> Matrix6<f64> {
    let (mut sum, mut term) = (Matrix6::identity(), Matrix6::identity());
    for order in 1..60 {
        term = term * matrix / f64::from(order);
        sum += term;
    }
    sum
}

#[test]
fn exponential_and_logarithm_of_a_twist() {
    let mut random = Random::new(5);
    for size in [0.0, 1e-160, 1e-8, 0.5, 1.7] {
        let twist = random.vector::<6>() * size;
        let h = se3::exp(&twist);
        assert!(
            (se3::log(&h) - twist).norm() <= 1e-14 * size,
            "a few dozen ulp"
        );
        let back = h * se3::exp(&-twist);
        assert!((back.matrix() - Pose::identity().matrix()).amax() < ROUNDING);
        // Ad_exp(T) = exp(ad_T)
        assert!(
            (h.adjoint() - exponential(&bracket(&twist))).amax() < 1e-12,
            "the series, whose terms are below 1e3"
        );
    }
}

#[test]
fn inertia_moves_with_its_frame() {
    let mut random = Random::new(6);
    let (properties, h, twist) = (mass(&mut random), pose(&mut random), random.vector::<6>());
    let inertia = SpatialInertia::from(&properties);
    assert!((inertia.apply(&twist) - inertia.matrix() * twist).amax() < ROUNDING);
    let moved = inertia.transform(&h);
    let adjoint = h.inverse().adjoint();
    assert!((moved.matrix() - adjoint.transpose() * inertia.matrix() * adjoint).amax() < ROUNDING);
    let momentum = moved.apply(&h.act_twist(&twist));
    assert!((momentum - h.act_wrench(&inertia.apply(&twist))).amax() < ROUNDING);
    let sum = inertia.combine(&moved);
    assert!((sum.matrix() - inertia.matrix() - moved.matrix()).amax() < ROUNDING);
    assert_eq!(SpatialInertia::<f64>::zero().matrix(), Matrix6::zeros());
    // About the centre of mass: T = ½ m v² + ½ ωᵀ I ω.
    let (angular, linear) = split(&twist);
    let velocity = linear + angular.cross(&properties.com);
    let energy = 0.5 * properties.mass * velocity.norm_squared()
        + 0.5 * angular.dot(&(properties.inertia_com * angular));
    assert!((0.5 * twist.dot(&inertia.apply(&twist)) - energy).abs() < ROUNDING);
}

fn with_inertia(inertia: Matrix3<f64>) -> Result<MassProperties, MassError> {
    MassProperties::new(1.0, Vector3::zeros(), inertia)
}

#[test]
fn physical_inertias_pass_however_thin() {
    let mut random = Random::new(7);
    for principal in [
        [1.0, 1.0, 1e-10],
        [1.0, 1.0, 0.0],
        [1.0, 0.4, 0.6],
        [0.0; 3],
        [1e-12, 1e-12, 2e-12],
    ] {
        for _ in 0..50 {
            let rotation = so3::exp(&random.rotation_vector());
            let inertia =
                rotation * Matrix3::from_diagonal(&principal.into()) * rotation.transpose();
            // The product itself is symmetric to rounding only, as an input from a file would be.
            assert_eq!(with_inertia(inertia).map(|_| ()), Ok(()), "{principal:?}");
        }
    }
}

#[test]
fn unphysical_mass_properties_are_named() {
    let message =
        |result: Result<MassProperties, MassError>| result.expect_err("unphysical").to_string();
    let unit = Matrix3::identity();
    assert_eq!(
        message(MassProperties::new(-0.5, Vector3::zeros(), unit)),
        "mass is -0.5 kg: it must be at least 0"
    );
    assert_eq!(
        message(MassProperties::new(f64::NAN, Vector3::zeros(), unit)),
        "mass is NaN, not a finite number"
    );
    assert_eq!(
        message(MassProperties::new(
            1.0,
            Vector3::new(0.0, f64::INFINITY, 0.0),
            unit
        )),
        "centre of mass y is inf, not a finite number"
    );
    let mut skewed = unit;
    skewed[(0, 2)] = 0.25;
    assert!(matches!(
        with_inertia(skewed),
        Err(MassError::NotSymmetric {
            row: 1,
            column: 3,
            ..
        })
    ));
    skewed[(2, 1)] = f64::NAN;
    assert_eq!(
        message(with_inertia(skewed)),
        "inertia entry (3, 2) is NaN, not a finite number"
    );
    let negative = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -0.1));
    assert!(matches!(
        with_inertia(negative),
        Err(MassError::NotPositive { .. })
    ));
    let rod = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 2.0 + 1e-12));
    assert!(matches!(with_inertia(rod), Err(MassError::Triangle { .. })));
}

#[test]
fn poses_that_are_none_are_named() {
    let mut h = Pose::<f64>::identity();
    h.rotation[(0, 1)] = 0.9e-9;
    assert_eq!(h.check(), Ok(()));
    h.rotation[(0, 1)] = 1.1e-9;
    assert!(matches!(h.check(), Err(PoseError::NotOrthonormal { .. })));
    h.rotation[(0, 1)] = f64::NAN;
    let message = h.check().expect_err("NaN").to_string();
    assert_eq!(message, "rotation entry (1, 2) is NaN, not a finite number");
    let mirror = Pose::from_rotation(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)));
    assert_eq!(
        mirror.check(),
        Err(PoseError::Reflection { determinant: -1.0 })
    );
}
