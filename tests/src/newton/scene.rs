//! A scene's description as bodies and rows, with its initial state.

use super::constraint::{Constraint, Direction};
use super::load::Load;
use super::number::{Matrix, Real, Vector, matrix, nearest_rotation, quaternion, real, vector};
use super::record::Record;
use super::system::{Inertia, STATE, System};
use hamel::spatial::Pose;
use hamel_scene::{
    BodyDescription, Motion, PerFreedom, Position, SceneDescription, SpringEnergy, TwistFrame,
};

/// Something of a scene that these equations do not know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported(pub String);

/// A system and its state at time 0.
#[derive(Clone, Debug)]
pub struct World {
    /// The bodies, but for driven ones.
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

/// Where a joint's child frame stands in its parent frame, and how it moves there, in parent axes.
struct Relative {
    axes: Matrix,
    origin: Vector,
    angular: Vector,
    linear: Vector,
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
                *value = *value + *value * real(part);
            }
        }
        state
    }

    fn add(&mut self, body: &BodyDescription, parent: &Frame) -> Result<Frame, Unsupported> {
        let base = parent.placed(&body.at);
        if let Some(motion) = &body.forces.motion {
            let rate = motion.value.first().map_or(0.0, |law| law.rate);
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

fn unknown(body: &BodyDescription, what: &str) -> Unsupported {
    Unsupported(format!("body `{}`: {what}", body.name.value))
}

/// The state of a joint, read without the joint library.
fn relative(body: &BodyDescription) -> Result<Relative, Unsupported> {
    let (axes, origin) = place(body)?;
    let speeds = |count: usize| match &body.initial.motion {
        Motion::Rest => Ok(vec![0.0; count]),
        Motion::Speeds(speeds) => Ok(speeds.value.clone()),
        _ => Err(unknown(body, "a motion given by other than speeds")),
    };
    let zero = Vector::zeros();
    let up = Vector::z();
    let (angular, linear) = match body.joint.kind.value.as_str() {
        "ball" | "ball_quaternion" => (triple(&speeds(3)?), zero),
        "ball_child" | "ball_quaternion_child" => match &body.initial.motion {
            Motion::Twist(twist) => {
                let angular = vector(&twist.value.twist.fixed_rows::<3>(0).into_owned());
                match twist.value.frame {
                    TwistFrame::Child => (axes * angular, zero),
                    TwistFrame::Parent => (angular, zero),
                }
            }
            _ => (axes * triple(&speeds(3)?), zero),
        },
        "free" => {
            let speeds = speeds(6)?;
            (axes * triple(&speeds), axes * triple(&speeds[3..]))
        }
        "revolute" => (up * real(speeds(1)?[0]), zero),
        "cart" | "knife_edge" => {
            let speeds = speeds(2)?;
            let ahead = axes * Vector::x();
            (up * real(speeds[0]), ahead * real(speeds[1]))
        }
        "falling_disk" => {
            let angular = axes * triple(&speeds(3)?);
            let (normal, length) = (axes.column(2).into_owned(), origin.z);
            let steep = up - normal * normal.z;
            let arm = steep * (-length / steep.dot(&steep));
            (angular, -angular.cross(&arm))
        }
        "ball_on_plane" => {
            let angular = triple(&speeds(3)?);
            (angular, angular.cross(&(up * origin.z)))
        }
        other => return Err(unknown(body, &format!("a joint of type {other}"))),
    };
    Ok(Relative {
        axes,
        origin,
        angular,
        linear,
    })
}

fn triple(values: &[f64]) -> Vector {
    Vector::new(real(values[0]), real(values[1]), real(values[2]))
}

fn parameter(body: &BodyDescription, name: &str) -> Result<Real, Unsupported> {
    let found = body
        .joint
        .parameters
        .iter()
        .find(|(key, _)| key.value == name);
    let found = found.ok_or_else(|| unknown(body, &format!("no {name}")))?;
    Ok(real(found.1))
}

/// Axes and origin of a joint's child frame in its parent frame.
fn place(body: &BodyDescription) -> Result<(Matrix, Vector), Unsupported> {
    let kind = body.joint.kind.value.as_str();
    let zero = Vector::zeros();
    match &body.initial.position {
        Position::Home => Ok((Matrix::identity(), zero)),
        Position::Pose(pose) => Ok((
            nearest_rotation(&pose.value.rotation),
            vector(&pose.value.translation),
        )),
        Position::Phi(phi) if kind == "revolute" => Ok((about_z(phi.value[0]), zero)),
        Position::Phi(phi) if kind == "knife_edge" => {
            let origin = Vector::new(real(phi.value[1]), real(phi.value[2]), real(0.0));
            Ok((about_z(phi.value[0]), origin))
        }
        Position::Configuration(q) if q.value.len() >= 9 => {
            let rows = hamel::nalgebra::Matrix3::from_row_slice(&q.value[..9]);
            let axes = nearest_rotation(&rows);
            match kind {
                "ball_on_plane" | "falling_disk" => {
                    let radius = parameter(body, "radius")?;
                    let cosine = axes[(2, 2)];
                    let height = match kind {
                        "falling_disk" => radius * (real(1.0) - cosine * cosine).sqrt(),
                        _ => radius,
                    };
                    let origin = Vector::new(real(q.value[9]), real(q.value[10]), height);
                    Ok((axes, origin))
                }
                _ => Ok((axes, zero)),
            }
        }
        _ => Err(unknown(body, "this way to give a configuration")),
    }
}

/// The rotation about z by an angle.
fn about_z(angle: f64) -> Matrix {
    let (cosine, sine) = super::closed::cosine_and_sine(angle);
    let (zero, one) = (real(0.0), real(1.0));
    Matrix::new(cosine, -sine, zero, sine, cosine, zero, zero, zero, one)
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
