//! States at time 0 of one scene under other numbers of `initial`, without building the scene anew.

use crate::build::{self, Stand};
use crate::description::{InitialDescription, Motion, Position, SceneDescription};
use crate::diagnostics::Diagnostic;
use crate::forces::JointForces;
use crate::read::Sink;
use hamel_integrate::State;
use hamel_runtime::registry::JointRegistry;

/// The joints of a scene, each with its `initial` and the state that follows.
#[derive(Debug)]
pub struct Starts {
    joints: Vec<Joint>,
}

/// A number of the `initial` of some joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartNumber {
    joint: usize,
    part: Part,
    index: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Position,
    Motion,
}

#[derive(Debug)]
struct Joint {
    body: String,
    stand: Stand,
    initial: InitialDescription,
    forces: JointForces,
    state: (Vec<f64>, Vec<f64>),
}

impl SceneDescription {
    /// The states at time 0 that other numbers of `initial` lead to. `None` where these numbers have a part in more than the state at time 0 of their own joint, because of loops, couplings, joints that follow others, constraints, prescribed motions or a controller;
    /// and where the scene has mistakes.
    pub fn starts(&self, registry: &JointRegistry) -> Option<Starts> {
        let mut bodies = self.bodies.iter();
        let is_more = !self.loops.is_empty()
            || !self.couplings.is_empty()
            || !self.constraints.is_empty()
            || self.controller.is_some()
            || bodies.any(|body| body.mimic.is_some() || body.forces.motion.is_some());
        if is_more {
            return None;
        }
        let joints = self.bodies.iter().filter(|body| body.leads()).map(|body| {
            let stand = build::stand(&body.joint, registry, &mut Sink::default())?;
            let state = stand.state(&body.initial, &body.forces).ok()?;
            Some(Joint {
                body: body.name.value.clone(),
                stand,
                initial: body.initial.clone(),
                forces: body.forces.clone(),
                state,
            })
        });
        let joints = joints.collect::<Option<Vec<Joint>>>()?;
        Some(Starts { joints })
    }
}

impl Starts {
    /// The number under `keys` in the `initial` of the body called `body`, such as `["speeds", "1"]`; places in lists count from 1. `None` where it has no such number, and of numbers of a `pose`.
    pub fn number(&self, body: &str, keys: &[&str]) -> Option<StartNumber> {
        let joint = self.joints.iter().position(|joint| joint.body == body)?;
        let InitialDescription { position, motion } = &self.joints[joint].initial;
        let (part, index) = match keys {
            [kind @ ("configuration" | "phi"), place] => {
                (Part::Position, listed(position.list(kind)?, place)?)
            }
            [kind @ ("velocity" | "speeds"), place] => {
                (Part::Motion, listed(motion.list(kind)?, place)?)
            }
            ["twist", "angular", place] => (Part::Motion, listed(&motion.twist()?[..3], place)?),
            ["twist", "linear", place] => (Part::Motion, 3 + listed(&motion.twist()?[3..], place)?),
            ["rates", port] => (Part::Motion, motion.port(port)?),
            _ => return None,
        };
        Some(StartNumber { joint, part, index })
    }

    /// The state at time 0 with these finite numbers, each of another place, instead of those of the scene: the bits of a scene that is built with them.
    ///
    /// # Errors
    /// The first number that a joint cannot take.
    pub fn state(&mut self, mut numbers: Vec<(StartNumber, f64)>) -> Result<State, Diagnostic> {
        let mut state = State {
            time: 0.0,
            configuration: Vec::new(),
            speeds: Vec::new(),
        };
        for (index, joint) in self.joints.iter_mut().enumerate() {
            if !numbers.iter().any(|(place, _)| place.joint == index) {
                state.configuration.extend(&joint.state.0);
                state.speeds.extend(&joint.state.1);
                continue;
            }
            joint.exchange(index, &mut numbers);
            let solved = joint.stand.state(&joint.initial, &joint.forces);
            joint.exchange(index, &mut numbers);
            let (q, speeds) = solved?;
            state.configuration.extend(q);
            state.speeds.extend(speeds);
        }
        Ok(state)
    }
}

impl Joint {
    /// Puts the numbers of this joint in their places, and what stood there in theirs: a copy of `initial` would take longer than the rest.
    fn exchange(&mut self, index: usize, numbers: &mut [(StartNumber, f64)]) {
        let own = numbers.iter_mut().filter(|(place, _)| place.joint == index);
        for (place, number) in own {
            if let Some(initial) = self.initial.number_mut(*place) {
                std::mem::swap(initial, number);
            }
        }
    }
}

/// The index of the place, counted from 1, in a list.
fn listed(list: &[f64], place: &str) -> Option<usize> {
    let index = place.parse::<usize>().ok()?.checked_sub(1)?;
    (index < list.len()).then_some(index)
}

impl Position {
    fn list(&self, kind: &str) -> Option<&[f64]> {
        match (self, kind) {
            (Self::Configuration(list), "configuration") | (Self::Phi(list), "phi") => {
                Some(&list.value)
            }
            _ => None,
        }
    }
}

impl Motion {
    fn list(&self, kind: &str) -> Option<&[f64]> {
        match (self, kind) {
            (Self::Velocity(list), "velocity") | (Self::Speeds(list), "speeds") => {
                Some(&list.value)
            }
            _ => None,
        }
    }

    fn twist(&self) -> Option<&[f64]> {
        match self {
            Self::Twist(twist) => Some(twist.value.twist.as_slice()),
            _ => None,
        }
    }

    fn port(&self, name: &str) -> Option<usize> {
        match self {
            Self::Rates(rates) => rates.value.iter().position(|own| own.name.value == name),
            _ => None,
        }
    }
}

impl InitialDescription {
    fn number_mut(&mut self, place: StartNumber) -> Option<&mut f64> {
        let Self { position, motion } = self;
        match place.part {
            Part::Position => match position {
                Position::Configuration(list) | Position::Phi(list) => {
                    list.value.get_mut(place.index)
                }
                Position::Home | Position::Pose(_) => None,
            },
            Part::Motion => match motion {
                Motion::Velocity(list) | Motion::Speeds(list) => list.value.get_mut(place.index),
                Motion::Twist(twist) => twist.value.twist.as_mut_slice().get_mut(place.index),
                Motion::Rates(rates) => Some(&mut rates.value.get_mut(place.index)?.rate),
                Motion::Rest => None,
            },
        }
    }
}
