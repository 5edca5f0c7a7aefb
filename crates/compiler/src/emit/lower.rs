//! From nodes to lines: what is named, what stands inside a formula, in which order.

use super::lines::{Formula, Heading, Line};
use crate::graph::{Graph, Operation, Operations, Value};
use hamel_codegen::expr::Function as Known;
use hamel_codegen::formula::names::NameSet;
use rustc_hash::{FxHashMap, FxHashSet};

/// Operations that one line holds at most: what is longer is cut into lines of its own.
const LONGEST: usize = 6;

/// For a sine the cosine of the same angle, and the other way round, where both are needed.
pub fn partners(graph: &Graph, uses: &[u32]) -> FxHashMap<u32, u32> {
    let mut partners = FxHashMap::default();
    let mut angles = FxHashMap::<(u32, Value), u32>::default();
    for (number, node) in (0_u32..).zip(&graph.nodes) {
        let Operation::Call(Known::Sin | Known::Cos, angle, None) = node.operation else {
            continue;
        };
        if uses[number as usize] == 0 {
            continue;
        }
        if let Some(other) = angles.insert((node.section, angle), number) {
            partners.insert(number, other);
            partners.insert(other, number);
        }
    }
    partners
}

/// What stands between packs and other nodes.
#[derive(Clone, Debug)]
pub enum Crossing {
    /// Nodes whose values are put side by side.
    Gather(Vec<u32>),
    /// A pack whose numbers are extracted, and their nodes, of which this is the first.
    Extract(u32, Vec<u32>),
}

/// Nodes that become lines.
pub struct Lowering<'a> {
    /// The graph.
    pub graph: &'a Graph,
    /// How often each node is read.
    pub uses: &'a [u32],
    /// Those of [`partners`].
    pub partners: &'a FxHashMap<u32, u32>,
    /// Names of the sections, in values.
    pub bodies: &'a dyn Fn(u32) -> String,
    /// What must have a name.
    pub left: FxHashSet<u32>,
    /// Nodes that stand between packs and other nodes.
    pub crossings: FxHashMap<u32, Crossing>,
    /// What stands for a node that is not lowered here.
    pub outside: &'a dyn Fn(u32) -> Formula,
    /// Names that are taken.
    pub names: &'a mut NameSet,
    /// What stands for a node, and the operations in it.
    pub formulas: FxHashMap<u32, (Formula, usize)>,
    /// The lines so far.
    pub lines: Vec<Line>,
}

impl Lowering<'_> {
    /// Adds the lines of `nodes`, with headings.
    pub fn run(&mut self, nodes: &[u32]) {
        let mut heading: Option<(u32, &'static str)> = None;
        let mut place = 0;
        for &number in nodes {
            if self.formulas.contains_key(&number) {
                continue;
            }
            let node = &self.graph.nodes[number as usize];
            let here = (node.section, node.topic);
            // What stands between packs and other nodes computes nothing, and goes with what is around it.
            if heading != Some(here) && !self.crossings.contains_key(&number) {
                heading = Some(here);
                place = self.lines.len();
                self.lines.push(Line::Heading(Heading {
                    body: (self.bodies)(here.0),
                    topic: here.1,
                    operations: Operations::default(),
                }));
            }
            if let Some(Line::Heading(heading)) = self.lines.get_mut(place) {
                heading.operations.add(&node.operation);
            }
            self.lower(number);
        }
        self.drop_empty_headings();
    }

    fn drop_empty_headings(&mut self) {
        let mut lines = std::mem::take(&mut self.lines).into_iter().peekable();
        while let Some(line) = lines.next() {
            let ends = matches!(lines.peek(), Some(Line::Heading(_)) | None);
            if !(ends && matches!(line, Line::Heading(_))) {
                self.lines.push(line);
            }
        }
    }

    /// Names for a sine and the cosine beside it, and the angle.
    pub fn sin_cos(
        &mut self,
        number: u32,
        function: Known,
        angle: Value,
    ) -> (String, String, Formula) {
        let angle = self.read(angle);
        let (sin, cos) = (self.claim(number, "sin"), self.claim(number, "cos"));
        let (own, other) = match function {
            Known::Sin => (&sin, &cos),
            _ => (&cos, &sin),
        };
        let named = |name: &String| (Formula::Name(name.clone()), 0);
        self.formulas.insert(number, named(own));
        if let Some(&partner) = self.partners.get(&number) {
            self.formulas.insert(partner, named(other));
        }
        (sin, cos, angle)
    }

    fn lower(&mut self, number: u32) {
        if let Some(crossing) = self.crossings.get(&number).cloned() {
            return self.cross(number, crossing);
        }
        if let (true, Operation::Call(function, angle, _)) = (
            self.partners.contains_key(&number),
            &self.graph.nodes[number as usize].operation,
        ) {
            let (sin, cos, angle) = self.sin_cos(number, *function, *angle);
            self.lines.push(Line::SinCos(sin, cos, angle));
            return;
        }
        let (formula, length) = self.formula(number);
        let is_shared = self.uses[number as usize] > 1 || self.left.contains(&number);
        let formula = if formula.computes() && (is_shared || length > LONGEST) {
            let label = self.graph.nodes[number as usize].label.clone();
            let name = self.claim(number, &label);
            self.lines.push(Line::Value(name.clone(), formula));
            (Formula::Name(name), 0)
        } else {
            (formula, length)
        };
        self.formulas.insert(number, formula);
    }

    /// Numbers that are the same for all limbs, or known, are put side by side where they are read: compilers find them.
    fn cross(&mut self, number: u32, crossing: Crossing) {
        match crossing {
            Crossing::Gather(sources) => {
                let numbers: Vec<Formula> =
                    sources.iter().map(|&source| self.part(source).0).collect();
                let is_number = |formula: &Formula| matches!(formula, Formula::Number(_));
                let is_plain = sources.iter().all(|&source| source == sources[0]);
                let is_plain = is_plain || numbers.iter().all(is_number);
                let mut formula = Formula::Gathered(numbers);
                if !is_plain {
                    let name = self.claim(number, &self.graph.nodes[number as usize].label);
                    self.lines.push(Line::Value(name.clone(), formula));
                    formula = Formula::Name(name);
                }
                self.formulas.insert(number, (formula, 0));
            }
            Crossing::Extract(source, parts) => {
                let formula = self.part(source).0;
                let mut names = vec![];
                for part in parts {
                    let name = self.claim(part, &self.graph.nodes[part as usize].label);
                    names.push(name.clone());
                    self.formulas.insert(part, (Formula::Name(name), 0));
                }
                self.lines.push(Line::Extracted(names, formula));
            }
        }
    }

    fn claim(&mut self, number: u32, label: &str) -> String {
        let body = (self.bodies)(self.graph.nodes[number as usize].section);
        self.names
            .claim(&format!("{body}_{}", label.replace(' ', "_")))
    }

    fn part(&self, number: u32) -> (Formula, usize) {
        let known = self.formulas.get(&number).cloned();
        known.unwrap_or_else(|| ((self.outside)(number), 0))
    }

    /// The formula of a value.
    pub fn read(&self, value: Value) -> Formula {
        let formula = self.part(value.node).0;
        match value.negative {
            true => formula.negated(),
            false => formula,
        }
    }

    fn formula(&self, number: u32) -> (Formula, usize) {
        match &self.graph.nodes[number as usize].operation {
            Operation::Input(..) | Operation::Constant(_) => ((self.outside)(number), 0),
            Operation::Opposite(of) => {
                let (of, length) = self.part(*of);
                (of.negated(), length)
            }
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
            Operation::Part(of, result) => {
                let all = Box::new(self.part(*of).0);
                (Formula::Part(all, *result as usize), 0)
            }
        }
    }

    fn sum(&self, a: u32, b: u32, minus: bool) -> (Formula, usize) {
        let ((a, m), (b, n)) = (self.part(a), self.part(b));
        let mut sum = terms(a);
        let added = terms(b).into_iter();
        sum.extend(added.map(|(subtracted, term)| (subtracted ^ minus, term)));
        (Formula::Sum(sum), m + n + 1)
    }
}

fn terms(formula: Formula) -> Vec<(bool, Formula)> {
    match formula {
        Formula::Sum(terms) => terms,
        other => vec![(false, other)],
    }
}
