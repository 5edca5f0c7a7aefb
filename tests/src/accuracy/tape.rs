//! A list of operations on numbers, each named by its place; equal operations stand there once.

use super::wide::Wide;
use super::{Grid, Tracked};
use hamel_codegen::expr::{Function, Number};
use std::collections::HashMap;

/// What makes the number at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Put there before the tape is run: an argument or a constant.
    Given,
    /// Sum.
    Plus(u32, u32),
    /// Product.
    Times(u32, u32),
    /// Quotient.
    Over(u32, u32),
    /// Negative.
    Negative(u32),
    /// The same value with its own size as scale.
    Anew(u32),
    /// A function of one argument.
    Apply(Function, u32),
    /// `atan2(y, x)`.
    Angle(u32, u32),
    /// The first number of a solved system, which is numbered so.
    Solved(u32),
    /// Another number of the system that is solved at that place.
    Beside(u32),
}

impl Op {
    /// Sum; the order does not matter.
    pub fn plus(a: u32, b: u32) -> Self {
        Self::Plus(a.min(b), a.max(b))
    }

    /// Product; the order does not matter.
    pub fn times(a: u32, b: u32) -> Self {
        Self::Times(a.min(b), a.max(b))
    }
}

/// A linear system, with its sizes.
#[derive(Clone, Copy, Debug)]
pub enum System {
    /// The left inverse of a matrix of so many rows and columns.
    LeftInverse(usize, usize),
    /// The least-squares solution with a matrix of so many rows and columns, by its left inverse, for so many columns.
    Solve(usize, usize, usize),
}

impl System {
    /// The solution, row by row, from all entries of the system one after the other.
    fn solution(self, entries: &[Tracked]) -> Grid<Tracked> {
        match self {
            Self::LeftInverse(rows, columns) => {
                Grid::of_entries(rows, columns, entries.to_vec()).left_inverse()
            }
            Self::Solve(rows, columns, width) => {
                let (matrix, rest) = entries.split_at(rows * columns);
                let (left, right) = rest.split_at(rows * columns);
                let matrix = Grid::of_entries(rows, columns, matrix.to_vec());
                let left = Grid::of_entries(columns, rows, left.to_vec());
                matrix.solve_by(&left, &Grid::of_entries(rows, width, right.to_vec()))
            }
        }
    }
}

/// The operations of a definition, in an order in which they can be done.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    ops: Vec<Op>,
    constants: Vec<(u32, Tracked)>,
    systems: Vec<(System, Vec<u32>)>,
    places: HashMap<Op, u32>,
    known: HashMap<(Wide, u64, bool), u32>,
}

impl Tape {
    /// A tape that starts with so many arguments.
    pub fn new(arguments: usize) -> Self {
        Self {
            ops: vec![Op::Given; arguments],
            ..Self::default()
        }
    }

    fn append(&mut self, op: Op) -> u32 {
        self.ops.push(op);
        self.ops.len() as u32 - 1
    }

    /// The place of an operation.
    pub fn push(&mut self, op: Op) -> u32 {
        if let Some(place) = self.places.get(&op) {
            return *place;
        }
        let place = self.append(op);
        self.places.insert(op, place);
        place
    }

    /// The place of a number that is the same at every point.
    pub fn constant(&mut self, value: Tracked) -> u32 {
        let key = (value.value, value.scale.to_bits(), value.exact);
        if let Some(place) = self.known.get(&key) {
            return *place;
        }
        let place = self.append(Op::Given);
        self.constants.push((place, value));
        self.known.insert(key, place);
        place
    }

    /// The first of `size` places for the solution of a system.
    pub fn block(&mut self, system: System, inputs: Vec<u32>, size: usize) -> u32 {
        self.systems.push((system, inputs));
        let first = self.append(Op::Solved(self.systems.len() as u32 - 1));
        for _ in 1..size {
            self.append(Op::Beside(first));
        }
        first
    }

    /// What an operation reads.
    fn read(&self, op: Op) -> Vec<u32> {
        match op {
            Op::Given => vec![],
            Op::Plus(a, b) | Op::Times(a, b) | Op::Over(a, b) | Op::Angle(a, b) => vec![a, b],
            Op::Negative(a) | Op::Anew(a) | Op::Apply(_, a) | Op::Beside(a) => vec![a],
            Op::Solved(system) => self.systems[system as usize].1.clone(),
        }
    }

    /// The operations that these places need, in order.
    pub fn needed(&self, places: &[u32]) -> Vec<(u32, Op)> {
        let mut live = vec![false; self.ops.len()];
        places.iter().for_each(|place| live[*place as usize] = true);
        for place in (0..self.ops.len()).rev() {
            if live[place] {
                self.read(self.ops[place])
                    .iter()
                    .for_each(|p| live[*p as usize] = true);
            }
        }
        let ops = self.ops.iter().enumerate();
        ops.filter(|(place, op)| live[*place] && !matches!(op, Op::Given | Op::Beside(_)))
            .map(|(place, op)| (place as u32, *op))
            .collect()
    }

    /// Numbers for all places, the constants in theirs.
    pub fn start(&self) -> Vec<Tracked> {
        let mut values = vec![Tracked::input(0.0); self.ops.len()];
        for (place, value) in &self.constants {
            values[*place as usize] = *value;
        }
        values
    }

    /// Does one operation.
    pub fn run(&self, place: u32, op: Op, values: &mut [Tracked]) {
        let at = |place: u32| &values[place as usize];
        values[place as usize] = match op {
            Op::Given | Op::Beside(_) => return,
            Op::Plus(a, b) => at(a).plus(at(b)),
            Op::Times(a, b) => at(a).times(at(b)),
            Op::Over(a, b) => at(a).over(at(b)),
            Op::Negative(a) => at(a).negative(),
            Op::Anew(a) => Tracked::computed(at(a).value, 0.0),
            Op::Apply(function, a) => at(a).function(function, std::slice::from_ref(at(a))),
            Op::Angle(y, x) => at(y).function(Function::Atan2, &[*at(y), *at(x)]),
            Op::Solved(number) => {
                let (system, inputs) = &self.systems[number as usize];
                let inputs: Vec<Tracked> = inputs.iter().map(|place| *at(*place)).collect();
                let solution = system.solution(&inputs);
                let end = place as usize + solution.entries().len();
                return values[place as usize..end].copy_from_slice(solution.entries());
            }
        };
    }
}
