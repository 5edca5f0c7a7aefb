//! Dual numbers: a value and its derivative along one direction. Nest them for higher derivatives.

use super::Scalar;
use crate::spatial::vee;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::{Matrix3, Vector3};
use num_traits::{One, Zero};

/// `value + derivative · ε` with `ε² = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    /// The value.
    pub value: T,
    /// The derivative along the seeded direction.
    pub derivative: T,
}

impl<T: Scalar> Dual<T> {
    /// A number with the given value and derivative.
    pub const fn new(value: T, derivative: T) -> Self {
        Self { value, derivative }
    }

    /// A number that does not vary.
    pub fn constant(value: T) -> Self {
        Self::new(value, T::zero())
    }

    /// The number along which is differentiated: its derivative is 1.
    pub fn variable(value: T) -> Self {
        Self::new(value, T::one())
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.derivative + other.derivative)
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.derivative - other.derivative)
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.value * other.value,
            self.derivative * other.value + self.value * other.derivative,
        )
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(
            value,
            (self.derivative - value * other.derivative) / other.value,
        )
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

macro_rules! implement_assignment {
    ($($trait:ident, $method:ident, $operator:tt;)*) => {$(
        impl<T: Scalar> $trait for Dual<T> {
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

implement_assignment! {
    AddAssign, add_assign, +;
    SubAssign, sub_assign, -;
    MulAssign, mul_assign, *;
    DivAssign, div_assign, /;
}

impl<T: Scalar> Zero for Dual<T> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }

    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.derivative.is_zero()
    }
}

impl<T: Scalar> One for Dual<T> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}

/// The rotation vector r of a rotation that turns with ω in its own axes: its rate is `dexp⁻¹_r ω`, which is
/// `ω + ½ r × ω + G(r²) r × (r × ω)`.
fn turning<T: Scalar>(r: Vector3<T>, omega: Vector3<T>) -> Vector3<Dual<T>> {
    let turn = r.cross(&omega);
    let square = r.x * r.x + r.y * r.y + r.z * r.z;
    let derivative = omega + turn * T::from_f64(0.5) + r.cross(&turn) * square.dexp_inverse(0);
    Vector3::from_fn(|i, _| Dual::new(r[i], derivative[i]))
}

impl<T: Scalar> Scalar for Dual<T> {
    type Mask = T::Mask;

    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }

    fn epsilon() -> Self {
        Self::constant(T::epsilon())
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let product = self.derivative.mul_add(factor.value, addend.derivative);
        Self::new(
            self.value.mul_add(factor.value, addend.value),
            self.value.mul_add(factor.derivative, product),
        )
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, self.derivative / (root + root))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (
            Self::new(sin, cos * self.derivative),
            Self::new(cos, -(sin * self.derivative)),
        )
    }

    fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        let area = x.value * self.derivative - self.value * x.derivative;
        Self::new(self.value.atan2(x.value), area / square)
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        Self::new(value, value * self.derivative)
    }

    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.derivative / self.value)
    }

    fn ln_1p(self) -> Self {
        Self::new(
            self.value.ln_1p(),
            self.derivative / (T::one() + self.value),
        )
    }

    fn sinh(self) -> Self {
        Self::new(self.value.sinh(), self.value.cosh() * self.derivative)
    }

    fn cosh(self) -> Self {
        Self::new(self.value.cosh(), self.value.sinh() * self.derivative)
    }

    fn sech(self) -> Self {
        let value = self.value.sech();
        Self::new(value, -(self.value.tanh() * value * self.derivative))
    }

    fn tanh(self) -> Self {
        let sech = self.value.sech();
        Self::new(self.value.tanh(), sech * sech * self.derivative)
    }

    fn ln_cosh(self) -> Self {
        Self::new(self.value.ln_cosh(), self.value.tanh() * self.derivative)
    }

    fn stumpff(self, order: usize) -> Self {
        let slope = if order == 0 {
            -self.value.stumpff(1)
        } else {
            T::from_f64(order as f64) * self.value.stumpff(order + 2)
                - self.value.stumpff(order + 1)
        };
        Self::new(
            self.value.stumpff(order),
            T::from_f64(0.5) * slope * self.derivative,
        )
    }

    fn dexp_inverse(self, derivative: usize) -> Self {
        Self::new(
            self.value.dexp_inverse(derivative),
            self.value.dexp_inverse(derivative + 1) * self.derivative,
        )
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        let value = rotation.map(|entry| entry.value);
        let rate = rotation.map(|entry| entry.derivative);
        let omega = vee(&(value.transpose() * rate));
        turning(T::rotation_vector(&value), omega)
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        let [w, x, y, z] = quaternion.map(|entry| entry.value);
        let [dw, dx, dy, dz] = quaternion.map(|entry| entry.derivative);
        let (v, dv) = (Vector3::new(x, y, z), Vector3::new(dx, dy, dz));
        // ω = 2 vec(q̄ q̇) / |q|².
        let turn = dv * w - v * dw - v.cross(&dv);
        let square = w * w + x * x + y * y + z * z;
        turning(
            T::quaternion_vector([w, x, y, z]),
            turn * (T::from_f64(2.0) / square),
        )
    }

    fn less(self, other: Self) -> Self::Mask {
        self.value.less(other.value)
    }

    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            T::select(mask, if_true.value, if_false.value),
            T::select(mask, if_true.derivative, if_false.derivative),
        )
    }
}
