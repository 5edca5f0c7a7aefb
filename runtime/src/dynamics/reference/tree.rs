//! Jacobians of all bodies and their derivatives in ϕ, by recursion from the root.

use crate::mechanism::{Body, Mechanism};
use crate::spatial::{Pose, SpatialInertia, bracket, join};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Matrix6, Matrix6xX, Vector3, Vector6};

/// The motion of one body's joint-child frame.
pub(super) struct BodyMotion {
    /// The frame in the world.
    pose: Pose<f64>,
    /// J, 6×K: v of the whole mechanism to the twist of this frame, in this frame.
    pub(super) jacobian: Matrix6xX<f64>,
    /// ∂J/∂ϕ_k, where it is not zero: for the degrees of freedom of the joints between world and body.
    pub(super) jacobian_gradient: Vec<Option<Matrix6xX<f64>>>,
}

impl BodyMotion {
    fn world(freedoms: usize) -> Self {
        Self {
            pose: Pose::identity(),
            jacobian: Matrix6xX::zeros(freedoms),
            jacobian_gradient: vec![None; freedoms],
        }
    }

    /// Gravity's wrench on the body, in this frame.
    pub(super) fn weight(
        &self,
        gravity: &Vector3<f64>,
        inertia: &SpatialInertia<f64>,
    ) -> Vector6<f64> {
        let gravity = self.pose.rotation.tr_mul(gravity);
        join(
            &inertia.first_moment.cross(&gravity),
            &(gravity * inertia.mass),
        )
    }

    /// m gᵀ r of the centre of mass: minus the potential energy.
    pub(super) fn gravity_work(
        &self,
        gravity: &Vector3<f64>,
        inertia: &SpatialInertia<f64>,
    ) -> f64 {
        let moment =
            self.pose.rotation * inertia.first_moment + self.pose.translation * inertia.mass;
        gravity.dot(&moment)
    }
}

/// The motion of every body at one configuration.
pub(super) struct Tree {
    pub(super) bodies: Vec<BodyMotion>,
}

impl Tree {
    /// `velocity_map` is S of the whole mechanism: it turns ϕ̇ into the v behind a frame's twist.
    pub(super) fn new(mechanism: &Mechanism, q: &[f64], velocity_map: &DMatrix<f64>) -> Self {
        let world = BodyMotion::world(mechanism.layout().freedoms);
        let mut bodies: Vec<BodyMotion> = Vec::with_capacity(mechanism.bodies().len());
        for body in mechanism.bodies() {
            let parent = body.parent().map_or(&world, |parent| &bodies[parent]);
            bodies.push(next(body, parent, body.configuration(q), velocity_map));
        }
        Self { bodies }
    }
}

/// J_i = Ad_{i←λ} J_λ + X^c_i E_i, and its derivative.
///
/// Along the joint's own ϕ_a the frame moves with the twist `ξ_a = X^c S e_a`, so that ∂Ad_{i←λ}/∂ϕ_a = −ad_ξ Ad_{i←λ}.
fn next(body: &Body, parent: &BodyMotion, q: &[f64], velocity_map: &DMatrix<f64>) -> BodyMotion {
    let (joint, own) = (body.joint(), body.ranges().freedoms.clone());
    let relative = body.joint_frame().compose(&joint.pose(q));
    let carry = relative.inverse().adjoint();
    let carried = carry * &parent.jacobian;

    let mut twist_map = Matrix6xX::zeros(own.len());
    joint.twist_map_child(q, twist_map.as_mut_slice());
    let mut slopes = vec![0.0; 6 * own.len() * own.len()];
    joint.twist_map_child_gradient(q, &mut slopes);

    let mut gradient: Vec<_> = parent
        .jacobian_gradient
        .iter()
        .map(|slope| slope.as_ref().map(|slope| carry * slope))
        .collect();
    let local_map = velocity_map.view((own.start, own.start), (own.len(), own.len()));
    let directions = &twist_map * local_map;
    for (a, k) in own.clone().enumerate() {
        let turn: Matrix6<f64> = bracket(&directions.column(a).into_owned());
        let slope = &slopes[6 * own.len() * a..6 * own.len() * (a + 1)];
        let mut total = -(turn * &carried);
        set_columns(&mut total, own.start, &Matrix6xX::from_column_slice(slope));
        gradient[k] = Some(total);
    }
    let mut jacobian = carried;
    set_columns(&mut jacobian, own.start, &twist_map);
    BodyMotion {
        pose: parent.pose.compose(&relative),
        jacobian,
        jacobian_gradient: gradient,
    }
}

/// Columns that belong to the joint itself: what is carried over from the parent is zero there.
fn set_columns(matrix: &mut Matrix6xX<f64>, start: usize, columns: &Matrix6xX<f64>) {
    matrix
        .columns_mut(start, columns.ncols())
        .copy_from(columns);
}
