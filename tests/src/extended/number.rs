//! A number of 256 bits (77 digits) as a scalar of matrices.

use hamel::nalgebra::{Matrix3, SMatrix, Vector3};
use hamel_codegen::precise::Precise;
use num_traits::{One, Zero};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Precision of an [`Exact`].
pub const BITS: usize = 256;

/// A binary floating-point number of [`BITS`] bits.
#[derive(Clone, Debug)]
pub struct Exact(Precise);

impl Exact {
    /// The nearest double.
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64()
    }

    /// Cosine and sine.
    pub fn cos_sin(&self) -> (Self, Self) {
        (Self(self.0.cos()), Self(self.0.sin()))
    }
}

impl From<f64> for Exact {
    fn from(value: f64) -> Self {
        Self(Precise::from_f64(value, BITS))
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        self.0.compare(&other.0) == Some(Ordering::Equal)
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident),*) => {$(
        impl $operator for Exact {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self((&self.0).$method(&other.0))
            }
        }

        impl $assign for Exact {
            fn $assign_method(&mut self, other: Self) {
                self.0 = (&self.0).$method(&other.0);
            }
        }
    )*};
}

operators!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign
);

impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Exact {
    fn zero() -> Self {
        Self(Precise::integer(0, BITS))
    }
    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }
}

impl One for Exact {
    fn one() -> Self {
        Self(Precise::integer(1, BITS))
    }
}

/// The same matrix, exactly.
pub(super) fn exact<const R: usize, const C: usize>(
    matrix: &SMatrix<f64, R, C>,
) -> SMatrix<Exact, R, C> {
    matrix.map(Exact::from)
}

/// The rotation nearest to a matrix of doubles that is one up to their rounding.
pub(super) fn rotation(matrix: &Matrix3<f64>) -> Matrix3<Exact> {
    let mut rotation = exact(matrix);
    let half = Exact::from(0.5);
    let three = Matrix3::<Exact>::identity() * Exact::from(3.0);
    // Newton's method for the polar factor doubles the digits: 16, 32, 64, 128.
    for _ in 0..3 {
        let gram = rotation.transpose() * &rotation;
        rotation = &rotation * (&three - gram) * half.clone();
    }
    rotation
}

/// `a × b`.
pub(super) fn cross(a: &Vector3<Exact>, b: &Vector3<Exact>) -> Vector3<Exact> {
    hat(a) * b
}

/// `a~`.
pub(super) fn hat(a: &Vector3<Exact>) -> Matrix3<Exact> {
    let [x, y, z] = [0, 1, 2].map(|i| a[i].clone());
    let zero = Exact::zero();
    Matrix3::from_row_slice(&[
        zero.clone(),
        -z.clone(),
        y.clone(),
        z,
        zero.clone(),
        -x.clone(),
        -y,
        x,
        zero,
    ])
}
