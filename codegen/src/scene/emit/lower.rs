//! From a graph to lines: what is named, what stands inside a formula, in which order.

use super::Function;
use crate::derived::Primitive;
use crate::emit::names::NameSet;
use crate::expr::Function as Known;
use crate::scene::graph::{Argument, Graph, Operation, Operations, Value};

/// Operations that one line holds at most: what is longer is cut into lines of its own.
const LONGEST: usize = 6;

/// A formula of one line.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A number.
    Number(f64),
    /// An entry of an argument.
    Input(Argument, usize),
    /// A value of an earlier line.
    Name(String),
    /// Terms; those marked true are subtracted.
    Sum(Vec<(bool, Formula)>),
    /// Two factors.
    Product(Box<Formula>, Box<Formula>),
    /// A quotient.
    Quotient(Box<Formula>, Box<Formula>),
    /// The opposite.
    Negative(Box<Formula>),
    /// A function.
    Call(Known, Vec<Formula>),
    /// A function of the runtime with several results.
    Several(Primitive, Vec<Formula>),
    /// One of the results that a name stands for.
    Part(Box<Formula>, usize),
}

impl Formula {
    fn negated(self) -> Self {
        match self {
            Self::Negative(inner) => *inner,
            Self::Number(number) => Self::Number(-number),
            Self::Sum(terms) => Self::Sum(
                terms
                    .into_iter()
                    .map(|(minus, term)| (!minus, term))
                    .collect(),
            ),
            Self::Product(a, b) if matches!(*a, Self::Number(_)) => {
                Self::Product(Box::new(a.negated()), b)
            }
            Self::Product(a, b) if matches!(*b, Self::Number(_)) => {
                Self::Product(a, Box::new(b.negated()))
            }
            other => Self::Negative(Box::new(other)),
        }
    }
}

/// What stands above a part of the lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Name of the body.
    pub body: String,
    /// What of it.
    pub topic: &'static str,
    /// The operations below it.
    pub operations: Operations,
}

/// One line.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// What follows.
    Heading(Heading),
    /// A name for a value.
    Value(String, Formula),
    /// Names for sine and cosine of one angle.
    SinCos(String, String, Formula),
    /// The same for several angles at once.
    SinCosAll(Vec<(String, String, Formula)>),
}

/// A function in lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowered {
    /// The lines.
    pub lines: Vec<Line>,
    /// Its results.
    pub outputs: Vec<Formula>,
}

impl Lowered {
    /// The lines of a function; `bodies` are the names of the sections, `reserved` must not be used.
    pub fn new(function: &Function, bodies: &[String], reserved: &[&str]) -> Self {
        let mut names = NameSet::default();
        for name in reserved {
            names.claim(name);
        }
        let uses = function.graph.uses(&function.outputs);
        let mut lowering = Lowering {
            graph: &function.graph,
            partner: partners(&function.graph, &uses),
            uses,
            bodies,
            names,
            formulas: vec![None; function.graph.nodes.len()],
            lines: vec![],
        };
        lowering.run();
        let outputs = function
            .outputs
            .iter()
            .map(|&output| lowering.read(output))
            .collect();
        Self {
            lines: lowering.lines,
            outputs,
        }
    }
}

/// For a sine the cosine of the same angle, and the other way round, where both are needed.
fn partners(graph: &Graph, uses: &[u32]) -> Vec<Option<u32>> {
    let mut partners = vec![None; graph.nodes.len()];
    let mut angles = rustc_hash::FxHashMap::<Value, u32>::default();
    for (number, node) in graph.nodes.iter().enumerate() {
        let Operation::Call(Known::Sin | Known::Cos, angle, None) = node.operation else {
            continue;
        };
        if uses[number] == 0 {
            continue;
        }
        let number = u32::try_from(number).unwrap_or(u32::MAX);
        if let Some(other) = angles.insert(angle, number) {
            partners[number as usize] = Some(other);
            partners[other as usize] = Some(number);
        }
    }
    partners
}

struct Lowering<'a> {
    graph: &'a Graph,
    uses: Vec<u32>,
    partner: Vec<Option<u32>>,
    bodies: &'a [String],
    names: NameSet,
    /// What stands for a node, and the operations in it.
    formulas: Vec<Option<(Formula, usize)>>,
    lines: Vec<Line>,
}

impl Lowering<'_> {
    /// Sines and cosines of arguments come first and together.
    fn batch(&mut self) {
        let of_input = |number: usize| {
            let Operation::Call(function @ (Known::Sin | Known::Cos), angle, None) =
                self.graph.nodes[number].operation
            else {
                return None;
            };
            let is_input = matches!(
                self.graph.nodes[angle.node as usize].operation,
                Operation::Input(..)
            );
            (self.uses[number] > 0 && is_input).then_some((number, function, angle))
        };
        let calls: Vec<(usize, Known, Value)> =
            (0..self.graph.nodes.len()).filter_map(of_input).collect();
        let mut operations = Operations::default();
        let mut lines: Vec<(String, String, Formula)> = vec![];
        for (number, function, angle) in calls {
            operations.add(&self.graph.nodes[number].operation);
            if self.formulas[number].is_some() {
                continue;
            }
            self.lower(angle.node as usize);
            let (sin, cos) = (self.claim(number, "sin"), self.claim(number, "cos"));
            let named = |function| {
                Some((
                    Formula::Name(if function == Known::Sin {
                        sin.clone()
                    } else {
                        cos.clone()
                    }),
                    0,
                ))
            };
            self.formulas[number] = named(function);
            if let Some(partner) = self.partner[number] {
                let other = if function == Known::Sin {
                    Known::Cos
                } else {
                    Known::Sin
                };
                self.formulas[partner as usize] = named(other);
            }
            lines.push((sin, cos, self.read(angle)));
        }
        if lines.is_empty() {
            return;
        }
        self.lines.push(Line::Heading(Heading {
            body: "all joints".to_owned(),
            topic: "sines and cosines",
            operations,
        }));
        self.lines.push(Line::SinCosAll(lines));
    }

    fn run(&mut self) {
        self.batch();
        let mut heading: Option<(u32, &'static str)> = None;
        let mut place = 0;
        for number in 0..self.graph.nodes.len() {
            if self.uses[number] == 0 || self.formulas[number].is_some() {
                continue;
            }
            let node = &self.graph.nodes[number];
            let here = (node.section, node.topic);
            let computes = !matches!(
                node.operation,
                Operation::Input(..) | Operation::Constant(_) | Operation::Part(..)
            );
            if computes && heading != Some(here) {
                heading = Some(here);
                place = self.lines.len();
                self.lines.push(Line::Heading(Heading {
                    body: self
                        .bodies
                        .get(here.0 as usize)
                        .cloned()
                        .unwrap_or_default(),
                    topic: here.1,
                    operations: Operations::default(),
                }));
            }
            if let Some(Line::Heading(heading)) = self.lines.get_mut(place) {
                heading.operations.add(&node.operation);
            }
            self.lower(number);
        }
        let is_empty = |pair: &[Line]| matches!(pair, [Line::Heading(_), Line::Heading(_)]);
        let mut kept = vec![];
        let lines = std::mem::take(&mut self.lines);
        for (place, line) in lines.iter().enumerate() {
            if !lines.get(place..place + 2).is_some_and(is_empty) {
                kept.push(line.clone());
            }
        }
        self.lines = kept;
    }

    fn lower(&mut self, number: usize) {
        let operation = &self.graph.nodes[number].operation;
        if let (Some(partner), Operation::Call(function, angle, _)) =
            (self.partner[number], operation)
        {
            let (function, angle) = (*function, self.read(*angle));
            let (sin, cos) = (self.claim(number, "sin"), self.claim(number, "cos"));
            let own = if function == Known::Sin { &sin } else { &cos };
            let other = if function == Known::Sin { &cos } else { &sin };
            self.formulas[number] = Some((Formula::Name(own.clone()), 0));
            self.formulas[partner as usize] = Some((Formula::Name(other.clone()), 0));
            self.lines.push(Line::SinCos(sin, cos, angle));
            return;
        }
        let (formula, length) = self.formula(number);
        let computes = !matches!(
            formula,
            Formula::Number(_) | Formula::Input(..) | Formula::Part(..)
        );
        let shared = self.uses[number] > 1 || length > LONGEST;
        let formula = if computes && shared {
            let label = self.graph.nodes[number].label.clone();
            let name = self.claim(number, &label);
            self.lines.push(Line::Value(name.clone(), formula));
            (Formula::Name(name), 0)
        } else {
            (formula, length)
        };
        self.formulas[number] = Some(formula);
    }

    fn claim(&mut self, number: usize, label: &str) -> String {
        let body = self.bodies.get(self.graph.nodes[number].section as usize);
        let body = body.map_or("", String::as_str);
        self.names
            .claim(&format!("{body}_{}", label.replace(' ', "_")))
    }

    fn part(&self, number: u32) -> (Formula, usize) {
        self.formulas[number as usize]
            .clone()
            .unwrap_or((Formula::Number(f64::NAN), 0))
    }

    fn read(&self, value: Value) -> Formula {
        let formula = self.part(value.node).0;
        if value.negative {
            formula.negated()
        } else {
            formula
        }
    }

    fn formula(&self, number: usize) -> (Formula, usize) {
        match &self.graph.nodes[number].operation {
            Operation::Input(argument, index) => (Formula::Input(*argument, *index as usize), 0),
            Operation::Constant(bits) => (Formula::Number(f64::from_bits(*bits)), 0),
            Operation::Sum(a, b) => self.sum(*a, *b, false),
            Operation::Difference(a, b) => self.sum(*a, *b, true),
            Operation::Product(a, b) => {
                let ((a, m), (b, n)) = (self.part(*a), self.part(*b));
                (Formula::Product(Box::new(a), Box::new(b)), m + n + 1)
            }
            Operation::Quotient(a, b) => {
                let ((a, m), (b, n)) = (self.part(*a), self.part(*b));
                (Formula::Quotient(Box::new(a), Box::new(b)), m + n + 1)
            }
            Operation::Call(function, a, b) => {
                let arguments = std::iter::once(a)
                    .chain(b)
                    .map(|&value| self.read(value))
                    .collect();
                (Formula::Call(*function, arguments), LONGEST)
            }
            // Always a line of its own.
            Operation::Several(function, arguments) => {
                let arguments = arguments.iter().map(|&value| self.read(value)).collect();
                (Formula::Several(*function, arguments), LONGEST + 1)
            }
            Operation::Part(of, result) => (
                Formula::Part(Box::new(self.part(*of).0), *result as usize),
                0,
            ),
        }
    }

    fn sum(&self, a: u32, b: u32, minus: bool) -> (Formula, usize) {
        let ((a, m), (b, n)) = (self.part(a), self.part(b));
        let mut terms = terms(a);
        terms.extend(terms_of(b, minus));
        (Formula::Sum(terms), m + n + 1)
    }
}

fn terms(formula: Formula) -> Vec<(bool, Formula)> {
    match formula {
        Formula::Sum(terms) => terms,
        other => vec![(false, other)],
    }
}

fn terms_of(formula: Formula, minus: bool) -> Vec<(bool, Formula)> {
    terms(formula)
        .into_iter()
        .map(|(subtracted, term)| (subtracted ^ minus, term))
        .collect()
}
