//! How the wrench on a moving body changes with its twist.

use crate::spatial::fused::{add_cross, apply, apply_transposed, cross, dot};
use crate::spatial::{SpatialInertia, hat, join, shift_wrench, split};
use nalgebra::{Matrix3, Vector3, Vector6};

/// `B U = N ad_U V − ad_Uᵀ N V − ad_Vᵀ N U` of a body with inertia N and twist V: what U added to its twist, together with `ad_U V` added to
/// its rate, adds to the wrench that it takes.
///
/// By Galileo's principle a linear U adds nothing: with the body's momentum p, `B U = (K ω; −2 p × ω)`. Twelve numbers instead of 36, which add
/// up over the bodies of a subtree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coriolis {
    /// K.
    pub(super) turn: Matrix3<f64>,
    /// p, linear.
    pub(super) momentum: Vector3<f64>,
}

impl Coriolis {
    /// Of no body.
    pub(super) fn zero() -> Self {
        Self {
            turn: Matrix3::zeros(),
            momentum: Vector3::zeros(),
        }
    }

    /// Of one body: `K = ω~ I + (ω~ I)ᵀ − (I ω)~ + 2 (mc·v) 1 − 2 v mcᵀ`.
    #[inline(always)]
    pub(super) fn of(rigid: &SpatialInertia<f64>, twist: &Vector6<f64>) -> Self {
        let (angular, linear) = split(twist);
        let moment = &rigid.first_moment;
        let [x, y, z] = rigid.inertia.rows();
        let turned = Matrix3::from_columns(&[
            cross(&angular, &x),
            cross(&angular, &y),
            cross(&angular, &z),
        ]);
        let mut turn = turned + turned.transpose() - hat(&rigid.inertia.apply(&angular));
        add_arm(&mut turn, moment, &linear);
        Self {
            turn,
            momentum: add_cross(&(linear * rigid.mass), &angular, moment),
        }
    }

    /// The same at a frame whose origin is `−offset` from this one's: `K′ = K + 2 (r·p) 1 − 2 p rᵀ`.
    #[inline(always)]
    pub(super) fn shifted(&self, offset: &Vector3<f64>) -> Self {
        let mut shifted = *self;
        add_arm(&mut shifted.turn, offset, &self.momentum);
        shifted
    }

    /// Of both.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.turn += other.turn;
        self.momentum += other.momentum;
    }

    /// `B U` for the angular part of U.
    #[inline(always)]
    pub(super) fn apply(&self, angular: &Vector3<f64>) -> Vector6<f64> {
        let force = cross(angular, &self.momentum);
        join(&apply(&self.turn, angular), &(force + force))
    }

    /// The angular part of `Bᵀ X`; the linear one is zero.
    #[inline(always)]
    pub(super) fn apply_transposed(&self, column: &Vector6<f64>) -> Vector3<f64> {
        let (turn, slide) = split(column);
        let slid = cross(&self.momentum, &slide);
        apply_transposed(&self.turn, &turn) + (slid + slid)
    }
}

/// `K += 2 (r·p) 1 − 2 p rᵀ`.
#[inline(always)]
fn add_arm(turn: &mut Matrix3<f64>, r: &Vector3<f64>, p: &Vector3<f64>) {
    let twice = r + r;
    let along = dot(&twice, p);
    for j in 0..3 {
        let column = &mut turn.data.0[j];
        for i in 0..3 {
            column[i] -= p[i] * twice[j];
        }
        column[j] += along;
    }
}

/// [`Coriolis`] with the joints below free to give way: 6×3, angular U to wrenches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ArticulatedCoriolis([Vector6<f64>; 3]);

impl ArticulatedCoriolis {
    /// Of no body.
    pub(super) fn zero() -> Self {
        Self([Vector6::zeros(); 3])
    }

    /// Adds a body that does not give way.
    #[inline(always)]
    pub(super) fn add_rigid(&mut self, rigid: &Coriolis) {
        // Column j of −2 p~ is 2 e_j × p.
        let [x, y, z] = (rigid.momentum + rigid.momentum).into();
        let forces = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for (j, column) in self.0.iter_mut().enumerate() {
            let [a, b, c] = rigid.turn.data.0[j];
            let [d, e, f] = forces[j];
            *column += Vector6::new(a, b, c, d, e, f);
        }
    }

    /// Takes out one degree of freedom with column X, momentum Y and `1/d`; what is left of U in its rate, `Bᵀ X / d`.
    #[inline(always)]
    pub(super) fn eliminate(
        &mut self,
        column: &Vector6<f64>,
        momentum: &Vector6<f64>,
        inverse: f64,
    ) -> Vector3<f64> {
        let weights = Vector3::from_fn(|j, _| self.0[j].dot(column) * inverse);
        for (own, weight) in self.0.iter_mut().zip(weights.iter()) {
            *own -= momentum * *weight;
        }
        weights
    }

    /// Adds what another frame's, `offset` away, hands over.
    #[inline(always)]
    pub(super) fn add_shifted(&mut self, other: &Self, offset: &Vector3<f64>) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own += shift_wrench(other, offset);
        }
    }

    /// `B U` for the angular part of U.
    #[inline(always)]
    pub(super) fn apply(&self, angular: &Vector3<f64>) -> Vector6<f64> {
        self.0[0] * angular.x + self.0[1] * angular.y + self.0[2] * angular.z
    }
}
