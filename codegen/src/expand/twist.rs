//! Twists of the bodies: J to first order in ϕ, (23), and what takes twists from frame to frame.

use super::motion::Motion;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{Declared, JointSpec, PoseExpr};

/// `Ad_{H⁻¹} = [Rᵀ 0; −Rᵀp~ Rᵀ]`.
pub fn adjoint_inverse(pose: &PoseExpr) -> Matrix {
    let (r, p) = (pose.rotation.transpose(), pose.translation.entries());
    let zero = Matrix::zeros(3, 3);
    let lower = r.times(&Matrix::tilde(p)).map(|entry| -entry);
    r.beside(&zero).stack(&lower.beside(&r))
}

/// Twists of all bodies, in the parent frame, in the frame of each.
pub fn in_child_frames(spec: &JointSpec, twists: &Matrix) -> Matrix {
    let own = |(body, pose): (usize, &Declared<PoseExpr>)| {
        adjoint_inverse(&pose.value).times(&twists.rows_of_body(body))
    };
    let bodies = spec.poses().enumerate().map(own);
    let none = Matrix::zeros(0, twists.columns());
    bodies.fold(none, |above, rows| above.stack(&rows))
}

/// `Ad_{H⁻¹}` of every body, as blocks of a diagonal.
pub fn adjoint_inverses(spec: &JointSpec) -> Matrix {
    spec.poses().fold(Matrix::zeros(0, 0), |diagonal, pose| {
        let own = adjoint_inverse(&pose.value);
        let (rows, size) = (diagonal.rows(), own.rows());
        let above = diagonal.beside(&Matrix::zeros(rows, size));
        above.stack(&Matrix::zeros(size, rows).beside(&own))
    })
}

/// `ad_T = [ω~ 0; v~ ω~]`.
pub fn bracket(twist: &[Expr]) -> Matrix {
    let (omega, v) = (Matrix::tilde(&twist[..3]), Matrix::tilde(&twist[3..]));
    omega.beside(&Matrix::zeros(3, 3)).stack(&v.beside(&omega))
}

/// J(Q, ϕ) to first order: twist of H(Φ(Q, ϕ)) in the parent frame, by ϕ̇.
#[derive(Clone, Debug)]
pub struct TwistJacobian {
    /// J₀, 6×k; of several bodies one below the other.
    pub base: Matrix,
    /// J₀ in the child frame.
    pub child: Matrix,
    /// J_l = ∂J/∂ϕ_l.
    pub slopes: Vec<Matrix>,
}

impl TwistJacobian {
    /// That of every body, one below the other.
    pub fn of_bodies(spec: &JointSpec, motion: &Motion, ideal: &Ideal) -> Self {
        let own = |pose: &Declared<PoseExpr>| Self::new(&pose.value, motion, ideal);
        let first = own(&spec.pose);
        spec.more.iter().map(own).fold(first, Self::above)
    }

    /// With the rows of another below.
    fn above(self, other: Self) -> Self {
        let slopes = self.slopes.iter().zip(&other.slopes);
        Self {
            slopes: slopes.map(|(own, below)| own.stack(below)).collect(),
            base: self.base.stack(&other.base),
            child: self.child.stack(&other.child),
        }
    }

    /// That of one body.
    pub fn rows_of_body(&self, body: usize) -> Self {
        let own = |m: &Matrix| m.rows_of_body(body);
        Self {
            base: own(&self.base),
            child: own(&self.child),
            slopes: self.slopes.iter().map(own).collect(),
        }
    }

    /// `J ϕ̇ = vee(Ḣ H⁻¹)`: angular part `∂R Rᵀ`, linear part `∂p − ω × p`.
    pub fn new(pose: &PoseExpr, motion: &Motion, ideal: &Ideal) -> Self {
        let k = motion.freedoms();
        let r_t = pose.rotation.transpose();
        let p = pose.translation.entries();
        let rotations: Vec<Matrix> = (0..k)
            .map(|i| motion.along_each(&pose.rotation, i))
            .collect();
        let translations: Vec<Matrix> = (0..k)
            .map(|i| motion.along_each(&pose.translation, i))
            .collect();
        let omegas: Vec<Vec<Expr>> = rotations
            .iter()
            .map(|dr| vee(&ideal.simplest_entries(&dr.times(&r_t))))
            .collect();
        let column = |i: usize| {
            let linear = translations[i].minus(&cross(&omegas[i], p));
            join(&omegas[i], &ideal.simplest_entries(&linear))
        };
        let slope_column = |i: usize, l: usize| {
            let curved = pose.rotation.map(|entry| motion.along_both(entry, i, l));
            let omega_slope = curved
                .times(&r_t)
                .plus(&rotations[i].times(&rotations[l].transpose()));
            let omega_slope = vee(&ideal.simplest_entries(&omega_slope));
            let linear = pose.translation.map(|entry| motion.along_both(entry, i, l));
            let linear = linear
                .minus(&cross(&omega_slope, p))
                .minus(&cross(&omegas[i], translations[l].entries()));
            join(&omega_slope, &ideal.simplest_entries(&linear))
        };
        let slope = |l: usize| {
            Matrix::from_columns(6, &(0..k).map(|i| slope_column(i, l)).collect::<Vec<_>>())
        };
        Self {
            base: Matrix::from_columns(6, &(0..k).map(column).collect::<Vec<_>>()),
            child: child_twists(pose, motion, ideal),
            slopes: (0..k).map(slope).collect(),
        }
    }
}

/// J₀ in the child frame, 6×k: `vee(H⁻¹ Ḣ)`.
pub fn child_twists(pose: &PoseExpr, motion: &Motion, ideal: &Ideal) -> Matrix {
    let r_t = pose.rotation.transpose();
    let column = |i: usize| {
        let turned = r_t.times(&motion.along_each(&pose.rotation, i));
        let moved = r_t.times(&motion.along_each(&pose.translation, i));
        join(
            &vee(&ideal.simplest_entries(&turned)),
            &ideal.simplest_entries(&moved),
        )
    };
    Matrix::from_columns(6, &(0..motion.freedoms()).map(column).collect::<Vec<_>>())
}

fn vee(m: &Matrix) -> Vec<Expr> {
    vec![m.at(2, 1).clone(), m.at(0, 2).clone(), m.at(1, 0).clone()]
}

fn cross(a: &[Expr], b: &[Expr]) -> Matrix {
    Matrix::tilde(a).times(&Matrix::column_vector(b.to_vec()))
}

fn join(angular: &[Expr], linear: &Matrix) -> Vec<Expr> {
    angular.iter().chain(linear.entries()).cloned().collect()
}
