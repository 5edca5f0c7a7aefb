//! Quotients by one divisor: from three on, one division and products with the reciprocal; of two with a common factor, one division of
//! that.
//!
//! A product with a reciprocal has one rounding more than a quotient, so that two quotients without a common factor stay quotients, and so
//! does division by numbers and π, whose reciprocals the compiler knows.

use super::Node;
use std::collections::{BTreeMap, BTreeSet};

/// Quotients by one divisor that are worth a reciprocal.
const ENOUGH: usize = 3;

/// What quotients by a divisor are written with.
enum Shared {
    /// The reciprocal.
    Reciprocal,
    /// The quotient of these factors.
    Factors(Vec<Node>),
}

/// Replaces quotients by products with reciprocals, where enough quotients have the same divisor, and by products with one quotient, where two
/// have a common factor.
pub fn share_reciprocals(formulas: &mut [Node]) {
    let mut quotients: BTreeMap<Node, BTreeSet<Node>> = BTreeMap::new();
    for formula in formulas.iter() {
        formula.visit(&mut |node| {
            if let Node::Quotient(above, below) = node {
                let above = (**above).clone();
                quotients
                    .entry((**below).clone())
                    .or_default()
                    .insert(above);
            }
        });
    }
    let divisors = quotients.into_iter();
    let divisors = divisors.filter(|(below, _)| !is_constant(below));
    let shared = divisors.filter_map(|(below, all)| shared(&all).map(|shared| (below, shared)));
    let shared: BTreeMap<Node, Shared> = shared.collect();
    if !shared.is_empty() {
        formulas
            .iter_mut()
            .for_each(|formula| *formula = with_shared(formula, &shared));
    }
}

/// What the quotients of all these by one divisor share.
fn shared(all: &BTreeSet<Node>) -> Option<Shared> {
    if all.len() >= ENOUGH {
        return Some(Shared::Reciprocal);
    }
    let mut all = all.iter().map(factors);
    let (first, second) = (all.next()?, all.next()?);
    let common = common(first, second);
    (!common.is_empty()).then_some(Shared::Factors(common))
}

fn factors(node: &Node) -> &[Node] {
    match node {
        Node::Product(factors) => factors,
        other => std::slice::from_ref(other),
    }
}

/// The factors of both, numbers aside.
fn common(first: &[Node], second: &[Node]) -> Vec<Node> {
    let mut second: Vec<&Node> = second.iter().collect();
    let mut is_common = |factor: &&Node| {
        let at = second.iter().position(|other| *other == *factor);
        !is_constant(factor) && at.map(|at| second.remove(at)).is_some()
    };
    first
        .iter()
        .filter(|factor| is_common(factor))
        .cloned()
        .collect()
}

fn is_constant(node: &Node) -> bool {
    let mut constant = true;
    node.visit(&mut |part| constant &= !matches!(part, Node::Symbol(_)));
    constant
}

fn with_shared(node: &Node, all: &BTreeMap<Node, Shared>) -> Node {
    let rewritten = node.map_parts(&mut |part| with_shared(part, all));
    let (Node::Quotient(_, below), Node::Quotient(above, new_below)) = (node, &rewritten) else {
        return rewritten;
    };
    let quotient = |above: Node| Node::Quotient(Box::new(above), new_below.clone());
    let (above, shared) = match all.get(below) {
        None => return rewritten,
        Some(Shared::Reciprocal) => ((**above).clone(), Node::one()),
        Some(Shared::Factors(common)) => {
            let common: Vec<Node> = common.iter().map(|part| with_shared(part, all)).collect();
            (without(factors(above), &common), Node::of_factors(common))
        }
    };
    let shared = quotient(shared);
    match above {
        one if one.is_one() => shared,
        Node::Product(mut factors) => {
            factors.push(shared);
            Node::Product(factors)
        }
        other => Node::Product(vec![other, shared]),
    }
}

/// The product of the factors that are left without these.
fn without(factors: &[Node], taken: &[Node]) -> Node {
    let mut rest = factors.to_vec();
    for factor in taken {
        if let Some(at) = rest.iter().position(|other| other == factor) {
            rest.remove(at);
        }
    }
    Node::of_factors(rest)
}
