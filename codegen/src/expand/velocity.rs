//! The paper's step: J, X and S to first order in ϕ, (23).

use super::motion::Motion;
use super::rank;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::PoseExpr;

/// `Ad_{H⁻¹} = [Rᵀ 0; −Rᵀp~ Rᵀ]`.
pub fn adjoint_inverse(pose: &PoseExpr) -> Matrix {
    let (r, p) = (pose.rotation.transpose(), pose.translation.entries());
    let zero = Matrix::zeros(3, 3);
    let lower = r.times(&Matrix::tilde(p)).map(|entry| -entry);
    r.beside(&zero).stack(&lower.beside(&r))
}

/// `ad_T = [ω~ 0; v~ ω~]`.
pub fn bracket(twist: &[Expr]) -> Matrix {
    let (omega, v) = (Matrix::tilde(&twist[..3]), Matrix::tilde(&twist[3..]));
    omega.beside(&Matrix::zeros(3, 3)).stack(&v.beside(&omega))
}

/// J(Q, ϕ) to first order: twist of H(Φ(Q, ϕ)) in the parent frame, by ϕ̇.
#[derive(Clone, Debug)]
pub struct TwistJacobian {
    /// J₀, 6×k.
    pub base: Matrix,
    /// J_l = ∂J/∂ϕ_l.
    pub slopes: Vec<Matrix>,
}

impl TwistJacobian {
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
            .map(|dr| vee(&ideal.normal_forms(&dr.times(&r_t))))
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
            let omega_slope = vee(&ideal.normal_forms(&omega_slope));
            let linear = pose.translation.map(|entry| motion.along_both(entry, i, l));
            let linear = linear
                .minus(&cross(&omega_slope, p))
                .minus(&cross(&omegas[i], translations[l].entries()));
            join(&omega_slope, &ideal.normal_forms(&linear))
        };
        let slope = |l: usize| {
            Matrix::from_columns(6, &(0..k).map(|i| slope_column(i, l)).collect::<Vec<_>>())
        };
        Self {
            base: Matrix::from_columns(6, &(0..k).map(column).collect::<Vec<_>>()),
            slopes: (0..k).map(slope).collect(),
        }
    }
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

/// S to first order: `X S = J`, so `X₀ S₀ = J₀` and `X₀ S_l = J_l − X_l S₀`.
#[derive(Clone, Debug)]
pub struct VelocityMap {
    /// S₀.
    pub base: Matrix,
    /// ∂S/∂ϕ_l.
    pub slopes: Vec<Matrix>,
}

impl VelocityMap {
    /// Applies a left inverse of X₀ to both orders. Whether the result solves (23) is proved afterwards, by substitution.
    pub fn new(
        jacobian: &TwistJacobian,
        twist_map: &Matrix,
        left_inverse: &Matrix,
        motion: &Motion,
        ideal: &Ideal,
    ) -> Self {
        let base = ideal.normal_forms(&left_inverse.times(&jacobian.base));
        let slope = |(l, j): (usize, &Matrix)| {
            let rest = j.minus(&motion.along_each(twist_map, l).times(&base));
            ideal.normal_forms(&left_inverse.times(&ideal.normal_forms(&rest)))
        };
        Self {
            slopes: jacobian.slopes.iter().enumerate().map(slope).collect(),
            base,
        }
    }
}

/// A left inverse of X that is as simple as the manifold allows: from rows of X, or of X in the child frame, whose determinant is a
/// constant of one term; else `(XᵀX)⁻¹Xᵀ`. `None` where even det(XᵀX) vanishes.
pub fn left_inverse(
    twist_map: &Matrix,
    child: &Matrix,
    to_child: &Matrix,
    ideal: &Ideal,
) -> Option<Matrix> {
    let in_parent = || row_inverse(twist_map, ideal);
    let in_child = || Some(row_inverse(child, ideal)?.times(to_child));
    match child.is_constant() && !twist_map.is_constant() {
        true => in_child().or_else(in_parent),
        false => in_parent().or_else(in_child),
    }
    .or_else(|| pseudo_inverse(twist_map, ideal))
}

/// The inverse of the first rows with a determinant of one constant term, zero elsewhere.
fn row_inverse(m: &Matrix, ideal: &Ideal) -> Option<Matrix> {
    let simplify = |e: &Expr| ideal.normal_form(e);
    rank::combinations(m.rows(), m.columns())
        .into_iter()
        .find_map(|rows| {
            let square = m.select_rows(&rows);
            let determinant = square.determinant(&simplify);
            if !rank::is_unit(&determinant) {
                return None;
            }
            let inverse = square.adjugate(&simplify).scale(&determinant.recip()?);
            Some(spread_columns(&inverse, &rows, m.rows()))
        })
}

fn pseudo_inverse(m: &Matrix, ideal: &Ideal) -> Option<Matrix> {
    let simplify = |e: &Expr| ideal.normal_form(e);
    let gram = ideal.normal_forms(&m.transpose().times(m));
    let inverse = gram.determinant(&simplify).recip()?;
    Some(
        gram.adjugate(&simplify)
            .times(&m.transpose())
            .scale(&inverse),
    )
}

/// Puts the columns at the given places of a wider matrix of zeros.
fn spread_columns(m: &Matrix, places: &[usize], width: usize) -> Matrix {
    Matrix::from_fn(m.rows(), width, |i, j| {
        match places.iter().position(|&place| place == j) {
            Some(column) => m.at(i, column).clone(),
            None => Expr::zero(),
        }
    })
}
