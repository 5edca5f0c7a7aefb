//! Constraints that couple joints in the reference form: A and S̄ of Theorem 3 in full.

use super::Expansion;
use super::tree::Tree;
use crate::mechanism::Mechanism;
use crate::spatial::fused::{apply, cross};
use crate::spatial::join;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector, RowDVector, Vector6};

/// The wrench of each constraint in its body's joint-child frame, with the body: its product with the frame's twist is what is forbidden.
fn wrenches(mechanism: &Mechanism) -> impl Iterator<Item = (usize, Vector6<f64>)> + '_ {
    mechanism.constraints().iter().map(|constraint| {
        let fixed = mechanism.bodies()[constraint.body].child_placement();
        let point = fixed.transform_point(&constraint.point);
        let direction = apply(&fixed.rotation, &constraint.direction.normalize());
        (
            constraint.body,
            join(&cross(&point, &direction), &direction),
        )
    })
}

/// The matrix of the given rows.
fn stack(columns: usize, rows: Vec<RowDVector<f64>>) -> DMatrix<f64> {
    match rows.is_empty() {
        true => DMatrix::zeros(0, columns),
        false => DMatrix::from_rows(&rows),
    }
}

impl Expansion {
    /// S̄ and ∂S̄/∂ϕ on the independent speeds, A with the coupling constraints, from those of the joints alone.
    ///
    /// With the rows `a = Fᵀ J S̄ⱼ` of the constraints on the speeds of the tree: `A_d B = −A_i`, `A_d ∂B = −∂A [1; B]`.
    pub(super) fn couple(&mut self, mechanism: &Mechanism, tree: &Tree) {
        if mechanism.constraints().is_empty() {
            return;
        }
        let joints = self.speed_basis.clone();
        let dependent = mechanism.dependent_speeds();
        let on_velocity = |body: usize, wrench: &Vector6<f64>| -> RowDVector<f64> {
            wrench.transpose() * &tree.bodies[body].jacobian
        };
        let rows = wrenches(mechanism).map(|(body, wrench)| on_velocity(body, &wrench));
        let rows = stack(joints.nrows(), rows.collect());
        let on_speeds = &rows * &joints;
        let columns = dependent.iter().map(|&d| on_speeds.column(d));
        let square = DMatrix::from_columns(&columns.collect::<Vec<_>>());
        // Singular where the constraints do not determine the dependent speeds: NaN tells so in every result.
        let inverse = square
            .try_inverse()
            .unwrap_or_else(|| DMatrix::from_element(dependent.len(), dependent.len(), f64::NAN));

        let mut basis = DMatrix::zeros(joints.ncols(), self.independent.len());
        for (j, &speed) in self.independent.iter().enumerate() {
            basis[(speed, j)] = 1.0;
            let column = &inverse * on_speeds.column(speed);
            for (&d, value) in dependent.iter().zip(column.iter()) {
                basis[(d, j)] = -value;
            }
        }
        for (k, slope) in self.speed_basis_gradient.iter_mut().enumerate() {
            let turned = wrenches(mechanism).map(|(body, wrench)| {
                let motion = &tree.bodies[body];
                let through_basis = wrench.transpose() * &motion.jacobian * &*slope;
                match &motion.jacobian_gradient[k] {
                    Some(gradient) => through_basis + wrench.transpose() * gradient * &joints,
                    None => through_basis,
                }
            });
            let turned = stack(joints.ncols(), turned.collect());
            let change = &inverse * (turned * &basis);
            let mut basis_slope = DMatrix::zeros(joints.ncols(), self.independent.len());
            for (i, &d) in dependent.iter().enumerate() {
                basis_slope.row_mut(d).copy_from(&-change.row(i));
            }
            *slope = &*slope * &basis + &joints * basis_slope;
        }
        self.speed_basis = joints * basis;
        let own = self.constraint.ncols();
        let constraint = core::mem::replace(&mut self.constraint, DMatrix::zeros(0, 0));
        let mut constraint = constraint.resize_horizontally(own + rows.nrows(), 0.0);
        constraint
            .columns_mut(own, rows.nrows())
            .copy_from(&rows.transpose());
        self.constraint = constraint;
    }

    /// The entries of independent speeds.
    pub(super) fn select(&self, whole: &[f64]) -> DVector<f64> {
        let entries = self.independent.iter().map(|&i| whole[i]);
        DVector::from_vec(entries.collect())
    }

    /// Entries of independent speeds into their places, 0 elsewhere.
    pub(super) fn scatter(&self, reduced: &DVector<f64>, whole: &mut [f64]) {
        whole.fill(0.0);
        for (&i, value) in self.independent.iter().zip(reduced) {
            whole[i] = *value;
        }
    }

    /// Speeds of the tree from the independent ones: `v̄ = (S̄ⱼ)⁺ S̄ v̄ᵢ`, by the rows of the dependent ones.
    pub(super) fn whole_speeds(
        &self,
        mechanism: &Mechanism,
        q: &[f64],
        reduced: &DVector<f64>,
    ) -> DVector<f64> {
        let velocity = &self.speed_basis * reduced;
        let mut speeds = DVector::zeros(mechanism.layout().speeds);
        for (_, body) in mechanism.joints() {
            let ranges = body.ranges();
            let own = velocity.rows_range(ranges.freedoms.clone()).into_owned();
            let mut basis = DMatrix::zeros(ranges.freedoms.len(), ranges.speeds.len());
            body.joint()
                .speed_basis(body.configuration(q), basis.as_mut_slice());
            let gram = basis.tr_mul(&basis);
            let side = basis.tr_mul(&own);
            if let Some(factors) = gram.cholesky() {
                speeds
                    .rows_range_mut(ranges.speeds.clone())
                    .copy_from(&factors.solve(&side));
            }
        }
        speeds
    }
}
