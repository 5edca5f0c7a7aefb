//! Laws that every joint obeys, checked on the compiled kernels by dual numbers: the definition against what was derived.
//!
//! Each law takes a configuration Q and a local coordinate ϕ; [`check_all`] runs them at ϕ = 0, 1e-8, random, and within 1e-6 of
//! half a turn, from random configurations.

use hamel::joint::Joint;
use hamel::nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3, Vector6};
use hamel::scalar::{Dual, Scalar};
use hamel::spatial::{Pose, vee};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Bound on relative errors: sums of up to a hundred products of numbers of order 1 to 10 in double precision, 100 × 10² × 1.1e-16.
const TOLERANCE: f64 = 1e-12;
const CONFIGURATIONS: usize = 40;

type D1 = Dual<f64>;
type D2 = Dual<D1>;

/// A joint at a configuration.
struct At<'a, J, const N: usize, const K: usize, const S: usize, const C: usize> {
    joint: &'a J,
    q: SVector<f64, N>,
}

/// How far ϕ goes.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// Up to half a turn: Φ is exp, or as good.
    HalfTurn,
    /// Entries up to this number: beyond, Φ(Q, ·) takes values twice, or meets an exception.
    Entries(f64),
}

/// Checks every law at many configurations and sizes of ϕ, up to half a turn.
///
/// # Panics
/// With the law, the joint and the figures, where one does not hold.
pub fn check_all<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
) {
    check_within(joint, Reach::HalfTurn);
}

/// Checks every law at many configurations, at sizes of ϕ up to `reach`.
///
/// # Panics
/// With the law, the joint and the figures, where one does not hold.
pub fn check_within<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    reach: Reach,
) {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..CONFIGURATIONS {
        let away: SVector<f64, K> = vector(&mut random, 1.5);
        let at = At {
            joint,
            q: joint.retract(&joint.home(), &away),
        };
        at.velocity_laws(&vector(&mut random, 2.0), &vector(&mut random, 2.0));
        at.speed_laws(&vector(&mut random, 2.0), &vector(&mut random, 2.0));
        at.manifold_laws(&vector(&mut random, 1e-6));
        at.imperceptible_laws(&vector(&mut random, 1.0));
        at.singular_sets();
        for phi in at.sizes(&vector(&mut random, 1.0), reach) {
            at.finite_laws(&phi, &vector(&mut random, 2.0));
        }
    }
}

fn vector<const K: usize>(random: &mut ChaCha8Rng, size: f64) -> SVector<f64, K> {
    SVector::from_fn(|_, _| random.random_range(-size..size))
}

fn close<const R: usize, const M: usize>(
    law: &str,
    name: &str,
    got: &SMatrix<f64, R, M>,
    expected: &SMatrix<f64, R, M>,
) {
    close_within(law, name, got, expected, TOLERANCE);
}

fn close_within<const R: usize, const M: usize>(
    law: &str,
    name: &str,
    got: &SMatrix<f64, R, M>,
    expected: &SMatrix<f64, R, M>,
    tolerance: f64,
) {
    let size = 1.0 + got.amax().max(expected.amax());
    let error = (got - expected).amax() / size;
    assert!(
        !(error.is_nan() || error > tolerance),
        "{name}: {law}: relative error {error:e}\ngot {got}expected {expected}"
    );
}

/// The dual vector `base + ε direction`.
fn moving<T: Scalar, const M: usize>(
    base: &SVector<T, M>,
    direction: &SVector<T, M>,
) -> SVector<Dual<T>, M> {
    SVector::from_fn(|i, _| Dual::new(base[i], direction[i]))
}

fn constant<T: Scalar, const R: usize, const M: usize>(
    value: &SMatrix<T, R, M>,
) -> SMatrix<Dual<T>, R, M> {
    value.map(Dual::constant)
}

fn values<T: Scalar, const R: usize, const M: usize>(
    m: &SMatrix<Dual<T>, R, M>,
) -> SMatrix<T, R, M> {
    m.map(|entry| entry.value)
}

fn slopes<T: Scalar, const R: usize, const M: usize>(
    m: &SMatrix<Dual<T>, R, M>,
) -> SMatrix<T, R, M> {
    m.map(|entry| entry.derivative)
}

/// `vee(Ḣ H⁻¹)`: angular part first.
fn twist<T: Scalar>(pose: &Pose<Dual<T>>) -> Vector6<T> {
    let (r, dr): (Matrix3<T>, Matrix3<T>) = (values(&pose.rotation), slopes(&pose.rotation));
    let omega = vee(&(dr * r.transpose()));
    let (p, dp): (Vector3<T>, Vector3<T>) = (values(&pose.translation), slopes(&pose.translation));
    let v = dp - omega.cross(&p);
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

fn unit<const K: usize>(k: usize) -> SVector<f64, K> {
    SVector::from_fn(|i, _| f64::from(u8::from(i == k)))
}

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    At<'_, J, N, K, S, C>
{
    /// ϕ = 0, of size 1e-8, and up to the reach: as given and with its turn within 1e-6 of π, or a half and the whole.
    fn sizes(&self, phi: &SVector<f64, K>, reach: Reach) -> [SVector<f64, K>; 4] {
        if let Reach::Entries(most) = reach {
            return [SVector::zeros(), phi * 1e-8, phi * (most / 2.0), phi * most];
        }
        let turn = (self.joint.twist_map_child(&self.q) * self.joint.velocity_map(&self.q) * phi)
            .fixed_rows::<3>(0)
            .norm();
        let scale = match turn > 0.1 {
            // An angle of Q may turn further than the child does, as on the flat side of an ellipse.
            true => (std::f64::consts::PI - 1e-6) / turn.max(phi.amax()),
            false => std::f64::consts::PI,
        };
        [SVector::zeros(), phi * 1e-8, *phi, phi * scale]
    }

    /// Q moved along ϕ_k, as a dual number.
    fn along(&self, direction: &SVector<f64, K>) -> SVector<D1, N> {
        let start = moving(&SVector::zeros(), direction);
        self.joint.retract(&constant(&self.q), &start)
    }

    /// Laws of X, S and the Boltzmann–Hamel terms, at ϕ = 0.
    fn velocity_laws(&self, v: &SVector<f64, K>, p: &SVector<f64, K>) {
        let (joint, q) = (self.joint, &self.q);
        let x = joint.twist_map(q);
        let s = joint.velocity_map(q);
        let inverse = joint.velocity_map_inverse(q);
        close("S₀ S₀⁻¹ = I", J::NAME, &(s * inverse), &SMatrix::identity());
        let child = joint.twist_map_child(q);
        close(
            "X = Ad X^c",
            J::NAME,
            &(joint.pose(q).adjoint() * child),
            &x,
        );
        let gradient = joint.velocity_map_gradient(q);
        let child_gradient = joint.twist_map_child_gradient(q);
        for k in 0..K {
            let moved = self.along(&unit(k));
            close(
                "J₀ = X S₀",
                J::NAME,
                &twist(&joint.pose(&moved)),
                &(x * s.column(k)),
            );
            close(
                "∂X^c/∂ϕ",
                J::NAME,
                &slopes(&joint.twist_map_child(&moved)),
                &child_gradient[k],
            );
            let left = x * gradient[k] + slopes(&joint.twist_map(&moved)) * s;
            close("X ∂S + ∂X S = ∂J", J::NAME, &left, &self.jacobian_slope(k));
        }
        let rate = inverse * v;
        close(
            "Q̇",
            J::NAME,
            &joint.configuration_rate(q, v),
            &slopes(&self.along(&rate)),
        );
        self.hamel_laws(v, p, &gradient, &inverse);
    }

    /// ∂J/∂ϕ_l at ϕ = 0, by nested dual numbers on H(Φ(Q, ϕ)).
    fn jacobian_slope(&self, l: usize) -> SMatrix<f64, 6, K> {
        let column = |k: usize| {
            let phi: SVector<D2, K> = SVector::from_fn(|i, _| {
                let outer = f64::from(u8::from(i == l));
                let inner = f64::from(u8::from(i == k));
                Dual::new(Dual::new(0.0, outer), Dual::constant(inner))
            });
            let q: SVector<D2, N> = constant(&constant(&self.q));
            slopes(&twist(&self.joint.pose(&self.joint.retract(&q, &phi))))
        };
        let columns: Vec<Vector6<f64>> = (0..K).map(column).collect();
        SMatrix::from_fn(|i, k| columns[k][i])
    }

    /// (17) and (28) from S₀⁻¹ and ∂S/∂ϕ.
    fn hamel_laws(
        &self,
        v: &SVector<f64, K>,
        p: &SVector<f64, K>,
        gradient: &[SMatrix<f64, K, K>; K],
        inverse: &SMatrix<f64, K, K>,
    ) {
        let w = inverse * v;
        let inner = SMatrix::<f64, K, K>::from_fn(|l, j| {
            (0..K)
                .map(|m| (gradient[m][(j, l)] - gradient[l][(j, m)]) * w[m])
                .sum()
        });
        let gamma = self.joint.gamma(&self.q, v);
        close("γ, (17)", J::NAME, &gamma, &inverse.tr_mul(&inner));
        let b =
            SMatrix::<f64, K, K>::from_fn(|i, m| (0..K).map(|l| gradient[m][(l, i)] * p[l]).sum());
        let j22 = self.joint.j22(&self.q, p);
        close(
            "J22, (28)",
            J::NAME,
            &j22,
            &(inverse.tr_mul(&(b.transpose() - b)) * inverse),
        );
        close(
            "Σ γ_k v_k p = −J22 v",
            J::NAME,
            &(gamma * p),
            &(j22 * v * -1.0),
        );
    }

    /// Laws of the constraint and of the speeds.
    fn speed_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, &self.q);
        let basis = joint.speed_basis(q);
        close(
            "Aᵀ S̄ = 0",
            J::NAME,
            &joint.constraint(q).tr_mul(&basis),
            &SMatrix::zeros(),
        );
        let gradient = joint.speed_basis_gradient(q);
        for (k, slice) in gradient.iter().enumerate() {
            close(
                "∂S̄/∂ϕ",
                J::NAME,
                &slopes(&joint.speed_basis(&self.along(&unit(k)))),
                slice,
            );
        }
        let moved = self.along(&(joint.velocity_map_inverse(q) * basis * speeds));
        let rate = slopes(&(joint.twist_map_child(&moved) * joint.speed_basis(&moved)));
        close(
            "c = Ẋ̄^c v̄",
            J::NAME,
            &joint.bias_acceleration(q, speeds),
            &(rate * speeds),
        );
        close(
            "Ẋ̄^cᵀ h",
            J::NAME,
            &joint.bias_momentum(q, speeds, wrench),
            &rate.tr_mul(wrench),
        );
        close("Ẋ̄^c", J::NAME, &joint.twist_map_rate(q, speeds), &rate);
        self.gradient_laws(speeds, wrench);
        self.slope_laws(speeds, wrench);
    }

    /// Derivatives along ϕ of X̄^c v̄, of c and of their duals.
    fn gradient_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, &self.q);
        let local = joint.local_twist_map(q);
        let of_twist = joint.twist_gradient(q, speeds);
        let of_effort = joint.effort_gradient(q, wrench);
        let of_bias = joint.bias_acceleration_gradient(q, speeds);
        let of_momentum = joint.bias_momentum_gradient(q, speeds, wrench);
        let product = joint.twist_map_child(q) * joint.velocity_map(q);
        close("X^c S₀", J::NAME, &local, &product);
        for k in 0..K {
            let moved = self.along(&unit(k));
            let (v, h) = (constant(speeds), constant(wrench));
            let map = joint.twist_map_child(&moved) * joint.speed_basis(&moved);
            let check = |law: &str, got: &[f64], expected: &[D1]| {
                for (got, expected) in got.iter().zip(expected) {
                    let got = SVector::<f64, 1>::new(*got);
                    close(
                        law,
                        J::NAME,
                        &got,
                        &SVector::<f64, 1>::new(expected.derivative),
                    );
                }
            };
            let column = of_twist.column(k);
            check("∂(X̄^c v̄)/∂ϕ", column.as_slice(), (map * v).as_slice());
            let column = of_effort.column(k);
            check("∂(X̄^cᵀ h)/∂ϕ", column.as_slice(), map.tr_mul(&h).as_slice());
            let bias = joint.bias_acceleration(&moved, &v);
            check("∂c/∂ϕ", of_bias.column(k).as_slice(), bias.as_slice());
            let dual = joint.bias_momentum(&moved, &v, &h);
            let column = of_momentum.column(k);
            check("∂(Ẋ̄^cᵀ h)/∂ϕ", column.as_slice(), dual.as_slice());
        }
    }

    /// Derivatives of c and of its dual by the speeds.
    fn slope_laws(&self, speeds: &SVector<f64, S>, wrench: &Vector6<f64>) {
        let (joint, q) = (self.joint, constant(&self.q));
        let of_bias = joint.bias_acceleration_slope(&self.q, speeds);
        let of_momentum = joint.bias_momentum_slope(&self.q, speeds, wrench);
        for a in 0..S {
            let faster = moving(speeds, &unit(a));
            close(
                "∂c/∂v̄",
                J::NAME,
                &of_bias.column(a).into_owned(),
                &slopes(&joint.bias_acceleration(&q, &faster)),
            );
            close(
                "∂(Ẋ̄^cᵀ h)/∂v̄",
                J::NAME,
                &of_momentum.column(a).into_owned(),
                &slopes(&joint.bias_momentum(&q, &faster, &constant(wrench))),
            );
        }
    }

    /// The manifold: relations, projection.
    fn manifold_laws(&self, disturbance: &SVector<f64, N>) {
        let (joint, q) = (self.joint, &self.q);
        // RᵀR − I of a product of two rotations: nine entries of a few ulp each.
        assert!(
            joint.residual(q) < 1e-14,
            "{}: residual {:e}",
            J::NAME,
            joint.residual(q)
        );
        let pose = joint.pose(q);
        close(
            "RᵀR = I",
            J::NAME,
            &pose.rotation.tr_mul(&pose.rotation),
            &Matrix3::identity(),
        );
        assert!(
            (pose.rotation.determinant() - 1.0).abs() < TOLERANCE,
            "{}: det R",
            J::NAME
        );
        close(
            "projection keeps the manifold",
            J::NAME,
            &joint.project(q),
            q,
        );
        let back = joint.project(&(q + disturbance));
        assert!(
            joint.residual(&back) < 1e-14,
            "{}: residual {:e} after projection",
            J::NAME,
            joint.residual(&back)
        );
        // The nearest point is at most twice the disturbance from Q.
        assert!(
            (back - q).norm() <= 2.0 * disturbance.norm(),
            "{}: projection moves far",
            J::NAME
        );
    }

    /// N_X: no force, no inertia felt.
    fn imperceptible_laws(&self, phi: &SVector<f64, K>) {
        let other = self.joint.retract(&self.q, phi);
        for parameters in J::IMPERCEPTIBLE {
            let n = spatial_inertia(parameters);
            close(
                "N X^c = 0",
                J::NAME,
                &(n * self.joint.twist_map_child(&self.q)),
                &SMatrix::zeros(),
            );
            let in_parent = |q: &SVector<f64, N>| {
                let inverse = self.joint.pose(q).inverse().adjoint();
                inverse.transpose() * n * inverse
            };
            close(
                "N is constant in the parent",
                J::NAME,
                &in_parent(&self.q),
                &in_parent(&other),
            );
        }
    }

    /// A joint that names no singular set is at no distance from one; any other is off its own here.
    fn singular_sets(&self) {
        let distance: f64 = self.joint.singularity(&self.q);
        match J::SINGULARITIES.is_empty() {
            true => assert_eq!(distance, f64::INFINITY, "{}", J::NAME),
            false => assert!(distance > 0.0 && distance.is_finite(), "{}", J::NAME),
        }
    }

    /// Laws at finite ϕ: Φ, its inverse, its differential, and S(Q, ϕ) with it.
    fn finite_laws(&self, phi: &SVector<f64, K>, v: &SVector<f64, K>) {
        let (joint, q) = (self.joint, &self.q);
        let moved = joint.retract(q, phi);
        assert!(
            joint.residual(&moved) < 2e-14,
            "{}: Φ leaves the manifold by {:e}",
            J::NAME,
            joint.residual(&moved)
        );
        close("Φ⁻¹(Q, Φ(Q, ϕ)) = ϕ", J::NAME, &joint.local(q, &moved), phi);
        let u = joint.velocity_map_inverse(&moved) * v;
        let rate = joint.retract_differential_inverse(q, phi, &u);
        let differential = joint.retract_differential(q, phi);
        close("D D⁻¹ = I", J::NAME, &(differential * rate), &u);
        let path = joint.retract(&constant(q), &moving(phi, &rate));
        let from_there = joint.local(&constant(&moved), &path);
        close(
            "Φ(Q, ϕ + δ) = Φ(Q′, D δ)",
            J::NAME,
            &slopes(&from_there),
            &u,
        );
        close(
            "X(Φ) v = J ϕ̇ at finite ϕ",
            J::NAME,
            &twist(&joint.pose(&path)),
            &(joint.twist_map(&moved) * v),
        );
        close(
            "Q̇ along Φ",
            J::NAME,
            &slopes(&path),
            &joint.configuration_rate(&moved, v),
        );
        let inverse_path = joint.local(&constant(q), &path);
        close(
            "differential of Φ⁻¹",
            J::NAME,
            &slopes(&inverse_path),
            &rate,
        );
    }
}

fn spatial_inertia(n: &[f64; 10]) -> Matrix6<f64> {
    let [m, x, y, z, xx, yy, zz, xy, xz, yz] = *n;
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let moment = hamel::spatial::hat(&Vector3::new(x, y, z));
    let mut spatial = Matrix6::zeros();
    spatial.fixed_view_mut::<3, 3>(0, 0).copy_from(&inertia);
    spatial.fixed_view_mut::<3, 3>(0, 3).copy_from(&moment);
    spatial.fixed_view_mut::<3, 3>(3, 0).copy_from(&-moment);
    spatial
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(Matrix3::identity() * m));
    spatial
}
