//! Couplings: joints that follow others by `mimic`, and with them become one joint of several bodies.
//!
//! A follower turns or slides by `multiplier · y + offset` of another joint's y, a follower of a follower by both. With the joints that move between
//! them, back to the last body that all hang on, they are one [`Coupled`](hamel_runtime::joint::Coupled) joint, whose coordinates are those of the
//! joints that follow none. [`SceneDescription::coupled`] puts it in their place: every body keeps its name and its mass, and what acts at a follower acts
//! at the port that has its name.
//!
//! `graph` finds who follows whom (`follow`) and what moves between (`forest`), `order` lets the bodies of a coupling follow each other, `lower` makes the joint of it.

mod follow;
mod forces;
mod forest;
mod graph;
mod initial;
mod joint;
mod limit;
mod lower;
mod order;

pub(crate) use graph::{Group, Movement, Node, groups};
pub use joint::Coupling;
pub(crate) use order::order;

use crate::description::{BodyDescription, SceneDescription};
use crate::diagnostics::Diagnostics;
use crate::read::Sink;
use std::borrow::Cow;

impl SceneDescription {
    /// The scene with each coupling of mimic joints as one joint of several bodies, of which [`BodyDescription::joint`] holds the
    /// [`Coupling`]; bodies stand in the same places. Without mimic joints it is the scene as it is.
    ///
    /// # Errors
    /// Everything that makes no coupling, each by the joint's name: joints that follow none that is there, or themselves; other joints than
    /// turns and slides; too many of them; states at time 0 that contradict each other; what cannot act at a joint that follows.
    pub fn coupled(&self) -> Result<Cow<'_, Self>, Diagnostics> {
        if self.bodies.iter().all(|body| body.mimic.is_none()) {
            return Ok(Cow::Borrowed(self));
        }
        let mut sink = Sink::default();
        let lowered = lower::lower(self, &mut sink);
        lowered.map(Cow::Owned).ok_or_else(|| self.refuse(sink))
    }
}

impl<'a> Node<'a> {
    /// A body of a scene.
    fn of(body: &'a BodyDescription) -> Self {
        let kind = match body.part {
            None => Movement::of(&body.joint.kind.value),
            Some(_) => Movement::Other(&body.joint.kind.value),
        };
        Self {
            joint: body.leads().then_some(&body.joint.name),
            parent: body.parent,
            movement: kind,
            mimic: body.mimic.as_ref(),
            motor: None,
        }
    }
}
