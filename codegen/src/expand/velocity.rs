//! The paper's step: S to first order in ϕ from X and J, (23).

use super::implicit::Flow;
use super::motion::Motion;
use super::rank::MOST_MINORS;
use super::twist::TwistJacobian;
use super::{directions, elimination};
use crate::domain::Domain;
use crate::expr::{Expr, budget};
use crate::matrix::{Matrix, combinations, count_combinations};

/// S to first order: `X S = J`, so `X₀ S₀ = J₀` and `X₀ S_l = J_l − X_l S₀`.
#[derive(Clone, Debug)]
pub struct VelocityMap {
    /// S₀.
    pub base: Matrix,
    /// ∂S/∂ϕ_l.
    pub slopes: Vec<Matrix>,
    /// S₀⁻¹, where S₀ was found from it.
    pub inverse: Option<Matrix>,
}

/// A left inverse of X.
struct LeftInverse {
    matrix: Matrix,
    /// S₀⁻¹, where it is made of that.
    of_velocity_map: Option<Matrix>,
}

impl LeftInverse {
    fn of_twist_map(matrix: Matrix) -> Self {
        Self {
            matrix,
            of_velocity_map: None,
        }
    }
}

/// What S is solved from.
pub struct Solver<'a, 'b> {
    /// J.
    pub jacobian: &'a TwistJacobian,
    /// X.
    pub twist_map: &'a Matrix,
    /// X^c.
    pub child: &'a Matrix,
    /// `Ad_{H⁻¹}`.
    pub to_child: &'a Matrix,
    /// Φ to second order.
    pub motion: &'a Motion,
    /// How v moves Q, where relations alone say so.
    pub flow: Option<&'a Flow>,
    /// Where the joint lives.
    pub domain: &'a Domain<'b>,
    /// Structure constants, where Φ = Q exp(ϕ).
    pub structure_constants: Option<&'a Vec<Matrix>>,
}

impl Solver<'_, '_> {
    /// Applies a left inverse of X₀ to both orders of (23), where the answer is not plain. Whether the result solves (23) is proved
    /// afterwards, by substitution. `None` where X has dependent columns everywhere.
    pub fn solve(&self) -> Option<VelocityMap> {
        let ideal = self.domain.ideal();
        let rates = self.jacobian.base.minus(self.twist_map);
        if !ideal.normal_forms(&rates).is_zero() {
            let left = self.left_inverse()?;
            let inverse = left.matrix;
            let base = ideal.normal_forms(&inverse.times(&self.jacobian.base));
            let slopes = self.rests(&base);
            return Some(VelocityMap {
                slopes: slopes
                    .iter()
                    .map(|rest| ideal.normal_forms(&inverse.times(rest)))
                    .collect(),
                base,
                inverse: left.of_velocity_map,
            });
        }
        // v = ϕ̇ at ϕ = 0, so that S₀ = I.
        let base = Matrix::identity(self.motion.freedoms());
        let slopes = match (self.structure_constants, self.flow) {
            // S = I − ½ ad_ϕ.
            (Some(constants), _) => constants
                .iter()
                .map(|ad| ad.scale(&Expr::fraction(-1, 2)))
                .collect(),
            // S belongs to Q and v alone: H does not come in.
            (None, Some(flow)) => flow.slopes.clone(),
            (None, None) => self.slopes_of_rates(&base)?,
        };
        Some(VelocityMap {
            base,
            slopes,
            inverse: None,
        })
    }

    /// ∂S/∂ϕ where S₀ = I.
    fn slopes_of_rates(&self, base: &Matrix) -> Option<Vec<Matrix>> {
        let rests = self.rests(base);
        if rests.iter().all(Matrix::is_zero) {
            return Some(vec![base.minus(base); rests.len()]);
        }
        let solve = |inverse: &Matrix, right: &[Matrix]| {
            let solved = |rest| self.domain.ideal().normal_forms(&inverse.times(rest));
            right.iter().map(solved).collect()
        };
        if let Some(inverse) = self.short_left_inverse() {
            return Some(solve(&inverse.matrix, &rests));
        }
        let whole = || {
            elimination::pseudo_inverse(self.twist_map, self.domain.ideal(), |gram| {
                gram.terms().len() <= LONGEST_GRAM
            })
        };
        if let Some(inverse) = budget::scope(GRAM_LIMIT, whole).ok().flatten() {
            return Some(solve(&inverse, &rests));
        }
        // The same in stored scalars, where H does not come in: `Σ_j δ_j (S_l)_ji = δ_li − ∂δ_i/∂ϕ_l`.
        if let Some(inverse) = directions::left_inverse(self.motion, self.domain) {
            return Some(solve(&inverse, &directions::bends(self.motion)));
        }
        Some(solve(&self.left_inverse()?.matrix, &rests))
    }

    /// `J_l − X_l S₀`.
    fn rests(&self, base: &Matrix) -> Vec<Matrix> {
        let rest = |(l, j): (usize, &Matrix)| {
            let moved = self.motion.along_each(self.twist_map, l).times(base);
            self.domain.ideal().normal_forms(&j.minus(&moved))
        };
        self.jacobian.slopes.iter().enumerate().map(rest).collect()
    }

    /// A left inverse of X that is as simple as the manifold allows: from rows of X, or of X in the child frame, whose determinant is a
    /// constant of one term; from rows whose determinant is short and never 0; by elimination; else `(XᵀX)⁻¹Xᵀ`. `None` where even det(XᵀX) vanishes.
    fn left_inverse(&self) -> Option<LeftInverse> {
        let whole = || elimination::pseudo_inverse(self.twist_map, self.domain.ideal(), |_| true);
        let eliminated = || {
            let in_parent = elimination::left_inverse(self.twist_map, self.domain);
            let in_child = || elimination::left_inverse(self.child, self.domain);
            in_parent.or_else(|| Some(in_child()?.times(self.to_child)))
        };
        let rest = || eliminated().or_else(whole).map(LeftInverse::of_twist_map);
        self.short_left_inverse().or_else(rest)
    }

    /// Any of these but the last.
    fn short_left_inverse(&self) -> Option<LeftInverse> {
        let constant = |determinant: &Expr| self.domain.is_unit(determinant);
        let short = |determinant: &Expr| {
            determinant.terms().len() <= LONGEST_PIVOT && self.domain.nonzero(determinant).is_some()
        };
        let in_parent = |good: &dyn Fn(&Expr) -> bool| self.row_inverse(self.twist_map, good);
        let in_child = |good: &dyn Fn(&Expr) -> bool| {
            Some(self.row_inverse(self.child, good)?.times(self.to_child))
        };
        let plain = match self.child.is_constant() && !self.twist_map.is_constant() {
            true => in_child(&constant).or_else(|| in_parent(&constant)),
            false => in_parent(&constant).or_else(|| in_child(&constant)),
        };
        let plain = plain.map(LeftInverse::of_twist_map);
        plain.or_else(|| self.by_rates(&constant)).or_else(|| {
            let divided = in_child(&short).or_else(|| in_parent(&short));
            divided.map(LeftInverse::of_twist_map)
        })
    }

    /// `(L X)⁻¹ L` with L a left inverse of J: where v is declared by X as what it makes of simpler velocities, `L X = S₀⁻¹` is short.
    fn by_rates(&self, good: &dyn Fn(&Expr) -> bool) -> Option<LeftInverse> {
        let ideal = self.domain.ideal();
        let simplify = |e: &Expr| ideal.normal_form(e);
        let in_child = self.row_inverse(&self.jacobian.child, good);
        let left = match in_child {
            Some(inverse) => inverse.times(self.to_child),
            None => self.row_inverse(&self.jacobian.base, good)?,
        };
        let rates = ideal.normal_forms(&left.times(self.twist_map));
        let determinant = rates.determinant(&simplify);
        self.domain.nonzero(&determinant)?;
        let inverse = rates.adjugate(&simplify).scale(&determinant.recip()?);
        Some(LeftInverse {
            matrix: inverse.times(&left),
            of_velocity_map: Some(rates),
        })
    }

    /// The inverse of the first rows with a good determinant, zero elsewhere; not looked for where there are very many choices.
    fn row_inverse(&self, m: &Matrix, good: &dyn Fn(&Expr) -> bool) -> Option<Matrix> {
        if count_combinations(m.rows(), m.columns()) > MOST_MINORS {
            return None;
        }
        let simplify = |e: &Expr| self.domain.ideal().normal_form(e);
        combinations(m.rows(), m.columns())
            .into_iter()
            .find_map(|rows| {
                let square = m.select_rows(&rows);
                let determinant = square.determinant(&simplify);
                if determinant.is_zero() || !good(&determinant) {
                    return None;
                }
                let inverse = square.adjugate(&simplify).scale(&determinant.recip()?);
                Some(spread_columns(&inverse, &rows, m.rows()))
            })
    }
}

/// Most terms of a determinant that is divided by, rather than by that of XᵀX.
const LONGEST_PIVOT: usize = 2;

/// Most terms of det(XᵀX) that is divided by where directions of Φ would do instead.
const LONGEST_GRAM: usize = 6;
/// Most term operations for finding that out.
const GRAM_LIMIT: u64 = 100_000;

/// Puts the columns at the given places of a wider matrix of zeros.
fn spread_columns(m: &Matrix, places: &[usize], width: usize) -> Matrix {
    Matrix::from_fn(m.rows(), width, |i, j| {
        match places.iter().position(|&place| place == j) {
            Some(column) => m.at(i, column).clone(),
            None => Expr::zero(),
        }
    })
}
