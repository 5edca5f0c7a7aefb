//! The equations of motion against Euler–Lagrange in ϕ, from H and Φ alone, and that oracle against a textbook.

use chacha20::ChaCha8Rng;
use hamel::dynamics::{Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{DVector, Matrix3, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::oracle::{Motion, Oracle, OracleJoint};
use hamel_tests::random::{Case, cases, library, numbers};
use rand::SeedableRng;
use std::sync::Arc;

/// Six bodies, 36 degrees of freedom at most: the oracle's sums of 4×4 products in world coordinates, metres away from the origin,
/// cancel up to a hundredfold; 1000 roundings of 1.1e-16.
const ROUNDING: f64 = 1e-13;

/// Cases on trees of 1 to 6 of the joints that the oracle knows, with their oracles.
fn known_cases() -> Vec<(Case, Oracle)> {
    let mut kinds = library();
    kinds.retain(|joint| OracleJoint::named(joint.name()).is_some());
    assert_eq!(
        kinds.len(),
        7,
        "revolute, prismatic, ball, planar twice, cart, free"
    );
    let with_oracle = |case: Case| {
        let oracle = Oracle::new(&case.mechanism, &case.q).expect("all kinds are known");
        (case, oracle)
    };
    cases(&kinds, 6, 84).map(with_oracle).collect()
}

/// S₀ of every joint, from the declared meaning of v.
#[test]
fn velocity_maps_are_those_of_the_definitions() {
    let mut worst = Largest::new("S₀ against the oracle");
    for (case, oracle) in known_cases() {
        let expansion = Reference::new(Arc::clone(&case.mechanism))
            .expansion(&case.q)
            .expect("sizes fit");
        worst.meet(
            (oracle.velocity_map() - expansion.velocity_map).amax(),
            case.seed,
        );
    }
    // Products of two rotations: a handful of roundings.
    worst.assert_within(1e-14);
}

/// `M v̇ + Ĉv + N̂` of (24), for any v and v̇, the cart's forbidden direction included.
#[test]
fn reference_form_is_euler_lagrange() {
    let mut worst = Largest::new("(24) against Euler–Lagrange");
    for (case, oracle) in known_cases() {
        let expansion = Reference::new(Arc::clone(&case.mechanism))
            .expansion(&case.q)
            .expect("sizes fit");
        let mut random = ChaCha8Rng::seed_from_u64(1000 + case.seed);
        let freedoms = case.efforts.len();
        let v = DVector::from_vec(numbers(&mut random, freedoms));
        let v_rate = DVector::from_vec(numbers(&mut random, freedoms));
        let motion = oracle.motion(&v, &v_rate).expect("S₀ is invertible");
        let expected = oracle.efforts(&motion).expect("S₀ is invertible");
        let terms = [
            &expansion.mass_matrix * &v_rate,
            expansion.coriolis_matrix(&v) * &v,
            expansion.potential_forces(),
        ];
        let found: DVector<f64> = terms.iter().sum();
        let largest = terms.iter().map(|term| term.amax()).fold(0.0, f64::max);
        worst.meet((found - expected).amax() / largest, case.seed);
    }
    worst.assert_within(ROUNDING);
}

/// Newton–Euler, constraint forces included, for v and v̇ that the constraints allow.
#[test]
fn newton_euler_is_euler_lagrange() {
    let mut worst = Largest::new("Newton–Euler against Euler–Lagrange");
    for (case, oracle) in known_cases() {
        let allowed = |speeds: &[f64]| {
            // S̄ of the cart is constant, so that v̇ = S̄ v̄̇.
            let v = case.mechanism.velocity_from_speeds(&case.q, speeds);
            DVector::from_vec(v.expect("sizes fit"))
        };
        let motion = oracle.motion(&allowed(&case.speeds), &allowed(&case.rates));
        let expected = oracle
            .efforts(&motion.expect("S₀ is invertible"))
            .expect("S₀ is invertible");
        let mut recursion = Recursive::new(Arc::clone(&case.mechanism));
        let mut reduced = vec![0.0; case.speeds.len()];
        recursion
            .inverse_dynamics(&case.q, &case.speeds, &case.rates, &mut reduced)
            .expect("sizes fit");
        let mut found = vec![0.0; case.efforts.len()];
        recursion
            .joint_efforts(&case.q, &mut found)
            .expect("sizes fit");
        let error = difference(&found, expected.as_slice()) / size(expected.as_slice());
        worst.meet(error, case.seed);
    }
    worst.assert_within(ROUNDING);
}

fn link(index: usize, joint: &Arc<dyn AnyJoint>, length: f64) -> BodySpec {
    let (mass, inertia) = LINKS[index];
    BodySpec {
        name: format!("link {index}"),
        joint_name: format!("hinge {index}"),
        parent: index.checked_sub(1),
        joint: Arc::clone(joint),
        placement: Pose::from_translation(Vector3::new(length, 0.0, 0.0)),
        child_placement: Pose::identity(),
        mass: MassProperties::new(
            mass,
            Vector3::new(CENTRES[index], 0.0, 0.0),
            Matrix3::identity() * inertia,
        )
        .expect("physical"),
    }
}

/// Mass and moment of inertia of the links of a double pendulum, their centres of mass, and the length of the first.
const LINKS: [(f64, f64); 2] = [(1.3, 0.11), (0.7, 0.05)];
const CENTRES: [f64; 2] = [0.6, 0.35];
const LENGTH: f64 = 0.9;
const WEIGHT: f64 = 9.81;

/// The oracle itself, on the double pendulum of the textbooks: angles a from the x axis and b relative, gravity along −y.
#[test]
fn oracle_gives_the_textbook_double_pendulum() {
    let revolute = library()
        .into_iter()
        .find(|joint| joint.name() == "revolute")
        .expect("in the library");
    let links = vec![link(0, &revolute, 0.0), link(1, &revolute, LENGTH)];
    let mechanism = Mechanism::new(Vector3::new(0.0, -WEIGHT, 0.0), links).expect("valid");
    let (a, b) = (0.4, 1.9);
    let (rate, second) = ([1.7, -2.3], [0.8, 3.1]);
    let oracle = Oracle::new(&mechanism, &[a, b]).expect("revolute is known");
    let motion = Motion {
        rate: DVector::from_column_slice(&rate),
        second: DVector::from_column_slice(&second),
    };
    let found = oracle.efforts(&motion).expect("S₀ = I");

    let [(m1, i1), (m2, i2)] = LINKS;
    let [c1, c2] = CENTRES;
    let (sin, cos) = f64::sin_cos(b);
    let coupling = m2 * LENGTH * c2;
    let m22 = i2 + m2 * c2 * c2;
    let m12 = m22 + coupling * cos;
    let m11 = i1 + m1 * c1 * c1 + m2 * LENGTH * LENGTH + m12 + coupling * cos;
    let far = m2 * WEIGHT * c2 * (a + b).cos();
    let expected = [
        m11 * second[0] + m12 * second[1]
            - coupling * sin * (2.0 * rate[0] * rate[1] + rate[1] * rate[1])
            + (m1 * c1 + m2 * LENGTH) * WEIGHT * a.cos()
            + far,
        m12 * second[0] + m22 * second[1] + coupling * sin * rate[0] * rate[0] + far,
    ];
    // A dozen terms of up to 20, a rounding each.
    assert!(
        difference(found.as_slice(), &expected) < 1e-13,
        "{found} {expected:?}"
    );
}

/// The oracle on a ball joint, whose v and ϕ differ: Euler's equations, `I ω̇ + ω × I ω = moment` in body axes.
#[test]
fn oracle_gives_eulers_equations() {
    let ball = library()
        .into_iter()
        .find(|joint| joint.name() == "ball")
        .expect("in the library");
    let inertia = Matrix3::new(0.9, 0.1, 0.0, 0.1, 1.2, -0.2, 0.0, -0.2, 1.5);
    let body = BodySpec {
        name: "top".into(),
        joint_name: "ball".into(),
        parent: None,
        joint: ball,
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(2.0, Vector3::zeros(), inertia).expect("physical"),
    };
    let mechanism = Mechanism::new(Vector3::zeros(), vec![body]).expect("valid");
    let q = mechanism
        .configuration_from_local(0, &[0.3, -1.2, 2.0])
        .expect("finite");
    let oracle = Oracle::new(&mechanism, &q).expect("ball is known");
    // v and v̇ in parent axes; the derivative of R ω is R ω̇.
    let rotation = Matrix3::from_row_slice(&q);
    let (omega, omega_rate) = (Vector3::new(0.7, -1.1, 0.4), Vector3::new(-0.3, 0.2, 0.9));
    let in_parent =
        |vector: Vector3<f64>| DVector::from_column_slice((rotation * vector).as_slice());
    let motion = oracle
        .motion(&in_parent(omega), &in_parent(omega_rate))
        .expect("S₀ = Q");
    let found = oracle.efforts(&motion).expect("S₀ = Q");
    let moment = inertia * omega_rate + omega.cross(&(inertia * omega));
    // Terms of order 1, a dozen roundings.
    assert!((found - in_parent(moment)).amax() < 1e-14);
}
