//! Symmetric 3×3 matrices as one triangle: what is stored once cannot lose its symmetry to rounding.

use super::fused::{apply, dot};
use crate::scalar::Scalar;
use core::ops::AddAssign;
use nalgebra::{Matrix3, Vector3};

/// A symmetric 3×3 matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric3<T> {
    /// Entry (1, 1).
    pub xx: T,
    /// Entries (1, 2) and (2, 1).
    pub xy: T,
    /// Entries (1, 3) and (3, 1).
    pub xz: T,
    /// Entry (2, 2).
    pub yy: T,
    /// Entries (2, 3) and (3, 2).
    pub yz: T,
    /// Entry (3, 3).
    pub zz: T,
}

impl<T: Scalar> Symmetric3<T> {
    /// The zero matrix.
    #[inline]
    pub fn zero() -> Self {
        Self::diagonal(T::zero())
    }

    /// `value` times the identity.
    #[inline]
    pub fn diagonal(value: T) -> Self {
        let zero = T::zero();
        Self {
            xx: value,
            xy: zero,
            xz: zero,
            yy: value,
            yz: zero,
            zz: value,
        }
    }

    /// The symmetric part of `matrix`.
    pub fn from_matrix(matrix: &Matrix3<T>) -> Self {
        let half = T::from_f64(0.5);
        let mean = |i: usize, j: usize| (matrix[(i, j)] + matrix[(j, i)]) * half;
        Self {
            xx: matrix[(0, 0)],
            xy: mean(0, 1),
            xz: mean(0, 2),
            yy: matrix[(1, 1)],
            yz: mean(1, 2),
            zz: matrix[(2, 2)],
        }
    }

    /// All nine entries.
    pub fn matrix(&self) -> Matrix3<T> {
        Matrix3::from_columns(&self.rows())
    }

    /// The rows, which are the columns as well.
    #[inline(always)]
    pub fn rows(&self) -> [Vector3<T>; 3] {
        [
            Vector3::new(self.xx, self.xy, self.xz),
            Vector3::new(self.xy, self.yy, self.yz),
            Vector3::new(self.xz, self.yz, self.zz),
        ]
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(&self) -> T {
        self.xx + self.yy + self.zz
    }

    /// The product with a vector.
    #[inline(always)]
    pub fn apply(&self, v: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = self.rows();
        Vector3::new(dot(&x, v), dot(&y, v), dot(&z, v))
    }

    /// `R S Rᵀ`.
    #[inline(always)]
    pub fn rotated(&self, rotation: &Matrix3<T>) -> Self {
        let [x, y, z] = self.rows();
        // Column j of R S; row i of R against it is entry (i, j) of R S Rᵀ read from the other side.
        let half = Matrix3::from_columns(&[
            apply(rotation, &x),
            apply(rotation, &y),
            apply(rotation, &z),
        ]);
        let row =
            |m: &Matrix3<T>, i: usize| Vector3::new(m.data.0[0][i], m.data.0[1][i], m.data.0[2][i]);
        let entry = |i: usize, j: usize| dot(&row(&half, i), &row(rotation, j));
        Self {
            xx: entry(0, 0),
            xy: entry(0, 1),
            xz: entry(0, 2),
            yy: entry(1, 1),
            yz: entry(1, 2),
            zz: entry(2, 2),
        }
    }

    /// `S + weight a aᵀ`.
    #[inline(always)]
    pub fn add_outer(&self, a: &Vector3<T>, weight: T) -> Self {
        let w = a * weight;
        Self {
            xx: w.x.mul_add(a.x, self.xx),
            xy: w.x.mul_add(a.y, self.xy),
            xz: w.x.mul_add(a.z, self.xz),
            yy: w.y.mul_add(a.y, self.yy),
            yz: w.y.mul_add(a.z, self.yz),
            zz: w.z.mul_add(a.z, self.zz),
        }
    }

    /// `S + 2 (a·b) 1 − a bᵀ − b aᵀ`.
    ///
    /// An entry of the diagonal takes the products of the other two axes alone. Were its own product added with `a·b` and subtracted with the rest, its rounding
    /// would stay: for a rod along z whose centre of mass lies far along z, more than the whole moment about z.
    #[inline(always)]
    pub fn add_steiner(&self, a: &Vector3<T>, b: &Vector3<T>) -> Self {
        let twice = a + a;
        Self {
            xx: twice.y.mul_add(b.y, twice.z.mul_add(b.z, self.xx)),
            xy: (-a.x).mul_add(b.y, (-b.x).mul_add(a.y, self.xy)),
            xz: (-a.x).mul_add(b.z, (-b.x).mul_add(a.z, self.xz)),
            yy: twice.x.mul_add(b.x, twice.z.mul_add(b.z, self.yy)),
            yz: (-a.y).mul_add(b.z, (-b.y).mul_add(a.z, self.yz)),
            zz: twice.x.mul_add(b.x, twice.y.mul_add(b.y, self.zz)),
        }
    }
}

impl<T: Scalar> AddAssign for Symmetric3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yy += other.yy;
        self.yz += other.yz;
        self.zz += other.zz;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moment about a thin axis along which the centre of mass lies keeps its digits.
    #[test]
    fn thin_moments_are_kept() {
        let thin: Symmetric3<f64> = Symmetric3 {
            zz: 1e-14,
            ..Symmetric3::diagonal(1.0)
        };
        let moved = thin.add_steiner(&Vector3::new(0.0, 0.0, -0.3), &Vector3::new(0.0, 0.0, -0.7));
        assert_eq!(moved.zz, 1e-14);
        assert!((moved.xx - 1.42).abs() <= 4.0 * f64::EPSILON);
    }
}
