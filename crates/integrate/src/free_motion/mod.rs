//! Bodies that no force but uniform gravity acts on, over steps of any length in closed form.
//!
//! A body that moves on its own in the world, freely or about a fixed point, turns as [`rotation`] says; its centre of mass flies on a parabola. What moves otherwise has no such
//! form, and is taken by the method itself.

mod elliptic;
mod rotation;

use super::flow::{Flow, multiply};
use super::step_state::StepState;
use super::stepper::Span;
use super::{State, StepFailure};
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{Body, Mechanism};
use hamel_runtime::spatial::Pose;
use nalgebra::{DMatrix, DVector, Matrix3, MatrixXx3, Vector3};
use rotation::{Principal, Spin, Turned};

/// What rounding of entries of about 1 makes of a relation between joints' maps, many times over.
const ROUNDING: f64 = 1e-12;

/// Local coordinates of the configurations at which a joint is looked at beside home, as parts of their numbers: of no symmetry.
const LOOKS: [f64; 2] = [0.17, -0.29];

/// All bodies of a mechanism, each free.
///
/// Every state is that of the whole time since the first step, so that rounding does not add up from step to step.
pub(super) struct FreeBodies {
    bodies: Vec<FreeBody>,
    start: Start,
    increment: Vec<f64>,
}

/// Where the first step begins.
#[derive(Default)]
struct Start {
    /// s; `None` before it.
    time: Option<f64>,
    configuration: Vec<f64>,
    speeds: Vec<f64>,
    /// How each body turns; `None` where one has no closed form.
    spins: Option<Vec<Spin>>,
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
            start: Start::default(),
            increment: vec![0.0; layout.freedoms + layout.speeds],
        })
    }

    /// Whether a mechanism has none but free bodies, each with a closed form from a state on.
    pub(super) fn have_form(mechanism: &Mechanism, state: &State) -> bool {
        Self::new(mechanism).is_some_and(|mut free| {
            free.begin(mechanism, &state.configuration, &state.speeds);
            free.start.spins.is_some()
        })
    }

    /// Moves to the end of a step; `false` where a body has no closed form.
    pub(super) fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<bool, StepFailure> {
        let begins = self.start.time.is_none();
        let start = *self.start.time.get_or_insert(time);
        if begins {
            let (q, speeds) = (&step_state.configuration, step_state.speeds());
            self.begin(&flow.mechanism, q, speeds);
        }
        let Some(spins) = &self.start.spins else {
            return Ok(false);
        };
        let mut configuration = self.start.configuration.clone();
        let mut speeds = self.start.speeds.clone();
        for (body, spin) in self.bodies.iter().zip(spins) {
            let Some(turned) = spin.after(time - start + step) else {
                return Ok(false);
            };
            let passed = (time - start + step, turned);
            let state = (&mut *configuration, &mut *speeds);
            if !body.advance(&flow.mechanism, passed, state)? {
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

    fn begin(&mut self, mechanism: &Mechanism, configuration: &[f64], speeds: &[f64]) {
        let spin = |own: &FreeBody| {
            let body = &mechanism.bodies()[own.index];
            let [angular, _] = own.velocities(body, configuration, speeds);
            own.principal.spin(&angular)
        };
        self.start.spins = self.bodies.iter().map(spin).collect();
        self.start.configuration = configuration.to_vec();
        self.start.speeds = speeds.to_vec();
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

    /// Angular and linear velocity of the child frame, in its own axes, rad/s and m/s.
    fn velocities(&self, body: &Body, configuration: &[f64], speeds: &[f64]) -> [Vector3<f64>; 2] {
        let map = twist_map(body, body.configuration(configuration));
        let mut twist = [0.0; 6];
        multiply(
            map.as_slice(),
            &speeds[body.ranges().speeds.clone()],
            &mut twist,
        );
        [0, 3].map(|at| Vector3::from_column_slice(&twist[at..at + 3]))
    }

    /// Moves this body's Q and v̄ by so many seconds, in which it has turned; `false` where v̄ is not found.
    fn advance(
        &self,
        mechanism: &Mechanism,
        (step, turned): (f64, Turned),
        (configuration, speeds): (&mut [f64], &mut [f64]),
    ) -> Result<bool, StepFailure> {
        let body = &mechanism.bodies()[self.index];
        let [angular, linear] = self.velocities(body, configuration, speeds);
        let q = &mut configuration[body.ranges().configuration.clone()];
        let Pose {
            rotation,
            translation,
        } = body.joint().pose(q);
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
        speeds[body.ranges().speeds.clone()].copy_from_slice(found.as_slice());
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
