//! Theorem 1 on systems whose equations are known otherwise.

use hamel_runtime::dynamics::quasi::{QuasiError, QuasiSystem, QuasiTerms};
use hamel_runtime::joint::from_rows;
use hamel_runtime::scalar::Scalar;
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

/// A rigid body about its centre of mass in ZYX Euler angles, v its angular velocity in body axes.
struct Euler(Vector3<f64>);

impl QuasiSystem<3> for Euler {
    fn velocity_map<T: Scalar>(&self, q: &SVector<T, 3>) -> SMatrix<T, 3, 3> {
        let ((sin_x, cos_x), (sin_y, cos_y)) = (q[2].sin_cos(), q[1].sin_cos());
        let (zero, one) = (T::zero(), T::one());
        from_rows([
            [-sin_y, zero, one],
            [sin_x * cos_y, cos_x, zero],
            [cos_x * cos_y, -sin_x, zero],
        ])
    }
    fn mass_matrix<T: Scalar>(&self, _q: &SVector<T, 3>) -> SMatrix<T, 3, 3> {
        Matrix3::from_diagonal(&self.0.map(T::from_f64))
    }
    fn potential<T: Scalar>(&self, _q: &SVector<T, 3>) -> T {
        T::zero()
    }
}

/// A point mass in the plane in polar coordinates, in a linear force field; v = d/dt of Cartesian coordinates.
struct Polar;

impl QuasiSystem<2> for Polar {
    fn velocity_map<T: Scalar>(&self, q: &SVector<T, 2>) -> SMatrix<T, 2, 2> {
        let (sin, cos) = q[1].sin_cos();
        from_rows([[cos, -(q[0] * sin)], [sin, q[0] * cos]])
    }
    fn mass_matrix<T: Scalar>(&self, _q: &SVector<T, 2>) -> SMatrix<T, 2, 2> {
        SMatrix::identity() * T::from_f64(2.0)
    }
    fn potential<T: Scalar>(&self, q: &SVector<T, 2>) -> T {
        // V = 3 x
        T::from_f64(3.0) * q[0] * q[1].sin_cos().1
    }
}

/// A mass matrix that varies and velocities that are none.
struct Mixed;

impl QuasiSystem<2> for Mixed {
    fn velocity_map<T: Scalar>(&self, q: &SVector<T, 2>) -> SMatrix<T, 2, 2> {
        from_rows([[T::one(), q[1]], [T::zero(), q[0].exp()]])
    }
    fn mass_matrix<T: Scalar>(&self, q: &SVector<T, 2>) -> SMatrix<T, 2, 2> {
        let cos = q[1].sin_cos().1;
        from_rows([
            [T::from_f64(2.0) + cos, q[0] * q[0]],
            [q[0] * q[0], T::from_f64(3.0)],
        ])
    }
    fn potential<T: Scalar>(&self, q: &SVector<T, 2>) -> T {
        q[0] * q[1]
    }
}

/// A few roundings of terms of order 1.
const ROUNDING: f64 = 1e-13;

#[test]
fn euler_equations() {
    let inertia = Vector3::new(1.0, 2.0, 2.5);
    let terms = QuasiTerms::new(&Euler(inertia), &Vector3::new(0.3, -0.8, 2.0)).expect("regular");
    let (w, torque) = (Vector3::new(0.4, -1.1, 0.7), Vector3::new(0.1, 0.2, -0.3));
    let momentum = inertia.component_mul(&w);
    let momentum_rate = torque - w.cross(&momentum);
    let found = terms.accelerations(&w, &torque).expect("regular");
    assert!((found - momentum_rate.component_div(&inertia)).amax() < ROUNDING);
    let (_, found) = terms
        .hamiltonian_rates(&momentum, &torque)
        .expect("regular");
    assert!((found - momentum_rate).amax() < ROUNDING);
    // J22 of body axes is the cross product with the angular momentum.
    assert!((terms.j22(&momentum) * w - momentum.cross(&w)).amax() < ROUNDING);
}

#[test]
fn integrable_velocities_have_no_gamma() {
    let terms = QuasiTerms::new(&Polar, &Vector2::new(1.4, 0.9)).expect("regular");
    for gamma in terms.gamma() {
        assert!(gamma.amax() < ROUNDING);
    }
    let (p, efforts) = (Vector2::new(0.3, -2.0), Vector2::new(0.5, 0.25));
    assert!(terms.j22(&p).amax() < ROUNDING);
    let expected = Vector2::new((0.5 - 3.0) / 2.0, 0.25 / 2.0);
    let found = terms.accelerations(&(p / 2.0), &efforts).expect("regular");
    assert!((found - expected).amax() < ROUNDING);
}

#[test]
fn gamma_and_j22_are_the_same_terms() {
    let terms = QuasiTerms::new(&Mixed, &Vector2::new(0.4, -0.6)).expect("regular");
    let (v, p) = (Vector2::new(0.7, -0.2), Vector2::new(-1.0, 0.8));
    let gamma = terms.gamma();
    let sum = gamma[0] * v[0] + gamma[1] * v[1];
    assert!((sum * p + terms.j22(&p) * v).amax() < ROUNDING);
    assert!(
        (sum * p).amax() > 0.1,
        "the velocities of this system are not integrable"
    );
}

/// ṗ of (18) is M v̇ + Ṁ v with v̇ of (16).
#[test]
fn both_forms_are_the_same_equations() {
    let terms = QuasiTerms::new(&Mixed, &Vector2::new(0.4, -0.6)).expect("regular");
    let (v, efforts) = (Vector2::new(0.7, -0.2), Vector2::new(-1.0, 0.8));
    let (q_rate, p_rate) = terms
        .hamiltonian_rates(&(terms.mass_matrix * v), &efforts)
        .expect("regular");
    assert!((q_rate - terms.coordinate_rate(&v)).amax() < ROUNDING);
    let slope = &terms.mass_matrix_gradient;
    let mass_rate = slope[0] * q_rate[0] + slope[1] * q_rate[1];
    let expected =
        terms.mass_matrix * terms.accelerations(&v, &efforts).expect("regular") + mass_rate * v;
    assert!((p_rate - expected).amax() < ROUNDING);
}

/// The Lagrangian in (q, q̇), by hand: d/dt(q̇ᵀ SᵀMS) by the chain rule on a path, differences for the outer derivative.
#[test]
fn theorem_1_is_euler_lagrange() {
    let (q, v, efforts) = (
        Vector2::new(0.4, -0.6),
        Vector2::new(0.7, -0.2),
        Vector2::new(-1.0, 0.8),
    );
    let terms = QuasiTerms::new(&Mixed, &q).expect("regular");
    let (q_rate, v_rate) = (
        terms.coordinate_rate(&v),
        terms.accelerations(&v, &efforts).expect("regular"),
    );
    // On the path q(t), v(t) to first order: ∂L/∂q̇ = Sᵀ M v.
    let momentum = |t: f64| {
        let (q, v) = (q + q_rate * t, v + v_rate * t);
        Mixed.velocity_map(&q).transpose() * Mixed.mass_matrix(&q) * v
    };
    let lagrangian = |q: Vector2<f64>| {
        let v = Mixed.velocity_map(&q) * q_rate;
        0.5 * v.dot(&(Mixed.mass_matrix(&q) * v)) - Mixed.potential(&q)
    };
    let step = 1e-5;
    let rate = (momentum(step) - momentum(-step)) / (2.0 * step);
    let slope = Vector2::from_fn(|k, _| {
        let mut ahead = Vector2::zeros();
        ahead[k] = step;
        (lagrangian(q + ahead) - lagrangian(q - ahead)) / (2.0 * step)
    });
    let applied = terms.velocity_map.transpose() * efforts;
    // Central differences: h²/6 times third derivatives, and ε/h.
    assert!((rate - slope - applied).amax() < 1e-9);
}

#[test]
fn singular_points_are_errors() {
    let gimbal_lock = Vector3::new(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    let terms = QuasiTerms::new(&Euler(Vector3::repeat(1.0)), &gimbal_lock);
    // cos(π/2) is 6e-17 and not 0, so that an inverse exists there in floating point: take q with an exact zero.
    assert!(terms.is_ok_and(|terms| terms.velocity_map_inverse.amax() > 1e15));
    let terms = QuasiTerms::new(&Polar, &Vector2::zeros());
    assert_eq!(terms.map(|_| ()), Err(QuasiError::SingularVelocityMap));
    let terms = QuasiTerms::new(&Euler(Vector3::new(1.0, 0.0, 1.0)), &Vector3::zeros())
        .expect("S is regular");
    let rates = terms.accelerations(&Vector3::zeros(), &Vector3::zeros());
    assert_eq!(rates, Err(QuasiError::SingularMass));
}
