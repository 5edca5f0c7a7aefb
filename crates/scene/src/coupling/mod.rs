//! Couplings: joints that follow others by `mimic` or `[[coupling]]`, or that loops close, and together become one joint of several bodies.
//!
//! A follower turns or slides by `multiplier · y + offset` of another joint's y, a follower of a follower by both. With the joints that move between
//! them, back to the last body that all hang on, they are one [`Coupled`](hamel_runtime::joint::Coupled) joint, whose coordinates are those of the
//! joints that follow none. A loop, or a coupling of sums, holds such joints together by relations: some coordinates then depend on the others. [`SceneDescription::coupled`] puts it in their place: every body keeps its name and its mass, and what acts at a follower acts
//! at the port that has its name.
//!
//! `graph` finds who follows whom (`follow`, `tie`) and what moves between (`forest`), `order` lets the bodies of a coupling follow each other, `lower` makes the joint of it, with
//! the relations that `closing` finds.

mod closing;
mod follow;
mod forces;
mod forest;
mod graph;
mod initial;
mod joint;
mod limit;
mod linkage;
mod lower;
mod order;
mod tie;

pub(crate) use graph::{Group, Movement, Node, groups};
pub use joint::Coupling;
pub(crate) use order::order;
pub(crate) use tie::Tie;

use crate::description::{BodyDescription, SceneDescription};
use crate::diagnostics::Diagnostics;
use crate::notice::Notices;
use crate::read::Sink;
use std::borrow::Cow;

impl SceneDescription {
    /// The scene with each coupling of mimic joints and each loop as one joint of several bodies, of which [`BodyDescription::joint`] holds the
    /// [`Coupling`]; bodies stand in the same places. Without these it is the scene as it is.
    ///
    /// # Errors
    /// Everything that makes no coupling, each by the joint's name: joints that follow none that is there, or themselves; joints other
    /// than revolute and prismatic ones; too many of them; states at time 0 that contradict each other; what cannot act at a joint that follows; loops that do not close near their start, or whose relations
    /// are not named as independent.
    pub fn coupled(&self) -> Result<Cow<'_, Self>, Diagnostics> {
        self.coupled_with(&mut Notices::default())
    }

    /// The same, with what has been chosen where the scene leaves it open.
    pub(crate) fn coupled_with(&self, notices: &mut Notices) -> Result<Cow<'_, Self>, Diagnostics> {
        let follows = |body: &BodyDescription| body.mimic.is_some();
        let is_tree = self.loops.is_empty() && self.couplings.is_empty();
        if is_tree && !self.bodies.iter().any(follows) {
            return Ok(Cow::Borrowed(self));
        }
        let mut sink = Sink::default();
        let lowered = lower::lower(self, notices, &mut sink);
        lowered.map(Cow::Owned).ok_or_else(|| self.refuse(sink))
    }
}

impl<'a> Node<'a> {
    /// A body of a scene.
    pub(crate) fn of(body: &'a BodyDescription) -> Self {
        let kind = match body.part {
            None => Movement::of(&body.joint.kind.value),
            Some(_) => Movement::Other(&body.joint.kind.value),
        };
        Self {
            joint: Some(&body.joint.name),
            parent: body.parent,
            movement: kind,
            mimic: body.mimic.as_ref(),
            motor: None,
        }
    }
}
