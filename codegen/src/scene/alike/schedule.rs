//! An order of blocks in which like ones follow each other.

use super::Interface;
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
