//! A function without loops.

use super::lines::{Formula, Heading, Line, Place};
use super::lower::{Lowering, partners};
use super::{Function, Lowered};
use crate::alike::{Blocks, Read, late};
use crate::graph::{Graph, Operation, Operations};
use hamel_codegen::formula::names::NameSet;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// The lines of a function; `bodies` are the names of the sections, `names` holds those that must not be used.
pub fn lowered(function: &Function, bodies: &[String], names: &mut NameSet) -> Lowered {
    let graph = &function.graph;
    let uses = graph.uses(&function.outputs);
    let body = |section: u32| bodies.get(section as usize).cloned().unwrap_or_default();
    let mut lowering = Lowering {
        graph,
        uses: &uses,
        partners: &partners(graph, &uses),
        bodies: &body,
        left: FxHashSet::default(),
        crossings: FxHashMap::default(),
        outside: &|node| given(graph, node),
        names,
        formulas: FxHashMap::default(),
        lines: vec![],
    };
    let blocks = Blocks::new(graph, &function.outputs);
    batch(&mut lowering, &blocks);
    let order = late(graph, &blocks);
    let nodes = order.iter().flat_map(|&block| &blocks.blocks[block].nodes);
    lowering.run(&nodes.copied().collect::<Vec<u32>>());
    let outputs = function.outputs.iter();
    let outputs = outputs.map(|&output| lowering.read(output)).collect();
    Lowered {
        lines: lowering.lines,
        arrays: BTreeMap::new(),
        outputs: Some(outputs),
    }
}

/// An argument's entry, or a number.
pub fn given(graph: &Graph, node: u32) -> Formula {
    match graph.nodes[node as usize].operation {
        Operation::Input(argument, entry) => {
            Formula::Input(Read::Argument(argument), Place::Known(entry as usize))
        }
        Operation::Constant(bits) => Formula::Number(f64::from_bits(bits)),
        // Nodes that compute are lowered before they are read.
        _ => Formula::Number(f64::NAN),
    }
}

/// Sines and cosines of arguments come first and together.
pub fn batch(lowering: &mut Lowering<'_>, blocks: &Blocks) {
    let mut calls: Vec<u32> = blocks.trigonometry.keys().copied().collect();
    calls.sort_unstable();
    let mut operations = Operations::default();
    let mut named = vec![];
    for node in calls {
        let operation = &lowering.graph.nodes[node as usize].operation;
        operations.add(operation);
        let Operation::Call(function, angle, _) = operation else {
            continue;
        };
        if !lowering.formulas.contains_key(&node) {
            named.push(lowering.sin_cos(node, *function, *angle));
        }
    }
    if !named.is_empty() {
        lowering.lines.push(Line::Heading(heading(operations)));
        lowering.lines.push(Line::SinCosAll(named));
    }
}

/// What stands above the sines and cosines of all angles.
pub fn heading(operations: Operations) -> Heading {
    Heading {
        body: "all joints".to_owned(),
        topic: "sines and cosines",
        operations,
    }
}
