//! A chain in extended precision, and its inverse dynamics.

use super::number::{Exact, cross, exact, rotation};
use hamel::mechanism::{Body, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::Pose;

/// What a joint of a chain does, both with v read in child axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedoms {
    /// Turns about z (`revolute`).
    Axis,
    /// Turns about every axis (`ball_child`).
    All,
}

impl Freedoms {
    /// The joint of the library.
    pub const fn joint(self) -> &'static str {
        match self {
            Self::Axis => "revolute",
            Self::All => "ball_child",
        }
    }

    /// Speeds of one joint.
    pub const fn speeds(self) -> usize {
        match self {
            Self::Axis => 1,
            Self::All => 3,
        }
    }

    /// A joint's share of a vector, as a rotation in child axes.
    pub(super) fn turn(self, own: &[Exact]) -> Vector3<Exact> {
        match self {
            Self::Axis => Vector3::new(0.0.into(), 0.0.into(), own[0].clone()),
            Self::All => Vector3::from_fn(|i, _| own[i].clone()),
        }
    }
}

/// One body; everything in the axes and at the origin of its joint's child frame.
#[derive(Clone, Debug)]
pub(super) struct Link {
    /// Axes of the joint's child frame in those of its parent's.
    pub(super) rotation: Matrix3<Exact>,
    /// Its origin in the parent's.
    pub(super) offset: Vector3<Exact>,
    pub(super) mass: Exact,
    /// Centre of mass.
    pub(super) com: Vector3<Exact>,
    /// Inertia about the centre of mass.
    pub(super) inertia: Matrix3<Exact>,
}

/// A chain at one configuration.
#[derive(Clone, Debug)]
pub struct Chain {
    pub(super) freedoms: Freedoms,
    pub(super) gravity: Vector3<Exact>,
    pub(super) links: Vec<Link>,
}

impl Chain {
    /// The doubles of `mechanism`, every body on the one before by joints of one kind, at the doubles `q`; what are rotations
    /// up to the rounding of doubles, configurations and placements alike, become the nearest rotations.
    pub fn new(mechanism: &Mechanism, freedoms: Freedoms, q: &[f64]) -> Self {
        let mut carried = (Matrix3::identity(), Vector3::zeros());
        let mut links = Vec::new();
        for body in mechanism.bodies() {
            let placement = pose(body.placement());
            let joint = (joint(freedoms, body.configuration(q)), Vector3::zeros());
            let (rotation, offset) = compose(&compose(&carried, &placement), &joint);
            carried = pose(body.child_placement());
            links.push(link(body, rotation, offset, &carried));
        }
        Self {
            freedoms,
            gravity: exact(mechanism.gravity()),
            links,
        }
    }

    /// The same chain without gravity.
    #[must_use]
    pub fn weightless(&self) -> Self {
        Self {
            gravity: Vector3::zeros(),
            ..self.clone()
        }
    }

    /// At least the largest moment of inertia about the origin of a joint, over all axes, of what the joint carries: half the trace of the inertia matrix.
    ///
    /// An entry of M̄ is this inertia seen along the axes of the joint. It has the roundings of the other axes, also where its own moment is small.
    pub fn largest_moment(&self) -> f64 {
        let (mut mass, mut first_moment) = (Exact::from(0.0), Vector3::<Exact>::zeros());
        let (mut half_trace, mut largest) = (Exact::from(0.0), 0.0_f64);
        for link in self.links.iter().rev() {
            mass += link.mass.clone();
            let own = &link.com * link.mass.clone();
            half_trace += link.inertia.trace() * Exact::from(0.5) + own.dot(&link.com);
            first_moment += own;
            largest = largest.max(half_trace.to_f64());

            let turned = &link.rotation * &first_moment;
            let moved = &link.offset * mass.clone();
            half_trace += link.offset.dot(&(&turned * Exact::from(2.0) + &moved));
            first_moment = turned + moved;
        }
        largest
    }

    /// τ of the motion with the given speeds and accelerations, by Newton's and Euler's equations of each body.
    pub fn inverse_dynamics(&self, speeds: &[Exact], accelerations: &[Exact]) -> Vec<Exact> {
        let size = self.freedoms.speeds();
        let shares = speeds.chunks(size).zip(accelerations.chunks(size));
        let mut motion = (Vector3::zeros(), Vector3::zeros(), -self.gravity.clone());
        let mut wrenches = Vec::new();
        for (link, (speeds, accelerations)) in self.links.iter().zip(shares) {
            let turn = self.freedoms.turn(speeds);
            motion = link.carry(&motion, &turn, &self.freedoms.turn(accelerations));
            wrenches.push(link.wrench(&motion));
        }
        let mut efforts = vec![Exact::from(0.0); speeds.len()];
        let mut carried = (Vector3::zeros(), Vector3::zeros());
        for (index, (link, (moment, force))) in self.links.iter().zip(wrenches).enumerate().rev() {
            let (moment, force) = (moment + &carried.0, force + &carried.1);
            for (i, effort) in efforts[size * index..size * (index + 1)]
                .iter_mut()
                .enumerate()
            {
                *effort = moment[i + 3 - size].clone();
            }
            let force = &link.rotation * force;
            carried = (&link.rotation * moment + cross(&link.offset, &force), force);
        }
        efforts
    }
}

/// Angular velocity, angular acceleration, and acceleration of the origin.
type Motion = (Vector3<Exact>, Vector3<Exact>, Vector3<Exact>);

impl Link {
    /// The motion of this link, from that of the one before and the joint's own.
    fn carry(
        &self,
        (velocity, acceleration, origin): &Motion,
        turn: &Vector3<Exact>,
        turn_rate: &Vector3<Exact>,
    ) -> Motion {
        let inverse = self.rotation.transpose();
        let swung = cross(velocity, &cross(velocity, &self.offset));
        let origin = origin + cross(acceleration, &self.offset) + swung;
        let before = &inverse * velocity;
        let acceleration = &inverse * acceleration + turn_rate + cross(&before, turn);
        (before + turn, acceleration, inverse * origin)
    }

    /// Moment about the origin, and force, that move the body.
    fn wrench(
        &self,
        (velocity, acceleration, origin): &Motion,
    ) -> (Vector3<Exact>, Vector3<Exact>) {
        let swung = cross(velocity, &cross(velocity, &self.com));
        let of_com = origin + cross(acceleration, &self.com) + swung;
        let force = of_com * self.mass.clone();
        let gyroscopic = cross(velocity, &(&self.inertia * velocity));
        let moment = &self.inertia * acceleration + gyroscopic + cross(&self.com, &force);
        (moment, force)
    }
}

type ExactPose = (Matrix3<Exact>, Vector3<Exact>);

fn pose(pose: &Pose<f64>) -> ExactPose {
    (rotation(&pose.rotation), exact(&pose.translation))
}

fn compose(first: &ExactPose, second: &ExactPose) -> ExactPose {
    (&first.0 * &second.0, &first.0 * &second.1 + &first.1)
}

/// The joint's rotation: from an angle, or from the nine entries of a matrix row by row.
fn joint(freedoms: Freedoms, q: &[f64]) -> Matrix3<Exact> {
    match freedoms {
        Freedoms::All => rotation(&Matrix3::from_row_slice(q)),
        Freedoms::Axis => {
            let (c, s) = Exact::from(q[0]).cos_sin();
            let mut rotation = Matrix3::identity();
            rotation[(0, 0)] = c.clone();
            rotation[(0, 1)] = -s.clone();
            rotation[(1, 0)] = s;
            rotation[(1, 1)] = c;
            rotation
        }
    }
}

fn link(body: &Body, rotation: Matrix3<Exact>, offset: Vector3<Exact>, child: &ExactPose) -> Link {
    let mass = body.mass();
    let (axes, origin) = child;
    Link {
        rotation,
        offset,
        mass: mass.mass.into(),
        com: axes * exact(&mass.com) + origin,
        inertia: axes * exact(&mass.inertia_com) * axes.transpose(),
    }
}
