//! Like bodies: parts of a graph that repeat are found, so that they are written once and looped over.
//!
//! ```text
//! Graph
//!    │  blocks      what is computed for one body in one sweep of a recursion
//!    ▼
//! Block …
//!    │  interface   what a block reads and leaves, and whether two blocks differ in numbers and places alone
//!    ▼
//! Interface …
//!    │  schedule    an order in which like blocks follow each other
//!    ▼
//! Plan              groups of like blocks; where each finds what others left
//! ```
//!
//! Blocks leave their values in rows of arrays, one array for each length of row, so that like blocks find them by row alone.

mod blocks;
mod interface;
mod schedule;

pub use blocks::{Block, Blocks, Trigonometry};
pub use interface::{Interface, Read};
pub use schedule::late;

use super::graph::{Graph, Value};
use std::collections::BTreeMap;

/// The blocks of a graph in groups of like ones.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The blocks.
    pub blocks: Blocks,
    /// What each reads and leaves.
    pub interfaces: Vec<Interface>,
    /// Indices of like blocks, in an order in which they can be computed.
    pub groups: Vec<Vec<usize>>,
    /// The row of each block that leaves values in one, in the array for its number of values.
    pub rows: Vec<Option<usize>>,
    /// Rows of the array for each number of values.
    pub arrays: BTreeMap<usize, usize>,
}

impl Plan {
    /// The plan for what `outputs` need.
    pub fn new(graph: &Graph, outputs: &[Value]) -> Self {
        let blocks = Blocks::new(graph, outputs);
        let interfaces: Vec<Interface> = (0..blocks.blocks.len())
            .map(|block| Interface::new(graph, &blocks, outputs, block))
            .collect();
        let groups = schedule::groups(&interfaces);
        let mut plan = Self {
            rows: vec![None; blocks.blocks.len()],
            arrays: BTreeMap::new(),
            blocks,
            interfaces,
            groups,
        };
        plan.give_rows();
        plan
    }

    /// Rows for the blocks of loops and for those that loops read, in the order of computation.
    fn give_rows(&mut self) {
        let mut wanted = vec![false; self.rows.len()];
        for group in self.groups.iter().filter(|group| group.len() > 1) {
            for &block in group {
                wanted[block] = true;
                for &source in &self.interfaces[block].sources {
                    wanted[source] = true;
                }
            }
        }
        for &block in self.groups.iter().flatten() {
            let width = self.blocks.blocks[block].outputs.len();
            if wanted[block] && width > 0 {
                let rows = self.arrays.entry(width).or_insert(0);
                self.rows[block] = Some(*rows);
                *rows += 1;
            }
        }
    }

    /// Operations of what is written, where those of a loop are written once.
    pub fn written(&self, graph: &Graph) -> usize {
        let mut operations = super::graph::Operations::default();
        for group in &self.groups {
            for &node in &self.blocks.blocks[group[0]].nodes {
                operations.add(&graph.nodes[node as usize].operation);
            }
        }
        operations.flops()
    }
}
