//! Three formulas of the paper as they are printed, against Newton–Euler: they do not hold, and with the errata they do.
//!
//! On the mechanism of Example 7, and on a free planar body. The wrong patterns are built here, from public matrices.

mod point;

use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Cholesky, DMatrix, Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::random::library;
use hamel_tests::scenes;
use point::Point;
use std::sync::Arc;

/// Three bodies, terms of one size: 100 roundings of 1.1e-16, with an order of magnitude for the condition of M̄.
const ROUNDING: f64 = 1e-13;
/// A formula is wrong, not inaccurate, where it misses by more than this part of the largest term.
const WRONG: f64 = 1e-3;

/// A body in a plane on a joint of that type, its centre of mass at `com`.
fn body_in_plane(joint: &str, com: Vector3<f64>) -> Arc<Mechanism> {
    let joint = library()
        .into_iter()
        .find(|other| other.name() == joint)
        .expect("in the library");
    let body = BodySpec {
        name: "disc".into(),
        joint_name: "plane".into(),
        parent: None,
        joint,
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(1.7, com, Matrix3::identity() * 0.6).expect("physical"),
    };
    Arc::new(Mechanism::new(Vector3::zeros(), vec![body]).expect("valid"))
}

/// Twelve random states of Example 7's mechanism, a free planar disc, and one with an offset centre of mass.
fn points() -> Vec<(&'static str, Vec<Point>)> {
    let mechanisms = [
        ("Example 7", scenes::load("plate_cart_arm").mechanism),
        ("disc", body_in_plane("planar", Vector3::zeros())),
        (
            "offset disc",
            body_in_plane("planar", Vector3::new(0.3, 0.1, 0.0)),
        ),
    ];
    let states = |(name, mechanism)| {
        (
            name,
            (0..12).map(|seed| Point::new(&mechanism, seed)).collect(),
        )
    };
    mechanisms.into_iter().map(states).collect()
}

/// Smallest and largest of some errors, said aloud.
fn range(what: &str, name: &str, errors: impl Iterator<Item = f64>) -> (f64, f64) {
    let range = errors.fold((f64::INFINITY, 0.0_f64), |(low, high), error| {
        assert!(!error.is_nan(), "{what}, {name}");
        (low.min(error), high.max(error))
    });
    println!("{what}, {name}: {:.1e} to {:.1e}", range.0, range.1);
    range
}

/// (26) carries `S_jm, S_js, S⁻¹_sk` where (17) requires `S_km, S_ks, S⁻¹_sj`.
#[test]
fn index_pattern_of_26() {
    for (name, points) in points() {
        let errors = points
            .iter()
            .map(|point| point.lagrangian_error(&point.printed()));
        assert!(range("(26) printed", name, errors).0 > WRONG);
        let errors = points
            .iter()
            .map(|point| point.lagrangian_error(&point.corrected()));
        assert!(range("(26) corrected", name, errors).1 < ROUNDING);
        // The library's Ĉ is the corrected one.
        let differences = points
            .iter()
            .map(|point| (point.expansion.coriolis_matrix(&point.v()) - point.corrected()).amax());
        assert!(range("(26) of the library", name, differences).1 < ROUNDING);
    }
}

/// Example 6 finds `S(Q, ϕ) ≡ I` for the planar joint, where `S = I − ½ ad_ϕ + …`.
#[test]
fn planar_velocity_map_of_example_6() {
    for (name, points) in points() {
        let errors = points.iter().map(|point| {
            let constant = point.with_constant_planar_maps();
            constant.lagrangian_error(&constant.corrected())
        });
        assert!(range("S ≡ I", name, errors).0 > WRONG);
        let errors = points
            .iter()
            .map(|point| point.hamiltonian_error(&(&point.expansion.mass_matrix * point.v())));
        assert!(range("S = I − ½ ad, (35)", name, errors).1 < ROUNDING);
    }
}

/// Example 6 got away with it: where the cart's centre of mass is at its frame's origin, the lateral momentum is zero. An
/// offset of the centre of mass shows the difference.
#[test]
fn reduced_cart_of_example_6() {
    let errors = |com: Vector3<f64>| {
        let cart = body_in_plane("cart", com);
        (0..12).map(move |seed| {
            let constant = Point::new(&cart, seed).with_constant_planar_maps();
            constant.lagrangian_error(&constant.corrected())
        })
    };
    assert!(range("S ≡ I", "cart", errors(Vector3::zeros())).1 < ROUNDING);
    assert!(range("S ≡ I", "offset cart", errors(Vector3::new(0.3, 0.1, 0.0))).0 > WRONG);
}

/// After (36) stands `p = M⁻¹S̄M̄⁻¹p̄`; it must be `p = MS̄M̄⁻¹p̄`.
#[test]
fn momentum_after_36() {
    for (name, points) in points() {
        let printed = |point: &Point| {
            let factors =
                Cholesky::new(point.expansion.mass_matrix.clone()).expect("every body has mass");
            point.hamiltonian_error(&factors.solve(&point.v()))
        };
        assert!(range("p printed", name, points.iter().map(printed)).0 > WRONG);
        let corrected =
            |point: &Point| point.hamiltonian_error(&(&point.expansion.mass_matrix * point.v()));
        assert!(range("p corrected", name, points.iter().map(corrected)).1 < ROUNDING);
    }
}

/// What the errata come to: without forces a disc moves straight in the plane, with the corrected terms alone.
#[test]
fn a_disc_without_forces_moves_straight() {
    for seed in 0..12 {
        let point = Point::new(&body_in_plane("planar", Vector3::zeros()), seed);
        let acceleration = |coriolis: DMatrix<f64>| {
            let mass = Cholesky::new(point.expansion.mass_matrix.clone()).expect("a body has mass");
            let rate = -mass.solve(&(coriolis * point.v()));
            let v = point.v();
            // In the axes of the plane the acceleration is (v̇₂ − v₁v₃, v̇₃ + v₁v₂), turned.
            (rate[1] - v[0] * v[2]).hypot(rate[2] + v[0] * v[1])
        };
        assert!(acceleration(point.corrected()) < ROUNDING);
        assert!(acceleration(point.printed()) > WRONG);
        assert!(acceleration(point.with_constant_planar_maps().corrected()) > WRONG);
    }
}
