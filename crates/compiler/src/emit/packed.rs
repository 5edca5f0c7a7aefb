//! A function without loops whose like limbs are computed side by side.
//!
//! The graph of [`Packs`] is written anew: a pack becomes one node, and between packs and other nodes stand crossings, nodes of their own for four numbers that are put side by
//! side and for each number that is extracted from a pack.

use super::Lowered;
use super::lower::{Crossing, Lowering, partners};
use super::straight::{batch, given};
use crate::alike::{Blocks, late};
use crate::graph::{Graph, Node, Operation, Value};
use crate::packs::{Packs, WIDTH};
use hamel_codegen::formula::names::NameSet;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// The lines of a function by its packs.
pub fn lowered(packs: &Packs, bodies: &[String], names: &mut NameSet) -> Lowered {
    let mut writer = Writer::new(packs, bodies);
    writer.write(&packs.outputs);
    let outputs: Vec<Value> = packs
        .outputs
        .iter()
        .map(|output| Value {
            node: writer.single(output.node),
            negative: output.negative,
        })
        .collect();
    let Writer {
        graph,
        crossings,
        left,
        order,
        bodies,
        ..
    } = writer;
    let needed: Vec<Value> = left.iter().map(|&node| node.into()).collect();
    let needed = [outputs.clone(), needed].concat();
    let uses = graph.uses(&needed);
    let body = |section: u32| bodies.get(section as usize).cloned().unwrap_or_default();
    let mut lowering = Lowering {
        graph: &graph,
        uses: &uses,
        partners: &partners(&graph, &uses),
        bodies: &body,
        left,
        crossings,
        outside: &|node| given(&graph, node),
        names,
        formulas: FxHashMap::default(),
        lines: vec![],
    };
    batch(&mut lowering, &Blocks::new(&graph, &needed));
    lowering.run(&order);
    let outputs = outputs.iter().map(|&output| lowering.read(output));
    let outputs = outputs.collect();
    Lowered {
        lines: lowering.lines,
        arrays: BTreeMap::new(),
        outputs: Some(outputs),
    }
}

struct Writer<'a> {
    packs: &'a Packs,
    /// Names of the sections, those of packs behind those of bodies.
    bodies: Vec<String>,
    /// The new graph.
    graph: Graph,
    /// New nodes of old ones that are in no pack, and of each number that is extracted from a pack.
    singles: FxHashMap<u32, u32>,
    /// New nodes of packs.
    together: FxHashMap<usize, u32>,
    /// New nodes of numbers that are put side by side.
    gathered: FxHashMap<Vec<u32>, u32>,
    /// Sections of packs, by those of their nodes.
    sections: FxHashMap<Vec<u32>, u32>,
    crossings: FxHashMap<u32, Crossing>,
    /// What crossings read.
    left: FxHashSet<u32>,
    /// New nodes in the order of their lines.
    order: Vec<u32>,
}

impl<'a> Writer<'a> {
    fn new(packs: &'a Packs, bodies: &[String]) -> Self {
        Self {
            packs,
            bodies: bodies.to_vec(),
            graph: Graph::default(),
            singles: FxHashMap::default(),
            together: FxHashMap::default(),
            gathered: FxHashMap::default(),
            sections: FxHashMap::default(),
            crossings: FxHashMap::default(),
            left: FxHashSet::default(),
            order: vec![],
        }
    }

    /// Writes what `outputs` need: in the order of a function without packs, and before each node what it needs.
    fn write(&mut self, outputs: &[Value]) {
        let blocks = Blocks::new(&self.packs.graph, outputs);
        let order = late(&self.packs.graph, &blocks);
        let mut trigonometry: Vec<u32> = blocks.trigonometry.keys().copied().collect();
        trigonometry.sort_unstable();
        let nodes = order.iter().flat_map(|&block| &blocks.blocks[block].nodes);
        for node in trigonometry.into_iter().chain(nodes.copied()) {
            self.reach(node);
        }
    }

    /// Writes a node and all that it needs.
    fn reach(&mut self, node: u32) {
        let mut stack = vec![(node, false)];
        while let Some((node, is_ready)) = stack.pop() {
            let home = self.packs.home[node as usize];
            let is_written = match home {
                Some(pack) => self.together.contains_key(&pack),
                None => self.singles.contains_key(&node),
            };
            if is_written {
                continue;
            }
            if is_ready {
                match home {
                    Some(pack) => self.pack(pack),
                    None => self.node(node),
                }
                continue;
            }
            stack.push((node, true));
            let own = home.map_or(vec![node], |pack| self.packs.packs[pack].nodes.clone());
            let mut needed = vec![];
            for node in own {
                let operation = &self.packs.graph.nodes[node as usize].operation;
                operation.each_operand(|operand| needed.push((operand, false)));
            }
            stack.extend(needed.into_iter().rev());
        }
    }

    fn push(&mut self, node: Node) -> u32 {
        let number = u32::try_from(self.graph.nodes.len()).unwrap_or(u32::MAX);
        self.graph.nodes.push(node);
        number
    }

    /// A node that is in no pack.
    fn node(&mut self, old: u32) {
        let node = self.packs.graph.nodes[old as usize].clone();
        let operation = node
            .operation
            .clone()
            .with_operands(|node| self.single(node));
        let is_given = matches!(operation, Operation::Input(..) | Operation::Constant(_));
        let new = self.push(Node { operation, ..node });
        self.singles.insert(old, new);
        if !is_given {
            self.order.push(new);
        }
    }

    fn pack(&mut self, pack: usize) {
        let own = &self.packs.packs[pack].nodes;
        let first = self.packs.graph.nodes[own[0] as usize].clone();
        let section = self.section(own);
        let slots = self.packs.slots(pack);
        let operands: Vec<u32> = slots
            .into_iter()
            .map(|nodes| self.side_by_side(nodes, section))
            .collect();
        let mut operands = operands.into_iter();
        let operation = first.operation.clone();
        // One for each operand.
        let operation = operation.with_operands(|node| operands.next().unwrap_or(node));
        let new = self.push(Node {
            operation,
            section,
            ..first
        });
        self.together.insert(pack, new);
        self.order.push(new);
    }

    /// The section of a pack.
    fn section(&mut self, nodes: &[u32]) -> u32 {
        let sections: Vec<u32> = nodes
            .iter()
            .map(|&node| self.packs.graph.nodes[node as usize].section)
            .collect();
        if let Some(&known) = self.sections.get(&sections) {
            return known;
        }
        let first = self.bodies.get(sections[0] as usize);
        let name = format!("each_{}", first.map_or("", String::as_str));
        let number = u32::try_from(self.bodies.len()).unwrap_or(u32::MAX);
        self.bodies.push(name);
        self.sections.insert(sections, number);
        number
    }

    /// What a pack of a section reads in one place, as a new node.
    fn side_by_side(&mut self, nodes: Vec<u32>, section: u32) -> u32 {
        if let Some(pack) = self.packs.holding(&nodes) {
            return self.together[&pack];
        }
        if let Some(&known) = self.gathered.get(&nodes) {
            return known;
        }
        let mut sources: Vec<u32> = nodes.iter().map(|&node| self.single(node)).collect();
        sources.resize(WIDTH, sources[sources.len() - 1]);
        self.left.extend(&sources);
        let first = self.packs.graph.nodes[nodes[0] as usize].clone();
        let new = self.crossing(
            sources[0],
            Node {
                section,
                label: "gathered".to_owned(),
                ..first
            },
        );
        self.crossings.insert(new, Crossing::Gather(sources));
        self.order.push(new);
        self.gathered.insert(nodes, new);
        new
    }

    /// A node for itself: its new node, or one of those that are extracted from a pack.
    fn single(&mut self, old: u32) -> u32 {
        if let Some(&known) = self.singles.get(&old) {
            return known;
        }
        let Some(pack) = self.packs.home[old as usize] else {
            // Written by `reach` but for inputs and numbers that outputs alone read.
            self.node(old);
            return self.singles[&old];
        };
        let source = self.together[&pack];
        let nodes = self.packs.packs[pack].nodes.clone();
        let parts: Vec<u32> = nodes
            .iter()
            .map(|&node| {
                let node = self.packs.graph.nodes[node as usize].clone();
                self.crossing(source, node)
            })
            .collect();
        self.left.insert(source);
        self.singles
            .extend(nodes.iter().copied().zip(parts.iter().copied()));
        self.order.push(parts[0]);
        self.crossings
            .insert(parts[0], Crossing::Extract(source, parts));
        self.singles[&old]
    }

    /// A node that `self.crossings` says more of, as `node` but for what it reads: the new `source`.
    fn crossing(&mut self, source: u32, node: Node) -> u32 {
        self.push(Node {
            operation: Operation::Opposite(source),
            ..node
        })
    }
}
