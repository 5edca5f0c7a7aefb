//! A definition read once, for evaluation at any number of points.

use super::tape::{Op, Tape};
use super::{Grid, Node, Tracked};
use std::cell::RefCell;
use std::rc::Rc;

/// Matrices by name; those of one name stand in order.
#[derive(Clone, Debug)]
pub struct Sheet<T> {
    matrices: Vec<(&'static str, Grid<T>)>,
}

impl<T> Default for Sheet<T> {
    fn default() -> Self {
        Self { matrices: vec![] }
    }
}

impl<T: Clone> Sheet<T> {
    /// Adds a matrix.
    pub fn put(&mut self, name: &'static str, matrix: Grid<T>) {
        self.matrices.push((name, matrix));
    }

    /// All matrices of that name.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Grid<T>> {
        let named = self.matrices.iter().filter(move |(other, _)| *other == name);
        named.map(|(_, matrix)| matrix)
    }

    /// The first matrix of that name, where there is one.
    pub fn find(&self, name: &str) -> Option<&Grid<T>> {
        let named = self.matrices.iter().find(|(other, _)| *other == name);
        named.map(|(_, matrix)| matrix)
    }

    /// The first matrix of that name.
    ///
    /// # Panics
    /// Where there is none.
    pub fn get(&self, name: &str) -> &Grid<T> {
        self.find(name).unwrap_or_else(|| panic!("{name} is defined"))
    }
}

/// Matrices as functions of numbers.
#[derive(Clone, Debug)]
pub struct Program {
    arguments: usize,
    tape: Tape,
    ops: Vec<(u32, Op)>,
    results: Sheet<u32>,
    values: RefCell<Vec<Tracked>>,
}

impl Program {
    /// Reads a definition of so many numbers.
    pub fn new(arguments: usize, definition: impl FnOnce(&[Node]) -> Sheet<Node>) -> Self {
        let tape = Rc::new(RefCell::new(Tape::new(arguments)));
        let places = 0..arguments as u32;
        let inputs: Vec<Node> = places.map(|n| Node::Place(Rc::clone(&tape), n)).collect();
        let sheet = definition(&inputs);
        let results = Sheet {
            matrices: sheet
                .matrices
                .iter()
                .map(|(name, matrix)| (*name, matrix.map(|entry| entry.place(&tape))))
                .collect(),
        };
        let tape = tape.borrow().clone();
        let entries = results.matrices.iter().flat_map(|(_, m)| m.entries());
        let needed: Vec<u32> = entries.copied().collect();
        Self {
            arguments,
            ops: tape.needed(&needed),
            values: RefCell::new(tape.start()),
            results,
            tape,
        }
    }

    /// Number of operations.
    pub fn size(&self) -> usize {
        self.ops.len()
    }

    /// The matrices for these numbers.
    pub fn run(&self, arguments: &[Tracked]) -> Sheet<Tracked> {
        assert_eq!(arguments.len(), self.arguments, "arguments of a definition");
        let mut values = self.values.borrow_mut();
        values[..arguments.len()].copy_from_slice(arguments);
        for (place, op) in &self.ops {
            self.tape.run(*place, *op, &mut values);
        }
        let matrices = self.results.matrices.iter();
        Sheet {
            matrices: matrices
                .map(|(name, matrix)| (*name, matrix.map(|place| values[*place as usize])))
                .collect(),
        }
    }
}
