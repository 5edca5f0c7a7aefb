//! What a force feels at a frame: operational-space inertia.
//!
//! With the articulated factors `M̄⁻¹ = L⁻ᵀ D⁻¹ L⁻¹` one walk from the frame to the root gives `J M̄⁻¹ Jᵀ = Σ_j l_j l_jᵀ / d_j`: six unit wrenches are carried
//! rootward, and at each speed they leave `l_j = X_jᵀ W` and go on as `W − Y_j l_j / d_j`. That is O(n) for the factors and O(depth) for the walk.

use super::Recursive;
use super::frames::FrameReadings;
use super::readings::Frame;
use crate::dynamics::DynamicsError;
use crate::spatial::shift_wrench;
use nalgebra::{Cholesky, Matrix6, Vector6};
use num_traits::Float;

/// The directions in which a frame moves, as its twist has them.
const DIRECTIONS: [&str; 6] = [
    "angular x",
    "angular y",
    "angular z",
    "linear x",
    "linear y",
    "linear z",
];

/// The least pivot of `J M̄⁻¹ Jᵀ`, scaled to a diagonal of ones, that can be inverted: its rounding, some 1e-16 times the number of joints, is then
/// a hundredth of it for trees of a hundred.
const LEAST_PIVOT: f64 = 1e-12;

impl Recursive {
    /// `J M̄⁻¹ Jᵀ` of the named frame of index `frame` at `q`: wrenches on it to the rates of its twist. Symmetric, 6×6; defined for every
    /// mechanism, and singular where the frame cannot move in all six ways.
    ///
    /// # Errors
    /// A wrong size; no such frame; a singular mass matrix; constraints that couple joints, which are not covered.
    pub fn operational_mobility(
        &mut self,
        q: &[f64],
        frame: usize,
        axes: Frame,
    ) -> Result<Matrix6<f64>, DynamicsError> {
        self.check(q, &[])?;
        let (body, fixed) = self.attachment(frame)?;
        if let Some(constraint) = self.mechanism.constraints().first() {
            return Err(DynamicsError::CoupledFrame {
                frame: self.mechanism.frames()[frame].name.clone(),
                constraint: constraint.name.clone(),
            });
        }
        self.weigh(q);
        self.articulate()?;
        let at = FrameReadings {
            recursive: self,
            q,
            speeds: &[],
            body,
            fixed,
        };
        Ok(at.mobility(axes))
    }

    /// `Λ = (J M̄⁻¹ Jᵀ)⁻¹` of the named frame of index `frame` at `q`, kg m², kg m and kg: the inertia that a force feels at the frame.
    ///
    /// # Errors
    /// As [`Recursive::operational_mobility`]; a frame that cannot move in all six ways, or hardly: the first direction that depends on those before it.
    pub fn operational_inertia(
        &mut self,
        q: &[f64],
        frame: usize,
        axes: Frame,
    ) -> Result<Matrix6<f64>, DynamicsError> {
        let mobility = self.operational_mobility(q, frame, axes)?;
        inverse(&mobility).map_err(|(direction, pivot)| DynamicsError::SingularFrame {
            frame: self.mechanism.frames()[frame].name.clone(),
            direction: DIRECTIONS[direction],
            pivot,
            limit: LEAST_PIVOT,
        })
    }
}

impl FrameReadings<'_> {
    /// The walk to the root, after [`Recursive::articulate`].
    fn mobility(&self, axes: Frame) -> Matrix6<f64> {
        let mut mobility = Matrix6::zeros();
        let mut wrenches: [Vector6<f64>; 6] = core::array::from_fn(|i| {
            let mut unit = Vector6::zeros();
            unit[i] = 1.0;
            self.at_origin(axes, &unit)
        });
        let mut before = None;
        for (index, arm) in self.path() {
            let offset = before.map_or(arm, |before| arm - before);
            before = Some(arm);
            for wrench in &mut wrenches {
                *wrench = shift_wrench(wrench, &offset);
            }
            let link = &self.recursive.links[index];
            if link.driven {
                continue;
            }
            if let Some(group) = link.group {
                mobility += self.recursive.groups[group].yield_wrenches(
                    &self.recursive.columns[link.columns.clone()],
                    &self.recursive.nodes[index].motion.placement.offset,
                    &mut wrenches,
                );
                continue;
            }
            for (speed, column) in self.recursive.columns_of(index) {
                let pivot = &self.recursive.pivots[speed];
                let loads = Vector6::from_fn(|i, _| wrenches[i].dot(column));
                mobility += loads * loads.transpose() * pivot.inverse;
                for (wrench, load) in wrenches.iter_mut().zip(&loads) {
                    *wrench -= pivot.momentum * (load * pivot.inverse);
                }
            }
        }
        mobility
    }
}

/// The inverse of a symmetric matrix that is positive, else the first row whose pivot is not, with that pivot; scaled, so that radians and metres
/// are compared with their own.
fn inverse(matrix: &Matrix6<f64>) -> Result<Matrix6<f64>, (usize, f64)> {
    let scales = matrix.diagonal().map(|entry| 1.0 / Float::sqrt(entry));
    if let Some(row) = scales.iter().position(|scale| !scale.is_finite()) {
        return Err((row, matrix[(row, row)]));
    }
    let scaled = Matrix6::from_fn(|i, j| matrix[(i, j)] * scales[i] * scales[j]);
    let mut left = scaled;
    let mut factor = Matrix6::zeros();
    for k in 0..6 {
        let pivot = left[(k, k)];
        if pivot.is_nan() || pivot <= LEAST_PIVOT {
            return Err((k, pivot));
        }
        let column = left.column(k) / Float::sqrt(pivot);
        left -= column * column.transpose();
        factor.set_column(k, &column);
    }
    // What rounding leaves above the diagonal is not read.
    let inverse = Cholesky::pack_dirty(factor).inverse();
    Ok(Matrix6::from_fn(|i, j| {
        inverse[(i, j)] * scales[i] * scales[j]
    }))
}
