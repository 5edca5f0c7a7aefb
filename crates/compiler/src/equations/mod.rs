//! Equations of motion on the graph, body by body in the frames that were chosen.
//!
//! Accelerations are classical ones, of points: the second derivative of the origin's place, in the body's own axes. With them no linear
//! velocity occurs, `f = m a + α × h + ω × (ω × h)` and `n = I α + h × a + ω × I ω` with h the first moment. Gravity is an acceleration of the
//! world, upwards.
//!
//! Of a joint that carries several bodies, each has a [`Placed`] of its own, as if the joint carried it alone. What is linear in the bodies is found for
//! each of them and added up in the joint's rows; what acts at the joint is found for the first of them. The elimination of articulated bodies alone
//! takes them together (`elimination`).

pub mod articulated;
mod composite;
mod coupling;
mod derivatives;
mod elements;
mod elimination;
mod energy;
mod external;
mod forward_derivatives;
mod kinematics;
mod layout;
mod meetings;
mod newton_euler;
mod pairs;
mod ports;
mod rotors;
mod second;
pub(crate) mod solve;
mod variation;

pub use articulated::Bias;
pub use pairs::Paired;

use super::graph::{Argument, Sym, inverse_of_inertia, section};
use super::joint::Joint;
use super::model::{Body, Model, Share};
use super::prune::Link;
use super::spatial::{Step, Twist, Vec3, Wrench, cross, simplified};
use num_traits::Zero;

/// One body at one state.
pub struct Placed {
    /// Index of the parent.
    pub parent: Option<usize>,
    /// Where its values lie.
    pub share: Share,
    /// The frame of its equations in that of its parent's.
    pub steps: Vec<Step>,
    /// v̄ of its joint.
    pub speeds: Vec<Sym>,
    /// X̄^c in its frame.
    pub columns: Vec<Twist>,
    /// S̄ by rows.
    pub basis: Vec<Vec<Sym>>,
    /// X̄^c v̄.
    pub velocity: Twist,
    /// Ẋ̄^c v̄.
    pub bias: Twist,
}

/// All bodies at one state.
pub struct Tree<'a> {
    /// The model.
    pub model: &'a Model,
    /// Its bodies in their frames.
    pub links: Vec<Link>,
    /// The bodies at the state.
    pub bodies: Vec<Placed>,
}

impl<'a> Tree<'a> {
    /// The bodies at the arguments Q and v̄ of the graph under construction.
    pub fn new(model: &'a Model, links: Vec<Link>) -> Self {
        let count = model.sizes()[2];
        let speeds = (0..count).map(|i| Sym::input(Argument::Speeds, i));
        Self::at(model, links, &speeds.collect::<Vec<_>>())
    }

    /// The bodies at the argument Q and at v̄ of one's own.
    pub fn at(model: &'a Model, links: Vec<Link>, speeds: &[Sym]) -> Self {
        let shares = model.shares();
        let bodies = model.bodies.iter().zip(&links).zip(shares).enumerate();
        let bodies = bodies
            .map(|(index, ((body, link), share))| {
                section(number(index), "joint");
                placed(body, link, &speeds[share.speeds.clone()], share)
            })
            .collect();
        Self {
            model,
            links,
            bodies,
        }
    }

    /// The joints, each with the index of the body that stands for it.
    fn joints(&self) -> impl Iterator<Item = (usize, &Placed)> {
        let joints = self.model.joints();
        joints.map(|(index, _)| (index, &self.bodies[index]))
    }

    /// Whether the joint under a body carries several.
    fn carries_several(&self, index: usize) -> bool {
        self.model.carried(index).len() > 1
    }

    /// The Q of a body's joint.
    fn coordinates(&self, index: usize) -> Vec<Sym> {
        let places = self.bodies[index].share.configuration.clone();
        places
            .map(|place| Sym::input(Argument::Configuration, place))
            .collect()
    }

    /// A body's joint at its Q and at some v̄ of it, empty for kernels that do not read it.
    fn joint_at(&self, index: usize, speeds: &[Sym]) -> Joint<'_> {
        let body = &self.model.bodies[index];
        let q = self.coordinates(index);
        Joint::new(&body.joint, &body.parameters, &q, speeds)
    }

    /// Acceleration of the world that stands for gravity.
    fn ground(&self) -> Vec3 {
        self.model.gravity.map(|entry| -Sym::from(entry))
    }

    /// Angular velocity of every body, in its own axes; and that of its parent there.
    fn angular_velocities(&self) -> Vec<(Vec3, Vec3)> {
        let mut velocities: Vec<(Vec3, Vec3)> = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "angular velocity");
            let carried = match body.parent {
                Some(parent) => to_child(&body.steps, &velocities[parent].0),
                None => Vec3::zeros(),
            };
            let own = carried + body.velocity.angular;
            let named = |i: usize| own[i].settled().named(["rate_x", "rate_y", "rate_z"][i]);
            velocities.push((Vec3::from_fn(|i, _| named(i)), carried));
        }
        velocities
    }

    /// The part of a body's acceleration that neither its parent's acceleration nor v̄̇ makes, in its axes.
    fn bias(&self, index: usize, velocities: &[(Vec3, Vec3)]) -> Twist {
        let body = &self.bodies[index];
        let carried = &velocities[index].1;
        let Twist { angular, linear } = &body.velocity;
        let two = Sym::Number(2.0);
        let relative = cross(carried, linear) * two + cross(angular, linear);
        Twist {
            angular: cross(carried, angular) + body.bias.angular,
            linear: relative + body.bias.linear,
        }
    }

    /// The rates of a body's joint where they are prescribed: the first of its entries of an argument.
    fn prescribed(&self, index: usize, argument: Argument) -> Option<Vec<Sym>> {
        let share = &self.bodies[index].share;
        let start = match argument {
            Argument::Efforts => share.freedoms.start,
            _ => share.speeds.start,
        };
        let inputs = (0..share.speeds.len()).map(|j| Sym::input(argument, start + j));
        self.model.bodies[index].driven.then(|| inputs.collect())
    }

    /// `X̄ x` of a body's joint.
    fn along(&self, index: usize, x: &[Sym]) -> Twist {
        let columns = self.bodies[index].columns.iter().zip(x);
        columns.fold(Twist::zero(), |sum, (column, &x)| {
            sum.plus(&column.times(x))
        })
    }

    /// τ̄ = S̄ᵀτ with τ the argument, the constant efforts, the dampers, the springs, the rotors and the ports of the joint that a body stands for; 0 for further
    /// bodies of a joint.
    fn efforts(&self, index: usize, argument: Option<Argument>) -> Vec<Sym> {
        let (body, placed) = (&self.model.bodies[index], &self.bodies[index]);
        if !body.leads() {
            return vec![Sym::zero(); placed.speeds.len()];
        }
        section(number(index), "spring");
        let springs = self.spring_efforts(index);
        section(number(index), "port");
        let ports = self.port_efforts(index);
        section(number(index), "rotors");
        let rotors = self.rotor_forces(index);
        section(number(index), "effort");
        let of = |forces: &[Sym], k: usize| forces.get(k).copied().unwrap_or_else(Sym::zero);
        let freedom = |(k, place): (usize, usize)| {
            let given = argument.map_or(Sym::zero(), |argument| Sym::input(argument, place));
            let constant = body.effort.get(k).copied().unwrap_or(0.0);
            let damping = body.damping.get(k).copied().unwrap_or(0.0);
            let velocity: Sym = placed.basis[k]
                .iter()
                .zip(&placed.speeds)
                .map(|(&s, &v)| s * v)
                .sum();
            let applied = given + Sym::from(constant) + of(&springs, k) + of(&ports, k);
            applied - Sym::from(damping) * velocity - of(&rotors, k)
        };
        let efforts: Vec<Sym> = placed
            .share
            .freedoms
            .clone()
            .enumerate()
            .map(freedom)
            .collect();
        (0..placed.speeds.len())
            .map(|j| {
                efforts
                    .iter()
                    .zip(&placed.basis)
                    .map(|(&tau, row)| row[j] * tau)
                    .sum()
            })
            .collect()
    }

    /// The inverse of the inertia that moves with a speed of a body's joint; where that is nothing, the words of a simulation.
    fn inverse_of_inertia(&self, index: usize, speed: usize, pivot: Sym) -> Sym {
        let body = &self.model.bodies[index];
        inverse_of_inertia(pivot, |pivot| {
            let name = body.joint.derived.speed_names.get(speed);
            format!(
                "the mass matrix is singular at joint `{}`, speed `{}`: its pivot {pivot:e} is not above 0e0; give mass or inertia to the \
                 bodies that this joint moves",
                body.joint_name,
                name.map_or("", String::as_str)
            )
        })
    }
}

/// A body's index as the number of its section.
fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

fn placed(body: &Body, link: &Link, speeds: &[Sym], share: Share) -> Placed {
    let places = share.configuration.clone();
    let q: Vec<Sym> = places
        .map(|i| Sym::input(Argument::Configuration, i))
        .collect();
    let joint = Joint::new(&body.joint, &body.parameters, &q, speeds);
    let (freedoms, basis) = (joint.freedoms(), joint.speed_basis());
    let column = |j: usize| {
        let terms = freedoms
            .iter()
            .zip(&basis)
            .map(|(column, row)| column.times(row[j]));
        terms.fold(Twist::zero(), |sum, term| sum.plus(&term))
    };
    let columns: Vec<Twist> = (0..speeds.len()).map(column).collect();
    let velocity = columns
        .iter()
        .zip(speeds)
        .map(|(column, &speed)| column.times(speed));
    let fixed = link.placement.iter().map(super::prune::Fixed::step);
    let after = link.after.iter().map(super::prune::Fixed::step);
    Placed {
        parent: body.parent,
        steps: simplified(fixed.chain(joint.pose()).chain(after)),
        velocity: velocity.fold(Twist::zero(), |sum, term| sum.plus(&term)),
        bias: joint.bias_acceleration(),
        speeds: speeds.to_vec(),
        columns,
        basis,
        share,
    }
}

/// A vector from the parent's axes to the child's.
fn to_child(steps: &[Step], a: &Vec3) -> Vec3 {
    steps.iter().fold(*a, |a, step| step.to_child(&a))
}

/// A vector from the child's axes to the parent's.
fn to_parent(steps: &[Step], a: &Vec3) -> Vec3 {
    let steps = steps.iter().rev();
    steps.fold(*a, |a, step| step.to_parent(&a))
}

/// A wrench from child to parent.
fn wrench_to_parent(steps: &[Step], wrench: &Wrench) -> Wrench {
    let steps = steps.iter().rev();
    steps.fold(wrench.clone(), |wrench, step| {
        step.wrench_to_parent(&wrench)
    })
}

/// Wrenches on bodies that hang on one parent, each with the steps of its body, as one there.
fn wrenches_to_parent<'a>(wrenches: impl Iterator<Item = (&'a [Step], Wrench)>) -> Wrench {
    wrenches.fold(Wrench::zero(), |sum, (steps, wrench)| {
        sum.plus(&wrench_to_parent(steps, &wrench))
    })
}

/// An acceleration from parent to child, as a rigid connection carries it: without centripetal parts.
fn carried(steps: &[Step], twist: &Twist) -> Twist {
    steps
        .iter()
        .fold(twist.clone(), |twist, step| step.twist_to_child(&twist))
}
