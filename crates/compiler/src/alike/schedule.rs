//! Orders of blocks: one in which like ones follow each other, and one in which values are read soon after.

use super::{Blocks, Interface};
use crate::graph::Graph;
use std::collections::BTreeSet;

/// Groups of like blocks: the next is always like the one before, where one can be computed, else the earliest.
pub fn groups(interfaces: &[Interface]) -> Vec<Vec<usize>> {
    let classes = classes(interfaces);
    let mut missing: Vec<usize> = interfaces.iter().map(|block| block.sources.len()).collect();
    let mut readers: Vec<Vec<usize>> = vec![vec![]; interfaces.len()];
    for (block, interface) in interfaces.iter().enumerate() {
        for &source in &interface.sources {
            readers[source].push(block);
        }
    }
    let mut ready: BTreeSet<(usize, usize)> = BTreeSet::new();
    let mut waiting: BTreeSet<usize> = (0..interfaces.len()).filter(|&b| missing[b] == 0).collect();
    ready.extend(waiting.iter().map(|&block| (classes[block], block)));
    let mut groups: Vec<Vec<usize>> = vec![];
    let mut class = usize::MAX;
    while let Some(&earliest) = waiting.first() {
        let same = ready.range((class, 0)..=(class, usize::MAX)).next();
        let block = match same {
            Some(&(_, block)) => block,
            None => earliest,
        };
        match groups.last_mut() {
            Some(group) if classes[block] == class => group.push(block),
            _ => groups.push(vec![block]),
        }
        class = classes[block];
        waiting.remove(&block);
        ready.remove(&(class, block));
        for &reader in &readers[block] {
            missing[reader] -= 1;
            if missing[reader] == 0 {
                waiting.insert(reader);
                ready.insert((classes[reader], reader));
            }
        }
    }
    groups
}

/// Each block as late as it can be, right before the first that reads it: few values wait at any time, as a limb of a tree is done, outward and
/// inward, before the next one begins.
pub fn late(graph: &Graph, blocks: &Blocks) -> Vec<usize> {
    let count = blocks.blocks.len();
    let sources: Vec<BTreeSet<usize>> = (0..count).map(|b| blocks.sources(graph, b)).collect();
    let read: BTreeSet<usize> = sources.iter().flatten().copied().collect();
    let mut order = Vec::with_capacity(count);
    let mut is_done = vec![false; count];
    for last in (0..count).filter(|block| !read.contains(block)) {
        let mut stack = vec![(last, sources[last].iter())];
        while let Some((block, waited_for)) = stack.last_mut() {
            if let Some(&source) = waited_for.find(|&&source| !is_done[source]) {
                stack.push((source, sources[source].iter()));
            } else {
                is_done[*block] = true;
                order.push(*block);
                stack.pop();
            }
        }
    }
    order
}

/// For each block the number of the first that it is like.
fn classes(interfaces: &[Interface]) -> Vec<usize> {
    let mut known: rustc_hash::FxHashMap<u64, Vec<usize>> = rustc_hash::FxHashMap::default();
    let class = |(index, interface): (usize, &Interface)| {
        let alike = known.entry(interface.fingerprint()).or_default();
        let found = alike
            .iter()
            .copied()
            .find(|&first| interfaces[first].is_like(interface));
        found.unwrap_or_else(|| {
            alike.push(index);
            index
        })
    };
    interfaces.iter().enumerate().map(class).collect()
}
