//! The configuration at which a joint takes a given pose.

use super::check::check_size;
use super::{Body, Mechanism, StateError};
use crate::spatial::{Pose, se3};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector, Vector6};

/// How far from a pose a joint may stay, in rad and in m relative to max(1, distance of the pose).
pub const REACH_TOLERANCE: f64 = 1e-9;

/// Gauss–Newton steps from one start: convergence is quadratic, so that few are ever taken.
const STEPS: usize = 60;

/// Halvings of a step that does not bring the pose nearer.
const HALVINGS: usize = 12;

/// Starts other than home, along each degree of freedom both ways, tried in turn when home leads nowhere.
const STARTS: [f64; 3] = [1.5, 3.0, 0.75];

/// The least-squares solution of `matrix · x = target`, by QR; zero along what a singular matrix cannot reach.
pub(super) fn least_squares(matrix: &DMatrix<f64>, target: &DVector<f64>) -> DVector<f64> {
    let columns = matrix.ncols();
    let qr = matrix.clone().qr();
    let mut rotated = target.clone();
    qr.q_tr_mul(&mut rotated);
    let triangle = qr.unpack_r();
    triangle
        .solve_upper_triangular(&rotated.rows(0, columns).into_owned())
        .unwrap_or_else(|| DVector::zeros(columns))
}

/// A configuration on the way to the target pose.
struct Approach {
    q: Vec<f64>,
    /// log(H(Q)⁻¹ target): the twist that would lead there in unit time, child frame.
    error: Vector6<f64>,
}

impl Body {
    fn approach(&self, q: Vec<f64>, target: &Pose<f64>) -> Approach {
        let error = se3::log(&self.joint().pose(&q).inverse().compose(target));
        Approach { q, error }
    }

    fn moved(&self, q: &[f64], phi: &DVector<f64>) -> Vec<f64> {
        let mut moved = vec![0.0; q.len()];
        self.joint().retract(q, phi.as_slice(), &mut moved);
        // Where the projection fails, what it leaves is NaN, and NaN is no nearer to anything.
        _ = self.joint().project(&mut moved);
        moved
    }

    /// ϕ of the Gauss–Newton step: the v that comes nearest to the error, as ϕ̇ = S₀⁻¹ v.
    fn gauss_newton_step(&self, from: &Approach) -> DVector<f64> {
        let freedoms = self.ranges.freedoms.len();
        let target = DVector::from_column_slice(from.error.as_slice());
        let velocity = least_squares(&self.twist_map_child(&from.q), &target);
        let mut inverse = DMatrix::zeros(freedoms, freedoms);
        self.joint()
            .velocity_map_inverse(&from.q, inverse.as_mut_slice());
        inverse * velocity
    }

    /// Gauss–Newton from one start until no step brings the pose nearer.
    fn descend(&self, start: Vec<f64>, target: &Pose<f64>) -> Approach {
        let mut best = self.approach(start, target);
        for _ in 0..STEPS {
            let full = self.gauss_newton_step(&best);
            let shares = core::iter::successors(Some(1.0), |share| Some(0.5 * share));
            let nearer = shares.take(HALVINGS).find_map(|share: f64| {
                let phi = &full * share;
                let next = self.approach(self.moved(&best.q, &phi), target);
                (next.error.norm() < best.error.norm()).then_some(next)
            });
            match nearer {
                Some(next) => best = next,
                None => break,
            }
        }
        best
    }

    fn starts(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let freedoms = self.ranges.freedoms.len();
        let home = self.home();
        let elsewhere = STARTS
            .into_iter()
            .flat_map(move |size| (0..freedoms).flat_map(move |k| [(k, size), (k, -size)]));
        core::iter::once(home.clone()).chain(elsewhere.map(move |(k, size)| {
            let mut phi = DVector::zeros(freedoms);
            phi[k] = size;
            self.moved(&home, &phi)
        }))
    }
}

impl Mechanism {
    /// The Q of the joint under body `body` with `H(Q) = pose`: the joint's child frame in its parent frame.
    ///
    /// Gauss–Newton through the twist map and Φ, from home and, where that fails, from other starts. It converges to
    /// rounding. Where several Q have the same pose, the one that is found first is returned.
    ///
    /// # Errors
    /// When the pose is out of the joint's reach beyond [`REACH_TOLERANCE`]; no pose; no such body.
    pub fn configuration_from_pose(
        &self,
        body: usize,
        pose: &Pose<f64>,
    ) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        pose.check().map_err(|cause| StateError::Pose {
            joint: body.joint_name().into(),
            cause,
        })?;
        let limit = REACH_TOLERANCE * pose.translation.norm().max(1.0);
        let mut nearest: Option<Approach> = None;
        for start in body.starts() {
            let found = body.descend(start, pose);
            if found.error.norm() <= limit {
                return Ok(found.q);
            }
            if nearest
                .as_ref()
                .is_none_or(|best| found.error.norm() < best.error.norm())
            {
                nearest = Some(found);
            }
        }
        let error = nearest.map_or(Vector6::repeat(f64::INFINITY), |best| best.error);
        Err(StateError::OutOfReach {
            joint: body.joint_name().into(),
            angle: error.fixed_rows::<3>(0).norm(),
            distance: error.fixed_rows::<3>(3).norm(),
            limit,
        })
    }

    /// `Φ(home, ϕ)` of the joint under body `body`.
    ///
    /// # Errors
    /// NaN; wrong size; no such body; ϕ so large that Φ does not end on the manifold.
    pub fn configuration_from_local(
        &self,
        body: usize,
        phi: &[f64],
    ) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        check_size(
            body.joint_name(),
            "phi",
            body.ranges.freedoms.len(),
            phi.len(),
        )?;
        body.check_finite("phi", body.joint().freedoms(), phi)?;
        let moved = body.moved(&body.home(), &DVector::from_column_slice(phi));
        body.check_configuration(&moved)?;
        Ok(moved)
    }
}
