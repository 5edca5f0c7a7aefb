//! The gradient of a scalar function of a mechanism's motion by the motion of one child frame, and its products with what one unit of each ϕ and speed of that
//! frame's joint changes.
//!
//! The products are the same for every joint: they are compiled once, and not once more for each joint type.

use crate::erased::nan;
use crate::scalar::{Dual, Scalar};
use crate::spatial::bracket_product;
use nalgebra::Vector6;

/// The gradient of a scalar function of a mechanism's motion by the motion of one child frame and of all that hangs on it: four vectors that are read as
/// wrenches are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionGradient<T> {
    /// ζ, by the placement.
    pub placement: Vector6<T>,
    /// β, by V.
    pub twist: Vector6<T>,
    /// h, by V̇.
    pub rate: Vector6<T>,
    /// F, by the virtual twist P.
    pub virtual_twist: Vector6<T>,
}

/// V, V̇ and P of the parent, as they carry a child frame along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrying<T> {
    /// V.
    pub twist: Vector6<T>,
    /// V̇.
    pub rate: Vector6<T>,
    /// P.
    pub virtual_twist: Vector6<T>,
}

/// What a joint adds to the motion of its child, in child axes: one vector for each of K degrees of freedom or S speeds.
pub(super) struct OwnMotion<'a> {
    /// X̄; S.
    pub(super) columns: &'a [Vector6<Dual<f64>>],
    /// X^c S₀; K.
    pub(super) local: &'a [Vector6<Dual<f64>>],
    /// X̄ v̄.
    pub(super) twist: Vector6<Dual<f64>>,
    /// ∂(X̄ v̄)/∂ϕ; K.
    pub(super) twist_slopes: &'a [Vector6<Dual<f64>>],
    /// ∂(X̄ v̄̇ + c)/∂ϕ; K.
    pub(super) rate_slopes: &'a [Vector6<Dual<f64>>],
    /// ∂(X̄ μ)/∂ϕ; K.
    pub(super) virtual_slopes: &'a [Vector6<Dual<f64>>],
    /// ∂c/∂v̄; S.
    pub(super) speed_slopes: &'a [Vector6<Dual<f64>>],
}

impl<T: Scalar> MotionGradient<T> {
    /// Zeros.
    pub fn zero() -> Self {
        Self {
            placement: Vector6::zeros(),
            twist: Vector6::zeros(),
            rate: Vector6::zeros(),
            virtual_twist: Vector6::zeros(),
        }
    }

    /// Each of its vectors.
    pub(crate) fn map<U>(&self, f: impl Fn(&Vector6<T>) -> Vector6<U>) -> MotionGradient<U> {
        MotionGradient {
            placement: f(&self.placement),
            twist: f(&self.twist),
            rate: f(&self.rate),
            virtual_twist: f(&self.virtual_twist),
        }
    }
}

impl MotionGradient<f64> {
    /// The same without a derivative.
    pub(super) fn constant(&self) -> MotionGradient<Dual<f64>> {
        self.map(|vector| vector.map(Dual::constant))
    }

    /// Derivatives along the joint's own directions of the products with what each of them changes, where X̄ with these `columns` is constant and ϕ̇ = v = v̄.
    /// Then nothing changes but what the parent does, as seen from the child. Into `out` as
    /// [`AnyJoint::second_variations`](crate::erased::AnyJoint::second_variations) says.
    pub(super) fn constant_columns(
        &self,
        columns: &[Vector6<f64>],
        carrying: &Carrying<f64>,
        [by_local, mixed, by_speeds]: [&mut [f64]; 3],
    ) {
        let size = columns.len();
        mixed.fill(0.0);
        for (l, outer) in columns.iter().enumerate() {
            let moved = carrying.map(|twist| -bracket_product(outer, twist));
            for (k, inner) in columns.iter().enumerate() {
                let drift = bracket_product(&moved.twist, inner);
                let rate = bracket_product(&moved.rate, inner)
                    + bracket_product(&moved.twist, &bracket_product(&carrying.twist, inner))
                    + bracket_product(&carrying.twist, &drift);
                let virtual_drift = bracket_product(&moved.virtual_twist, inner);
                by_local[k * size + l] = self.twist.dot(&drift)
                    + self.rate.dot(&rate)
                    + self.virtual_twist.dot(&virtual_drift);
                by_speeds[k * size + l] = self.rate.dot(&bracket_product(outer, inner));
            }
        }
    }
}

impl MotionGradient<Dual<f64>> {
    /// What one unit of each ϕ and of each speed changes: K and S products.
    pub(super) fn products(
        &self,
        own: &OwnMotion<'_>,
        carrying: &Carrying<Dual<f64>>,
        by_local: &mut [Dual<f64>],
        by_speeds: &mut [Dual<f64>],
    ) {
        let twist = carrying.twist + own.twist;
        for (k, product) in by_local.iter_mut().enumerate() {
            let (local, slope) = (&own.local[k], &own.twist_slopes[k]);
            let drift = bracket_product(&carrying.twist, local) + slope;
            let rate = bracket_product(&carrying.rate, local)
                + bracket_product(&carrying.twist, &drift)
                + bracket_product(&twist, slope)
                + own.rate_slopes[k];
            let virtual_drift =
                bracket_product(&carrying.virtual_twist, local) + own.virtual_slopes[k];
            *product = self.placement.dot(local)
                + self.twist.dot(&drift)
                + self.rate.dot(&rate)
                + self.virtual_twist.dot(&virtual_drift);
        }
        let both = twist + carrying.twist;
        for (j, product) in by_speeds.iter_mut().enumerate() {
            let column = &own.columns[j];
            let rate = bracket_product(&both, column) + own.speed_slopes[j];
            *product = self.twist.dot(column) + self.rate.dot(&rate);
        }
    }
}

impl Carrying<f64> {
    /// Each of its vectors.
    pub(crate) fn map<U>(&self, f: impl Fn(&Vector6<f64>) -> Vector6<U>) -> Carrying<U> {
        Carrying {
            twist: f(&self.twist),
            rate: f(&self.rate),
            virtual_twist: f(&self.virtual_twist),
        }
    }

    /// The same without a derivative.
    pub(super) fn constant(&self) -> Carrying<Dual<f64>> {
        self.map(|twist| twist.map(Dual::constant))
    }

    /// How it changes as the child moves by the twist `z`: it stands still in the parent, and turns back in the child.
    pub(super) fn turned_back(&self, z: &Vector6<f64>) -> Carrying<Dual<f64>> {
        self.map(|twist| {
            let turned = bracket_product(z, twist);
            Vector6::from_fn(|i, _| Dual::new(twist[i], -turned[i]))
        })
    }
}

/// Fills all of `out` with NaN where its slices are not of these sizes; whether they are.
pub(super) fn have_sizes<const M: usize>(out: &mut [&mut [f64]; M], sizes: [usize; M]) -> bool {
    let fit = out.iter().zip(sizes).all(|(own, size)| own.len() == size);
    if !fit {
        for own in out {
            own.fill(nan());
        }
    }
    fit
}
