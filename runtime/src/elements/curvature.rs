//! Second derivatives of what elements exert.
//!
//! Under virtual speeds μ, with which the bodies have the virtual twists P, what an element exerts has the power W. It enters the contracted inverse dynamics
//! μᵀτ̄ as −W. Of what acts on bodies, W depends on their placements, twists and virtual twists: its gradient by these is handed to the recursion over the
//! tree, which knows how they bend, and what it bends itself is added here, for all pairs of directions that move the bodies. Of efforts at a joint, W depends on
//! that joint alone.

use super::View;
use super::slopes::{End, Place, SIGNS, at, path};
use crate::dynamics::Sensitivity;
use crate::joint::MOST_FREEDOMS;
use crate::scalar::Dual;
use crate::spatial::fused::{cross, dot};
use crate::spatial::{join, split};
use crate::steps::{EffortLaw, MotionGradient, Variation};
use core::ops::Range;
use nalgebra::{SMatrix, SVector, Vector3, Vector6};

/// A number with its derivatives along two directions, and along one after the other.
pub type HyperDual = Dual<Dual<f64>>;

/// A force as a function of the way between two points and of its rate; world axes, N, m and m/s.
pub type ForceLaw<'a> = &'a dyn Fn(&Vector3<HyperDual>, &Vector3<HyperDual>) -> Vector3<HyperDual>;

/// An element whose second derivatives are known.
pub trait Curvature {
    /// Adds first and second derivatives of the power of what [`Element::act`](super::Element::act) exerts under virtual speeds.
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>);
}

/// Where elements put the second derivatives of what they exert. What is said of a body that is not there makes all of it NaN.
#[derive(Debug)]
pub struct Curvatures<'a> {
    /// X̄ of each body, one column per speed of its joint.
    pub(crate) columns: &'a [Vector6<f64>],
    /// One for each body and each degree of freedom of its joint.
    pub(crate) variations: &'a [Variation<f64>],
    /// What each of them adds to the virtual twists of all that the joint carries.
    pub(crate) virtual_drifts: &'a [Vector6<f64>],
    /// P, one a body.
    pub(crate) virtual_twists: &'a [Vector6<f64>],
    /// v̄̇ and μ.
    pub(crate) accelerations: &'a [f64],
    pub(crate) virtual_speeds: &'a [f64],
    /// What has been found, of −W.
    pub(crate) into: Collected<'a>,
}

/// Derivatives of the contracted inverse dynamics.
#[derive(Debug)]
pub(crate) struct Collected<'a> {
    /// Over (ϕ, v̄, v̄̇).
    pub(crate) hessian: &'a mut Sensitivity,
    /// By ϕ, of efforts at joints.
    pub(crate) by_local: &'a mut [f64],
    /// By the motion of each body.
    pub(crate) gradients: &'a mut [MotionGradient<f64>],
    /// Room: how far each direction moves what an element acts on.
    pub(crate) reaches: &'a mut [SVector<f64, 9>],
}

/// One unit of a coordinate or speed as a point or a body feels it.
struct Reach {
    /// Its place in the Hessian.
    index: usize,
    is_local: bool,
    /// The angular part of Z.
    turn: Vector3<f64>,
    /// What Z, U and the virtual drift do at the point.
    moved: [Vector3<f64>; 3],
}

/// What an element asks of a point or a body: derivatives of W by its place, its velocity and its virtual velocity.
struct Acting {
    body: usize,
    gradient: [Vector3<f64>; 3],
    velocity: Vector3<f64>,
    virtual_velocity: Vector3<f64>,
}

impl Acting {
    /// How W changes along two directions beside the second derivatives of W itself: `outer` is above `inner`, or of the same joint.
    fn bend(&self, outer: &Reach, inner: &Reach) -> f64 {
        let [by_place, by_rate, by_virtual] = &self.gradient;
        let term = |n: usize, by: &Vector3<f64>, velocity: &Vector3<f64>| {
            let carried = cross(&inner.turn, velocity) + inner.moved[n];
            let change = cross(&outer.turn, &carried) + cross(&inner.turn, &outer.moved[n]);
            dot(by, &change)
        };
        dot(by_place, &cross(&outer.turn, &inner.moved[0]))
            + term(1, by_rate, &self.velocity)
            + term(2, by_virtual, &self.virtual_velocity)
    }
}

impl Curvatures<'_> {
    /// What was said makes no sense: NaN, which whoever takes derivatives finds.
    fn spoil(&mut self) {
        self.into.hessian.entries_mut().fill(f64::NAN);
    }

    /// Efforts of the joint under a body.
    pub fn add_effort(&mut self, view: &View<'_>, body: usize, law: &EffortLaw<'_>) {
        let Some(own) = view.mechanism.bodies().get(body) else {
            return self.spoil();
        };
        let (joint, ranges) = (own.joint(), own.ranges());
        let is_linear = matches!(law, EffortLaw::Constant(_) | EffortLaw::Damper(_));
        if is_linear && joint.structures().speed_basis_gradient.is_zero() {
            return;
        }
        let (size, count) = (ranges.freedoms.len(), ranges.speeds.len());
        let mut room = [[0.0; MOST_FREEDOMS * MOST_FREEDOMS]; 4];
        let mut gradient = [0.0; MOST_FREEDOMS];
        let [by_local, mixed, by_speeds, by_accelerations] = &mut room;
        let out = [
            &mut gradient[..size],
            &mut by_local[..size * size],
            &mut mixed[..size * count],
            &mut by_speeds[..count * count],
            &mut by_accelerations[..size * count],
        ];
        joint.power_hessian(
            (
                own.configuration(view.configuration),
                &view.speeds[ranges.speeds.clone()],
                &self.accelerations[ranges.speeds.clone()],
            ),
            &self.virtual_speeds[ranges.speeds.clone()],
            law,
            out,
        );
        for (sum, entry) in self.into.by_local[ranges.freedoms.clone()]
            .iter_mut()
            .zip(&gradient)
        {
            *sum -= entry;
        }
        let (freedoms, speeds) = (self.into.by_local.len(), self.virtual_speeds.len());
        let local = ranges.freedoms.clone();
        let of_speeds = shifted(&ranges.speeds, freedoms);
        let of_rates = shifted(&ranges.speeds, freedoms + speeds);
        let [by_local, mixed, by_speeds, by_accelerations] = &room;
        let hessian = &mut *self.into.hessian;
        subtract(hessian, (&local, &local), by_local, false);
        subtract(hessian, (&local, &of_speeds), mixed, true);
        subtract(hessian, (&of_speeds, &of_speeds), by_speeds, false);
        subtract(hessian, (&local, &of_rates), by_accelerations, true);
    }

    /// A moment on a body that keeps its direction in the world, N·m.
    pub fn add_moment(&mut self, view: &View<'_>, body: usize, moment: &Vector3<f64>) {
        let Some(twist) = self.virtual_twists.get(body) else {
            return self.spoil();
        };
        let (turn, _) = split(twist);
        let asked = Acting {
            body,
            gradient: [Vector3::zeros(), Vector3::zeros(), *moment],
            velocity: Vector3::zeros(),
            virtual_velocity: turn,
        };
        let turned = join(&cross(&turn, moment), &Vector3::zeros());
        self.into.gradients[body].placement -= turned;
        let feel = |twists: [&Vector6<f64>; 3], _: &Vector3<f64>| {
            let [.., drift] = twists;
            [Vector3::zeros(), Vector3::zeros(), split(drift).0]
        };
        self.add_bends(view, &asked, feel);
    }

    /// A force F on the second of two points and −F on the first, as a function of the way x from the first to the second and of its rate, which are given;
    /// world axes, N, m and m/s. A point that is `None` belongs to the world.
    pub fn add_point_force(
        &mut self,
        view: &View<'_>,
        ends: [Option<End>; 2],
        (way, rate): (&Vector3<f64>, &Vector3<f64>),
        force: ForceLaw<'_>,
    ) {
        let mut bodies = ends.iter().flatten().map(|(body, _)| *body);
        if bodies.any(|body| body >= self.virtual_twists.len()) {
            return self.spoil();
        }
        let twists = self.virtual_twists;
        let virtual_velocities = ends.map(|end| match end {
            Some((body, arm)) => at(&twists[body], &arm),
            None => Vector3::zeros(),
        });
        let places = ends.map(|end| end.and_then(|end| Place::new(view, end)));
        let virtual_rate = virtual_velocities[1] - virtual_velocities[0];
        let (gradient, hessian) = expanded((way, rate), &virtual_rate, force);
        self.into.reaches.fill(SVector::zeros());
        for ((place, virtual_velocity), sign) in places.iter().zip(virtual_velocities).zip(SIGNS) {
            let Some(place) = place else { continue };
            let asked = Acting {
                body: place.body,
                gradient: gradient.map(|by| by * sign),
                velocity: place.velocity,
                virtual_velocity,
            };
            self.ask(view, place, &asked);
            self.reach(view, place, (&asked, sign));
            let position = place.position;
            let feel = move |twists: [&Vector6<f64>; 3], origin: &Vector3<f64>| {
                twists.map(|twist| at(twist, &(position - origin)))
            };
            self.add_bends(view, &asked, feel);
        }
        self.subtract_quadratic(&hessian);
    }

    /// The gradient of −W by the motion of the body at a point; that by the virtual twist is the force, which the recursion knows.
    fn ask(&mut self, view: &View<'_>, place: &Place, asked: &Acting) {
        let Some(placement) = view.motions.placement(place.body) else {
            return self.spoil();
        };
        let arm = place.position - placement.origin;
        let [by_place, by_rate, by_virtual] = &asked.gradient;
        let wrench = |force: &Vector3<f64>| join(&cross(&arm, force), force);
        let turned = cross(&asked.velocity, by_rate) + cross(&asked.virtual_velocity, by_virtual);
        let own = &mut self.into.gradients[place.body];
        own.placement -= wrench(by_place) + join(&turned, &Vector3::zeros());
        own.twist -= wrench(by_rate);
    }

    /// How far each direction moves the way between the points.
    fn reach(&mut self, view: &View<'_>, place: &Place, (asked, sign): (&Acting, f64)) {
        let position = place.position;
        let feel = move |twists: [&Vector6<f64>; 3], origin: &Vector3<f64>| {
            twists.map(|twist| at(twist, &(position - origin)))
        };
        for index in path(view.mechanism, place.body) {
            for n in 0..self.directions(view, index) {
                let reach = self.direction(view, (index, n), &feel);
                let [moved, drift, virtual_drift] = &reach.moved;
                let rate = cross(&reach.turn, &asked.velocity) + drift;
                let virtual_rate = cross(&reach.turn, &asked.virtual_velocity) + virtual_drift;
                let sum = &mut self.into.reaches[reach.index];
                for i in 0..3 {
                    sum[i] += sign * moved[i];
                    sum[3 + i] += sign * rate[i];
                    sum[6 + i] += sign * virtual_rate[i];
                }
            }
        }
    }

    /// How many directions the joint under a body has: its degrees of freedom and speeds.
    fn directions(&self, view: &View<'_>, body: usize) -> usize {
        let ranges = view.mechanism.bodies()[body].ranges();
        ranges.variations.len() + ranges.columns.len()
    }

    /// One of them.
    fn direction(
        &self,
        view: &View<'_>,
        (body, n): (usize, usize),
        feel: &impl Fn([&Vector6<f64>; 3], &Vector3<f64>) -> [Vector3<f64>; 3],
    ) -> Reach {
        let ranges = view.mechanism.bodies()[body].ranges();
        let nan = Vector3::repeat(f64::NAN);
        let origin = view.motions.placement(body).map_or(nan, |own| own.origin);
        let (zero, size) = (Vector6::zeros(), ranges.variations.len());
        match n.checked_sub(size) {
            None => {
                let slot = ranges.variations.start + n;
                let Variation { local, drift, .. } = &self.variations[slot];
                Reach {
                    index: ranges.freedoms.start + n,
                    is_local: true,
                    turn: split(local).0,
                    moved: feel([local, drift, &self.virtual_drifts[slot]], &origin),
                }
            }
            Some(j) => Reach {
                index: self.into.by_local.len() + ranges.speeds.start + j,
                is_local: false,
                turn: Vector3::zeros(),
                moved: feel(
                    [&zero, &self.columns[ranges.columns.start + j], &zero],
                    &origin,
                ),
            },
        }
    }

    /// [`Acting::bend`] for all pairs of directions.
    fn add_bends(
        &mut self,
        view: &View<'_>,
        asked: &Acting,
        feel: impl Fn([&Vector6<f64>; 3], &Vector3<f64>) -> [Vector3<f64>; 3],
    ) {
        for lower in path(view.mechanism, asked.body) {
            for n in 0..self.directions(view, lower) {
                let inner = self.direction(view, (lower, n), &feel);
                for upper in path(view.mechanism, lower) {
                    for m in 0..self.directions(view, upper) {
                        let outer = self.direction(view, (upper, m), &feel);
                        let same = upper == lower;
                        // Of the same joint a pair of a coordinate and a speed is met once, and two coordinates in either order.
                        if same && !inner.is_local {
                            continue;
                        }
                        let value = asked.bend(&outer, &inner);
                        self.into.hessian.add(outer.index, inner.index, -value);
                        if !(same && outer.is_local) {
                            self.into.hessian.add(inner.index, outer.index, -value);
                        }
                    }
                }
            }
        }
    }

    /// The second derivatives of W by the way, its rate and its virtual rate, for all pairs of directions.
    fn subtract_quadratic(&mut self, hessian: &SMatrix<f64, 9, 9>) {
        let Collected {
            hessian: sum,
            reaches,
            ..
        } = &mut self.into;
        let moving = |reach: &SVector<f64, 9>| reach.iter().any(|entry| *entry != 0.0);
        for (l, outer) in reaches.iter().enumerate().filter(|(_, own)| moving(own)) {
            let turned = hessian * outer;
            for (k, inner) in reaches.iter().enumerate().filter(|(_, own)| moving(own)) {
                sum.add(l, k, -turned.dot(inner));
            }
        }
    }
}

/// The gradient of `W = yᵀF(x, ẋ)` by x, ẋ and y, and its Hessian.
fn expanded(
    (way, rate): (&Vector3<f64>, &Vector3<f64>),
    virtual_rate: &Vector3<f64>,
    force: ForceLaw<'_>,
) -> ([Vector3<f64>; 3], SMatrix<f64, 9, 9>) {
    let mut hessian = SMatrix::zeros();
    let mut gradient = [Vector3::zeros(); 3];
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    for i in 0..6 {
        for j in 0..=i {
            let seeded = |n: usize, value: f64| {
                HyperDual::new(Dual::new(value, unit(n, i)), Dual::constant(unit(n, j)))
            };
            let x = Vector3::from_fn(|n, _| seeded(n, way[n]));
            let x_rate = Vector3::from_fn(|n, _| seeded(3 + n, rate[n]));
            let found = force(&x, &x_rate);
            let second = found.map(|entry| entry.derivative().derivative());
            let entry = dot(virtual_rate, &second);
            (hessian[(i, j)], hessian[(j, i)]) = (entry, entry);
            let first = found.map(|entry| entry.value.derivative());
            for n in 0..3 {
                (hessian[(i, 6 + n)], hessian[(6 + n, i)]) = (first[n], first[n]);
            }
            gradient[i / 3][i % 3] = dot(virtual_rate, &first);
            gradient[2] = found.map(|entry| entry.value.value);
        }
    }
    (gradient, hessian)
}

fn shifted(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start + by..range.end + by
}

/// Subtracts a block of a matrix that is stored column by column, and its transpose where that is another block.
fn subtract(
    hessian: &mut Sensitivity,
    (rows, columns): (&Range<usize>, &Range<usize>),
    entries: &[f64],
    both: bool,
) {
    let size = rows.len().max(1);
    for (column, entries) in columns.clone().zip(entries.chunks_exact(size)) {
        for (row, entry) in rows.clone().zip(entries) {
            hessian.add(row, column, -entry);
            if both {
                hessian.add(column, row, -entry);
            }
        }
    }
}
