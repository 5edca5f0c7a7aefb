//! Which nodes of like limbs compute the same.

use super::limbs::Member;
use super::{Pack, WIDTH};
use crate::graph::{Argument, Graph, Operation};
use crate::model::Model;
use hamel_codegen::expr::Function;
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

/// The packs that there are, those that do not pay as well.
pub fn packs(model: &Model, members: &[Option<Member>], graph: &Graph, uses: &[u32]) -> Vec<Pack> {
    let mut likeness = Likeness::new(model, members, graph);
    // Partial sums over limbs are taken for the limb that was added last, and so is all that reads the whole sum: it shows only without them to which limb that belongs.
    likeness.read();
    while likeness.unassign(uses) {
        likeness.read();
    }
    let alike =
        likeness.alike(|node| uses[node] > 0 && can_be_packed(&graph.nodes[node].operation));
    let mut found: Vec<Vec<u32>> = alike.values().flat_map(|lists| together(lists)).collect();
    // Colors are hashes: what packs rest on is looked at itself.
    let depths = depths(graph);
    found.retain(|nodes| is_sound(graph, &depths, nodes));
    found.sort_unstable();
    likeness.matched(found)
}

/// Nodes that compute the same for limbs, side by side: those of the same rank in each limb, and where limbs have different numbers of them, as of the entries of a
/// symmetric matrix, all in turn.
fn together(lists: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let ranks = lists[0].len();
    if lists.iter().all(|list| list.len() == ranks) {
        let row = |rank: usize| lists.iter().map(|list| list[rank]).collect();
        let rows = (0..ranks).map(row);
        return rows.filter(|row: &Vec<u32>| row.len() > 1).collect();
    }
    let all: Vec<u32> = lists.concat();
    let rows = all.chunks(WIDTH).map(<[u32]>::to_vec);
    rows.filter(|row| row.len() > 1).collect()
}

/// For each node the operations on the longest way to it.
fn depths(graph: &Graph) -> Vec<u32> {
    let mut depths: Vec<u32> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let mut depth = 0;
        node.operation
            .each_operand(|operand| depth = depth.max(depths[operand as usize] + 1));
        depths.push(depth);
    }
    depths
}

/// Whether nodes do the same, and none needs another.
fn is_sound(graph: &Graph, depths: &[u32], nodes: &[u32]) -> bool {
    let does = |node: u32| std::mem::discriminant(&graph.nodes[node as usize].operation);
    let depth = |node: u32| depths[node as usize];
    let mut nodes = nodes.iter().copied();
    let first = nodes.next();
    first.is_none_or(|first| {
        nodes.all(|node| does(node) == does(first) && depth(node) == depth(first))
    })
}

/// Whether an operation has a form for several numbers side by side.
fn can_be_packed(operation: &Operation) -> bool {
    match operation {
        Operation::Sum(..)
        | Operation::Difference(..)
        | Operation::Product(..)
        | Operation::Quotient(..)
        | Operation::Opposite(_) => true,
        Operation::Call(Function::Sqrt, of, None) => !of.negative,
        _ => false,
    }
}

/// Class, first limb and color.
type Key = (usize, usize, u64);

struct Likeness<'a> {
    graph: &'a Graph,
    members: &'a [Option<Member>],
    parents: Vec<Option<usize>>,
    /// The body of each entry of the arguments that bodies have a share of, with the place in this share.
    inputs: BTreeMap<(Argument, u32), (usize, u32)>,
    /// Bodies of each class.
    sizes: BTreeMap<usize, usize>,
    /// Nodes that belong to no limb although they read of one.
    unassigned: FxHashSet<usize>,
    /// For each node the body of like ones that it belongs to.
    limbs: Vec<Option<usize>>,
    /// For each node a number that those share which compute the same for different limbs.
    colors: Vec<u64>,
}

impl<'a> Likeness<'a> {
    fn new(model: &Model, members: &'a [Option<Member>], graph: &'a Graph) -> Self {
        let mut sizes = BTreeMap::new();
        for member in members.iter().flatten() {
            *sizes.entry(member.class).or_insert(0) += 1;
        }
        let mut inputs = BTreeMap::new();
        for ((index, _), share) in model.bodies.iter().enumerate().zip(model.shares()).rev() {
            let ranges = [
                (Argument::Configuration, share.configuration),
                (Argument::Efforts, share.freedoms),
                (Argument::Speeds, share.speeds.clone()),
                (Argument::Momenta, share.speeds.clone()),
                (Argument::Accelerations, share.speeds.clone()),
                (Argument::Weights, share.speeds),
            ];
            for (argument, range) in ranges {
                for (offset, entry) in (0_u32..).zip(range) {
                    inputs.insert((argument, entry as u32), (index, offset));
                }
            }
        }
        Self {
            graph,
            members,
            parents: model.bodies.iter().map(|body| body.parent).collect(),
            inputs,
            sizes,
            unassigned: FxHashSet::default(),
            limbs: vec![],
            colors: vec![],
        }
    }

    /// Finds limbs and colors of all nodes.
    fn read(&mut self) {
        self.limbs.clear();
        self.colors.clear();
        (0..self.graph.nodes.len()).for_each(|number| self.add(number));
    }

    /// Whether a node is in the section of a body that has like ones.
    fn is_of_limb(&self, number: usize) -> bool {
        let section = self.graph.nodes[number].section as usize;
        matches!(self.members.get(section), Some(Some(_)))
    }

    /// The nodes that belong to limbs, by class, first limb of those side by side, and color; limb by limb.
    fn alike(&self, is_wanted: impl Fn(usize) -> bool) -> BTreeMap<Key, Vec<Vec<u32>>> {
        let mut alike: BTreeMap<Key, Vec<Vec<u32>>> = BTreeMap::new();
        for number in (0..self.graph.nodes.len()).filter(|&number| is_wanted(number)) {
            if let Some((key, limb)) = self.key(number) {
                let count = (self.sizes[&key.0] - key.1).min(WIDTH);
                let lists = alike.entry(key).or_insert_with(|| vec![vec![]; count]);
                // Numbers of nodes fit.
                lists[limb].push(number as u32);
            }
        }
        alike
    }

    /// Where a node stands in [`Likeness::alike`].
    fn key(&self, number: usize) -> Option<(Key, usize)> {
        let member = self.members[self.limbs[number]?]?;
        let first = member.limb / WIDTH * WIDTH;
        let key = (member.class, first, self.colors[number]);
        Some((key, member.limb - first))
    }

    /// Takes nodes from limbs that have nothing like them for another limb, while all that they read has: those outside of limbs, and those that are the only ones of their
    /// color. Returns whether there was any.
    fn unassign(&mut self, uses: &[u32]) -> bool {
        let alike = self.alike(|node| uses[node] > 0);
        let is_alone = |node: usize, is_of_limb: bool| {
            let lists = self.key(node).and_then(|(key, _)| alike.get(&key));
            lists.is_some_and(|lists| match is_of_limb {
                true => lists.iter().map(Vec::len).sum::<usize>() == 1,
                false => lists.iter().any(Vec::is_empty),
            })
        };
        let before = self.unassigned.len();
        let first = (0..self.graph.nodes.len()).filter(|&node| {
            let operation = &self.graph.nodes[node].operation;
            let mut is_first = uses[node] > 0 && is_alone(node, self.is_of_limb(node));
            operation.each_operand(|operand| is_first &= !is_alone(operand as usize, false));
            is_first && !matches!(operation, Operation::Input(..))
        });
        let first: Vec<usize> = first.collect();
        self.unassigned.extend(first);
        self.unassigned.len() > before
    }

    /// Adds the next node.
    fn add(&mut self, number: usize) {
        let node = &self.graph.nodes[number];
        let mut hasher = rustc_hash::FxHasher::default();
        let limb = match &node.operation {
            Operation::Constant(_) => {
                "number".hash(&mut hasher);
                self.limbs.push(None);
                self.colors.push(hasher.finish());
                return;
            }
            Operation::Input(argument, entry) => {
                let known = self.inputs.get(&(*argument, *entry)).copied();
                let known = known.filter(|&(body, _)| self.members[body].is_some());
                (argument, known.map(|(_, offset)| offset)).hash(&mut hasher);
                known.map(|(body, _)| body)
            }
            operation => {
                self.structure(operation, &mut hasher);
                match self.is_of_limb(number) {
                    _ if self.unassigned.contains(&number) => None,
                    true => Some(node.section as usize),
                    false => self.common(operation),
                }
            }
        };
        match limb.and_then(|body| self.members[body]) {
            Some(member) => member.class.hash(&mut hasher),
            // What no limb has is itself alone.
            None => number.hash(&mut hasher),
        }
        self.limbs.push(limb);
        self.colors.push(hasher.finish());
    }

    /// What an operation does with what.
    fn structure(&self, operation: &Operation, hasher: &mut impl Hasher) {
        std::mem::discriminant(operation).hash(hasher);
        let mut colors = vec![];
        operation.each_operand(|node| colors.push(self.colors[node as usize]));
        match operation {
            Operation::Sum(..) | Operation::Product(..) => colors.sort_unstable(),
            Operation::Call(function, a, b) => {
                (function, a.negative, b.map(|b| b.negative)).hash(hasher);
            }
            Operation::Several(function, values) => {
                function.hash(hasher);
                values.iter().for_each(|value| value.negative.hash(hasher));
            }
            Operation::Part(_, result) => result.hash(hasher),
            _ => {}
        }
        colors.hash(hasher);
    }

    /// The one limb that the operands belong to: the outer of two bodies of one limb.
    fn common(&self, operation: &Operation) -> Option<usize> {
        let mut bodies = vec![];
        operation.each_operand(|node| bodies.extend(self.limbs[node as usize]));
        let mut common: Option<usize> = None;
        for body in bodies {
            common = match common {
                None => Some(body),
                Some(other) if self.carries(other, body) => Some(body),
                Some(other) if self.carries(body, other) => Some(other),
                Some(_) => return None,
            };
        }
        common
    }

    /// Whether the way from `outer` to the root leads by `inner`.
    fn carries(&self, inner: usize, outer: usize) -> bool {
        let mut way = Some(outer);
        while let Some(body) = way.filter(|&body| body > inner) {
            way = self.parents[body];
        }
        way == Some(inner)
    }

    /// Packs of these nodes, with the operands that match each other.
    fn matched(&self, found: Vec<Vec<u32>>) -> Vec<Pack> {
        let mut places: Vec<Option<(usize, usize)>> = vec![None; self.graph.nodes.len()];
        for (number, nodes) in found.iter().enumerate() {
            for (place, &node) in nodes.iter().enumerate() {
                places[node as usize] = Some((number, place));
            }
        }
        let operands = |node: u32| {
            let mut operands = vec![];
            let operation = &self.graph.nodes[node as usize].operation;
            operation.each_operand(|operand| operands.push(operand));
            operands
        };
        let matched = |nodes: Vec<u32>| {
            let first = operands(nodes[0]);
            let own = nodes.iter().enumerate().map(|(limb, &node)| {
                let mut own = operands(node);
                let commutes = matches!(
                    self.graph.nodes[node as usize].operation,
                    Operation::Sum(..) | Operation::Product(..)
                );
                if commutes && self.is_swapped(&first, &own, (&places, limb)) {
                    own.swap(0, 1);
                }
                own
            });
            let operands = own.collect();
            Pack { nodes, operands }
        };
        found.into_iter().map(matched).collect()
    }

    /// Whether two operands match those of the first node in the other order.
    fn is_swapped(
        &self,
        first: &[u32],
        own: &[u32],
        (places, limb): (&[Option<(usize, usize)>], usize),
    ) -> bool {
        let matches = |first: u32, own: u32| {
            let together = || {
                let (pack, _) = places[first as usize]?;
                Some(places[own as usize] == Some((pack, limb)))
            };
            match first == own || together().unwrap_or(false) {
                true => 2,
                false => usize::from(self.colors[first as usize] == self.colors[own as usize]),
            }
        };
        let straight = matches(first[0], own[0]) + matches(first[1], own[1]);
        straight < matches(first[0], own[1]) + matches(first[1], own[0])
    }
}
