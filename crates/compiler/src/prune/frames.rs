//! Frames for equations: each body's may slide and turn along what its joint does not notice, so that constant placements become sparse.
//!
//! A frame on the child side of a joint may move by any g that leaves the columns of X^c and of its derivative as they are: a turn about
//! the direction of all of them, a shift along the direction of all rotations (anywhere, where there are none). A shift is constant on the parent side as well,
//! `T(R d) H = H T(d)`, if the rotation R of H(Q) takes its direction to a constant one; there it is written, as part of the placement. The two directions
//! differ where H(Q) has a constant turn: links of a mechanism that is one joint, each placed in the one before it.

use super::{Fixed, Link, rotation};
use crate::graph::{Argument, Sym, record};
use crate::joint::Joint;
use crate::model::{Body, Inertia, Model};
use crate::spatial::{Step, Twist};
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use num_traits::Zero;

/// Rounds of improvement: the frames of neighbours depend on each other.
const ROUNDS: usize = 4;
/// What one number of a shift costs, in operations: two products and sums in each of the sweeps.
const SHIFT: usize = 10;
/// What a turn by no quarter costs.
const TURN: usize = 60;
/// What a turn costs that is taken together with the joint's own.
const MERGED: usize = 6;
/// Components of shifts below this fraction of the shift are rounding.
const ROUNDING: f64 = 1e-15;

/// How a body's frame may move.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Freedom {
    /// Along which axes, each with its direction in the joint's parent frame.
    shifts: [Option<Vector3<f64>>; 3],
    /// About z.
    turns: bool,
    /// Whether the joint's pose ends with a turn about z, which takes up others.
    absorbs: bool,
}

/// Where a body's frame stands in the joint's child frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moved {
    shift: Vector3<f64>,
    cos: f64,
    sin: f64,
}

impl Moved {
    const NOT: Self = Self {
        shift: Vector3::new(0.0, 0.0, 0.0),
        cos: 1.0,
        sin: 0.0,
    };

    fn turn(&self) -> Pose<f64> {
        Fixed::pose(&[Fixed::Turn(2, self.cos, self.sin)])
    }

    fn pose(&self) -> Pose<f64> {
        Pose::from_translation(self.shift).compose(&self.turn())
    }
}

/// The frames of all bodies.
pub struct Placed<'a> {
    model: &'a Model,
    /// Joint frame of each body in the child frame of the parent's joint.
    joints: Vec<Pose<f64>>,
    freedoms: Vec<Freedom>,
    moved: Vec<Moved>,
}

impl<'a> Placed<'a> {
    /// The joints' child frames, or, if they `may_move`, frames in which constant placements cost least.
    pub fn new(model: &'a Model, may_move: bool) -> Self {
        let joint = |body: &Body| match body.parent {
            Some(parent) => model.bodies[parent]
                .child_placement
                .compose(&body.placement),
            None => body.placement,
        };
        let mut placed = Self {
            model,
            joints: model.bodies.iter().map(joint).collect(),
            freedoms: model.bodies.iter().map(freedom).collect(),
            moved: vec![Moved::NOT; model.bodies.len()],
        };
        let rounds = if may_move { ROUNDS } else { 0 };
        for _ in 0..rounds {
            let before = placed.moved.clone();
            (0..model.bodies.len()).for_each(|body| placed.improve(body));
            // What one round leaves as it is, all others would.
            if placed.moved == before {
                break;
            }
        }
        placed
    }

    /// Placement of a body's joint between the frames of equations, without what turns on the child side.
    fn placement(&self, body: usize) -> Pose<f64> {
        self.joint_frame(body).compose(&self.shifted(body))
    }

    /// The shift of a body's frame on the parent side of its joint.
    fn shifted(&self, body: usize) -> Pose<f64> {
        let shift = &self.moved[body].shift;
        let parts = self.freedoms[body].shifts.iter().zip(shift.iter());
        let parts = parts.filter_map(|(direction, by)| Some(direction.as_ref()? * *by));
        Pose::from_translation(parts.sum())
    }

    /// The joint's parent frame, as this body sees it, in the frame of the parent's equations.
    pub fn joint_frame(&self, body: usize) -> Pose<f64> {
        match self.model.bodies[body].parent {
            Some(parent) => self.moved[parent]
                .pose()
                .inverse()
                .compose(&self.joints[body]),
            None => self.joints[body],
        }
    }

    fn steps(&self, body: usize) -> Vec<Fixed> {
        Fixed::steps(&self.placement(body))
    }

    /// What the placement of a body's joint costs.
    fn cost(&self, body: usize) -> usize {
        let steps = self.steps(body);
        let last = steps.len().saturating_sub(1);
        let one = |(place, step): (usize, &Fixed)| match *step {
            Fixed::Shift(by) => SHIFT * by.iter().filter(|entry| **entry != 0.0).count(),
            Fixed::Turn(_, cos, sin) if cos == 0.0 || sin == 0.0 => 0,
            Fixed::Turn(2, ..) if place == last && self.freedoms[body].absorbs => MERGED,
            Fixed::Turn(..) => TURN,
        };
        let Moved { cos, sin, .. } = self.moved[body];
        let after = if cos == 0.0 || sin == 0.0 { 0 } else { MERGED };
        after + steps.iter().enumerate().map(one).sum::<usize>()
    }

    fn children(&self, body: usize) -> impl Iterator<Item = usize> {
        let bodies = self.model.bodies.iter().enumerate();
        bodies.filter_map(move |(child, other)| (other.parent == Some(body)).then_some(child))
    }

    /// Moves a body's frame to where it and its children cost least.
    fn improve(&mut self, body: usize) {
        let around = |placed: &Self| {
            placed.cost(body)
                + placed
                    .children(body)
                    .map(|child| placed.cost(child))
                    .sum::<usize>()
        };
        for candidate in self.candidates(body) {
            let (before, known) = (self.moved[body], around(self));
            self.moved[body] = candidate;
            if around(self) >= known {
                self.moved[body] = before;
            }
        }
    }

    /// Frames in which one number of a placement vanishes. Of those that cost the same the first is taken: turns, then shifts along the
    /// body's own placement, so that like bodies come to stand alike (on common normals, where joints are hinges).
    fn candidates(&self, body: usize) -> Vec<Moved> {
        let (freedom, now) = (self.freedoms[body], self.moved[body]);
        let mut candidates = vec![];
        let children: Vec<Pose<f64>> = self
            .children(body)
            .map(|child| self.joints[child].compose(&self.shifted(child)))
            .collect();
        if freedom.turns {
            candidates.push(Moved {
                cos: 1.0,
                sin: 0.0,
                ..now
            });
            for child in &children {
                if let Some(Fixed::Turn(2, cos, sin)) = rotation::turns(&child.rotation).first() {
                    candidates.push(Moved {
                        cos: *cos,
                        sin: *sin,
                        ..now
                    });
                }
                let (x, y) = (child.translation.x, child.translation.y);
                let length = x.hypot(y);
                if length > 0.0 {
                    candidates.push(Moved {
                        cos: x / length,
                        sin: y / length,
                        ..now
                    });
                }
            }
        }
        for (axis, direction) in freedom.shifts.iter().enumerate() {
            let Some(direction) = direction else { continue };
            let mut to = |entry: f64| {
                let mut moved = now;
                moved.shift[axis] = entry;
                candidates.push(moved);
            };
            to(0.0);
            let still = self.placement(body);
            let direction = still.rotation * direction;
            for i in (0..3).filter(|&i| direction[i].abs() > 0.1) {
                to(now.shift[axis] - still.translation[i] / direction[i]);
            }
            children
                .iter()
                .for_each(|child| to(child.translation[axis]));
        }
        candidates
    }

    /// Where a body's frame stands in the joint's child frame.
    pub fn moved(&self, body: usize) -> Pose<f64> {
        self.moved[body].pose()
    }

    /// The links in these frames, each with its body's own inertia.
    pub fn links(&self) -> Vec<Link> {
        let link = |(index, body): (usize, &Body)| {
            let Moved { cos, sin, .. } = self.moved[index];
            let to_joint = self.moved(index).inverse().compose(&body.child_placement);
            Link {
                placement: self.steps(index),
                after: ((cos, sin) != (1.0, 0.0))
                    .then_some(Fixed::Turn(2, cos, sin))
                    .into_iter()
                    .collect(),
                body: to_joint,
                dropped: Vector3::zeros(),
                inertia: tidy(&Inertia::of(&body.mass).seen_from(&to_joint)),
            }
        };
        self.model.bodies.iter().enumerate().map(link).collect()
    }
}

/// Without entries that are rounding of the others.
pub fn clean(shift: Vector3<f64>) -> Vector3<f64> {
    let limit = ROUNDING * shift.norm();
    shift.map(|entry| if entry.abs() <= limit { 0.0 } else { entry })
}

/// Without entries that are rounding of the others: of squares, of both moments of inertia that they are part of.
fn tidy(inertia: &Inertia) -> Inertia {
    let second = &inertia.second;
    let limit = |i: usize, j: usize| {
        let [a, b] = [1, 2].map(|k| second[(i, i)] + second[((i + k) % 3, (i + k) % 3)]);
        let size = if i == j {
            a.abs().min(b.abs())
        } else {
            second.trace().abs()
        };
        ROUNDING * size
    };
    let entry = |i: usize, j: usize| match second[(i, j)] {
        entry if entry.abs() <= limit(i, j) => 0.0,
        entry => entry,
    };
    Inertia {
        first: clean(inertia.first),
        second: Matrix3::from_fn(entry),
        ..*inertia
    }
}

/// How the frame of a body may move.
fn freedom(body: &Body) -> Freedom {
    body.joint.frames.get(&body.parameters, || found(body))
}

fn found(body: &Body) -> Freedom {
    let shape = body.joint.derived.shape;
    let (freedom, _) = record(|| {
        let q: Vec<Sym> = (0..shape.configuration)
            .map(|i| Sym::input(Argument::Configuration, i))
            .collect();
        let speeds: Vec<Sym> = (0..shape.speeds)
            .map(|i| Sym::input(Argument::Speeds, i))
            .collect();
        let joint = Joint::new(&body.joint, &body.parameters, &q, &speeds);
        let mut columns = joint.freedoms();
        columns.push(joint.bias_acceleration());
        let along_z = |column: &Twist, angular: bool| {
            let part = if angular {
                &column.angular
            } else {
                &column.linear
            };
            part.x.is_zero() && part.y.is_zero()
        };
        let still = columns
            .iter()
            .all(|column| column.angular.iter().all(Zero::is_zero));
        let slides = columns.iter().all(|column| along_z(column, true));
        let rotation = joint.rotation();
        let shift = |axis: usize| -> Option<Vector3<f64>> {
            let [x, y, z] = [0, 1, 2].map(|row| rotation[(row, axis)].number());
            let keeps = if axis == 2 { slides } else { still };
            keeps.then_some(Vector3::new(x?, y?, z?))
        };
        Freedom {
            shifts: [0, 1, 2].map(shift),
            turns: slides && columns.iter().all(|column| along_z(column, false)),
            absorbs: matches!(joint.pose().last(), Some(Step::Turn { axis: 2, .. })),
        }
    });
    freedom
}
