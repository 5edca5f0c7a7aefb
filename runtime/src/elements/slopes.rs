//! How the generalised forces of elements change with ϕ and v̄.
//!
//! One unit of a local coordinate of joint k moves all that hangs on it by the twist Z. The recursion reads an element's wrench on a body as
//! one that is carried along with the body; what an element adds here is how its wrench changes beside that, projected on all speeds that move
//! the body.

use super::View;
use crate::dynamics::Sensitivity;
use crate::joint::MOST_FREEDOMS;
use crate::mechanism::Mechanism;
use crate::spatial::fused::{add_cross, cross, dot};
use crate::spatial::split;
use crate::steps::{Placement, Variation};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Matrix3, Vector3, Vector6};

/// An element whose slopes are known.
pub trait Slope {
    /// Adds `∂/∂ϕ` and `∂/∂v̄` of what [`Element::act`](super::Element::act) exerts.
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>);

    /// Why what it exerts has no derivative there, if it has none. Its slopes are then those of what has one.
    fn missing(&self, _view: &View<'_>) -> Option<&'static str> {
        None
    }
}

/// Where elements put how what they exert changes. What is said of a body that is not there makes all of it NaN.
#[derive(Debug)]
pub struct Slopes<'a> {
    /// X̄ of each body, one column per speed of its joint.
    pub(crate) columns: &'a [Vector6<f64>],
    /// One for each body and each degree of freedom of its joint.
    pub(crate) variations: &'a [Variation<f64>],
    pub(crate) into: Target<'a>,
}

/// Where slopes go.
#[derive(Debug)]
pub(crate) enum Target<'a> {
    /// All of them.
    Whole {
        /// `∂(generalised force)/∂ϕ`: a row a speed, a column a degree of freedom.
        by_local: &'a mut Sensitivity,
        /// `∂(generalised force)/∂v̄`.
        by_speeds: &'a mut Sensitivity,
    },
    /// Those of each joint's own forces by its own motion, and no others.
    Joints(&'a mut JointSlopes),
}

/// How each joint's own generalised forces change with its own ϕ and v̄.
#[derive(Clone, Debug)]
pub struct JointSlopes {
    joints: Vec<OwnSlopes>,
    /// The joint of each degree of freedom and of each speed.
    of_freedom: Vec<usize>,
    of_speed: Vec<usize>,
    /// Whether a joint's forces change with another's motion.
    couples: bool,
}

#[derive(Clone, Debug)]
struct OwnSlopes {
    freedoms: Range<usize>,
    speeds: Range<usize>,
    /// S×K and S×S, column by column.
    by_local: Vec<f64>,
    by_speeds: Vec<f64>,
}

impl JointSlopes {
    /// Zeros, of a mechanism.
    pub fn new(mechanism: &Mechanism) -> Self {
        let (mut of_freedom, mut of_speed) = (Vec::new(), Vec::new());
        let bodies = mechanism.bodies().iter().enumerate();
        let joints = bodies.map(|(index, body)| {
            let (freedoms, speeds) = (&body.ranges().freedoms, &body.ranges().speeds);
            of_freedom.resize(freedoms.end, index);
            of_speed.resize(speeds.end, index);
            OwnSlopes {
                by_local: vec![0.0; speeds.len() * freedoms.len()],
                by_speeds: vec![0.0; speeds.len() * speeds.len()],
                freedoms: freedoms.clone(),
                speeds: speeds.clone(),
            }
        });
        Self {
            joints: joints.collect(),
            of_freedom,
            of_speed,
            couples: false,
        }
    }

    /// Whether anything was left out: forces of a joint that change with another's motion.
    pub const fn leaves_out(&self) -> bool {
        self.couples
    }

    pub(crate) fn clear(&mut self) {
        self.couples = false;
        for own in &mut self.joints {
            own.by_local.fill(0.0);
            own.by_speeds.fill(0.0);
        }
    }

    /// `∂/∂ϕ` (S×K) and `∂/∂v̄` (S×S) of one joint's forces, column by column.
    pub fn of(&self, joint: usize) -> (&[f64], &[f64]) {
        let own = &self.joints[joint];
        (&own.by_local, &own.by_speeds)
    }

    fn add(&mut self, row: usize, column: Column, entry: f64) {
        let index = self.of_speed[row];
        let own = &mut self.joints[index];
        let (slopes, column) = match column {
            Column::Local(freedom) if self.of_freedom[freedom] == index => {
                (&mut own.by_local, freedom - own.freedoms.start)
            }
            Column::Speed(speed) if self.of_speed[speed] == index => {
                (&mut own.by_speeds, speed - own.speeds.start)
            }
            _ => {
                self.couples |= entry != 0.0;
                return;
            }
        };
        slopes[column * own.speeds.len() + row - own.speeds.start] += entry;
    }
}

/// A point of a body: which, and the way to it from the origin of the joint-child frame, world axes, as [`View::arm`] has it.
pub type End = (usize, Vector3<f64>);

/// A force F on the second of two points and −F on the first, and how it changes with the way x from the first to the second and with its
/// rate; world axes. A point that is `None` belongs to the world.
#[derive(Clone, Copy, Debug)]
pub struct PointForce {
    /// The points.
    pub ends: [Option<End>; 2],
    /// F, N.
    pub force: Vector3<f64>,
    /// `∂F/∂x`, N/m.
    pub by_way: Matrix3<f64>,
    /// `∂F/∂ẋ`, N·s/m.
    pub by_rate: Matrix3<f64>,
}

/// The signs with which a force acts on its two points.
pub(super) const SIGNS: [f64; 2] = [-1.0, 1.0];

/// A column of one of both matrices.
#[derive(Clone, Copy)]
enum Column {
    /// That of a degree of freedom.
    Local(usize),
    /// That of a speed.
    Speed(usize),
}

/// A point of a body, where it is and how it moves.
pub(super) struct Place {
    pub(super) body: usize,
    pub(super) position: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
}

impl Slopes<'_> {
    /// What was said makes no sense: NaN, which whoever takes derivatives finds.
    fn spoil(&mut self) {
        match &mut self.into {
            Target::Joints(slopes) => {
                for own in &mut slopes.joints {
                    own.by_local.fill(f64::NAN);
                    own.by_speeds.fill(f64::NAN);
                }
            }
            Target::Whole {
                by_local,
                by_speeds,
            } => {
                by_local.entries_mut().fill(f64::NAN);
                by_speeds.entries_mut().fill(f64::NAN);
            }
        }
    }

    /// Efforts of the joint under a body, with `∂τ/∂ϕ` and `∂τ/∂v`: K×K each, column by column.
    pub fn add_effort(
        &mut self,
        view: &View<'_>,
        body: usize,
        by_local: &[f64],
        by_velocity: &[f64],
    ) {
        let (Some(own), Some((joint, q))) = (
            view.mechanism.bodies().get(body),
            view.joint_and_configuration(body),
        ) else {
            return self.spoil();
        };
        let (freedoms, speeds) = (&own.ranges().freedoms, &own.ranges().speeds);
        let size = freedoms.len();
        if by_local.len() < size * size || by_velocity.len() < size * size {
            return self.spoil();
        }
        let (mut basis, mut turned) = (
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS * MOST_FREEDOMS],
        );
        let basis = &mut basis[..size * speeds.len()];
        let turned = &mut turned[..size * basis.len()];
        joint.speed_basis(q, basis);
        joint.speed_basis_gradient(q, turned);
        let v = &view.speeds[speeds.clone()];
        for (k, freedom) in freedoms.clone().enumerate() {
            let slice = &turned[k * basis.len()..(k + 1) * basis.len()];
            let velocity = combination(slice, v, size);
            let mut effort = combination(by_velocity, &velocity[..size], size);
            for (sum, entry) in effort.iter_mut().zip(&by_local[k * size..(k + 1) * size]) {
                *sum += entry;
            }
            self.project_effort(speeds, basis, Column::Local(freedom), &effort[..size]);
        }
        for (speed, column) in speeds.clone().zip(basis.chunks_exact(size.max(1))) {
            let effort = combination(by_velocity, column, size);
            self.project_effort(speeds, basis, Column::Speed(speed), &effort[..size]);
        }
    }

    /// A moment on a body that keeps its direction in the world, N·m.
    pub fn add_moment(&mut self, view: &View<'_>, body: usize, moment: &Vector3<f64>) {
        if body >= view.mechanism.bodies().len() {
            return self.spoil();
        }
        for index in path(view.mechanism, body) {
            let ranges = view.mechanism.bodies()[index].ranges();
            let own = ranges.freedoms.clone().zip(ranges.variations.clone());
            for (freedom, variation) in own {
                let (turn, _) = split(&self.variations[variation].local);
                let change = -cross(&turn, moment);
                let power =
                    |column: &Vector6<f64>, _: &Vector3<f64>| dot(&split(column).0, &change);
                self.project(view, body, Column::Local(freedom), power);
            }
        }
    }

    /// A force between two points.
    pub fn add_point_force(&mut self, view: &View<'_>, force: &PointForce) {
        let mut bodies = force.ends.iter().flatten().map(|(body, _)| *body);
        if bodies.any(|body| body >= view.mechanism.bodies().len()) {
            return self.spoil();
        }
        let places = force
            .ends
            .map(|end| end.and_then(|end| Place::new(view, end)));
        for (place, sign) in places.iter().zip(SIGNS) {
            let Some(place) = place else {
                continue;
            };
            for index in path(view.mechanism, place.body) {
                let ranges = view.mechanism.bodies()[index].ranges();
                let Some(placement) = view.motions.placement(index) else {
                    return self.spoil();
                };
                let arm = place.position - placement.origin;
                let own = ranges.freedoms.clone().zip(ranges.variations.clone());
                for (freedom, variation) in own {
                    let Variation { local, drift, .. } = &self.variations[variation];
                    let (turn, moved) = (split(local).0, at(local, &arm));
                    let rate = add_cross(&at(drift, &arm), &turn, &place.velocity);
                    let change = (force.by_way * moved + force.by_rate * rate) * sign;
                    let carried = cross(&turn, &force.force) * sign;
                    let column = Column::Local(freedom);
                    self.project_force(view, &places, column, &change);
                    self.project_point(view, place, column, &-carried);
                }
                for (speed, column) in ranges.speeds.clone().zip(ranges.columns.clone()) {
                    let rate = at(&self.columns[column], &arm);
                    let change = force.by_rate * rate * sign;
                    self.project_force(view, &places, Column::Speed(speed), &change);
                }
            }
        }
    }

    /// Adds `S̄ᵀ effort` of one joint.
    fn project_effort(
        &mut self,
        speeds: &Range<usize>,
        basis: &[f64],
        column: Column,
        effort: &[f64],
    ) {
        for (row, own) in speeds.clone().zip(basis.chunks_exact(effort.len().max(1))) {
            let entry = own.iter().zip(effort).map(|(s, t)| s * t).sum();
            self.add(row, column, entry);
        }
    }

    /// Adds what a `change` of the force between two points does to all speeds.
    fn project_force(
        &mut self,
        view: &View<'_>,
        places: &[Option<Place>; 2],
        column: Column,
        change: &Vector3<f64>,
    ) {
        for (place, sign) in places.iter().zip(SIGNS) {
            if let Some(place) = place {
                self.project_point(view, place, column, &(change * sign));
            }
        }
    }

    /// Adds what a `change` of a force at a point does to all speeds.
    fn project_point(
        &mut self,
        view: &View<'_>,
        place: &Place,
        column: Column,
        change: &Vector3<f64>,
    ) {
        let power = |twist: &Vector6<f64>, origin: &Vector3<f64>| {
            dot(&at(twist, &(place.position - origin)), change)
        };
        self.project(view, place.body, column, power);
    }

    /// Adds the power of something on `body` with each column of X̄ that moves it; `power` is handed the column and the origin at which it is read.
    fn project(
        &mut self,
        view: &View<'_>,
        body: usize,
        column: Column,
        power: impl Fn(&Vector6<f64>, &Vector3<f64>) -> f64,
    ) {
        for index in path(view.mechanism, body) {
            let Some(Placement { origin, .. }) = view.motions.placement(index) else {
                return self.spoil();
            };
            let ranges = view.mechanism.bodies()[index].ranges();
            for (speed, own) in ranges.speeds.clone().zip(ranges.columns.clone()) {
                let entry = power(&self.columns[own], origin);
                self.add(speed, column, entry);
            }
        }
    }

    fn add(&mut self, row: usize, column: Column, entry: f64) {
        match &mut self.into {
            Target::Joints(slopes) => slopes.add(row, column, entry),
            Target::Whole {
                by_local,
                by_speeds,
            } => match column {
                Column::Local(freedom) => by_local.add(row, freedom, entry),
                Column::Speed(speed) => by_speeds.add(row, speed, entry),
            },
        }
    }
}

/// The body and all that it hangs on, up to the root.
pub(super) fn path(mechanism: &Mechanism, body: usize) -> impl Iterator<Item = usize> + '_ {
    let parent = |index: &usize| mechanism.bodies()[*index].parent();
    core::iter::successors(Some(body), parent)
}

impl Place {
    pub(super) fn new(view: &View<'_>, (body, arm): End) -> Option<Self> {
        let (turn, slide) = split(view.motions.twist(body)?);
        Some(Self {
            body,
            position: view.motions.placement(body)?.origin + arm,
            velocity: add_cross(&slide, &turn, &arm),
        })
    }
}

/// The velocity that a twist gives the end of an arm.
pub(super) fn at(twist: &Vector6<f64>, arm: &Vector3<f64>) -> Vector3<f64> {
    let (turn, slide) = split(twist);
    add_cross(&slide, &turn, arm)
}

/// The columns of a matrix of `rows` rows, weighted.
fn combination(matrix: &[f64], weights: &[f64], rows: usize) -> [f64; MOST_FREEDOMS] {
    let mut sum = [0.0; MOST_FREEDOMS];
    for (column, weight) in matrix.chunks_exact(rows.max(1)).zip(weights) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += entry * weight;
        }
    }
    sum
}
