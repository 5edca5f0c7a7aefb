//! Dual numbers: a value and its derivatives along one or several directions. Nest them for higher derivatives.

use super::Scalar;
use crate::curve::Curve;
use crate::spatial::vee;
use core::array::from_fn;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use nalgebra::{Matrix3, Vector3};
use num_traits::{One, Zero};

/// `value + Σ_d derivatives_d ε_d` with `ε_d ε_e = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const D: usize = 1> {
    /// The value.
    pub value: T,
    /// The derivative along each of the seeded directions.
    pub derivatives: [T; D],
}

impl<T: Scalar> Dual<T> {
    /// A number with the given value and derivative along one direction.
    pub const fn new(value: T, derivative: T) -> Self {
        Self {
            value,
            derivatives: [derivative],
        }
    }

    /// The number along which is differentiated: its derivative is 1.
    pub fn variable(value: T) -> Self {
        Self::new(value, T::one())
    }

    /// The derivative along the only direction.
    pub const fn derivative(&self) -> T {
        self.derivatives[0]
    }
}

impl<T: Scalar, const D: usize> Dual<T, D> {
    /// A number that does not vary.
    pub fn constant(value: T) -> Self {
        Self::each(value, |_| T::zero())
    }

    /// A number whose derivative along direction `d` is `derivative(d)`.
    pub fn each(value: T, mut derivative: impl FnMut(usize) -> T) -> Self {
        let mut number = Self {
            value,
            derivatives: [value; D],
        };
        // Not by `array::from_fn`, which is compiled to five times as much, for each operation and scalar.
        for d in 0..D {
            number.derivatives[d] = derivative(d);
        }
        number
    }

    /// Direction `d` of a product.
    fn product_rule(&self, other: &Self, d: usize) -> T {
        self.derivatives[d] * other.value + self.value * other.derivatives[d]
    }

    /// Direction `d` of a quotient of this value.
    fn quotient_rule(&self, other: &Self, value: T, d: usize) -> T {
        (self.derivatives[d] - value * other.derivatives[d]) / other.value
    }

    /// The function's value where its derivative is `slope`.
    fn chain(self, value: T, slope: T) -> Self {
        Self::each(value, |d| slope * self.derivatives[d])
    }
}

impl<T: Scalar, const D: usize> Add for Dual<T, D> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::each(self.value + other.value, |d| {
            self.derivatives[d] + other.derivatives[d]
        })
    }
}

impl<T: Scalar, const D: usize> Sub for Dual<T, D> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::each(self.value - other.value, |d| {
            self.derivatives[d] - other.derivatives[d]
        })
    }
}

impl<T: Scalar, const D: usize> Mul for Dual<T, D> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::each(self.value * other.value, |d| self.product_rule(&other, d))
    }
}

impl<T: Scalar, const D: usize> Div for Dual<T, D> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::each(value, |d| self.quotient_rule(&other, value, d))
    }
}

impl<T: Scalar, const D: usize> Neg for Dual<T, D> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::each(-self.value, |d| -self.derivatives[d])
    }
}

macro_rules! implement_assignment {
    ($($trait:ident, $method:ident, $operator:tt;)*) => {$(
        impl<T: Scalar, const D: usize> $trait for Dual<T, D> {
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

impl<T: Scalar, const D: usize> Zero for Dual<T, D> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }

    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.derivatives.iter().all(T::is_zero)
    }
}

impl<T: Scalar, const D: usize> One for Dual<T, D> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}

/// The rotation vector r of a rotation that turns with ω in its own axes: its rate is `dexp⁻¹_r ω`, which is
/// `ω + ½ r × ω + G(r²) r × (r × ω)`; one ω for each direction.
fn turning<T: Scalar, const D: usize>(
    r: Vector3<T>,
    omega: impl Fn(usize) -> Vector3<T>,
) -> Vector3<Dual<T, D>> {
    let square = r.x * r.x + r.y * r.y + r.z * r.z;
    let factor = square.dexp_inverse(0);
    let rates: [Vector3<T>; D] = from_fn(|d| {
        let omega = omega(d);
        let turn = r.cross(&omega);
        omega + turn * T::from_f64(0.5) + r.cross(&turn) * factor
    });
    Vector3::from_fn(|i, _| Dual::each(r[i], |d| rates[d][i]))
}

impl<T: Scalar, const D: usize> Scalar for Dual<T, D> {
    type Mask = T::Mask;
    type Four = super::Each<Self>;

    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }

    fn epsilon() -> Self {
        Self::constant(T::epsilon())
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self::each(self.value.mul_add(factor.value, addend.value), |d| {
            let product = self.derivatives[d].mul_add(factor.value, addend.derivatives[d]);
            self.value.mul_add(factor.derivatives[d], product)
        })
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::each(root, |d| self.derivatives[d] / (root + root))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        Self::each(self.value.atan2(x.value), |d| {
            let area = x.value * self.derivatives[d] - self.value * x.derivatives[d];
            area / square
        })
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    fn ln(self) -> Self {
        Self::each(self.value.ln(), |d| self.derivatives[d] / self.value)
    }

    fn ln_1p(self) -> Self {
        Self::each(self.value.ln_1p(), |d| {
            self.derivatives[d] / (T::one() + self.value)
        })
    }

    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }

    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }

    fn sech(self) -> Self {
        let value = self.value.sech();
        self.chain(value, -(self.value.tanh() * value))
    }

    fn tanh(self) -> Self {
        let sech = self.value.sech();
        self.chain(self.value.tanh(), sech * sech)
    }

    fn ln_cosh(self) -> Self {
        self.chain(self.value.ln_cosh(), self.value.tanh())
    }

    fn stumpff(self, order: usize) -> Self {
        let slope = if order == 0 {
            -self.value.stumpff(1)
        } else {
            T::from_f64(order as f64) * self.value.stumpff(order + 2)
                - self.value.stumpff(order + 1)
        };
        self.chain(self.value.stumpff(order), T::from_f64(0.5) * slope)
    }

    fn dexp_inverse(self, derivative: usize) -> Self {
        self.chain(
            self.value.dexp_inverse(derivative),
            self.value.dexp_inverse(derivative + 1),
        )
    }

    fn curve(self, curve: &Curve, order: usize) -> Self {
        self.chain(
            self.value.curve(curve, order),
            self.value.curve(curve, order + 1),
        )
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        let value = rotation.map(|entry| entry.value);
        turning(T::rotation_vector(&value), |d| {
            let rate = rotation.map(|entry| entry.derivatives[d]);
            vee(&(value.transpose() * rate))
        })
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        let [w, x, y, z] = quaternion.map(|entry| entry.value);
        let v = Vector3::new(x, y, z);
        let square = w * w + x * x + y * y + z * z;
        let scale = T::from_f64(2.0) / square;
        turning(T::quaternion_vector([w, x, y, z]), |d| {
            let [dw, dx, dy, dz] = quaternion.map(|entry| entry.derivatives[d]);
            let dv = Vector3::new(dx, dy, dz);
            // ω = 2 vec(q̄ q̇) / |q|².
            (dv * w - v * dw - v.cross(&dv)) * scale
        })
    }

    fn less(self, other: Self) -> Self::Mask {
        self.value.less(other.value)
    }

    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        Self::each(T::select(mask, if_true.value, if_false.value), |d| {
            T::select(mask, if_true.derivatives[d], if_false.derivatives[d])
        })
    }
}
