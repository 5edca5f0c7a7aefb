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
        let named = self
            .matrices
            .iter()
            .filter(move |(other, _)| *other == name);
        named.map(|(_, matrix)| matrix)
    }

    /// The matrices of that name alone.
    pub fn only(mut self, name: &str) -> Self {
        self.matrices.retain(|(other, _)| *other == name);
        self
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
        self.find(name)
            .unwrap_or_else(|| panic!("{name} is defined"))
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

#[cfg(test)]
mod tests {
    use super::{Program, Sheet};
    use crate::accuracy::{Grid, Node, Tracked};
    use hamel_codegen::expr::{Function, Number};

    /// Sums, products, quotients, functions and two systems of four numbers, some of which may be known beforehand.
    fn definition(x: &[Node]) -> Sheet<Node> {
        let one = Node::input(1.0);
        let angle = x[0].times(&x[1]).plus(&one);
        let sine = one.function(Function::Sin, std::slice::from_ref(&angle));
        let turned = one.function(Function::Atan2, &[sine.clone(), x[2].negative()]);
        let nothing = x[3].times(&Node::input(0.0)).plus(&x[3]);
        let matrix = Grid::of_entries(3, 2, [x, &[sine, turned]].concat());
        let right = Grid::column(vec![angle.over(&x[3]), nothing, one]);
        let left = matrix.left_inverse();
        let mut sheet = Sheet::default();
        sheet.put("solution", matrix.solve_by(&left, &right));
        sheet.put("inverse", matrix.transpose().times(&matrix).inverse());
        sheet.put("right", right);
        sheet
    }

    /// What is recorded and run is, number for number, what is known beforehand.
    #[test]
    fn recorded_is_direct() {
        for numbers in [[0.5, -1.25, 2.0, 0.75], [0.0, 1.0, -1.0, 3.0]] {
            let numbers = numbers.map(Tracked::input);
            let direct = definition(&numbers.map(Node::Known));
            for known in 0..4 {
                let program = Program::new(4, |inputs| {
                    let mut inputs = inputs.to_vec();
                    inputs[known] = Node::Known(numbers[known]);
                    definition(&inputs)
                });
                let run = program.run(&numbers);
                for name in ["solution", "inverse", "right"] {
                    let want = direct.get(name).map(|x| x.known().expect("is known"));
                    assert_eq!(run.get(name).entries(), want.entries(), "{name}");
                }
            }
        }
    }

    /// Equal operations are done once, those that no result needs not at all.
    #[test]
    fn only_what_is_needed_is_done() {
        let program = Program::new(2, |x| {
            let (there, back) = (x[0].times(&x[1]), x[1].times(&x[0]));
            let _unused = x[0].plus(&x[1]);
            let mut sheet = Sheet::default();
            sheet.put("sum", Grid::column(vec![there.plus(&back)]));
            sheet
        });
        assert_eq!(program.size(), 2);
    }
}
