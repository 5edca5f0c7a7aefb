//! What a block reads and leaves, and its structure: blocks of equal structure differ in numbers and places alone.

use super::Blocks;
use crate::graph::{Argument, Graph, Operation, Value};
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;
use rustc_hash::FxHashMap;

/// An array of which blocks read entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Read {
    /// An argument of the function.
    Argument(Argument),
    /// The sines of all angles.
    Sines,
    /// The cosines.
    Cosines,
}

/// A part of a block's structure.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Token {
    /// What a node does; operands follow.
    Sum,
    Difference,
    Product,
    Quotient,
    Opposite,
    Call(Function),
    Several(Primitive),
    Part(u32),
    /// The operand of a function is negated.
    Negative,
    /// A node of the block.
    Own(usize),
    /// An entry that another block left: which of the blocks that are read, the length of its row, the entry.
    Other(usize, usize, usize),
    /// An entry of an array, from the first one that is read there.
    Entry(Read, i64),
    /// A number.
    Number(usize),
    /// A node of the block is left for others.
    Left(usize),
    /// A node of the block, or its opposite, is a result.
    Result(usize, bool),
}

/// What a block reads and leaves.
#[derive(Clone, Debug)]
pub struct Interface {
    structure: Vec<Token>,
    /// The blocks that it reads, in the order of first use.
    pub sources: Vec<usize>,
    /// The arrays that it reads, with the entry that is read first.
    pub arrays: Vec<(Read, usize)>,
    /// Its numbers, as nodes.
    pub numbers: Vec<u32>,
    /// Results of the function that it computes: places and values.
    pub results: Vec<(usize, Value)>,
}

impl Interface {
    /// That of `block`.
    pub fn new(graph: &Graph, blocks: &Blocks, outputs: &[Value], block: usize) -> Self {
        let own = &blocks.blocks[block];
        let mut reader = Reader {
            graph,
            blocks,
            own: own.nodes.iter().copied().zip(0..).collect(),
            interface: Self {
                structure: vec![],
                sources: vec![],
                arrays: vec![],
                numbers: vec![],
                results: vec![],
            },
        };
        for &node in &own.nodes {
            reader.operation(&graph.nodes[node as usize].operation);
        }
        for &node in &own.outputs {
            let place = reader.own[&node];
            reader.interface.structure.push(Token::Left(place));
        }
        for (place, output) in outputs.iter().enumerate() {
            reader.result(place, *output);
        }
        reader.interface
    }

    /// Whether the other block differs in numbers and places alone.
    pub fn is_like(&self, other: &Self) -> bool {
        self.structure == other.structure
    }

    /// A number that like blocks share.
    pub fn fingerprint(&self) -> u64 {
        use std::hash::{Hash, Hasher};
        let mut hasher = rustc_hash::FxHasher::default();
        self.structure.hash(&mut hasher);
        hasher.finish()
    }

    /// Where an array is read first.
    pub fn first(&self, array: Read) -> Option<usize> {
        let mut known = self.arrays.iter().filter(|(known, _)| *known == array);
        known.next().map(|(_, first)| *first)
    }
}

struct Reader<'a> {
    graph: &'a Graph,
    blocks: &'a Blocks,
    own: FxHashMap<u32, usize>,
    interface: Interface,
}

impl Reader<'_> {
    fn operation(&mut self, operation: &Operation) {
        let token = match operation {
            Operation::Sum(..) => Token::Sum,
            Operation::Difference(..) => Token::Difference,
            Operation::Product(..) => Token::Product,
            Operation::Quotient(..) => Token::Quotient,
            Operation::Opposite(_) => Token::Opposite,
            Operation::Call(function, ..) => Token::Call(*function),
            Operation::Several(function, _) => Token::Several(*function),
            Operation::Part(_, result) => Token::Part(*result),
            Operation::Input(..) | Operation::Constant(_) => return,
        };
        self.interface.structure.push(token);
        match operation {
            Operation::Call(_, first, second) => {
                std::iter::once(first)
                    .chain(second)
                    .for_each(|&value| self.signed(value));
            }
            Operation::Several(_, values) => values.iter().for_each(|&value| self.signed(value)),
            plain => plain.each_operand(|node| self.operand(node)),
        }
    }

    fn signed(&mut self, value: Value) {
        if value.negative {
            self.interface.structure.push(Token::Negative);
        }
        self.operand(value.node);
    }

    fn operand(&mut self, node: u32) {
        let token = self.token(node);
        self.interface.structure.push(token);
    }

    fn token(&mut self, node: u32) -> Token {
        if let Some(&place) = self.own.get(&node) {
            return Token::Own(place);
        }
        if let Some(value) = self.blocks.trigonometry.get(&node) {
            let array = match value.is_sine {
                true => Read::Sines,
                false => Read::Cosines,
            };
            return self.entry(array, value.angle);
        }
        match self.graph.nodes[node as usize].operation {
            Operation::Input(argument, entry) => {
                self.entry(Read::Argument(argument), entry as usize)
            }
            Operation::Constant(_) => Token::Number(place_of(&mut self.interface.numbers, node)),
            _ => self.other(node),
        }
    }

    fn entry(&mut self, array: Read, entry: usize) -> Token {
        let first = self.interface.first(array).unwrap_or_else(|| {
            self.interface.arrays.push((array, entry));
            entry
        });
        Token::Entry(array, distance(first, entry))
    }

    fn other(&mut self, node: u32) -> Token {
        let home = self.blocks.home[&node];
        let outputs = &self.blocks.blocks[home].outputs;
        let entry = outputs.binary_search(&node).unwrap_or(outputs.len());
        let source = place_of(&mut self.interface.sources, home);
        Token::Other(source, outputs.len(), entry)
    }

    fn result(&mut self, place: usize, output: Value) {
        let Some(&own) = self.own.get(&output.node) else {
            return;
        };
        self.interface.results.push((place, output));
        let result = Token::Result(own, output.negative);
        self.interface.structure.push(result);
    }
}

fn place_of<T: PartialEq>(known: &mut Vec<T>, item: T) -> usize {
    known
        .iter()
        .position(|one| *one == item)
        .unwrap_or_else(|| {
            known.push(item);
            known.len() - 1
        })
}

fn distance(from: usize, to: usize) -> i64 {
    // Places in memory fit.
    to as i64 - from as i64
}
