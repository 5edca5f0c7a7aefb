//! Laws of the manifold, of the finite maps, and of the inertias that do not affect a joint.

use super::dual::{constant, moving, slopes, twist};
use super::{At, TOLERANCE, close};
use hamel::joint::Joint;
use hamel::nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3};

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    At<'_, J, N, K, S, C>
{
    /// The manifold: relations, projection.
    pub(super) fn manifold_laws(&self, disturbance: &SVector<f64, N>) {
        let (joint, q) = (self.joint, &self.q);
        // RᵀR − I of a product of two rotations: nine entries of a few ulp each.
        assert!(
            joint.residual(q) < 1e-14,
            "{}: residual {:e}",
            self.joint.facts().name,
            joint.residual(q)
        );
        let pose = joint.pose(q);
        close(
            "RᵀR = I",
            self.joint.facts().name,
            &pose.rotation.tr_mul(&pose.rotation),
            &Matrix3::identity(),
        );
        assert!(
            (pose.rotation.determinant() - 1.0).abs() < TOLERANCE,
            "{}: det R",
            self.joint.facts().name
        );
        close(
            "projection keeps the manifold",
            self.joint.facts().name,
            &joint.project(q),
            q,
        );
        let back = joint.project(&(q + disturbance));
        assert!(
            joint.residual(&back) < 1e-14,
            "{}: residual {:e} after projection",
            self.joint.facts().name,
            joint.residual(&back)
        );
        // The nearest point is at most twice the disturbance from Q.
        assert!(
            (back - q).norm() <= 2.0 * disturbance.norm(),
            "{}: projection moves far",
            self.joint.facts().name
        );
    }

    /// N_X: no force, no inertia felt.
    pub(super) fn unidentifiable_laws(&self, phi: &SVector<f64, K>) {
        let other = self.joint.retract(&self.q, phi);
        for parameters in self.joint.facts().unidentifiable {
            let n = spatial_inertia(parameters);
            close(
                "N X^c = 0",
                self.joint.facts().name,
                &(n * self.joint.twist_map_child(&self.q)),
                &SMatrix::zeros(),
            );
            let in_parent = |q: &SVector<f64, N>| {
                let inverse = self.joint.pose(q).inverse().adjoint();
                inverse.transpose() * n * inverse
            };
            close(
                "N is constant in the parent",
                self.joint.facts().name,
                &in_parent(&self.q),
                &in_parent(&other),
            );
        }
    }

    /// A joint that names no singular set is at no distance from one; any other is off its own here.
    pub(super) fn singular_sets(&self) {
        let distance: f64 = self.joint.singularity(&self.q);
        match self.joint.facts().singularities.is_empty() {
            true => assert_eq!(distance, f64::INFINITY, "{}", self.joint.facts().name),
            false => assert!(
                distance > 0.0 && distance.is_finite(),
                "{}",
                self.joint.facts().name
            ),
        }
    }

    /// Laws at finite ϕ: Φ, its inverse, its differential, and S(Q, ϕ) with it.
    pub(super) fn finite_laws(&self, phi: &SVector<f64, K>, v: &SVector<f64, K>) {
        let (joint, q) = (self.joint, &self.q);
        let moved = joint.retract(q, phi);
        assert!(
            joint.residual(&moved) < 2e-14,
            "{}: Φ leaves the manifold by {:e}",
            self.joint.facts().name,
            joint.residual(&moved)
        );
        close(
            "Φ⁻¹(Q, Φ(Q, ϕ)) = ϕ",
            self.joint.facts().name,
            &joint.local(q, &moved),
            phi,
        );
        let u = joint.velocity_map_inverse(&moved) * v;
        let rate = joint.retract_differential_inverse(q, phi, &u);
        let differential = joint.retract_differential(q, phi);
        close(
            "D D⁻¹ = I",
            self.joint.facts().name,
            &(differential * rate),
            &u,
        );
        let path = joint.retract(&constant(q), &moving(phi, &rate));
        let from_there = joint.local(&constant(&moved), &path);
        close(
            "Φ(Q, ϕ + δ) = Φ(Q′, D δ)",
            self.joint.facts().name,
            &slopes(&from_there),
            &u,
        );
        close(
            "X(Φ) v = J ϕ̇ at finite ϕ",
            self.joint.facts().name,
            &twist(&joint.pose(&path)),
            &(joint.twist_map(&moved) * v),
        );
        close(
            "Q̇ along Φ",
            self.joint.facts().name,
            &slopes(&path),
            &joint.configuration_rate(&moved, v),
        );
        let inverse_path = joint.local(&constant(q), &path);
        close(
            "differential of Φ⁻¹",
            self.joint.facts().name,
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
