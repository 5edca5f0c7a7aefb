//! Names for what a scene calls by name and a model may leave without.

use super::tree::Body;
use std::collections::HashSet;

/// The names that are taken: bodies and frames share theirs, joints have their own.
#[derive(Debug)]
pub(super) struct Names {
    bodies: HashSet<String>,
    joints: HashSet<String>,
}

impl Names {
    /// Those that a model gives.
    pub(super) fn of(bodies: &[Body<'_>]) -> Self {
        let named = bodies.iter().filter_map(|body| body.name.as_ref());
        let joints = bodies.iter().flat_map(|body| &body.joints);
        let joints = joints.filter_map(|joint| joint.element.name());
        Self {
            bodies: named.map(|name| name.value.clone()).collect(),
            joints: joints.map(|name| name.value).collect(),
        }
    }

    /// A new name for a body or a frame, as near to `wanted` as may be.
    pub(super) fn body(&mut self, wanted: String) -> String {
        free(&mut self.bodies, wanted)
    }

    /// A new name for a joint.
    pub(super) fn joint(&mut self, wanted: String) -> String {
        free(&mut self.joints, wanted)
    }

    /// Whether a body or a frame has that name.
    pub(super) fn has_body(&self, name: &str) -> bool {
        self.bodies.contains(name)
    }
}

fn free(taken: &mut HashSet<String>, mut name: String) -> String {
    while taken.contains(&name) {
        name.push('_');
    }
    taken.insert(name.clone());
    name
}
