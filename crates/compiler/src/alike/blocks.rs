//! The nodes of a graph by blocks: what is computed for one body in one sweep of a recursion.

use crate::graph::{Graph, Operation, Value};
use hamel_codegen::expr::Function;
use rustc_hash::FxHashMap;
use std::collections::BTreeSet;

/// What is computed for one body in one sweep.
#[derive(Clone, Debug)]
pub struct Block {
    /// The section of its nodes.
    pub section: u32,
    /// Its nodes, in order.
    pub nodes: Vec<u32>,
    /// Those that other blocks read, in order.
    pub outputs: Vec<u32>,
}

/// A sine or cosine of an entry of an argument: all of these are computed at first, together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trigonometry {
    /// Whether it is the sine.
    pub is_sine: bool,
    /// The angle's number in [`Blocks::angles`].
    pub angle: usize,
}

/// The blocks of a graph, in an order in which they can be computed.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// The blocks.
    pub blocks: Vec<Block>,
    /// The block of each node that is in one.
    pub home: FxHashMap<u32, usize>,
    /// Angles, entries of arguments, of which sines or cosines are needed.
    pub angles: Vec<u32>,
    /// The sines and cosines of these.
    pub trigonometry: FxHashMap<u32, Trigonometry>,
}

impl Blocks {
    /// The blocks of what `outputs` need.
    pub fn new(graph: &Graph, outputs: &[Value]) -> Self {
        let uses = graph.uses(outputs);
        let mut blocks = Self::default();
        let mut latest = FxHashMap::default();
        for run in blocks.runs(graph, &uses) {
            blocks.add(graph, run, &mut latest);
        }
        blocks.find_outputs(graph);
        blocks
    }

    /// What follows each other in one section, without what is no block's.
    fn runs(&mut self, graph: &Graph, uses: &[u32]) -> Vec<(u32, Vec<u32>)> {
        let mut runs: Vec<(u32, Vec<u32>)> = vec![];
        let mut angles = FxHashMap::default();
        for (number, node) in (0_u32..).zip(&graph.nodes) {
            let is_given = matches!(
                node.operation,
                Operation::Input(..) | Operation::Constant(_)
            );
            if is_given || uses[number as usize] == 0 {
                continue;
            }
            if let Some((is_sine, input)) = of_input(graph, &node.operation) {
                let angle = *angles.entry(input).or_insert_with(|| {
                    self.angles.push(input);
                    self.angles.len() - 1
                });
                let value = Trigonometry { is_sine, angle };
                self.trigonometry.insert(number, value);
                continue;
            }
            match runs.last_mut() {
                Some((section, run)) if *section == node.section => run.push(number),
                _ => runs.push((node.section, vec![number])),
            }
        }
        runs
    }

    /// Adds a run to the latest block of its section, if that can be computed where this stands; else as a block of its own.
    fn add(
        &mut self,
        graph: &Graph,
        (section, run): (u32, Vec<u32>),
        latest: &mut FxHashMap<u32, usize>,
    ) {
        let mut needed = None;
        for &node in &run {
            let operation = &graph.nodes[node as usize].operation;
            operation.each_operand(|node| needed = needed.max(self.home.get(&node)));
        }
        let place = match latest.get(&section) {
            Some(&block) if needed.is_none_or(|&needed| needed <= block) => block,
            _ => {
                self.blocks.push(Block {
                    section,
                    nodes: vec![],
                    outputs: vec![],
                });
                self.blocks.len() - 1
            }
        };
        latest.insert(section, place);
        self.home.extend(run.iter().map(|&node| (node, place)));
        self.blocks[place].nodes.extend(run);
    }

    /// The other blocks that a block reads.
    pub fn sources(&self, graph: &Graph, block: usize) -> BTreeSet<usize> {
        let mut sources = BTreeSet::new();
        for &node in &self.blocks[block].nodes {
            let operation = &graph.nodes[node as usize].operation;
            operation.each_operand(|node| sources.extend(self.home.get(&node).copied()));
        }
        sources.remove(&block);
        sources
    }

    fn find_outputs(&mut self, graph: &Graph) {
        let mut read: Vec<u32> = vec![];
        for (index, block) in self.blocks.iter().enumerate() {
            for &node in &block.nodes {
                let operation = &graph.nodes[node as usize].operation;
                operation.each_operand(|node| {
                    if self.home.get(&node).is_some_and(|&home| home != index) {
                        read.push(node);
                    }
                });
            }
        }
        read.sort_unstable();
        read.dedup();
        for node in read {
            let home = self.home[&node];
            self.blocks[home].outputs.push(node);
        }
    }
}

/// Whether an operation is the sine (true) or cosine of an entry of an argument, and of which.
fn of_input(graph: &Graph, operation: &Operation) -> Option<(bool, u32)> {
    let Operation::Call(function @ (Function::Sin | Function::Cos), angle, None) = operation else {
        return None;
    };
    let of = &graph.nodes[angle.node as usize].operation;
    let plain = matches!(of, Operation::Input(..)) && !angle.negative;
    plain.then_some((*function == Function::Sin, angle.node))
}
