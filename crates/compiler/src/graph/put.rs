//! Values with others in the place of their inputs: what depends on these is computed once more, and folded as it arises.

use super::sym::{call, call_two, make, primitive};
use super::{Argument, CURRENT, Node, Operation, Sym, Value, section};
use num_traits::Zero;
use rustc_hash::FxHashMap;

/// Nodes that changed, and what stands for them.
#[derive(Default)]
struct Changed {
    of: FxHashMap<u32, Sym>,
    /// Results of functions that have several.
    several: FxHashMap<u32, Vec<Sym>>,
}

/// The values with what `other` says in the place of entries of arguments; other entries stay.
pub fn put(values: &[Sym], other: impl Fn(Argument, usize) -> Option<Sym>) -> Vec<Sym> {
    let outputs: Vec<Value> = values.iter().map(|value| value.value()).collect();
    let needed: Vec<(u32, Node)> = CURRENT.with_borrow(|graph| {
        let uses = graph.uses(&outputs);
        let nodes = (0..).zip(&graph.nodes).zip(uses);
        let needed = nodes.filter(|(_, uses)| *uses > 0);
        needed
            .map(|((number, node), _)| (number, node.clone()))
            .collect()
    });
    let mut changed = Changed::default();
    for (number, node) in needed {
        section(node.section, node.topic);
        match &node.operation {
            Operation::Input(argument, place) => {
                let new = other(*argument, *place as usize);
                changed.of.extend(new.map(|new| (number, new)));
            }
            Operation::Several(function, arguments) => {
                if arguments.iter().any(|own| changed.has(own.node)) {
                    let arguments: Vec<Sym> =
                        arguments.iter().map(|own| changed.value(*own)).collect();
                    changed
                        .several
                        .insert(number, primitive(*function, &arguments));
                }
            }
            operation => {
                if let Some(new) = changed.computed(operation) {
                    let new = new.named(&node.label).settled();
                    changed.of.insert(number, new);
                }
            }
        }
    }
    let value = |value: &Sym| match value {
        Sym::Number(_) => *value,
        Sym::Node(value) => changed.value(*value),
    };
    values.iter().map(value).collect()
}

impl Changed {
    fn has(&self, node: u32) -> bool {
        self.of.contains_key(&node) || self.several.contains_key(&node)
    }

    fn node(&self, node: u32) -> Sym {
        self.of.get(&node).copied().unwrap_or_else(|| scalar(node))
    }

    fn value(&self, value: Value) -> Sym {
        let own = self.node(value.node);
        if value.negative { -own } else { own }
    }

    /// An operation once more; `None` where nothing that it reads has changed.
    fn computed(&self, operation: &Operation) -> Option<Sym> {
        let mut has_changed = false;
        operation.each_operand(|operand| has_changed |= self.has(operand));
        has_changed.then(|| match *operation {
            Operation::Sum(a, b) => self.node(a) + self.node(b),
            Operation::Difference(a, b) => self.node(a) - self.node(b),
            Operation::Product(a, b) => self.node(a) * self.node(b),
            Operation::Quotient(a, b) => self.node(a) / self.node(b),
            Operation::Opposite(a) => (-self.node(a)).settled(),
            Operation::Call(function, a, None) => call(function, self.value(a)),
            Operation::Call(function, a, Some(b)) => {
                call_two(function, self.value(a), self.value(b))
            }
            Operation::Part(all, place) => {
                let results = self.several.get(&all);
                let result = results.and_then(|results| results.get(place as usize));
                result.copied().unwrap_or_else(|| make(operation.clone()))
            }
            // They read nothing, or have several results.
            Operation::Input(..) | Operation::Constant(_) | Operation::Several(..) => Sym::zero(),
        })
    }
}

/// A node as a scalar: numbers as such, so that they fold.
pub(super) fn scalar(number: u32) -> Sym {
    let bits = CURRENT.with_borrow(|graph| match graph.nodes[number as usize].operation {
        Operation::Constant(bits) => Some(bits),
        _ => None,
    });
    match bits {
        Some(bits) => Sym::Number(f64::from_bits(bits)),
        None => Sym::Node(number.into()),
    }
}
