//! A scene's description as bodies and rows, with its initial state.

use super::constraint::{Constraint, Direction};
use super::joint::{parameter, relative, unknown};
use super::load::Load;
use super::number::{Matrix, Real, Vector, matrix, nearest_rotation, quaternion, real, vector};
use super::record::Record;
use super::system::{Inertia, STATE, System};
use hamel::spatial::Pose;
use hamel_scene::{BodyDescription, PerFreedom, Position, SceneDescription, SpringEnergy};

/// Something of a scene that these equations do not know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported(pub String);

/// A system and its state at time 0.
#[derive(Clone, Debug)]
pub struct World {
    /// The bodies, except for driven ones.
    pub system: System,
    /// The state at time 0.
    pub state: Vec<Real>,
    /// Names of the bodies.
    pub names: Vec<String>,
    /// Where positions of the state are counted from, so that a mechanism far from the world's origin loses nothing.
    origin: Vector,
}

/// A frame and its motion, in world axes.
#[derive(Clone, Debug)]
struct Frame {
    origin: Vector,
    axes: Matrix,
    velocity: Vector,
    turning: Vector,
    /// Its body in the system; the world and what is driven have none.
    body: Option<usize>,
    /// Turn of a driven table about the world's z axis, rad/s.
    driven: Option<Real>,
}

impl Frame {
    fn world(origin: Vector) -> Self {
        Self {
            origin,
            axes: Matrix::identity(),
            velocity: Vector::zeros(),
            turning: Vector::zeros(),
            body: None,
            driven: None,
        }
    }

    /// A frame at a point, in axes, that moves relative to this one: twist in the axes of this one, its linear part that of the origin.
    fn carry(&self, axes: &Matrix, origin: &Vector, angular: &Vector, linear: &Vector) -> Self {
        let arm = self.axes * origin;
        Self {
            origin: self.origin + arm,
            axes: self.axes * axes,
            velocity: self.velocity + self.turning.cross(&arm) + self.axes * linear,
            turning: self.turning + self.axes * angular,
            ..self.clone()
        }
    }

    fn placed(&self, pose: &Pose<f64>) -> Self {
        let still = Vector::zeros();
        let axes = nearest_rotation(&pose.rotation);
        self.carry(&axes, &vector(&pose.translation), &still, &still)
    }
}

impl World {
    /// Reads a description.
    ///
    /// # Errors
    /// Joints, forces or ways to say a state that these equations do not know.
    pub fn new(scene: &SceneDescription) -> Result<Self, Unsupported> {
        let mut world = Self {
            system: System {
                gravity: vector(&scene.gravity),
                bodies: Vec::new(),
                constraints: Vec::new(),
                loads: Vec::new(),
            },
            state: Vec::new(),
            names: Vec::new(),
            origin: scene
                .bodies
                .first()
                .map_or_else(Vector::zeros, |body| vector(&body.at.translation)),
        };
        let mut frames: Vec<Frame> = Vec::new();
        for body in &scene.bodies {
            let root = || Frame::world(-world.origin);
            let parent = body.parent.map_or_else(root, |i| frames[i].clone());
            let frame = world.add(body, &parent)?;
            frames.push(frame);
        }
        Ok(world)
    }

    /// Kinetic and potential energy of a state, J.
    pub fn energies(&self, state: &[Real]) -> (Real, Real) {
        let (kinetic, potential) = self.system.energies(state);
        let masses = self.system.bodies.iter().map(|body| body.mass);
        let mass = masses.fold(real(0.0), |sum, mass| sum + mass);
        (
            kinetic,
            potential - mass * self.system.gravity.dot(&self.origin),
        )
    }

    /// The record of the state at `time`.
    pub fn record(&self, time: f64, state: &[Real]) -> Record {
        let mut record = Record::new(&self.system, time, state);
        for body in &mut record.bodies {
            body.position += self.origin;
        }
        record
    }

    /// The initial state with all velocities greater by a part of them.
    pub fn faster(&self, part: f64) -> Vec<Real> {
        let mut state = self.state.clone();
        for body in state.chunks_mut(STATE) {
            for value in &mut body[7..] {
                *value *= real(1.0) + real(part);
            }
        }
        state
    }

    fn add(&mut self, body: &BodyDescription, parent: &Frame) -> Result<Frame, Unsupported> {
        let base = parent.placed(&body.at);
        if let Some(motion) = &body.forces.motion {
            let constant = motion.value.first().map(|law| law.constant());
            let Some(rate) = constant.unwrap_or(Some(0.0)) else {
                return Err(Unsupported("a motion that is not uniform".into()));
            };
            let turning = base.axes * Vector::z() * real(rate);
            return Ok(Frame {
                driven: Some(real(rate)),
                turning: base.turning + turning,
                ..base
            });
        }
        let relative = relative(body)?;
        let child = base.carry(
            &relative.axes,
            &relative.origin,
            &relative.angular,
            &relative.linear,
        );
        let frame = child.placed(&body.body_at);
        let still = Vector::zeros();
        let centre = frame.carry(&Matrix::identity(), &vector(&body.mass.com), &still, &still);
        let index = self.system.bodies.len();
        self.system.bodies.push(Inertia::new(
            real(body.mass.mass),
            matrix(&body.mass.inertia_com),
        ));
        self.names.push(body.name.value.clone());
        self.state.extend(centre.origin.iter());
        self.state.extend(quaternion(&centre.axes));
        self.state.extend(centre.velocity.iter());
        self.state
            .extend((centre.axes.transpose() * centre.turning).iter());
        let joint = Joint {
            parent,
            body: index,
            base: &base,
            child: &child,
            centre: &centre,
        };
        self.system.constraints.extend(joint.constraints(body)?);
        self.system.loads.extend(load(body, parent.body, index)?);
        Ok(Frame {
            body: Some(index),
            ..frame
        })
    }
}

/// A spring and a damper at a ball joint.
fn load(
    body: &BodyDescription,
    base: Option<usize>,
    index: usize,
) -> Result<Option<Load>, Unsupported> {
    let forces = &body.forces;
    let stiffness = match forces.spring.as_ref().map(|spring| &spring.value) {
        None => 0.0,
        Some(spring) => match (&spring.energy, &spring.rest) {
            (SpringEnergy::Trace(stiffness), Position::Home) => *stiffness,
            _ => return Err(unknown(body, "a spring other than \"trace\" from home")),
        },
    };
    let damping = match forces.damping.as_ref().map(|damping| &damping.value) {
        None => 0.0,
        Some(PerFreedom::All(damping)) => *damping,
        Some(PerFreedom::Each(_)) => return Err(unknown(body, "several dampers at one joint")),
    };
    let load = Load {
        base,
        body: index,
        stiffness: real(stiffness),
        damping: real(damping),
    };
    Ok((stiffness != 0.0 || damping != 0.0).then_some(load))
}

/// A joint between two bodies, at time 0.
struct Joint<'a> {
    parent: &'a Frame,
    body: usize,
    base: &'a Frame,
    child: &'a Frame,
    centre: &'a Frame,
}

impl Joint<'_> {
    fn constraints(&self, body: &BodyDescription) -> Result<Vec<Constraint>, Unsupported> {
        let world = [Vector::x(), Vector::y(), Vector::z()];
        let [x, y, z] = [0, 1, 2].map(|i| self.base.axes.column(i).into_owned());
        let ahead = self.child.axes.column(1).into_owned();
        let index = self.body;
        Ok(match body.joint.kind.value.as_str() {
            "free" => vec![],
            "ball" | "ball_quaternion" | "ball_child" | "ball_quaternion_child" => {
                world.map(|axis| self.point(axis, None)).to_vec()
            }
            "revolute" => {
                let turns = [x, y].map(|axis| self.turn(axis));
                let points = world.map(|axis| self.point(axis, None));
                points.into_iter().chain(turns).collect()
            }
            "cart" | "knife_edge" => vec![
                self.point(z, self.parent.body),
                self.point(ahead, Some(index)),
                self.turn(x),
                self.turn(y),
            ],
            "falling_disk" => vec![Constraint::RollingDisk {
                body: index,
                radius: parameter(body, "radius")?,
            }],
            "ball_on_plane" => vec![Constraint::RollingBall {
                body: index,
                radius: parameter(body, "radius")?,
                rate: self.parent.driven.unwrap_or(real(0.0)),
            }],
            other => return Err(unknown(body, &format!("a joint of type {other}"))),
        })
    }

    /// The joint's point has no velocity along a world direction, which a body carries from now on.
    fn point(&self, axis: Vector, carrier: Option<usize>) -> Constraint {
        let arm = self.child.origin - self.centre.origin;
        Constraint::Point {
            base: self.parent.body,
            body: self.body,
            point: self.centre.axes.transpose() * arm,
            direction: self.direction(axis, carrier),
        }
    }

    fn turn(&self, axis: Vector) -> Constraint {
        Constraint::Turn {
            base: self.parent.body,
            body: self.body,
            direction: self.direction(axis, self.parent.body),
        }
    }

    fn direction(&self, axis: Vector, carrier: Option<usize>) -> Direction {
        let axis = match carrier {
            Some(body) if body == self.body => self.centre.axes.transpose() * axis,
            Some(_) => self.parent.axes.transpose() * axis,
            None => axis,
        };
        Direction { carrier, axis }
    }
}
