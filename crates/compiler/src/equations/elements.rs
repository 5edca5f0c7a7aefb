//! What springs and rotors at joints exert.

use super::{Tree, number};
use crate::graph::{Sym, about, call_two, section};
use crate::joint::Joint;
use crate::spatial::{Mat3, Twist, Vec3, Wrench, dot, product};
use hamel_codegen::expr::Function;
use hamel_runtime::elements::{JointLimit, JointSpring, RotationSpring};
use num_traits::{One, Zero};

/// A spring at a joint.
struct Stretch<'a> {
    /// The joint at rest.
    rest: Joint<'a>,
    /// ϕ.
    phi: Vec<Sym>,
    /// Kϕ.
    load: Vec<Sym>,
}

impl Tree<'_> {
    /// The efforts of the springs and limits at the joint that a body stands for, one per degree of freedom; none where it has no spring. They may name
    /// any body of the joint.
    pub(super) fn spring_efforts(&self, index: usize) -> Vec<Sym> {
        let elements = &self.model.elements;
        let own = self.model.carried(index);
        let springs = elements.joint_springs.iter();
        let springs = springs.filter(|spring| own.contains(&spring.body));
        let turned = elements.rotation_springs.iter();
        let turned = turned.filter(|spring| own.contains(&spring.body));
        let each = springs
            .map(|spring| about(&spring.name, || self.joint_spring(spring)))
            .chain(turned.map(|spring| about(&spring.name, || self.rotation_spring(spring))));
        let limits = elements.limits.iter();
        let limits = limits.filter(|limit| limit.port.is_none() && own.contains(&limit.body));
        let limits = limits.map(|limit| about(&limit.name, || vec![self.limit_effort(limit)]));
        let each = each.chain(limits);
        let add =
            |sum: Vec<Sym>, next: Vec<Sym>| sum.into_iter().zip(next).map(|(a, b)| a + b).collect();
        each.reduce(add).unwrap_or_default()
    }

    /// Energy of the springs at joints and between points.
    pub(super) fn spring_energy(&self) -> Sym {
        let elements = &self.model.elements;
        let half = Sym::from(0.5);
        let joints = elements.joint_springs.iter().map(|spring| {
            section(number(spring.body), "spring");
            about(&spring.name, || {
                let Stretch { phi, load, .. } = self.stretch(spring);
                phi.iter().zip(&load).map(|(&x, &l)| x * l).sum::<Sym>() * half
            })
        });
        let turned = elements.rotation_springs.iter().map(|spring| {
            section(number(spring.body), "spring");
            let back = spring.rest.transpose().map(Sym::from);
            let joint = self.joint_at(spring.body, &[]);
            // (3 − tr R)/2 loses digits near rest; ¼ |R − 1|² is the same and keeps them.
            let away = product(&joint.rotation(), &back) - Mat3::identity();
            let squares = away.iter().map(|&entry| entry * entry);
            squares.sum::<Sym>() * Sym::from(0.25 * spring.stiffness)
        });
        let points = elements
            .springs
            .iter()
            .map(|spring| about(&spring.name, || self.point_spring_energy(spring)));
        let limits = elements.limits.iter().map(|limit| {
            section(number(limit.body), "spring");
            about(&limit.name, || self.limit_energy(limit))
        });
        let ports = elements.port_springs.iter().map(|spring| {
            section(number(spring.body), "port");
            about(&spring.name, || self.port_energy(spring))
        });
        let springs = joints.chain(turned).chain(points).chain(limits);
        springs.chain(ports).sum()
    }

    /// ϕ of a spring and Kϕ.
    fn stretch(&self, spring: &JointSpring) -> Stretch<'_> {
        let q = self.coordinates(spring.body);
        let body = &self.model.bodies[spring.body];
        let rest: Vec<Sym> = spring.rest.iter().copied().map(Sym::from).collect();
        let rest = Joint::new(&body.joint, &body.parameters, &rest, &[]);
        let phi = rest.local(&q);
        let rows = spring.stiffness.chunks(phi.len().max(1));
        let load = rows.map(|row| weighted(row, &phi)).collect();
        Stretch { rest, phi, load }
    }

    /// `τ = −S₀⁻ᵀ D⁻ᵀ K ϕ`.
    fn joint_spring(&self, spring: &JointSpring) -> Vec<Sym> {
        let joint = self.joint_at(spring.body, &[]);
        let Stretch { rest, phi, load } = self.stretch(spring);
        let rates = joint.velocity_map_inverse();
        let effort = |column: &Vec<Sym>| {
            let rate = rest.retract_differential_inverse(&phi, column);
            -rate
                .iter()
                .zip(&load)
                .map(|(&rate, &load)| rate * load)
                .sum::<Sym>()
        };
        rates.iter().map(effort).collect()
    }

    /// `−k vee(½(R − Rᵀ))` on the rotation R from rest, by X or by X^c, whichever depends less on the configuration.
    fn rotation_spring(&self, spring: &RotationSpring) -> Vec<Sym> {
        let joint = self.joint_at(spring.body, &[]);
        let rotation = joint.rotation();
        let back = spring.rest.transpose().map(Sym::from);
        let (parent, child) = (joint.freedoms_in_parent(), joint.freedoms());
        let known = |columns: &[Twist]| {
            columns
                .iter()
                .flat_map(|column| column.angular.iter())
                .all(|entry| entry.number().is_some())
        };
        let (columns, turn) = match known(&child) && !known(&parent) {
            true => (child, product(&back, &rotation)),
            false => (parent, product(&rotation, &back)),
        };
        let half = Sym::from(-0.5) * Sym::from(spring.stiffness);
        let moment = axial(&turn) * half;
        columns
            .iter()
            .map(|column| dot(&column.angular, &moment))
            .collect()
    }

    /// How far the joint is beyond each of its limits, negative within, with the sign of the effort there.
    fn beyond(&self, limit: &JointLimit) -> Vec<(Sym, f64)> {
        let from = |rest: f64| match limit.port {
            Some(port) => self.deflection(limit.body, port, rest),
            None => self.coordinates(limit.body)[0] - Sym::from(rest),
        };
        let wraps = |port| self.joint_at(limit.body, &[]).port_wraps(port);
        if let (Some(lower), Some(upper), true) =
            (limit.lower, limit.upper, limit.port.is_some_and(wraps))
        {
            let half = 0.5 * (upper - lower);
            let (way, half) = (from(lower + half), Sym::from(half));
            return vec![(way - half, -1.0), (-way - half, 1.0)];
        }
        let upper = limit.upper.map(|upper| (from(upper), -1.0));
        let lower = limit.lower.map(|lower| (-from(lower), 1.0));
        upper.into_iter().chain(lower).collect()
    }

    /// `−k x max(0, 1 + d ẋ)` beyond the upper limit by x, and the opposite beyond the lower one.
    pub(super) fn limit_effort(&self, limit: &JointLimit) -> Sym {
        let rate = match limit.port {
            Some(port) => self.port_rate(limit.body, port),
            None => self.bodies[limit.body].speeds[0],
        };
        let sides = self.beyond(limit).into_iter();
        let efforts = sides.map(|(by, sign)| {
            let press = Sym::from(sign * limit.stiffness) * positive(by);
            if limit.damping == 0.0 {
                return press;
            }
            let outwards = Sym::from(-sign * limit.damping) * rate;
            press * positive(Sym::one() + outwards)
        });
        efforts.sum()
    }

    /// `½ k x²` beyond a limit by x.
    fn limit_energy(&self, limit: &JointLimit) -> Sym {
        let sides = self.beyond(limit).into_iter();
        let squares = sides.map(|(by, _)| positive(by) * positive(by));
        squares.sum::<Sym>() * Sym::from(0.5 * limit.stiffness)
    }

    /// `Ẋ̄ᵀ h` of a body's joint, one per speed.
    pub(super) fn bias_momentum(&self, index: usize, momentum: &Wrench) -> Vec<Sym> {
        let speeds = &self.bodies[index].speeds;
        self.joint_at(index, speeds).bias_momentum(momentum)
    }
}

/// What divides a number that is not positive, so that nothing is divided by 0: the smallest normal single.
const NOTHING: f64 = f32::MIN_POSITIVE as f64;

/// `max(0, x)`, as x times what is 1 where x is positive and 0 where it is not: exactly, except for x below the smallest single. That factor is made
/// of scales, whose slopes count as 0, so that the slope of all is right as well.
fn positive(x: Sym) -> Sym {
    let larger = |a, b| call_two(Function::Larger, a, b);
    let size = larger(larger(x, -x), Sym::from(NOTHING));
    x * (larger(x, Sym::zero()) / size)
}

/// `Σ numbers · values`.
fn weighted(numbers: &[f64], values: &[Sym]) -> Sym {
    numbers
        .iter()
        .zip(values)
        .map(|(&number, &value)| Sym::from(number) * value)
        .sum()
}

/// The vector a with `a~ = M − Mᵀ`.
fn axial(m: &Mat3) -> Vec3 {
    Vec3::new(
        m[(2, 1)] - m[(1, 2)],
        m[(0, 2)] - m[(2, 0)],
        m[(1, 0)] - m[(0, 1)],
    )
}
