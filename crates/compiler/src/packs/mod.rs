//! Like limbs side by side: operations that are the same for up to four legs, arms or other like limbs of one state become one operation on four numbers (packs, as in
//! superword-level parallelism).
//!
//! ```text
//! Model
//!    │  limbs       bodies that take the same place in like limbs
//!    ▼
//! Member per body
//!    │  likeness    which limb a node belongs to, and which nodes of like limbs compute the same
//!    ▼
//! Pack …            a node of each limb
//!    │  choice      packs that cost less than their nodes, what is carried between packs and other nodes included
//!    ▼
//! Packs
//! ```
//!
//! Nodes of a pack have equal depth, so that none needs another, and packs need each other in no circle.

mod choice;
mod likeness;
mod limbs;

use super::graph::{Graph, Value};
use super::model::Model;

/// Numbers side by side, at most.
pub const WIDTH: usize = 4;

/// Nodes of like limbs that do the same: two to four, by limb.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pack {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// The operands of each node that match those of the first, in the order of the first node's.
    pub operands: Vec<Vec<u32>>,
}

/// A graph with its packs.
#[derive(Clone, Debug)]
pub struct Packs {
    /// The graph, of numbers that keep their signs: limbs that differ in signs alone are alike.
    pub graph: Graph,
    /// What is sought.
    pub outputs: Vec<Value>,
    /// The packs.
    pub packs: Vec<Pack>,
    /// For each node the pack that it is in.
    pub home: Vec<Option<usize>>,
}

/// Operations with packs, as a part of those without, below which packs are taken. Functions that were measured had 0.34 to 0.72, and took 0.35 to 0.94 of their time.
const WORTH: f64 = 0.8;

/// Whether a model has like limbs.
pub fn may_have(model: &Model) -> bool {
    limbs::members(model).iter().any(Option::is_some)
}

impl Packs {
    /// The packs for what `outputs` need; none where they would save less than a fifth.
    pub fn new(model: &Model, graph: Graph, outputs: Vec<Value>) -> Option<Self> {
        let members = limbs::members(model);
        let uses = graph.uses(&outputs);
        let mut packs = Self {
            packs: likeness::packs(model, &members, &graph, &uses),
            home: vec![],
            graph,
            outputs,
        };
        packs.settle();
        let [one_by_one, packed] = packs.choose(&uses);
        (packed < WORTH * one_by_one).then_some(packs)
    }

    /// Finds the pack of each node anew.
    fn settle(&mut self) {
        self.home = vec![None; self.graph.nodes.len()];
        for (number, pack) in self.packs.iter().enumerate() {
            for &node in &pack.nodes {
                self.home[node as usize] = Some(number);
            }
        }
    }

    /// The pack that holds just these nodes, limb by limb.
    pub fn holding(&self, nodes: &[u32]) -> Option<usize> {
        let home = self.home[*nodes.first()? as usize]?;
        (self.packs[home].nodes == nodes).then_some(home)
    }
}
