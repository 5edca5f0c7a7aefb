//! From a graph to a program.

use crate::program::{Operand, Operation, Program, Several, Three, Two};
use crate::{exact, places};
use hamel_codegen::expr::Function;
use hamel_compiler::graph::{Argument, Graph, Operation as Of, Value};
use hamel_compiler::stepping::Stepping;
use std::collections::HashMap;

/// The program of a step.
pub fn program(step: &Stepping, inputs: usize) -> Program {
    let outputs: Vec<Value> = step.outputs.iter().map(|(_, value)| *value).collect();
    let uses = step.graph.uses(&outputs);
    let is_once = constant(&step.graph, step.places.numbers);
    let mut lowering = Lowering {
        graph: &step.graph,
        inner: inner(&step.graph, &uses, &is_once, &outputs),
        uses,
        is_once,
        rows: HashMap::new(),
        numbers: HashMap::new(),
        next: inputs as u32,
        is_now: false,
        program: Program::default(),
    };
    for node in 0..step.graph.nodes.len() as u32 {
        if lowering.uses[node as usize] > 0 && !lowering.inner[node as usize] {
            lowering.node(node);
        }
    }
    // Results take the places of the state when all of them are there.
    lowering.is_now = false;
    let results = step.outputs.iter();
    let results: Vec<(u32, Operand)> = results
        .map(|&(place, value)| (place as u32, lowering.signed(value)))
        .collect();
    let results: Vec<(u32, Operand)> = results
        .into_iter()
        .map(|(place, result)| (place, lowering.apart(result, inputs)))
        .collect();
    exact::joined(&mut lowering.program.step, &results);
    for (place, result) in results {
        let copy = Operation::Copy(result, place);
        lowering.program.step.push(copy);
    }
    places::in_place(&mut lowering.program.step, inputs);
    lowering.program.rows = lowering.next as usize;
    places::shared(lowering.program, inputs)
}

/// Which nodes depend on numbers of the model alone: they are computed once a motion.
fn constant(graph: &Graph, numbers: usize) -> Vec<bool> {
    let mut is_once: Vec<bool> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let own = match node.operation {
            Of::Input(Argument::Given, place) => place as usize >= numbers,
            _ => {
                let mut all = true;
                node.operation
                    .each_operand(|operand| all &= is_once[operand as usize]);
                all
            }
        };
        is_once.push(own);
    }
    is_once
}

/// Products that are computed within the one sum that reads them.
fn inner(graph: &Graph, uses: &[u32], is_once: &[bool], outputs: &[Value]) -> Vec<bool> {
    let mut inner = vec![false; graph.nodes.len()];
    let is_output = |node: u32| outputs.iter().any(|output| output.node == node);
    for (number, node) in graph.nodes.iter().enumerate() {
        let (Of::Sum(a, b) | Of::Difference(a, b)) = node.operation else {
            continue;
        };
        if uses[number] == 0 || a == b {
            continue;
        }
        for product in [a, b] {
            let place = product as usize;
            let is_product = matches!(graph.nodes[place].operation, Of::Product(..));
            if is_product
                && uses[place] == 1
                && !is_output(product)
                && is_once[place] == is_once[number]
            {
                inner[place] = true;
            }
        }
    }
    inner
}

struct Lowering<'a> {
    graph: &'a Graph,
    uses: Vec<u32>,
    is_once: Vec<bool>,
    inner: Vec<bool>,
    /// Rows of nodes, and of their opposites.
    rows: HashMap<Value, u32>,
    numbers: HashMap<u64, u32>,
    next: u32,
    /// Whether what follows is computed once a motion.
    is_now: bool,
    program: Program,
}

impl Lowering<'_> {
    fn push(&mut self, operation: Operation) {
        match self.is_now {
            true => self.program.once.push(operation),
            false => self.program.step.push(operation),
        }
    }

    fn row(&mut self, node: u32) -> u32 {
        let row = self.fresh();
        self.rows.insert(node.into(), row);
        row
    }

    fn fresh(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    fn number(&mut self, number: f64) -> Operand {
        let numbers = &mut self.program.numbers;
        let place = *self.numbers.entry(number.to_bits()).or_insert_with(|| {
            numbers.push(number);
            numbers.len() as u32 - 1
        });
        Operand::Number(place)
    }

    /// A node that has been computed, or a number.
    fn operand(&mut self, node: u32) -> Operand {
        match self.graph.nodes[node as usize].operation {
            Of::Constant(bits) => self.number(f64::from_bits(bits)),
            Of::Input(_, place) => Operand::Row(place),
            _ => {
                let row = self.rows.get(&node.into());
                Operand::Row(*row.expect("nodes are computed before what reads them"))
            }
        }
    }

    /// The same with a sign.
    fn signed(&mut self, value: Value) -> Operand {
        let plain = self.operand(value.node);
        match (value.negative, plain) {
            (false, _) => plain,
            (true, Operand::Number(place)) => {
                let number = self.program.numbers[place as usize];
                self.number(-number)
            }
            (true, Operand::Row(of)) => {
                if let Some(&row) = self.rows.get(&value) {
                    return Operand::Row(row);
                }
                let row = self.fresh();
                self.push(Operation::Opposite(of, row));
                self.rows.insert(value, row);
                Operand::Row(row)
            }
        }
    }

    /// A row with an operand.
    fn in_row(&mut self, operand: Operand) -> u32 {
        match operand {
            Operand::Row(row) => row,
            Operand::Number(_) => {
                let row = self.fresh();
                self.push(Operation::Copy(operand, row));
                row
            }
        }
    }

    /// The same where it is none of the rows that results take.
    fn apart(&mut self, operand: Operand, inputs: usize) -> Operand {
        match operand {
            Operand::Row(row) if (row as usize) < inputs => {
                let own = self.fresh();
                self.push(Operation::Copy(operand, own));
                Operand::Row(own)
            }
            other => other,
        }
    }

    /// The factors of a product that is computed within a sum.
    fn factors(&mut self, node: u32) -> Option<(u32, Operand)> {
        let Of::Product(a, b) = self.graph.nodes[node as usize].operation else {
            return None;
        };
        if !self.inner[node as usize] {
            return None;
        }
        let (a, b) = (self.operand(a), self.operand(b));
        let (first, second) = match a {
            Operand::Row(_) => (a, b),
            Operand::Number(_) => (b, a),
        };
        Some((self.in_row(first), second))
    }

    fn node(&mut self, node: u32) {
        self.is_now = self.is_once[node as usize];
        match self.graph.nodes[node as usize].operation.clone() {
            Of::Input(..) | Of::Constant(_) | Of::Part(..) => {}
            Of::Sum(a, b) => self.sum(node, [a, b], false),
            Of::Difference(a, b) => self.sum(node, [a, b], true),
            Of::Product(a, b) => self.two(node, Two::Multiply, [a, b]),
            Of::Quotient(a, b) => self.two(node, Two::Divide, [a, b]),
            Of::Opposite(of) => {
                let of = self.operand(of);
                let of = self.in_row(of);
                let row = self.row(node);
                self.push(Operation::Opposite(of, row));
            }
            Of::Call(Function::Sin | Function::Cos, angle, None) => self.sin_cos(node, angle),
            Of::Call(Function::Sqrt, of, None) => {
                let of = self.signed(of);
                let of = self.in_row(of);
                let row = self.row(node);
                self.push(Operation::Root(of, row));
            }
            Of::Call(Function::Larger, a, Some(b)) => {
                let of = [self.signed(a), self.signed(b)];
                let row = self.row(node);
                self.push(Operation::Two(Two::Larger, of, row));
            }
            Of::Call(function, a, b) => {
                let (a, b) = (self.signed(a), b.map(|b| self.signed(b)));
                let row = self.row(node);
                self.push(Operation::Call(function, a, b, row));
            }
            Of::Several(function, arguments) => {
                let arguments = arguments.iter().map(|&value| self.signed(value));
                let arguments: Vec<Operand> = arguments.collect();
                let results = self.parts(node);
                let several = Several {
                    function,
                    arguments,
                    results,
                };
                self.push(Operation::Several(Box::new(several)));
            }
        }
    }

    fn two(&mut self, node: u32, what: Two, [a, b]: [u32; 2]) {
        let of = [self.operand(a), self.operand(b)];
        let row = self.row(node);
        self.push(Operation::Two(what, of, row));
    }

    /// a + b, or, with `minus`, a − b.
    fn sum(&mut self, node: u32, [a, b]: [u32; 2], minus: bool) {
        let operation = match (self.factors(a), self.factors(b)) {
            (Some((a, b)), Some((c, d))) => {
                let row = self.row(node);
                Operation::Products(minus, [a, c], [b, d], row)
            }
            (Some((first, second)), None) => {
                let third = self.operand(b);
                let what = if minus { Three::Less } else { Three::AddTo };
                Operation::Three(what, first, [second, third], self.row(node))
            }
            (None, Some((first, second))) => {
                let third = self.operand(a);
                let what = if minus { Three::From } else { Three::AddTo };
                Operation::Three(what, first, [second, third], self.row(node))
            }
            (None, None) => {
                let what = if minus { Two::Subtract } else { Two::Add };
                let of = [self.operand(a), self.operand(b)];
                Operation::Two(what, of, self.row(node))
            }
        };
        self.push(operation);
    }

    /// Sine and cosine of an angle come together.
    fn sin_cos(&mut self, node: u32, angle: Value) {
        if self.rows.contains_key(&node.into()) {
            return;
        }
        let of = self.signed(angle);
        let of = self.in_row(of);
        let pair = [Function::Sin, Function::Cos].map(|function| {
            let call = Of::Call(function, angle, None);
            let nodes = self.graph.nodes.iter();
            let place = nodes
                .zip(&self.uses)
                .position(|(own, &uses)| uses > 0 && own.operation == call);
            match place {
                Some(place) => self.row(place as u32),
                None => self.fresh(),
            }
        });
        self.push(Operation::SinCos(of, pair));
    }

    /// Rows for the results of a function with several.
    fn parts(&mut self, node: u32) -> Vec<u32> {
        let nodes = self.graph.nodes.iter().enumerate();
        let parts: Vec<(usize, u32)> = nodes
            .filter_map(|(place, own)| match own.operation {
                Of::Part(of, part) if of == node => Some((place, part)),
                _ => None,
            })
            .collect();
        let most = parts.iter().map(|(_, part)| part + 1).max().unwrap_or(0);
        let rows: Vec<u32> = (0..most).map(|_| self.fresh()).collect();
        for (place, part) in parts {
            self.rows.insert((place as u32).into(), rows[part as usize]);
        }
        rows
    }
}
