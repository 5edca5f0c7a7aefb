//! Products that share two factors: the pair becomes a product of its own, which is then computed once.

use super::Node;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Most pairs pulled out of one kernel: a bound on the work, far above what joints need.
const MOST_PAIRS: usize = 64;

/// Pulls the most frequent pairs of factors out of all products of the formulas.
pub fn extract_pairs(formulas: &mut [Node]) {
    for _ in 0..MOST_PAIRS {
        let Some((a, b)) = most_frequent_pair(formulas) else {
            return;
        };
        for formula in formulas.iter_mut() {
            *formula = with_pair(formula, &a, &b);
        }
    }
}

/// The pair of factors, numbers aside, in most distinct products; in two at least, one of them longer than the pair.
fn most_frequent_pair(formulas: &[Node]) -> Option<(Node, Node)> {
    let mut products = BTreeSet::new();
    for formula in formulas {
        formula.visit(&mut |node| {
            if let Node::Product(factors) = node {
                products.insert(factors.clone());
            }
        });
    }
    let mut uses: BTreeMap<(Node, Node), (usize, usize)> = BTreeMap::new();
    for factors in &products {
        for pair in pairs_of(factors) {
            let entry = uses.entry(pair).or_default();
            entry.0 += 1;
            entry.1 += usize::from(factors.len() > 2);
        }
    }
    let shared = uses
        .into_iter()
        .filter(|(_, (all, long))| *all >= 2 && *long >= 1);
    shared
        .min_by_key(|(pair, (all, _))| (Reverse(*all), pair.clone()))
        .map(|(pair, _)| pair)
}

fn pairs_of(factors: &[Node]) -> BTreeSet<(Node, Node)> {
    let named: Vec<&Node> = factors
        .iter()
        .filter(|factor| !matches!(factor, Node::Number(_)))
        .collect();
    let mut pairs = BTreeSet::new();
    for (i, a) in named.iter().enumerate() {
        for b in &named[i + 1..] {
            pairs.insert(((*a).clone(), (*b).clone()));
        }
    }
    pairs
}

fn with_pair(node: &Node, a: &Node, b: &Node) -> Node {
    let node = node.map_parts(&mut |part| with_pair(part, a, b));
    let Node::Product(factors) = &node else {
        return node;
    };
    let first = factors.iter().position(|factor| factor == a);
    let second = first.and_then(|first| {
        Some(first + 1 + factors[first + 1..].iter().position(|factor| factor == b)?)
    });
    let (Some(first), Some(second), true) = (first, second, factors.len() > 2) else {
        return node;
    };
    let mut factors = factors.clone();
    factors.remove(second);
    factors[first] = Node::Product(vec![a.clone(), b.clone()]);
    Node::Product(factors)
}
