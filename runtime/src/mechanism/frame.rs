//! Named frames: tool points, sensors, feet.

use super::{Mechanism, MechanismError, MechanismErrors};
use crate::spatial::{Pose, PoseError};
use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

/// A frame that is fixed to a body, or to the world.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFrame {
    /// Its name: no other frame and no body has it.
    pub name: String,
    /// The body that carries it; `None` is the world.
    pub body: Option<usize>,
    /// Its pose in the body frame, or in the world.
    pub at: Pose<f64>,
}

/// What is wrong with a named frame.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameFault {
    /// No body has that index.
    #[error("there is no body of index {index}, the mechanism has {count}")]
    Body {
        /// The index given.
        index: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// Its pose is none.
    #[error("{0}")]
    Placement(PoseError),
    /// Another frame is called so.
    #[error("frame {first} has the name already")]
    NameOfFrame {
        /// Index of that frame.
        first: usize,
    },
    /// A body is called so.
    #[error("body {body} has the name already")]
    NameOfBody {
        /// Index of that body.
        body: usize,
    },
}

impl Mechanism {
    /// The mechanism with these named frames instead of those it had.
    ///
    /// # Errors
    /// Everything that is wrong with the frames: a body that is not there, a placement that is no pose, a name that is taken.
    pub fn with_frames(mut self, frames: Vec<NamedFrame>) -> Result<Self, MechanismErrors> {
        let mut errors = Vec::new();
        let bodies = self.bodies.iter().enumerate();
        let bodies: BTreeMap<&str, usize> = bodies.map(|(i, body)| (body.name(), i)).collect();
        let mut names = BTreeMap::new();
        for (index, frame) in frames.iter().enumerate() {
            let first = *names.entry(frame.name.as_str()).or_insert(index);
            let taken = [
                (first != index).then_some(FrameFault::NameOfFrame { first }),
                bodies
                    .get(frame.name.as_str())
                    .map(|&body| FrameFault::NameOfBody { body }),
            ];
            let faults = self.faults(frame).into_iter().chain(taken).flatten();
            errors.extend(faults.map(|fault| MechanismError::Frame {
                frame: frame.name.clone(),
                fault,
            }));
        }
        MechanismErrors::check(errors)?;
        self.frames = frames;
        Ok(self)
    }

    /// What is wrong with a frame, except for its name.
    fn faults(&self, frame: &NamedFrame) -> [Option<FrameFault>; 2] {
        let count = self.bodies.len();
        let missing = frame.body.filter(|index| *index >= count);
        [
            missing.map(|index| FrameFault::Body { index, count }),
            frame.at.check().err().map(FrameFault::Placement),
        ]
    }

    /// The named frames.
    pub fn frames(&self) -> &[NamedFrame] {
        &self.frames
    }

    /// Index of the frame called `name`.
    pub fn frame_index(&self, name: &str) -> Option<usize> {
        self.frames.iter().position(|frame| frame.name == name)
    }
}
