//! A body at one configuration in extended precision: what each of its ten parameters does.

use super::{BITS, named, size, zero};
use crate::model::Body;
use hamel_codegen::matrix::Matrix;
use hamel_codegen::precise::{Point, Precise};
use hamel_runtime::spatial::Pose;

type Vector = [Precise; 3];
type Square = [Vector; 3];

/// An inertia by mass, first moment and second moments, in the order of [`Inertia::parameters`](crate::model::Inertia::parameters): one of them 1, the others 0.
struct Unit {
    mass: Precise,
    first: Vector,
    second: Square,
}

/// A body at one configuration.
pub(super) struct Sample {
    /// The child frame in the parent's.
    rotation: Square,
    translation: Vector,
    /// Twists of the child by ϕ̇, in its own frame: angular parts before linear ones.
    pub twists: Vec<(Vector, Vector)>,
    units: Vec<Unit>,
}

impl Sample {
    /// The body of a joint whose parent frame has this placement, as the body sees it, in units of length of `unit` metres.
    pub(super) fn new(body: &Body, placement: &Pose<f64>, point: Point, unit: f64) -> Self {
        let derived = &body.joint.derived;
        let point = named(body, point);
        let pose = &derived.spec.pose.value;
        let fixed = |i: usize, j: usize| Precise::from_f64(placement.rotation[(i, j)], BITS);
        let fixed: Square = std::array::from_fn(|i| std::array::from_fn(|j| fixed(i, j)));
        let rotation = square(&point.matrix(&pose.rotation));
        let at = vector(&point.matrix(&pose.translation));
        let turned = turned(&fixed, &at);
        let shift = |i: usize| Precise::from_f64(placement.translation[i], BITS);
        let inverse = Precise::integer(1, BITS) / Precise::from_f64(unit, BITS);
        let twists = &derived.local_twist_map;
        let twist = |k: usize| {
            let (angular, linear) = column(&point, twists, k);
            (angular, linear.map(|entry| &entry * &inverse))
        };
        Self {
            rotation: product(&fixed, &rotation),
            translation: std::array::from_fn(|i| &(&turned[i] + &shift(i)) * &inverse),
            twists: (0..twists.columns()).map(twist).collect(),
            units: (0..10).map(Unit::new).collect(),
        }
    }

    /// The binary logarithm of the largest entry of twist j.
    pub(super) fn size(&self, j: usize) -> f64 {
        let (angular, linear) = &self.twists[j];
        angular
            .iter()
            .chain(linear)
            .map(size)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Divides twist j by that power of two.
    pub(super) fn lessen(&mut self, j: usize, power: i32) {
        let (angular, linear) = &mut self.twists[j];
        let entries = angular.iter_mut().chain(linear);
        entries.for_each(|entry| *entry = entry.halved(power));
    }

    /// The distance of the child frame from the parent's, in entries.
    pub(super) fn distance(&self) -> f64 {
        let entries = self.translation.iter().map(|entry| entry.to_f64().abs());
        entries.fold(0.0, f64::max)
    }

    /// The ten parameters, in the parent's frame, of parameter n.
    pub(super) fn in_parent(&self, n: usize) -> [Precise; 10] {
        let (unit, p) = (&self.units[n], &self.translation);
        let first = turned(&self.rotation, &unit.first);
        let second = product(
            &product(&self.rotation, &unit.second),
            &transposed(&self.rotation),
        );
        let moved = |i: usize, j: usize| {
            let mixed = &(&p[i] * &first[j]) + &(&first[i] * &p[j]);
            let shifted = &(&p[i] * &p[j]) * &unit.mass;
            &(&second[i][j] + &mixed) + &shifted
        };
        let place = |i: usize| &first[i] + &(&p[i] * &unit.mass);
        [
            unit.mass.clone(),
            place(0),
            place(1),
            place(2),
            moved(0, 0),
            moved(1, 1),
            moved(2, 2),
            moved(0, 1),
            moved(0, 2),
            moved(1, 2),
        ]
    }

    /// The momentum of parameter n by twist j, in the parent's frame: moment before force.
    pub(super) fn wrench_on_parent(&self, n: usize, j: usize) -> [Precise; 6] {
        let (moment, force) = self.units[n].momentum(&self.twists[j]);
        let force = turned(&self.rotation, &force);
        let arm = cross(&self.translation, &force);
        let moment = turned(&self.rotation, &moment);
        let [x, y, z]: Vector = std::array::from_fn(|i| &moment[i] + &arm[i]);
        let [fx, fy, fz] = force;
        [x, y, z, fx, fy, fz]
    }

    /// What parameter n has to do with twists j and k: x_jᵀ N x_k.
    pub(super) fn power(&self, n: usize, j: usize, k: usize) -> Precise {
        let (moment, force) = self.units[n].momentum(&self.twists[k]);
        let (angular, linear) = &self.twists[j];
        dot(angular, &moment) + dot(linear, &force)
    }
}

impl Unit {
    fn new(n: usize) -> Self {
        let is = |place: usize| Precise::integer(i64::from(place == n), BITS);
        Self {
            mass: is(0),
            first: [is(1), is(2), is(3)],
            second: [
                [is(4), is(7), is(8)],
                [is(7), is(5), is(9)],
                [is(8), is(9), is(6)],
            ],
        }
    }

    /// `[I, mc~; −mc~, m 1]` times a twist, with `I = tr(J) 1 − J`.
    fn momentum(&self, (angular, linear): &(Vector, Vector)) -> (Vector, Vector) {
        let j = &self.second;
        let trace = &(&j[0][0] + &j[1][1]) + &j[2][2];
        let spun = turned(j, angular);
        let carried = cross(&self.first, linear);
        let moment = |i: usize| &(&(&trace * &angular[i]) - &spun[i]) + &carried[i];
        let swept = cross(angular, &self.first);
        let force = |i: usize| &(&self.mass * &linear[i]) + &swept[i];
        (std::array::from_fn(moment), std::array::from_fn(force))
    }
}

fn column(point: &Point, twists: &Matrix, k: usize) -> (Vector, Vector) {
    let entry = |i: usize| point.evaluate(twists.at(i, k));
    (
        std::array::from_fn(entry),
        std::array::from_fn(|i| entry(3 + i)),
    )
}

fn vector(entries: &[Precise]) -> Vector {
    std::array::from_fn(|i| entries[i].clone())
}

fn square(entries: &[Precise]) -> Square {
    std::array::from_fn(|i| vector(&entries[3 * i..]))
}

fn dot(a: &Vector, b: &Vector) -> Precise {
    a.iter().zip(b).fold(zero(), |sum, (a, b)| sum + a * b)
}

fn turned(r: &Square, a: &Vector) -> Vector {
    std::array::from_fn(|i| dot(&r[i], a))
}

fn transposed(a: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i].clone()))
}

fn product(a: &Square, b: &Square) -> Square {
    let columns = transposed(b);
    std::array::from_fn(|i| turned(&columns, &a[i]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}
