//! What bodies of a joint exert on each other at its pins.
//!
//! Each body of the joint is a free body: the forces of its pins, with the efforts that act there, are what the joint exerts on it, as inverse dynamics
//! tells. These are six equations a body, in the frame that the joint hangs on, for the components that each pin can carry. What they do not determine
//! (the forces across the plane of a planar linkage) is NaN.

mod balance;

use self::balance::{Balance, Solution};
use super::Recursive;
use super::inverse::MOST_FREEDOMS;
use crate::joint::{DriveSource, Pin, PinDrive, Turning};
use crate::mechanism::StateError;
use crate::spatial::split;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// What the second body of a pin exerts on the first, at the pin, in the axes of the frame that the joint hangs on, without the efforts that act there.
/// A component that the equations of motion do not determine is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinForce {
    /// N.
    pub force: Vector3<f64>,
    /// About the pin, N·m.
    pub moment: Vector3<f64>,
}

/// Why the forces at the pins of a joint are not computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PinError {
    /// The state has no value.
    #[error(transparent)]
    State(#[from] StateError),
    /// An effort acts on the joint, and nothing says at which pin.
    #[error(
        "an effort acts at {what} of joint `{joint}`, of an input, a spring, a damper or a rotor, and none of the joint's pins moves as it does: where it acts, and so what the pins carry, is not known"
    )]
    Unplaced {
        /// The joint.
        joint: String,
        /// `` port `a` `` or `` degree of freedom `a` ``.
        what: String,
    },
    /// The pins do not hold the bodies.
    #[error(
        "the pins of joint `{joint}` let its bodies move in {motions} ways, and it has {freedoms} degrees of freedom: pins are missing, or the linkage is at a dead point"
    )]
    Loose {
        /// The joint.
        joint: String,
        /// Motions that the pins allow.
        motions: usize,
        /// Degrees of freedom of the joint.
        freedoms: usize,
    },
}

/// An effort of an input or of friction that acts at a port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortAtPort {
    /// The body whose joint it is.
    pub body: usize,
    /// Index of the port among those of the joint.
    pub port: usize,
    /// N m or N, positive towards larger values of the port.
    pub effort: f64,
}

impl EffortAtPort {
    /// The opposite effort.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            effort: -self.effort,
            ..*self
        }
    }
}

/// A pin at one configuration, in the frame that the joint hangs on.
pub(super) struct Placed {
    pub(super) pin: &'static Pin,
    pub(super) point: Vector3<f64>,
    turning: Vector3<f64>,
    sliding: Vector3<f64>,
}

/// An effort that is less than this part of what it is the sum of is rounding: half the digits.
const NOTHING: f64 = 1.5e-8;

impl Recursive {
    /// From now on these efforts of inputs and friction at ports, beside those of elements and rotors: [`Recursive::pin_forces`] and [`Recursive::relation_forces`] count them where
    /// they act. Without them an input is counted on v, whose efforts are the only ones that inverse dynamics knows.
    pub fn set_port_efforts(&mut self, efforts: Vec<EffortAtPort>) {
        self.port_efforts = efforts;
    }

    /// What the bodies of the joint under `body` exert on each other at its pins, in the order of [`Joint::PINS`](crate::joint::Joint::PINS), as of the last
    /// [`Recursive::inverse_dynamics`] at `q` and v̄ (or [`Recursive::coupling_force`] where constraints couple joints). Empty for a joint without
    /// pins. Allocates.
    ///
    /// # Errors
    /// No such body; a vector of the wrong size, or not finite; an effort on v or at a port that is the rate of no pin; pins that let the bodies move otherwise
    /// than the joint does.
    pub fn pin_forces(
        &self,
        body: usize,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<Vec<PinForce>, PinError> {
        let owner = self.mechanism.body(body)?;
        self.check(q, &[("speeds", speeds)])?;
        let pins = self.placed_pins(body, q);
        if pins.is_empty() {
            return Ok(vec![]);
        }
        let length = self.extent(body, q, &pins);
        let efforts = self.own_efforts(body, (q, speeds), length);
        if let Some(what) = self.unplaced(body, &pins, &efforts) {
            let joint = owner.joint_name().into();
            return Err(PinError::Unplaced { joint, what });
        }
        let bodies = self.mechanism.carried(body);
        let mut balance = Balance::new(bodies.len(), &pins, length);
        for (place, index) in bodies.enumerate() {
            balance.exert(place, &self.wrench_in_parent(index, q));
        }
        for placed in &pins {
            balance.drive(placed, &placed.drive(&efforts));
        }
        let freedoms = owner.ranges().freedoms.len();
        let Solution { motions, forces } = balance.solve(&pins);
        if motions != freedoms {
            return Err(PinError::Loose {
                joint: owner.joint_name().into(),
                motions,
                freedoms,
            });
        }
        Ok(forces)
    }

    fn placed_pins(&self, body: usize, q: &[f64]) -> Vec<Placed> {
        let link = &self.links[body];
        let own = &q[link.configuration.clone()];
        let pins = link.joint.pins().iter().enumerate();
        let pins = pins.map(|(n, pin)| {
            let [x, y, z, a, b, c, d, e, f] = link.joint.pin_place(own, n);
            Placed {
                pin,
                point: Vector3::new(x, y, z),
                turning: Vector3::new(a, b, c),
                sliding: Vector3::new(d, e, f),
            }
        });
        pins.collect()
    }

    /// What the joint exerts on a body, moment about the origin of the frame that the joint hangs on, and force.
    fn wrench_in_parent(&self, index: usize, q: &[f64]) -> Vector6<f64> {
        let link = &self.links[index];
        let pose = link.joint.pose(&q[link.configuration.clone()]);
        pose.act_wrench(&self.joint_wrench(index).unwrap_or_default())
    }

    /// How far pins and origins of bodies are from the first pin, m; 1 where all are one point.
    fn extent(&self, body: usize, q: &[f64], pins: &[Placed]) -> f64 {
        let first = pins.first().map_or(Vector3::zeros(), |placed| placed.point);
        let origins = self.mechanism.carried(body).map(|index| {
            let link = &self.links[index];
            link.joint.pose(&q[link.configuration.clone()]).translation
        });
        let points = pins.iter().map(|placed| placed.point).chain(origins);
        let farthest = points
            .map(|point| (point - first).norm())
            .fold(0.0, f64::max);
        if farthest > 0.0 { farthest } else { 1.0 }
    }

    /// What the efforts on each degree of freedom are the sums of, in size: twists by wrenches, lengths of the size of the joint.
    fn effort_sizes(&self, body: usize, q: &[f64], length: f64) -> Vec<f64> {
        let mut sizes = vec![0.0; self.links[body].freedoms.len()];
        let mut map = [0.0; 6 * MOST_FREEDOMS];
        let map = &mut map[..6 * sizes.len()];
        for index in self.mechanism.carried(body) {
            let link = &self.links[index];
            link.joint
                .twist_map_child(&q[link.configuration.clone()], map);
            let (moment, force) = split(&self.joint_wrench(index).unwrap_or_default());
            let strength = moment.norm() / length + force.norm();
            for (size, column) in sizes.iter_mut().zip(map.chunks_exact(6)) {
                let (turn, slide) = split(&Vector6::from_column_slice(column));
                *size += (turn.norm() * length + slide.norm()) * strength;
            }
        }
        sizes
    }

    /// The efforts on a joint: at each port, and on each degree of freedom beside these.
    fn own_efforts(&self, body: usize, (q, speeds): (&[f64], &[f64]), length: f64) -> Efforts {
        let link = &self.links[body];
        let own = &q[link.configuration.clone()];
        let mut freedoms = vec![0.0; link.freedoms.len()];
        let mut sizes = self.effort_sizes(body, q, length);
        self.joint_effort(body, q, &mut freedoms);
        let ports = 0..link.joint.ports().len();
        let ports: Vec<f64> = ports
            .map(|port| self.effort_at_port(body, port, q, speeds))
            .collect();
        let mut row = [0.0; MOST_FREEDOMS];
        let row = &mut row[..freedoms.len()];
        for (port, effort) in ports.iter().enumerate() {
            link.joint.port_row(own, port, row);
            for ((sum, size), entry) in freedoms.iter_mut().zip(&mut sizes).zip(&*row) {
                *sum -= entry * effort;
                *size += (entry * effort).abs();
            }
        }
        Efforts {
            freedoms,
            sizes,
            ports,
        }
    }

    /// What elements, rotors, and the inputs of [`Recursive::set_port_efforts`] exert at one port, as of the last inverse dynamics.
    pub(super) fn effort_at_port(
        &self,
        body: usize,
        port: usize,
        q: &[f64],
        speeds: &[f64],
    ) -> f64 {
        let bodies = self.mechanism.carried(body);
        let elements = self.over_elements(q, speeds, |element, view| {
            let effort = element.port_effort(view);
            let own = effort.filter(|(index, other, _)| bodies.contains(index) && *other == port);
            own.map_or(0.0, |(.., effort)| effort)
        });
        let given = self.port_efforts.iter();
        let given = given.filter(|given| bodies.contains(&given.body) && given.port == port);
        let given: f64 = given.map(|given| given.effort).sum();
        elements + given + self.rotor_effort(bodies.start, port)
    }

    /// The first effort that acts at no pin, in words.
    fn unplaced(&self, body: usize, pins: &[Placed], efforts: &Efforts) -> Option<String> {
        let joint = &self.links[body].joint;
        let acts = |source| pins.iter().any(|placed| placed.pin.is_driven_by(source));
        let ports = efforts.ports.iter().enumerate();
        let mut ports = ports.filter(|&(n, f)| *f != 0.0 && !acts(DriveSource::Port(n)));
        let freedoms = efforts.freedoms.iter().zip(&efforts.sizes).enumerate();
        let mut freedoms = freedoms.filter(|&(n, (f, size))| {
            // What rounding leaves of nothing is nothing.
            f.abs() > NOTHING * size && !acts(DriveSource::Freedom(n))
        });
        match (ports.next(), freedoms.next()) {
            (Some((n, _)), _) => Some(alloc::format!("port `{}`", joint.ports()[n].name)),
            (None, Some((n, _))) => Some(alloc::format!(
                "degree of freedom `{}`",
                joint.freedoms()[n]
            )),
            (None, None) => None,
        }
    }
}

/// Efforts on a joint, N·m or N.
struct Efforts {
    freedoms: Vec<f64>,
    /// What they are sums of: the sum of its sizes.
    sizes: Vec<f64>,
    ports: Vec<f64>,
}

impl Placed {
    /// What acts at the pin by efforts, of the second body on the first: the couple and the force.
    fn drive(&self, efforts: &Efforts) -> [Vector3<f64>; 2] {
        let mut exerted = [Vector3::zeros(); 2];
        for drive in self.pin.drives {
            let PinDrive {
                source,
                turns,
                reversed,
            } = *drive;
            let effort = match source {
                DriveSource::Freedom(place) => efforts.freedoms[place],
                DriveSource::Port(place) => efforts.ports[place],
            };
            let effort = if reversed { -effort } else { effort };
            match turns {
                true => exerted[0] += self.turning * effort,
                false => exerted[1] += self.sliding * effort,
            }
        }
        exerted
    }

    /// Unit vectors of the forces that the pin can carry, and of the moments.
    pub(super) fn carries(&self) -> [Vec<Vector3<f64>>; 2] {
        let all = || (0..3).map(|i| Vector3::ith(i, 1.0)).collect();
        let forces = match self.pin.slides {
            true => across(&self.sliding),
            false => all(),
        };
        let moments = match self.pin.turning {
            Turning::Freely => vec![],
            Turning::AboutAxis => across(&self.turning),
            Turning::Not => all(),
        };
        [forces, moments]
    }
}

/// Two unit vectors across a unit vector and each other. Where it is an axis of the frame, they are the others.
fn across(axis: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let first = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    vec![first, axis.cross(&first)]
}
