//! Quotients by one divisor: from three on, one division and products with the reciprocal.
//!
//! A product with a reciprocal has one rounding more than a quotient, so that two quotients stay quotients, and so does
//! division by numbers and π, whose reciprocals the compiler knows.

use super::Node;
use std::collections::{BTreeMap, BTreeSet};

/// Quotients by one divisor that are worth a reciprocal.
const ENOUGH: usize = 3;

/// Replaces quotients by products with reciprocals, where enough quotients have the same divisor.
pub fn share_reciprocals(formulas: &mut [Node]) {
    let mut quotients: BTreeSet<(Node, Node)> = BTreeSet::new();
    for formula in formulas.iter() {
        formula.visit(&mut |node| {
            if let Node::Quotient(above, below) = node {
                quotients.insert(((**below).clone(), (**above).clone()));
            }
        });
    }
    let mut counts: BTreeMap<Node, usize> = BTreeMap::new();
    for (below, _) in quotients {
        *counts.entry(below).or_default() += 1;
    }
    counts.retain(|below, count| *count >= ENOUGH && !is_constant(below));
    if !counts.is_empty() {
        formulas
            .iter_mut()
            .for_each(|formula| *formula = with_reciprocals(formula, &counts));
    }
}

fn is_constant(node: &Node) -> bool {
    let mut constant = true;
    node.visit(&mut |part| constant &= !matches!(part, Node::Symbol(_)));
    constant
}

fn with_reciprocals(node: &Node, shared: &BTreeMap<Node, usize>) -> Node {
    let rewritten = node.map_parts(&mut |part| with_reciprocals(part, shared));
    match (node, rewritten) {
        (Node::Quotient(_, below), Node::Quotient(above, new_below))
            if shared.contains_key(below) =>
        {
            let reciprocal = Node::Quotient(Box::new(Node::one()), new_below);
            match *above {
                one if one.is_one() => reciprocal,
                Node::Product(mut factors) => {
                    factors.push(reciprocal);
                    Node::Product(factors)
                }
                other => Node::Product(vec![other, reciprocal]),
            }
        }
        (_, rewritten) => rewritten,
    }
}
