//! Theorems 2 and 3 against the Newton–Euler recursion, against each other, and against the laws of mechanics.

use crate::common::random::Random;
use crate::common::trees::{configuration, trees};
use crate::common::{joints, trees as support};
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Recursive, Reference};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{DVector, Matrix3, Vector3};
use std::sync::Arc;

struct Case {
    mechanism: Arc<Mechanism>,
    q: Vec<f64>,
    speeds: Vec<f64>,
    efforts: Vec<f64>,
}

fn cases() -> Vec<Case> {
    trees()
        .into_iter()
        .enumerate()
        .map(|(seed, mechanism)| {
            let mut random = Random::new(100 + seed as u64);
            let q = configuration(&mut random, &mechanism);
            let speeds = random.vec(mechanism.layout().speeds);
            let efforts = random.vec(mechanism.layout().freedoms);
            Case {
                mechanism,
                q,
                speeds,
                efforts,
            }
        })
        .collect()
}

fn vector(slice: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(slice)
}

/// Largest difference relative to the larger of 1 and the largest entry.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = a.iter().chain(b).fold(1.0_f64, |m, x| m.max(x.abs()));
    a.iter()
        .zip(b)
        .fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()))
        / scale
}

/// Six joints, terms of size 1 to 100, some hundred roundings each: 1e-12 leaves an order of magnitude.
const ROUNDING: f64 = 1e-12;

#[test]
fn mass_matrix_gives_the_kinetic_energy() {
    for case in cases() {
        let expansion = Reference::new(Arc::clone(&case.mechanism))
            .expansion(&case.q)
            .expect("sizes fit");
        let v = vector(
            &case
                .mechanism
                .velocity_from_speeds(&case.q, &case.speeds)
                .expect("sizes fit"),
        );
        let kinematics = case
            .mechanism
            .kinematics(&case.q, &case.speeds)
            .expect("sizes fit");
        let mass = &expansion.mass_matrix;
        assert!((mass - mass.transpose()).amax() <= ROUNDING * mass.amax());
        let energy = 0.5 * v.dot(&(mass * &v));
        assert!(difference(&[energy], &[kinematics.kinetic_energy()]) < ROUNDING);
        assert!(difference(&[expansion.potential], &[kinematics.potential_energy()]) < ROUNDING);
    }
}

/// Derivatives along ϕ_k by central differences through Φ.
#[test]
fn gradients_are_those_of_the_moved_mechanism() {
    let step = 1e-5;
    for case in cases() {
        let reference = Reference::new(Arc::clone(&case.mechanism));
        let expansion = reference.expansion(&case.q).expect("sizes fit");
        for k in 0..case.mechanism.layout().freedoms {
            let at = |size: f64| {
                let mut q = case.q.clone();
                for body in case.mechanism.bodies() {
                    let own = body.ranges().freedoms.clone();
                    let phi: Vec<f64> = own.map(|i| if i == k { size } else { 0.0 }).collect();
                    let range = body.ranges().configuration.clone();
                    body.joint()
                        .retract(&case.q[range.clone()], &phi, &mut q[range]);
                }
                reference.expansion(&q).expect("sizes fit")
            };
            let (ahead, behind) = (at(step), at(-step));
            let slope = (&ahead.mass_matrix - &behind.mass_matrix) / (2.0 * step);
            // Truncation h²/6 times third derivatives (some hundreds), rounding eps·|M|/h: both below 1e-7.
            let tolerance = 1e-7 * expansion.mass_matrix.amax().max(1.0);
            assert!((slope - &expansion.mass_matrix_gradient[k]).amax() < tolerance);
            let slope = (ahead.potential - behind.potential) / (2.0 * step);
            assert!(
                (slope - expansion.potential_gradient[k]).abs()
                    < 1e-6 * expansion.potential.abs().max(10.0)
            );
            let slope = (ahead.speed_basis - behind.speed_basis) / (2.0 * step);
            assert!((slope - &expansion.speed_basis_gradient[k]).amax() < 1e-8);
        }
    }
}

#[test]
fn theorem_3_is_the_newton_euler_recursion() {
    for case in cases() {
        let mut reference = Reference::new(Arc::clone(&case.mechanism));
        let mut rates = vec![0.0; case.speeds.len()];
        reference
            .forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates)
            .expect("regular");
        let expansion = reference.expansion(&case.q).expect("sizes fit");
        let expected = expansion.speed_basis.tr_mul(&vector(&case.efforts));

        let mut recursion = Recursive::new(Arc::clone(&case.mechanism));
        let mut efforts = vec![0.0; case.speeds.len()];
        recursion
            .inverse_dynamics(&case.q, &case.speeds, &rates, &mut efforts)
            .expect("sizes fit");
        assert!(difference(&efforts, expected.as_slice()) < ROUNDING);

        let mut forces = vec![0.0; case.mechanism.layout().constraints];
        recursion
            .constraint_force(&case.q, &case.efforts, &mut forces)
            .expect("independent");
        let lambda = reference
            .constraint_force(&case.q, &case.speeds, &case.efforts)
            .expect("regular");
        assert!(difference(&forces, lambda.as_slice()) < 10.0 * ROUNDING);
    }
}

#[test]
fn theorem_2_holds_with_the_constraint_force() {
    for case in cases() {
        let reference = Reference::new(Arc::clone(&case.mechanism));
        let expansion = reference.expansion(&case.q).expect("sizes fit");
        let (speeds, efforts) = (vector(&case.speeds), vector(&case.efforts));
        let lambda = reference
            .constraint_force(&case.q, &case.speeds, &case.efforts)
            .expect("regular");
        let total = efforts.clone() + &expansion.constraint * lambda;
        let v = &expansion.speed_basis * &speeds;
        let v_rate = expansion
            .accelerations(&case.mechanism, &v, &total)
            .expect("regular");
        let reduced = expansion
            .reduced_accelerations(&case.mechanism, &speeds, &efforts)
            .expect("regular");
        let expected =
            &expansion.speed_basis * reduced + expansion.speed_basis_rate(&speeds) * &speeds;
        assert!(difference(v_rate.as_slice(), expected.as_slice()) < 10.0 * ROUNDING);

        // (27) is (24) in p: ṗ = M v̇ + Ṁ v.
        let p_rate = expansion.momentum_rate(&v, &total);
        let expected = &expansion.mass_matrix * &v_rate + expansion.mass_matrix_rate(&v) * &v;
        assert!(difference(p_rate.as_slice(), expected.as_slice()) < 10.0 * ROUNDING);
    }
}

#[test]
fn skew_compatible_matrix_is_skew_and_acts_alike() {
    let mut printed_is_skew = true;
    for case in cases() {
        let expansion = Reference::new(Arc::clone(&case.mechanism))
            .expansion(&case.q)
            .expect("sizes fit");
        let v = &expansion.speed_basis * vector(&case.speeds);
        let coriolis = expansion.coriolis_matrix(&v);
        let skew = expansion.coriolis_matrix_skew(&v);
        let rate = expansion.mass_matrix_rate(&v);
        assert!(difference((&coriolis * &v).as_slice(), (&skew * &v).as_slice()) < ROUNDING);
        let power = v.dot(&((&rate - &coriolis * 2.0) * &v));
        assert!(power.abs() < ROUNDING * rate.amax().max(1.0));
        let rest = &rate - skew * 2.0;
        assert!((&rest + rest.transpose()).amax() < ROUNDING * rest.amax().max(1.0));
        let rest = rate - coriolis * 2.0;
        printed_is_skew &= (&rest + rest.transpose()).amax() < 1e-3;
    }
    assert!(!printed_is_skew, "the test would not tell the two apart");
}

/// dH/dt = v̄ᵀ S̄ᵀ τ, from ṗ and the gradient of H at fixed p.
#[test]
fn power_balance() {
    for case in cases() {
        let mut reference = Reference::new(Arc::clone(&case.mechanism));
        let size = case.speeds.len();
        let mut momenta = vec![0.0; size];
        reference
            .momenta(&case.q, &case.speeds, &mut momenta)
            .expect("sizes fit");
        let (mut speeds, mut rates) = (vec![0.0; size], vec![0.0; size]);
        reference
            .momentum_rates(
                &case.q,
                &momenta,
                &mut |_, efforts| efforts.copy_from_slice(&case.efforts),
                &mut speeds,
                &mut rates,
            )
            .expect("regular");
        assert!(
            difference(&speeds, &case.speeds) < 1e-11,
            "M̄ has a condition of some hundreds"
        );
        let expansion = reference.expansion(&case.q).expect("sizes fit");
        let v = &expansion.speed_basis * vector(&case.speeds);
        let gradient = expansion.reduced_hamiltonian_gradient(&vector(&case.speeds));
        let power =
            vector(&case.speeds).dot(&vector(&rates)) + gradient.dot(&expansion.local_rate(&v));
        let scale = gradient.amax().max(1.0);
        assert!((power - v.dot(&vector(&case.efforts))).abs() < ROUNDING * scale * size as f64);
    }
}

/// p̄̇ of (35) is d/dt (M̄ v̄) of (34).
#[test]
fn both_forms_are_the_same_equations() {
    for case in cases() {
        let expansion = Reference::new(Arc::clone(&case.mechanism))
            .expansion(&case.q)
            .expect("sizes fit");
        let (speeds, efforts) = (vector(&case.speeds), vector(&case.efforts));
        let rate = expansion
            .reduced_accelerations(&case.mechanism, &speeds, &efforts)
            .expect("regular");
        let v = &expansion.speed_basis * &speeds;
        let basis_rate = expansion.speed_basis_rate(&speeds);
        let half = basis_rate.tr_mul(&(&expansion.mass_matrix * &expansion.speed_basis));
        let mass_rate = expansion
            .speed_basis
            .tr_mul(&(expansion.mass_matrix_rate(&v) * &expansion.speed_basis))
            + &half
            + half.transpose();
        let expected = expansion.reduced_mass_matrix() * rate + mass_rate * &speeds;
        let found = expansion.reduced_momentum_rate(&speeds, &efforts);
        assert!(difference(found.as_slice(), expected.as_slice()) < 10.0 * ROUNDING);
    }
}

/// `m v̇₂ − m v₁v₃ = τ₂`, `m v̇₃ + m v₁v₂ = τ₃` of a free planar body with its centre of mass at the origin.
#[test]
fn free_planar_body_has_its_coriolis_terms() {
    let mass = MassProperties::new(2.0, Vector3::zeros(), Matrix3::identity()).expect("physical");
    let body = support::body("disc", None, joints::planar(), Pose::identity(), mass);
    let mechanism = Arc::new(Mechanism::new(Vector3::zeros(), vec![body]).expect("valid"));
    let q = mechanism
        .configuration_from_local(0, &[0.4, -1.0, 2.0])
        .expect("finite");
    let v = [1.3, -0.7, 0.9];
    let mut rates = [0.0; 3];
    Reference::new(mechanism)
        .forward_dynamics(&q, &v, &[0.5, 0.8, -0.6], &mut rates)
        .expect("regular");
    let expected = [0.5, 0.8 / 2.0 + v[0] * v[2], -0.6 / 2.0 - v[0] * v[1]];
    assert!(
        difference(&rates, &expected) < 1e-14,
        "a handful of roundings"
    );
}

#[test]
fn massless_end_names_its_joint() {
    let body = support::body(
        "ghost",
        None,
        joints::revolute(),
        Pose::identity(),
        MassProperties::massless(),
    );
    let mechanism = Arc::new(Mechanism::new(Vector3::zeros(), vec![body]).expect("valid"));
    let error = Reference::new(mechanism)
        .forward_dynamics(&[0.0], &[1.0], &[0.0], &mut [0.0])
        .expect_err("singular");
    let DynamicsError::SingularMass { joint, speed, .. } = &error else {
        panic!("another error: {error}");
    };
    assert_eq!((joint.as_str(), *speed), ("ghost joint", "turn"));
}

#[test]
fn wrong_sizes_are_errors() {
    let mechanism = support::tree(&mut Random::new(1), &[joints::ball()]);
    let mut reference = Reference::new(Arc::clone(&mechanism));
    let error = reference
        .forward_dynamics(&[0.0; 8], &[0.0; 3], &[0.0; 3], &mut [0.0; 3])
        .expect_err("a ball has nine entries");
    assert_eq!(
        error.to_string(),
        "configuration of the mechanism has 8 entries: it must have 9"
    );
    let error = Recursive::new(mechanism)
        .inverse_dynamics(&[0.0; 9], &[0.0; 3], &[0.0; 2], &mut [0.0; 3])
        .expect_err("three accelerations");
    assert_eq!(
        error.to_string(),
        "accelerations of the mechanism has 2 entries: it must have 3"
    );
}
