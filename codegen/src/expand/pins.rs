//! Pins: where they are, about and along which axes bodies move there, and which efforts act there.

use super::motion::Motion;
use super::{Expansion, Flow, Forbidden, ports};
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{Axis, JointSpec, Pin, PinEnd, PoseExpr};

/// Point, axis of turning and axis of sliding of each pin, in the frame that the joint hangs on; an axis that is not there is 0.
const PLACE: usize = 9;

/// An effort that acts at a pin: as a couple about its axis of turning, or as a force along its axis of sliding, of the second body on the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinDrive {
    /// Which effort.
    pub source: Source,
    /// Whether it is a couple, else a force.
    pub turns: bool,
    /// Whether it acts against the axis.
    pub reversed: bool,
}

/// An effort on a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// On this degree of freedom.
    Freedom(usize),
    /// At this port.
    Port(usize),
}

/// Points and axes, a row for each pin.
pub fn places(spec: &JointSpec, ideal: &Ideal) -> Matrix {
    let row = |pin: &Pin| {
        let axes = [pin.about, pin.along].map(|axis| match axis {
            Some(axis) => in_parent(spec, &pin.ends[1], &direction(axis)),
            None => vec![Expr::zero(); 3],
        });
        [point(spec, &pin.ends[1]), axes.concat()].concat()
    };
    let rows = spec.pins.iter().flat_map(|pin| row(&pin.value));
    let rows: Vec<Expr> = rows.map(|entry| ideal.simplest(&entry)).collect();
    Matrix::from_fn(spec.pins.len(), PLACE, |i, j| rows[PLACE * i + j].clone())
}

/// The point in the frame that the joint hangs on.
pub fn point(spec: &JointSpec, end: &PinEnd) -> Vec<Expr> {
    let turned = in_parent(spec, end, &end.point);
    match pose(spec, end) {
        Some(pose) => sum(&turned, pose.translation.entries()),
        None => turned,
    }
}

/// A vector in the axes of the body of `end`, in those of the frame that the joint hangs on.
pub fn in_parent(spec: &JointSpec, end: &PinEnd, vector: &[Expr]) -> Vec<Expr> {
    match pose(spec, end) {
        Some(pose) => (pose.rotation.times(&Matrix::column_vector(vector.to_vec()))).column(0),
        None => vector.to_vec(),
    }
}

fn pose<'s>(spec: &'s JointSpec, end: &PinEnd) -> Option<&'s PoseExpr> {
    let mut poses = spec.poses();
    poses.nth(end.body?).map(|pose| &pose.value)
}

/// The axis in its frame.
pub fn direction(axis: Axis) -> Vec<Expr> {
    Matrix::identity(3).column(match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    })
}

/// How a point moves in the second body, less how it moves in the first, along ϕ_k: what sliding makes up for.
pub fn slip(spec: &JointSpec, pin: &Pin, motion: &Motion, k: usize) -> Vec<Expr> {
    let [first, second] = pin.ends.each_ref().map(|end| {
        let moved = end.point.iter().map(|entry| motion.along(entry, k));
        in_parent(spec, end, &moved.collect::<Vec<_>>())
    });
    difference(&second, &first)
}

/// The efforts that act at each pin. Where relations alone give how Q moves, the rate of the pin is that of the port along every displacement, also those
/// that relations forbid; an effort on v acts where the pin's rate is that v, and stands still along N.
pub fn drives(spec: &JointSpec, x: &Expansion, ideal: &Ideal) -> Vec<Vec<PinDrive>> {
    let rates = Rates::new(spec, x, ideal);
    let of_pin = |pin: &Pin| {
        let mut drives = vec![];
        for turns in [true, false] {
            let Some(rate) = rates.of_pin(pin, turns) else {
                continue;
            };
            let sources = (0..rates.ports.rows()).map(Source::Port);
            let sources = sources.chain((0..x.shape.freedoms).map(Source::Freedom));
            for source in sources {
                let reversed = [false, true].into_iter();
                let mut reversed =
                    reversed.filter(|&reversed| rates.agree(&rate, source, reversed));
                drives.extend(reversed.next().map(|reversed| PinDrive {
                    source,
                    turns,
                    reversed,
                }));
            }
        }
        drives
    };
    let mut all: Vec<Vec<PinDrive>> = spec.pins.iter().map(|pin| of_pin(&pin.value)).collect();
    keep_first(&mut all);
    all
}

/// An effort acts at one pin: the first whose rate is its own.
fn keep_first(all: &mut [Vec<PinDrive>]) {
    let mut seen: Vec<Source> = vec![];
    for drives in all {
        drives.retain(|drive| !seen.contains(&drive.source));
        seen.extend(drives.iter().map(|drive| drive.source));
    }
}

/// Twists of the bodies and rates of ports along some displacements.
struct Rates<'a> {
    spec: &'a JointSpec,
    ideal: &'a Ideal,
    flow: Option<&'a Flow>,
    /// In the child frames, one below the other.
    twists: &'a Matrix,
    ports: Matrix,
    /// Where there is no flow: v by the displacement, S₀.
    velocity_map: &'a Matrix,
}

impl<'a> Rates<'a> {
    fn new(spec: &'a JointSpec, x: &'a Expansion, ideal: &'a Ideal) -> Self {
        let (twists, ports) = match &x.forbidden {
            Some(Forbidden { twists, ports }) => (twists, ports.clone()),
            None => (
                &x.jacobian.child,
                ports::gradient(&spec.ports, &x.motion, ideal),
            ),
        };
        Self {
            spec,
            ideal,
            flow: x.flow.as_ref(),
            twists,
            ports,
            velocity_map: &x.velocity_map.base,
        }
    }

    /// The rate at which the first body turns or slides relative to the second, by the displacement; `None` where it does not.
    fn of_pin(&self, pin: &Pin, turns: bool) -> Option<Vec<Expr>> {
        let axis = match turns {
            true => pin.about?,
            false => pin.along?,
        };
        let axis = in_parent(self.spec, &pin.ends[1], &direction(axis));
        let point = point(self.spec, &pin.ends[1]);
        let rate = |d: usize| {
            let [first, second] =
                (pin.ends.each_ref()).map(|end| self.velocity(end, &point, turns, d));
            product(&axis, &difference(&first, &second))
        };
        Some((0..self.twists.columns()).map(rate).collect())
    }

    /// Angular velocity of a body, or the velocity of its point that is there, along displacement d; in the frame that the joint hangs on.
    fn velocity(&self, end: &PinEnd, point: &[Expr], turns: bool, d: usize) -> Vec<Expr> {
        let (Some(body), Some(pose)) = (end.body, pose(self.spec, end)) else {
            return vec![Expr::zero(); 3];
        };
        let part = |first: usize| {
            let own = (0..3).map(|i| self.twists.at(6 * body + first + i, d).clone());
            in_parent(self.spec, end, &own.collect::<Vec<_>>())
        };
        let angular = part(0);
        if turns {
            return angular;
        }
        let arm = difference(point, pose.translation.entries());
        let turned = Matrix::tilde(&angular).times(&Matrix::column_vector(arm));
        sum(&part(3), turned.entries())
    }

    /// Whether a pin's rate is that with which the effort does work, or its opposite.
    fn agree(&self, rate: &[Expr], source: Source, reversed: bool) -> bool {
        let rate: Vec<Expr> = match reversed {
            true => rate.iter().map(|entry| -entry).collect(),
            false => rate.to_vec(),
        };
        let same = |a: &[Expr], b: &[Expr]| {
            let mut pairs = a.iter().zip(b);
            pairs.all(|(a, b)| self.ideal.vanishes(&(a - b).without_arcsines()))
        };
        match (source, self.flow) {
            (Source::Port(port), _) => {
                let row = self.ports.select_rows(&[port]);
                same(&rate, row.entries())
            }
            (Source::Freedom(k), Some(flow)) => {
                let row = Matrix::column_vector(rate).transpose();
                let (along, across) = (row.times(&flow.tangent), row.times(&flow.normal));
                let wanted = Matrix::identity(flow.tangent.columns()).column(k);
                let none = vec![Expr::zero(); flow.normal.columns()];
                same(along.entries(), &wanted) && same(across.entries(), &none)
            }
            (Source::Freedom(k), None) => {
                let row = self.velocity_map.select_rows(&[k]);
                same(&rate, row.entries())
            }
        }
    }
}

fn sum(a: &[Expr], b: &[Expr]) -> Vec<Expr> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// a − b.
pub fn difference(a: &[Expr], b: &[Expr]) -> Vec<Expr> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn product(a: &[Expr], b: &[Expr]) -> Expr {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
