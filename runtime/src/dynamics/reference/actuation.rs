//! Elements, rotor inertias and drives in the reference form: elements as efforts and `Jᵀ` of wrenches, drives as known speeds.

use super::tree::Tree;
use super::{Expansion, StateError};
use crate::dynamics::Recursive;
use crate::elements::{Action, View};
use crate::mechanism::Mechanism;
use crate::spatial::fused::apply_transposed;
use crate::spatial::{join, split};
use crate::time_function::Moment;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector, Vector6};

/// What the elements of a mechanism amount to at one state.
pub(super) struct ElementForces {
    /// τ, one entry per degree of freedom.
    pub(super) efforts: DVector<f64>,
    /// Stored energy, J.
    pub(super) energy: f64,
}

impl ElementForces {
    pub(super) fn new(
        mechanism: &Arc<Mechanism>,
        expansion: &Expansion,
        (q, speeds): (&[f64], &[f64]),
        moment: Moment,
    ) -> Result<Self, StateError> {
        let mut forces = Self {
            efforts: DVector::zeros(mechanism.layout().freedoms),
            energy: 0.0,
        };
        if mechanism.elements().is_empty() {
            return Ok(forces);
        }
        // Elements see the bodies where the recursive form has them: its kinematics are tested against others.
        let motions = Recursive::new(Arc::clone(mechanism)).motions(q, speeds)?;
        let view = View::new(mechanism, q, speeds, &motions).at(moment);
        let mut wrenches = vec![Vector6::zeros(); mechanism.bodies().len()];
        let mut action = Action {
            wrenches: &mut wrenches,
            efforts: forces.efforts.as_mut_slice(),
        };
        for element in mechanism.elements() {
            element.act(&view, &mut action);
            forces.energy += element.energy(&view);
        }
        let tree = Tree::new(mechanism, q, &expansion.velocity_map);
        for ((motion, wrench), seen) in tree.bodies.iter().zip(&wrenches).zip(&motions.0) {
            let (moment, force) = split(wrench);
            let turned = |part| apply_transposed(&seen.0.rotation, part);
            let in_child = join(&turned(&moment), &turned(&force));
            forces.efforts += motion.jacobian.tr_mul(&in_child);
        }
        Ok(forces)
    }
}

/// Rows of `matrix · x = side` whose x is known, replaced by `x = known`, with the matrix kept symmetric.
pub(super) fn hold(matrix: &mut DMatrix<f64>, side: &mut DVector<f64>, known: &[(usize, f64)]) {
    for &(index, x) in known {
        side.axpy(-x, &matrix.column(index).into_owned(), 1.0);
        matrix.row_mut(index).fill(0.0);
        matrix.column_mut(index).fill(0.0);
    }
    for &(index, x) in known {
        matrix[(index, index)] = 1.0;
        side[index] = x;
    }
}

/// The driven among the independent speeds, each with its entry of `values` (one per speed of the tree).
pub(super) fn driven(
    mechanism: &Mechanism,
    expansion: &Expansion,
    values: &[f64],
) -> Vec<(usize, f64)> {
    let speeds = mechanism
        .drives()
        .iter()
        .flat_map(|drive| mechanism.bodies()[drive.body].ranges().speeds.clone());
    place(expansion, speeds.map(|speed| (speed, values[speed])))
}

/// The same for values with one entry per freedom: prescribed accelerations are the first of a joint's.
pub(super) fn driven_freedoms(
    mechanism: &Mechanism,
    expansion: &Expansion,
    values: &[f64],
) -> Vec<(usize, f64)> {
    let pairs = mechanism.drives().iter().flat_map(|drive| {
        let ranges = mechanism.bodies()[drive.body].ranges();
        ranges.speeds.clone().zip(ranges.freedoms.clone())
    });
    place(expansion, pairs.map(|(speed, k)| (speed, values[k])))
}

/// From speeds of the tree to places among the independent ones; driven speeds are independent.
fn place(expansion: &Expansion, speeds: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
    let position = |speed: usize| expansion.independent.iter().position(|&i| i == speed);
    speeds
        .filter_map(|(speed, value)| Some((position(speed)?, value)))
        .collect()
}
