//! The joint of a coupling.

use super::Movement;
use hamel_runtime::erased::Shared;
use hamel_runtime::joint::{Link, LinkFault, Port, Tie, closed, coupled};
use std::collections::HashSet;
use std::sync::{LazyLock, Mutex, PoisonError};

/// The links of a coupled joint, and what their ports are called.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// One link a body, in the order of the bodies.
    pub links: Vec<Link>,
    /// For each link its port, which has the name of the joint that the scene gives.
    pub ports: &'static [Port],
    /// What else holds the links together.
    pub ties: Vec<Tie>,
    /// A configuration on the ties; empty without them.
    pub start: Vec<f64>,
}

impl Coupling {
    /// The joint of the first body; [`AnyJoint::more`](hamel_runtime::erased::AnyJoint::more) are those of the others.
    ///
    /// # Errors
    /// Links that no joint can have.
    pub fn joint(&self) -> Result<Shared, LinkFault> {
        match self.ties.is_empty() {
            true => coupled(&self.links, self.ports),
            false => closed(&self.links, &self.ties, &self.start, self.ports),
        }
    }

    /// The number of the port of that name.
    pub fn port(&self, name: &str) -> Option<usize> {
        self.ports.iter().position(|port| port.name == name)
    }

    /// How many coordinates the links follow, those that depend on others by the ties among them.
    pub fn coordinates(&self) -> usize {
        let last = self.links.iter().map(|link| link.coordinate).max();
        last.map_or(0, |last| last + 1)
    }
}

/// The port of a joint that moves so.
pub(super) fn port(name: &str, movement: Movement<'_>) -> Port {
    Port {
        name: kept(name),
        unit: match movement {
            Movement::Slide => "m",
            _ => "rad",
        },
        wraps: movement == Movement::Circle,
    }
}

/// Names and lists of ports that have been asked for, each once: a joint's names live as long as the program.
static NAMES: LazyLock<Mutex<HashSet<&'static str>>> = LazyLock::new(Mutex::default);
static PORTS: LazyLock<Mutex<HashSet<&'static [Port]>>> = LazyLock::new(Mutex::default);

fn kept(name: &str) -> &'static str {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let own: &'static str = Box::leak(name.into());
    names.insert(own);
    own
}

/// These ports, kept.
pub(super) fn list(ports: Vec<Port>) -> &'static [Port] {
    let mut lists = PORTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lists.get(ports.as_slice()) {
        return known;
    }
    let own: &'static [Port] = Vec::leak(ports);
    lists.insert(own);
    own
}
