//! Where the bodies are.

use super::{Tree, number};
use crate::graph::{Sym, section};
use crate::prune::Fixed;
use crate::spatial::{Mat3, Step, Vec3};

/// A frame in the world.
#[derive(Clone)]
struct Frame {
    rotation: Mat3,
    origin: Vec3,
}

impl Frame {
    fn world() -> Self {
        Self {
            rotation: Mat3::identity(),
            origin: Vec3::from_element(Sym::Number(0.0)),
        }
    }

    /// The frame that stands in this one by a step.
    fn then(mut self, step: &Step) -> Self {
        let rows = [0, 1, 2].map(|i| self.rotation.row(i).transpose());
        match step {
            Step::Shift(by) => {
                self.origin += Vec3::from_fn(|i, _| crate::spatial::dot(&rows[i], by));
            }
            turn => {
                let rows = rows.map(|row| turn.to_child(&row).transpose());
                self.rotation = Mat3::from_rows(&rows);
            }
        }
        self
    }
}

impl Tree<'_> {
    /// For each body its rotation to world axes by rows, and its origin.
    pub fn poses(&self) -> Vec<Sym> {
        let mut frames: Vec<Frame> = vec![];
        let mut entries = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "pose");
            let parent = body
                .parent
                .map_or_else(Frame::world, |parent| frames[parent].clone());
            let frame = body.steps.iter().fold(parent, Frame::then);
            let fixed = Fixed::steps(&self.links[index].body);
            let own = fixed
                .iter()
                .map(Fixed::step)
                .fold(frame.clone(), |frame, step| frame.then(&step));
            entries.extend(own.rotation.transpose().iter().copied());
            entries.extend(own.origin.iter().copied());
            frames.push(frame);
        }
        entries
    }
}
