//! Scalars of a scene's equations as a graph: every value once, with zeros, ones and signs folded as they arise.
//!
//! A [`Sym`] is a handle on a node of the graph that is under construction on this thread ([`record`]), with a sign: changes of sign are no
//! nodes. Equal operations on equal operands are one node. What is built is taken out as a [`Graph`]; what nothing needs is left
//! behind when it is written.

mod count;
mod fault;
pub mod known;
mod put;
mod slope;
mod sym;

pub use count::Operations;
pub use fault::{Cause, Fault, about, inverse_of_inertia};
pub use put::put;
pub use slope::Slopes;
pub use sym::{Sym, atan2, call, call_two, primitive, sin_cos};

use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;
use rustc_hash::FxHashMap;
use std::cell::RefCell;

/// A node, or its opposite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value {
    /// Index of the node.
    pub node: u32,
    /// Whether the opposite is meant.
    pub negative: bool,
}

impl Value {
    /// The opposite.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self {
            negative: !self.negative,
            ..self
        }
    }
}

impl From<u32> for Value {
    fn from(node: u32) -> Self {
        Self {
            node,
            negative: false,
        }
    }
}

/// An argument of the functions that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Argument {
    /// Q.
    Configuration,
    /// v̄.
    Speeds,
    /// p̄.
    Momenta,
    /// τ.
    Efforts,
    /// v̄̇.
    Accelerations,
    /// λ, with which second derivatives are contracted: one entry a speed.
    Weights,
    /// Numbers in an order of their own: what a step of a motion is given, [`stepping`](crate::stepping).
    Given,
}

/// What a node computes. Operands are nodes before it; those of sums and products are in ascending order, numbers last: so the order does
/// not depend on who used a number first.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// A scalar of an argument.
    Input(Argument, u32),
    /// A number by its bits: greater than 0 but where numbers keep their signs ([`record_alike`]).
    Constant(u64),
    /// a + b.
    Sum(u32, u32),
    /// a − b.
    Difference(u32, u32),
    /// a b.
    Product(u32, u32),
    /// a / b.
    Quotient(u32, u32),
    /// The opposite of a value, as a value of its own: between like bodies.
    Opposite(u32),
    /// A function of one or two values.
    Call(Function, Value, Option<Value>),
    /// A function of the runtime with several results, which [`Operation::Part`] alone reads.
    Several(Primitive, Vec<Value>),
    /// A result of such a function, by its number.
    Part(u32, u32),
}

impl Operation {
    /// The same with other nodes as operands, in the order of [`Operation::each_operand`].
    #[must_use]
    pub fn with_operands(self, mut other: impl FnMut(u32) -> u32) -> Self {
        let mut value = |of: Value| Value {
            node: other(of.node),
            ..of
        };
        match self {
            Self::Input(..) | Self::Constant(_) => self,
            Self::Opposite(of) => Self::Opposite(other(of)),
            Self::Part(of, result) => Self::Part(other(of), result),
            Self::Sum(a, b) => Self::Sum(other(a), other(b)),
            Self::Difference(a, b) => Self::Difference(other(a), other(b)),
            Self::Product(a, b) => Self::Product(other(a), other(b)),
            Self::Quotient(a, b) => Self::Quotient(other(a), other(b)),
            Self::Call(function, a, b) => Self::Call(function, value(a), b.map(value)),
            Self::Several(function, values) => {
                Self::Several(function, values.into_iter().map(value).collect())
            }
        }
    }

    /// Visits the nodes that it reads.
    pub fn each_operand(&self, mut visit: impl FnMut(u32)) {
        match self {
            Self::Input(..) | Self::Constant(_) => {}
            Self::Opposite(of) | Self::Part(of, _) => visit(*of),
            Self::Sum(a, b)
            | Self::Difference(a, b)
            | Self::Product(a, b)
            | Self::Quotient(a, b) => {
                visit(*a);
                visit(*b);
            }
            Self::Call(_, a, b) => std::iter::once(a)
                .chain(b)
                .for_each(|value| visit(value.node)),
            Self::Several(_, arguments) => arguments.iter().for_each(|value| visit(value.node)),
        }
    }
}

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it computes.
    pub operation: Operation,
    /// The section of the code that it belongs to.
    pub section: u32,
    /// What of that section's body.
    pub topic: &'static str,
    /// What it is called, without the name of the section's body: the topic where nobody named it.
    pub label: String,
}

/// Nodes in an order in which they can be computed.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// The nodes.
    pub nodes: Vec<Node>,
    known: FxHashMap<Operation, u32>,
    /// Whether numbers keep their signs.
    signed: bool,
    section: u32,
    topic: &'static str,
    /// What is being computed, where it is no part of a body.
    element: Option<String>,
    /// What left the numbers.
    faults: Vec<Fault>,
    /// What stands for entries of arguments.
    bound: FxHashMap<(Argument, u32), Sym>,
    /// Numbers, by their bits, that stand for entries of [`Argument::Given`].
    marks: FxHashMap<u64, u32>,
}

thread_local! {
    static CURRENT: RefCell<Graph> = RefCell::default();
}

/// Runs `build` on an empty graph and returns what it makes, with the graph.
///
/// Graphs do not nest: `build` must not call this.
pub fn record<R>(build: impl FnOnce() -> R) -> (R, Graph) {
    record_in(Graph::default(), build)
}

/// The same with numbers that keep their signs: bodies whose numbers differ in sign alone make like nodes, at the price of some products
/// that differ from others in sign alone.
pub fn record_alike<R>(build: impl FnOnce() -> R) -> (R, Graph) {
    let graph = Graph {
        signed: true,
        ..Graph::default()
    };
    record_in(graph, build)
}

/// The same, where numbers of the model stand for what is given later: those with the bits of a key of `marks`, and their opposites, become entries of [`Argument::Given`].
/// Numbers that are computed with before they come on the graph are not known any more; who marks numbers compares the graphs of two sets of them.
pub fn record_marked<R>(marks: FxHashMap<u64, u32>, build: impl FnOnce() -> R) -> (R, Graph) {
    let graph = Graph {
        marks,
        ..Graph::default()
    };
    record_in(graph, build)
}

/// Whether numbers of the model stand for what is given later.
pub fn is_marked() -> bool {
    CURRENT.with_borrow(|graph| !graph.marks.is_empty())
}

/// What follows in `build` has these values in place of the entries of an argument.
pub fn bound<R>(arguments: &[(Argument, &[Sym])], build: impl FnOnce() -> R) -> R {
    let entries = arguments.iter().flat_map(|(argument, values)| {
        let places = (0_u32..).map(|place| (*argument, place));
        places.zip(values.iter().copied())
    });
    let own = entries.collect();
    let before = CURRENT.with_borrow_mut(|graph| std::mem::replace(&mut graph.bound, own));
    let result = build();
    CURRENT.with_borrow_mut(|graph| graph.bound = before);
    result
}

fn record_in<R>(empty: Graph, build: impl FnOnce() -> R) -> (R, Graph) {
    CURRENT.with_borrow_mut(|graph| *graph = empty);
    let result = build();
    (result, CURRENT.take())
}

/// What follows belongs to section `number`, and is about `topic` where it has no name of its own.
pub fn section(number: u32, topic: &'static str) {
    CURRENT.with_borrow_mut(|graph| {
        graph.section = number;
        graph.topic = topic;
    });
}

impl Graph {
    /// The node that computes `operation`, made where there is none yet.
    pub(super) fn node(&mut self, operation: Operation) -> u32 {
        if let Some(&known) = self.known.get(&operation) {
            return known;
        }
        let number = u32::try_from(self.nodes.len()).unwrap_or(u32::MAX);
        self.nodes.push(Node {
            operation: operation.clone(),
            section: self.section,
            topic: self.topic,
            label: self.topic.to_owned(),
        });
        self.known.insert(operation, number);
        number
    }

    /// How often each node is read by what `outputs` need, and 0 for what they do not need.
    pub fn uses(&self, outputs: &[Value]) -> Vec<u32> {
        let mut uses = vec![0; self.nodes.len()];
        for output in outputs {
            uses[output.node as usize] += 1;
        }
        for (number, node) in self.nodes.iter().enumerate().rev() {
            if uses[number] > 0 {
                node.operation
                    .each_operand(|operand| uses[operand as usize] += 1);
            }
        }
        uses
    }
}
