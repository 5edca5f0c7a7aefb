//! Formulas by number: equal ones have one number, so that asking whether two are equal does not walk through both.

use super::Node;
use crate::expr::Function;
use rustc_hash::FxHashMap;

/// A formula with its parts by number.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A formula without parts.
    Leaf(Node),
    /// As [`Node::Sum`].
    Sum(Vec<(bool, usize)>),
    /// As [`Node::Product`].
    Product(Vec<usize>),
    /// As [`Node::Quotient`].
    Quotient(usize, usize),
    /// As [`Node::Negative`].
    Negative(usize),
    /// As [`Node::Call`].
    Call(Function, Vec<usize>),
}

/// The distinct formulas met, with the places that use each.
#[derive(Default)]
pub struct Shapes {
    shapes: Vec<Shape>,
    numbers: FxHashMap<Shape, usize>,
    uses: Vec<usize>,
}

impl Shapes {
    /// The number of a formula.
    pub fn number(&mut self, node: &Node) -> usize {
        let shape = match node {
            Node::Number(_) | Node::Symbol(_) | Node::Pi => Shape::Leaf(node.clone()),
            Node::Sum(terms) => {
                let terms = terms
                    .iter()
                    .map(|(minus, term)| (*minus, self.number(term)));
                Shape::Sum(terms.collect())
            }
            Node::Product(factors) => Shape::Product(self.numbers(factors)),
            Node::Quotient(above, below) => Shape::Quotient(self.number(above), self.number(below)),
            Node::Negative(inner) => Shape::Negative(self.number(inner)),
            Node::Call(function, arguments) => Shape::Call(*function, self.numbers(arguments)),
        };
        if let Some(known) = self.numbers.get(&shape) {
            return *known;
        }
        self.shapes.push(shape.clone());
        self.uses.push(0);
        self.numbers.insert(shape, self.shapes.len() - 1);
        self.shapes.len() - 1
    }

    fn numbers(&mut self, nodes: &[Node]) -> Vec<usize> {
        nodes.iter().map(|node| self.number(node)).collect()
    }

    /// The number of a formula that has been met.
    pub fn known(&self, shape: &Shape) -> Option<usize> {
        self.numbers.get(shape).copied()
    }

    /// The formula of that number.
    pub fn shape(&self, number: usize) -> &Shape {
        &self.shapes[number]
    }

    /// Counts a place that uses a formula; the parts of a repeated one are counted once.
    pub fn count(&mut self, number: usize) {
        self.uses[number] += 1;
        if self.uses[number] == 1 {
            for part in self.parts(number) {
                self.count(part);
            }
        }
    }

    /// The places counted.
    pub fn uses(&self, number: usize) -> usize {
        self.uses[number]
    }

    fn parts(&self, number: usize) -> Vec<usize> {
        match self.shape(number) {
            Shape::Leaf(_) => vec![],
            Shape::Sum(terms) => terms.iter().map(|(_, term)| *term).collect(),
            Shape::Product(parts) | Shape::Call(_, parts) => parts.clone(),
            Shape::Quotient(above, below) => vec![*above, *below],
            Shape::Negative(inner) => vec![*inner],
        }
    }

    /// Whether it takes more than reading or changing a sign.
    pub fn is_operation(&self, number: usize) -> bool {
        !matches!(self.shape(number), Shape::Leaf(_) | Shape::Negative(_))
    }
}
