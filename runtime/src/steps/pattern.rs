//! How a joint moves its child, from the values of its kernels and from what is known of their entries.
//!
//! With the pattern a constant and everything inlined, each joint has code of its own without what it knows to be 0 or 1. In numbers of 106 bits, of which
//! each operation is twenty, all joints of so many speeds share one code that reads the pattern.

use super::{Motion, Placement};
use crate::joint::Entry;
use crate::scalar::Scalar;
use crate::spatial::fused::{add_scaled, apply, cross, product};
use crate::spatial::{Pose, bracket_product, join, shift_twist, split, turn_out};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};

/// Which entries of H and X̄ are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pattern<const S: usize> {
    /// The rotation matrix of H, by rows.
    pub(super) rotation: [[Entry; 3]; 3],
    /// The translation of H.
    pub(super) translation: [Entry; 3],
    /// X̄ in child axes, by rows.
    pub(super) columns: [[Entry; S]; 6],
}

/// What a joint's kernels say at a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels<T, const S: usize> {
    /// H.
    pub(super) pose: Pose<T>,
    /// X̄ in child axes.
    pub(super) speed_map: SMatrix<T, 6, S>,
    /// c in child axes, where it is not always 0.
    pub(super) bias: Option<Vector6<T>>,
}

/// `Σ_i a_i x_i` over the columns a of `matrix`, without what `pattern` knows to be 0 or 1; `None` where all is 0.
#[inline(always)]
fn combine<T: Scalar>(
    matrix: &Matrix3<T>,
    pattern: [Entry; 3],
    weights: [T; 3],
) -> Option<Vector3<T>> {
    let mut sum: Option<Vector3<T>> = None;
    for i in 0..3 {
        let [x, y, z] = matrix.data.0[i];
        let column = Vector3::new(x, y, z);
        sum = match (pattern[i], sum) {
            (Entry::Zero, sum) => sum,
            (Entry::One, None) => Some(column),
            (Entry::One, Some(sum)) => Some(sum + column),
            (Entry::Other, None) => Some(column * weights[i]),
            (Entry::Other, Some(sum)) => Some(add_scaled(&sum, &column, weights[i])),
        };
    }
    sum
}

const fn occurs<const S: usize>(pattern: &[[Entry; S]; 6], first: usize, j: usize) -> bool {
    !(matches!(pattern[first][j], Entry::Zero)
        && matches!(pattern[first + 1][j], Entry::Zero)
        && matches!(pattern[first + 2][j], Entry::Zero))
}

impl<const S: usize> Pattern<S> {
    /// Whether column `j` of X̄ can have an angular, and whether it can have a linear part.
    #[inline(always)]
    pub(super) const fn column_parts(&self, j: usize) -> (bool, bool) {
        (occurs(&self.columns, 0, j), occurs(&self.columns, 3, j))
    }

    /// The same of any column.
    #[inline(always)]
    pub(super) fn parts(&self) -> (bool, bool) {
        let (mut angular, mut linear) = (false, false);
        for j in 0..S {
            let (a, l) = self.column_parts(j);
            angular |= a;
            linear |= l;
        }
        (angular, linear)
    }

    /// The child frame where H is `pose`.
    #[inline(always)]
    pub(super) fn child<T: Scalar>(
        &self,
        pose: &Pose<T>,
        joint_frame: &Pose<T>,
        parent: &Placement<T>,
    ) -> Placement<T> {
        let base = product(&parent.rotation, &joint_frame.rotation);
        let [x, y, z] = self.rotation;
        // Array methods with closures are not reliably inlined, and then patterns would be read at run time.
        let mut rotation = Matrix3::zeros();
        for j in 0..3 {
            let column = combine(&base, [x[j], y[j], z[j]], pose.rotation.data.0[j]);
            rotation.data.0[j] = column.map_or([T::zero(); 3], |column| column.data.0[0]);
        }
        let fixed = apply(&parent.rotation, &joint_frame.translation);
        let offset = match combine(&base, self.translation, pose.translation.data.0[0]) {
            Some(moved) => fixed + moved,
            None => fixed,
        };
        Placement {
            rotation,
            origin: parent.origin + offset,
            offset,
        }
    }

    /// The columns of X̄, turned into world axes.
    #[inline(always)]
    pub(super) fn columns<T: Scalar>(
        &self,
        speed_map: &SMatrix<T, 6, S>,
        rotation: &Matrix3<T>,
    ) -> [Vector6<T>; S] {
        let [p0, p1, p2, p3, p4, p5] = &self.columns;
        let mut columns = [Vector6::zeros(); S];
        for j in 0..S {
            let [a, b, c, d, e, f] = speed_map.data.0[j];
            let angular = combine(rotation, [p0[j], p1[j], p2[j]], [a, b, c]);
            let linear = combine(rotation, [p3[j], p4[j], p5[j]], [d, e, f]);
            let zero = Vector3::zeros();
            columns[j] = join(&angular.unwrap_or(zero), &linear.unwrap_or(zero));
        }
        columns
    }

    /// The child's motion at v̄̇ = 0, and the columns of X̄.
    #[inline(always)]
    pub(super) fn advance<T: Scalar>(
        &self,
        kernels: &Kernels<T, S>,
        speeds: &SVector<T, S>,
        (joint_frame, parent): (&Pose<T>, &Motion<T>),
        columns: &mut [Vector6<T>; S],
    ) -> Motion<T> {
        let placement = self.child(&kernels.pose, joint_frame, &parent.placement);
        *columns = self.columns(&kernels.speed_map, &placement.rotation);
        let relative = self.add_columns(&Vector6::zeros(), columns, speeds);
        let carried = shift_twist(&parent.twist, &placement.offset);
        // ad_V X̄ v̄ with V = carried + X̄ v̄, where the bracket of the second with itself vanishes.
        let turned = self.bracket(&carried, &relative);
        let mut rate = shift_twist(&parent.rate, &placement.offset) + turned;
        if let Some(bias) = &kernels.bias {
            rate += turn_out(&placement.rotation, bias);
        }
        Motion {
            placement,
            twist: carried + relative,
            rate,
        }
    }

    /// [`Pattern::advance`], not inlined.
    #[inline(never)]
    pub(super) fn advance_shared<T: Scalar>(
        &self,
        kernels: &Kernels<T, S>,
        speeds: &SVector<T, S>,
        frames: (&Pose<T>, &Motion<T>),
        columns: &mut [Vector6<T>; S],
    ) -> Motion<T> {
        self.advance(kernels, speeds, frames, columns)
    }

    /// `start + X̄ weights`, without the parts that the joint type does not have.
    #[inline(always)]
    pub(super) fn add_columns<T: Scalar>(
        &self,
        start: &Vector6<T>,
        columns: &[Vector6<T>; S],
        weights: &SVector<T, S>,
    ) -> Vector6<T> {
        let (mut angular, mut linear) = split(start);
        for j in 0..S {
            let (column_angular, column_linear) = split(&columns[j]);
            let (turns, slides) = self.column_parts(j);
            if turns {
                angular = add_scaled(&angular, &column_angular, weights[j]);
            }
            if slides {
                linear = add_scaled(&linear, &column_linear, weights[j]);
            }
        }
        join(&angular, &linear)
    }

    /// `ad_V U` for a U in the joint's range.
    #[inline(always)]
    fn bracket<T: Scalar>(&self, twist: &Vector6<T>, relative: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let (turn, slide) = split(relative);
        match self.parts() {
            (true, true) => bracket_product(twist, relative),
            (true, false) => join(&cross(&angular, &turn), &cross(&linear, &turn)),
            (false, true) => join(&Vector3::zeros(), &cross(&angular, &slide)),
            (false, false) => Vector6::zeros(),
        }
    }
}
