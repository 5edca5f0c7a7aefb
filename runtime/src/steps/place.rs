//! Where a joint puts its child, and how it moves it.

use super::{Motion, Steps};
use crate::erased::nan;
use crate::joint::{Entry, Joint};
use crate::scalar::Scalar;
use crate::spatial::fused::{add_scaled, apply, cross, product};
use crate::spatial::{Pose, bracket_product, join, shift_twist, split, turn_out};

use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};

/// The child frame of a joint in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement<T> {
    /// Its axes, in world axes, as columns.
    pub rotation: Matrix3<T>,
    /// Its origin, in world axes, m.
    pub origin: Vector3<T>,
    /// Its origin seen from that of the parent's child frame, in world axes, m.
    ///
    /// Kept beside [`Placement::origin`], whose difference would lose digits far from the world's origin.
    pub offset: Vector3<T>,
}

impl<T: Scalar> Placement<T> {
    /// The world itself.
    pub fn world() -> Self {
        Self {
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
            offset: Vector3::zeros(),
        }
    }

    /// NaN.
    pub(crate) fn unknown() -> Self {
        Self {
            rotation: Matrix3::repeat(nan()),
            origin: Vector3::repeat(nan()),
            offset: Vector3::repeat(nan()),
        }
    }

    /// As a pose: child coordinates to world coordinates.
    pub fn pose(&self) -> Pose<T> {
        Pose::new(self.rotation, self.origin)
    }
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

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// The child frame of the joint at `q`.
    #[inline(always)]
    pub(crate) fn child<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        joint_frame: &Pose<T>,
        parent: &Placement<T>,
    ) -> Placement<T> {
        let (pose, patterns) = (self.0.pose(q), J::PATTERNS);
        let base = product(&parent.rotation, &joint_frame.rotation);
        let [x, y, z] = patterns.rotation;
        // Array methods with closures are not reliably inlined, and then patterns would be read at run time.
        let mut rotation = Matrix3::zeros();
        for j in 0..3 {
            let column = combine(&base, [x[j], y[j], z[j]], pose.rotation.data.0[j]);
            rotation.data.0[j] = column.map_or([T::zero(); 3], |column| column.data.0[0]);
        }
        let fixed = apply(&parent.rotation, &joint_frame.translation);
        let offset = match combine(&base, patterns.translation, pose.translation.data.0[0]) {
            Some(moved) => fixed + moved,
            None => fixed,
        };
        Placement {
            rotation,
            origin: parent.origin + offset,
            offset,
        }
    }

    /// Whether column `j` of X̄ can have an angular, and whether it can have a linear part.
    #[inline(always)]
    pub(crate) const fn column_parts(j: usize) -> (bool, bool) {
        let pattern = const { J::PATTERNS.speed_columns() };
        (occurs(&pattern, 0, j), occurs(&pattern, 3, j))
    }

    /// The same of any column.
    #[inline(always)]
    pub(crate) fn parts() -> (bool, bool) {
        let (mut angular, mut linear) = (false, false);
        for j in 0..S {
            let (a, l) = Self::column_parts(j);
            angular |= a;
            linear |= l;
        }
        (angular, linear)
    }

    /// The columns of `X̄ = X^c S̄`, turned into world axes.
    #[inline(always)]
    pub(crate) fn columns<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        rotation: &Matrix3<T>,
    ) -> [Vector6<T>; S] {
        let pattern = const { J::PATTERNS.speed_columns() };
        let map = self.speed_map(q);
        let [p0, p1, p2, p3, p4, p5] = pattern;
        let mut columns = [Vector6::zeros(); S];
        for j in 0..S {
            let [a, b, c, d, e, f] = map.data.0[j];
            let angular = combine(rotation, [p0[j], p1[j], p2[j]], [a, b, c]);
            let linear = combine(rotation, [p3[j], p4[j], p5[j]], [d, e, f]);
            let zero = Vector3::zeros();
            columns[j] = join(&angular.unwrap_or(zero), &linear.unwrap_or(zero));
        }
        columns
    }

    /// `X̄ = X^c S̄` in child axes.
    #[inline(always)]
    fn speed_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, S> {
        let map = self.0.twist_map_child(q);
        if J::STRUCTURES.speed_basis.is_identity() {
            let mut same = SMatrix::zeros();
            for j in 0..S {
                same.data.0[j] = map.data.0[j];
            }
            return same;
        }
        map * self.0.speed_basis(q)
    }

    /// The child's motion at v̄̇ = 0, and the columns of X̄.
    #[inline(always)]
    pub(crate) fn advance<T: Scalar>(
        &self,
        (q, speeds): (&SVector<T, N>, &SVector<T, S>),
        joint_frame: &Pose<T>,
        parent: &Motion<T>,
        columns: &mut [Vector6<T>; S],
    ) -> Motion<T> {
        let placement = self.child(q, joint_frame, &parent.placement);
        *columns = self.columns(q, &placement.rotation);
        let relative = Self::relative(speeds, columns);
        let carried = shift_twist(&parent.twist, &placement.offset);
        // ad_V X̄ v̄ with V = carried + X̄ v̄, where the bracket of the second with itself vanishes.
        let turned = Self::bracket(&carried, &relative);
        let mut rate = shift_twist(&parent.rate, &placement.offset) + turned;
        if !J::STRUCTURES.bias_acceleration.is_zero() {
            rate += turn_out(&placement.rotation, &self.0.bias_acceleration(q, speeds));
        }
        Motion {
            placement,
            twist: carried + relative,
            rate,
        }
    }

    /// `X̄ v̄`.
    #[inline(always)]
    fn relative<T: Scalar>(speeds: &SVector<T, S>, columns: &[Vector6<T>; S]) -> Vector6<T> {
        Self::add_columns(&Vector6::zeros(), columns, speeds)
    }

    /// `start + X̄ weights`, without the parts that the joint type does not have.
    #[inline(always)]
    pub(crate) fn add_columns<T: Scalar>(
        start: &Vector6<T>,
        columns: &[Vector6<T>; S],
        weights: &SVector<T, S>,
    ) -> Vector6<T> {
        let (mut angular, mut linear) = split(start);
        for j in 0..S {
            let (column_angular, column_linear) = split(&columns[j]);
            let (turns, slides) = Self::column_parts(j);
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
    fn bracket<T: Scalar>(twist: &Vector6<T>, relative: &Vector6<T>) -> Vector6<T> {
        let (angular, linear) = split(twist);
        let (turn, slide) = split(relative);
        match Self::parts() {
            (true, true) => bracket_product(twist, relative),
            (true, false) => join(&cross(&angular, &turn), &cross(&linear, &turn)),
            (false, true) => join(&Vector3::zeros(), &cross(&angular, &slide)),
            (false, false) => Vector6::zeros(),
        }
    }
}
