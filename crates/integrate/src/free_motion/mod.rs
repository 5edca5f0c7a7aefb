//! Bodies that no force but uniform gravity acts on, over steps of any length in closed form.
//!
//! A body that moves on its own in the world, freely or about a fixed point, turns as [`rotation`] says; its centre of mass flies on a parabola. What moves otherwise has no such
//! form, and is taken by the method itself.

mod elliptic;
mod rotation;

use super::StepFailure;
use super::flow::{Flow, multiply};
use super::step_state::StepState;
use super::stepper::Span;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{Body, Mechanism};
use hamel_runtime::spatial::Pose;
use nalgebra::{DMatrix, DVector, Matrix3, MatrixXx3, Vector3};
use rotation::Principal;

/// What rounding of entries of about 1 makes of a relation between joints' maps, many times over.
const ROUNDING: f64 = 1e-12;

/// Local coordinates of the configurations at which a joint is looked at beside home, as parts of their numbers: of no symmetry.
const LOOKS: [f64; 2] = [0.17, -0.29];

/// All bodies of a mechanism, each free.
///
/// Every state is that of the whole time since the first step, so that rounding does not add up from step to step.
pub(super) struct FreeBodies {
    bodies: Vec<FreeBody>,
    /// Where the first step began.
    start: Option<Start>,
    increment: Vec<f64>,
}

#[derive(Clone)]
struct Start {
    /// s.
    time: f64,
    configuration: Vec<f64>,
    speeds: Vec<f64>,
}

/// A body that turns about a point: its centre of mass, or a point that is fixed.
struct FreeBody {
    index: usize,
    /// The point in the joint's child frame, m.
    point: Vector3<f64>,
    /// Whether the point moves.
    flies: bool,
    principal: Principal,
}

impl FreeBodies {
    /// `None` where a force acts on a body, or a joint lets it neither move freely nor turn freely about a point.
    pub(super) fn new(mechanism: &Mechanism) -> Option<Self> {
        let is_left_alone = mechanism.elements().is_empty()
            && mechanism.drives().is_empty()
            && mechanism.constraints().is_empty()
            && mechanism.frictions().is_empty()
            && mechanism.stops().is_empty()
            && !mechanism.changes_with_time();
        let bodies = mechanism.bodies().iter().enumerate();
        let bodies = bodies.map(|(index, body)| FreeBody::new(mechanism, index, body));
        let bodies: Vec<FreeBody> = is_left_alone.then(|| bodies.collect()).flatten()?;
        let layout = mechanism.layout();
        (!bodies.is_empty()).then(|| Self {
            bodies,
            start: None,
            increment: vec![0.0; layout.freedoms + layout.speeds],
        })
    }

    /// Moves to the end of a step; `false` where a body has no closed form.
    pub(super) fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<bool, StepFailure> {
        let start = self.start.get_or_insert_with(|| Start {
            time,
            configuration: step_state.configuration.clone(),
            speeds: step_state.speeds().to_vec(),
        });
        let passed = time - start.time + step;
        let Start {
            mut configuration,
            mut speeds,
            ..
        } = start.clone();
        for body in &self.bodies {
            if !body.advance(&flow.mechanism, passed, &mut configuration, &mut speeds)? {
                return Ok(false);
            }
        }
        let mut y = speeds.clone();
        if !flow.y_is_speeds() {
            flow.dynamics().momenta(&configuration, &speeds, &mut y)?;
        }
        let (turned, pushed) = self.increment.split_at_mut(step_state.offset.len());
        for (_, body) in flow.mechanism.joints() {
            let own = &mut turned[body.ranges().freedoms.clone()];
            let base = body.configuration(&step_state.base);
            let there = body.configuration(&configuration);
            let found = body.joint().local(base, there, own);
            found.map_err(|cause| body.finite_map(cause))?;
        }
        for (turned, offset) in turned.iter_mut().zip(&step_state.offset) {
            *turned -= offset;
        }
        for ((pushed, y), before) in pushed.iter_mut().zip(&y).zip(&step_state.y) {
            *pushed = y - before;
        }
        step_state.move_by_increment(flow, &self.increment)?;
        Ok(true)
    }
}

impl FreeBody {
    fn new(mechanism: &Mechanism, index: usize, body: &Body) -> Option<Self> {
        let joint = body.joint();
        let is_alone = body.parent().is_none() && mechanism.carried(index).len() == 1;
        let is_plain = joint.structures().speed_basis.is_identity()
            && mechanism.armature(index).iter().all(|own| *own == 0.0)
            && mechanism.port_armature(index).iter().all(|own| *own == 0.0);
        if !is_alone || !is_plain {
            return None;
        }
        let (mass, placement) = (body.mass(), body.child_placement());
        let com = placement.transform_point(&mass.com);
        let turned = placement.rotation * mass.inertia_com * placement.rotation.transpose();
        let (point, flies) = match body.ranges().freedoms.len() {
            6 if mass.mass > 0.0 && moves_freely(body) => (com, true),
            3 => (fixed_point(body)?, false),
            _ => return None,
        };
        let arm = com - point;
        let weighs = mass.mass != 0.0 && *mechanism.gravity() != Vector3::zeros();
        if !flies && weighs && arm != Vector3::zeros() {
            return None;
        }
        let about = arm.norm_squared() * Matrix3::identity() - arm * arm.transpose();
        let principal = Principal::new(&(turned + mass.mass * about))?;
        Some(Self {
            index,
            point,
            flies,
            principal,
        })
    }

    /// Moves this body's Q and v̄ by so many seconds.
    fn advance(
        &self,
        mechanism: &Mechanism,
        step: f64,
        configuration: &mut [f64],
        speeds: &mut [f64],
    ) -> Result<bool, StepFailure> {
        let body = &mechanism.bodies()[self.index];
        let (own, ranges) = (body.joint(), body.ranges());
        let q = &mut configuration[ranges.configuration.clone()];
        let v = &mut speeds[ranges.speeds.clone()];
        let Pose {
            rotation,
            translation,
        } = own.pose(q);
        let mut twist = [0.0; 6];
        multiply(twist_map(body, q).as_slice(), v, &mut twist);
        let [angular, linear] = [0, 3].map(|at| Vector3::from_column_slice(&twist[at..at + 3]));
        let Some(turned) = self.principal.turn(&angular, step) else {
            return Ok(false);
        };
        let mut place = rotation * self.point + translation;
        let mut velocity = Vector3::zeros();
        if self.flies {
            let fall = body.joint_frame().rotation.transpose() * mechanism.gravity();
            velocity = rotation * (linear + angular.cross(&self.point));
            place += step * velocity + 0.5 * step * step * fall;
            velocity += step * fall;
        }
        let rotation = rotation * turned.rotation;
        let pose = Pose::new(rotation, place - rotation * self.point);
        let linear = rotation.transpose() * velocity - turned.angular.cross(&self.point);
        q.copy_from_slice(&mechanism.configuration_from_pose(self.index, &pose)?);
        let twist = DVector::from_iterator(6, turned.angular.iter().chain(&linear).copied());
        let found = twist_map(body, q).svd(true, true).solve(&twist, ROUNDING);
        let Ok(found) = found else {
            return Ok(false);
        };
        v.copy_from_slice(found.as_slice());
        Ok(true)
    }
}

/// X^c at Q, 6×K.
fn twist_map(body: &Body, q: &[f64]) -> DMatrix<f64> {
    let mut map = DMatrix::zeros(6, body.ranges().freedoms.len());
    body.joint().twist_map_child(q, map.as_mut_slice());
    map
}

/// X^c at home and at other configurations.
fn looks(body: &Body) -> impl Iterator<Item = DMatrix<f64>> {
    let home = body.home();
    let moved = LOOKS.map(|size| {
        let count = body.ranges().freedoms.len();
        let phi: Vec<f64> = (1..=count).map(|i| size * i as f64).collect();
        let mut q = home.clone();
        body.joint().retract(&home, &phi, &mut q);
        q
    });
    let all = core::iter::once(home.clone()).chain(moved);
    all.map(|q| twist_map(body, &q))
}

/// Whether a joint of six degrees of freedom lets a body move in any way.
fn moves_freely(body: &Body) -> bool {
    looks(body).all(|map| map.clone().svd(false, false).rank(ROUNDING) == 6)
}

/// The point of the child frame about which a joint of three degrees of freedom lets a body turn in any way.
fn fixed_point(body: &Body) -> Option<Vector3<f64>> {
    let point = |map: DMatrix<f64>| {
        let angular: MatrixXx3<f64> = map.rows(0, 3).fixed_columns::<3>(0).into_owned();
        let linear = map.rows(3, 3).fixed_columns::<3>(0).into_owned();
        let angular = Matrix3::from_column_slice(angular.as_slice()).try_inverse()?;
        // The linear velocity of the origin is the point × ω.
        let cross = Matrix3::from_column_slice(linear.as_slice()) * angular;
        let point = Vector3::new(cross.m32, cross.m13, cross.m21);
        let rest = cross - point.cross_matrix();
        (rest.amax() <= ROUNDING * point.amax().max(1.0)).then_some(point)
    };
    let mut points = looks(body).map(point);
    let first = points.next()??;
    let is_same = |other: Option<Vector3<f64>>| {
        other.is_some_and(|other| (other - first).amax() <= ROUNDING * first.amax().max(1.0))
    };
    points.all(is_same).then_some(first)
}
