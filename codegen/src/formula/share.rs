//! Subexpressions that occur more than once are computed once, under a name that says what they are.

use super::Names;
use super::divisor::shared_sums;
use super::exponential::in_range;
use super::few::{named, with_few_shared};
use super::names::{NameSet, describe};
use super::pairs::extract_pairs;
use super::reciprocal::share_reciprocals;
use super::shapes::{Shape, Shapes};
use super::{Counts, Node, factored};
use crate::expr::{Expr, Function, Role, Symbol};
use crate::kernel::{Primitive, Step};
use crate::matrix::Matrix;
use rustc_hash::FxHashMap;
use std::collections::BTreeSet;

/// First index of the symbols made here, above all that a derivation numbers itself.
const FIRST_INDEX: usize = 0x8000;

/// One line before the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A name for a value.
    Value {
        /// The name.
        name: Symbol,
        /// The value.
        value: Node,
    },
    /// Names for the sine and the cosine of one angle, each where it is used.
    SinCos {
        /// Name of the sine.
        sin: Option<Symbol>,
        /// Name of the cosine.
        cos: Option<Symbol>,
        /// The angle.
        angle: Node,
    },
    /// Names for the results of a function of the runtime.
    Call {
        /// The function.
        primitive: Primitive,
        /// Its argument, row by row.
        argument: Vec<Node>,
        /// Its results.
        outputs: Vec<Symbol>,
    },
}

impl Binding {
    /// The names that it binds.
    pub fn names(&self) -> Vec<&Symbol> {
        match self {
            Self::Value { name, .. } => vec![name],
            Self::SinCos { sin, cos, .. } => sin.iter().chain(cos).collect(),
            Self::Call { outputs, .. } => outputs.iter().collect(),
        }
    }

    /// Calls `change` for every formula that it evaluates, in order.
    pub(super) fn change(&mut self, change: &mut impl FnMut(&mut Node)) {
        match self {
            Self::Value { value, .. } => change(value),
            Self::SinCos { angle, .. } => change(angle),
            Self::Call { argument, .. } => argument.iter_mut().for_each(change),
        }
    }

    /// The formulas that it evaluates.
    pub fn formulas(&self) -> Vec<&Node> {
        match self {
            Self::Value { value, .. } => vec![value],
            Self::SinCos { angle, .. } => vec![angle],
            Self::Call { argument, .. } => argument.iter().collect(),
        }
    }
}

/// A kernel's body: lines in order, then the entries of all its outputs, one matrix after the other, row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// The lines before the result.
    pub bindings: Vec<Binding>,
    /// The entries of the result.
    pub outputs: Vec<Node>,
}

impl Program {
    /// Writes a kernel, its lines and its results: factored, shared, polished. `taken` holds the names that must not be used.
    ///
    /// Of the ways to factor, that with the least work: entries one by one, or sums shared between entries first.
    pub fn new(steps: &[Step], outputs: &[Matrix], taken: &NameSet) -> Self {
        let expressions = expressions(steps, outputs);
        let alone: Vec<Node> = expressions.iter().map(factored).collect();
        let together = match shared_sums(&expressions) {
            Some(together) if together != alone => together,
            _ => return Self::of_formulas(steps, alone, taken),
        };
        let [alone, together] =
            [alone, together].map(|formulas| Self::of_formulas(steps, formulas, taken));
        let [work_alone, work_together] =
            [&alone, &together].map(|program| Counts::of_program(program).work());
        // Entries one by one show the matrix as it is: they give way to a gain of a twentieth, not to a tie.
        match 20 * work_together < 19 * work_alone {
            true => together,
            false => alone,
        }
    }

    /// The same in the names of a joint, which it takes for the symbols that its lines bind.
    pub fn in_names(steps: &[Step], outputs: &[Matrix], mut names: Names) -> Self {
        let bound = steps.iter().flat_map(Step::bound);
        bound.for_each(|symbol| names.claim(symbol));
        Self::new(steps, outputs, names.taken())
    }

    fn of_formulas(steps: &[Step], mut formulas: Vec<Node>, taken: &NameSet) -> Self {
        share_reciprocals(&mut formulas);
        extract_pairs(&mut formulas);
        let mut sharing = Sharing::new(taken.clone());
        let numbers = sharing.numbered(&formulas);
        sharing.name_functions(steps, &numbers);
        let mut remaining = numbers.into_iter();
        for step in steps {
            sharing.step(step, &mut remaining);
        }
        let outputs = remaining.map(|formula| sharing.rewrite(formula)).collect();
        let mut names = sharing.taken;
        let mut program = Self {
            bindings: sharing.bindings,
            outputs,
        };
        program.change(&mut |node| node.replace_by(|node| node.opened().polished()));
        program.pruned().few(&mut names)
    }

    /// With few shared values, called by a letter and an index where no name says what they are.
    fn few(self, names: &mut NameSet) -> Self {
        let is_shared = |name: &Symbol| usize::from(name.index) >= FIRST_INDEX;
        let few = with_few_shared(self, is_shared).pruned();
        named(few, names, is_shared)
    }

    /// Without lines whose results nothing uses.
    fn pruned(mut self) -> Self {
        loop {
            let used = self.symbols();
            let before = self.bindings.len();
            self.bindings
                .retain(|binding| binding.names().iter().any(|name| used.contains(*name)));
            if self.bindings.len() == before {
                return self;
            }
        }
    }

    /// Calls `change` for every formula in it, in order.
    pub(super) fn change(&mut self, change: &mut impl FnMut(&mut Node)) {
        let bindings = self.bindings.iter_mut();
        bindings.for_each(|binding| binding.change(change));
        self.outputs.iter_mut().for_each(change);
    }

    /// Every formula in it, in order.
    pub fn formulas(&self) -> Vec<&Node> {
        let bound = self.bindings.iter().flat_map(Binding::formulas);
        bound.chain(&self.outputs).collect()
    }

    /// The symbols that its formulas use.
    pub fn symbols(&self) -> BTreeSet<Symbol> {
        let mut symbols = BTreeSet::new();
        for formula in self.formulas() {
            formula.visit(&mut |node| {
                if let Node::Symbol(symbol) = node {
                    symbols.insert(symbol.clone());
                }
            });
        }
        symbols
    }
}

/// What a kernel computes, in order: its lines, then the entries of its outputs.
fn expressions(steps: &[Step], outputs: &[Matrix]) -> Vec<Expr> {
    let of_step = |step: &Step| match step {
        Step::Let(_, value) => vec![value.clone()],
        Step::Call { argument, .. } => argument.entries().to_vec(),
    };
    let lines = steps.iter().flat_map(of_step);
    let outputs = outputs.iter().flat_map(Matrix::entries);
    in_range(lines.chain(outputs.cloned()))
}

/// Rewrites formulas in order, binding a shared part just before the first line that uses it.
struct Sharing {
    shapes: Shapes,
    /// What stands for a formula: the name that it is bound to, or what a name merely repeats.
    names: FxHashMap<usize, Node>,
    /// The sines and cosines that lines of the derivation name.
    named_functions: FxHashMap<usize, Symbol>,
    taken: NameSet,
    bindings: Vec<Binding>,
    count: usize,
}

impl Sharing {
    fn new(taken: NameSet) -> Self {
        Self {
            shapes: Shapes::default(),
            names: FxHashMap::default(),
            named_functions: FxHashMap::default(),
            taken,
            bindings: vec![],
            count: 0,
        }
    }

    /// The formulas by number, and every place that uses a part of them counted.
    fn numbered(&mut self, formulas: &[Node]) -> Vec<usize> {
        let shapes = &mut self.shapes;
        let numbers = formulas.iter().map(|formula| {
            let number = shapes.number(formula);
            shapes.count(number);
            number
        });
        numbers.collect()
    }

    /// A line that names a sine or a cosine names it also where both are bound together.
    fn name_functions(&mut self, steps: &[Step], formulas: &[usize]) {
        let mut place = 0;
        for step in steps {
            let formula = formulas.get(place).copied();
            if let (Step::Let(name, _), Some(formula)) = (step, formula)
                && self.angle(formula).is_some()
            {
                let named = self.named_functions.entry(formula);
                named.or_insert_with(|| name.clone());
            }
            place += step.formulas();
        }
    }

    fn step(&mut self, step: &Step, formulas: &mut impl Iterator<Item = usize>) {
        match step {
            Step::Let(name, _) => {
                let Some(formula) = formulas.next() else {
                    return;
                };
                let value = self.rewrite_named(formula);
                self.define(name, formula, value);
            }
            Step::Call {
                primitive, outputs, ..
            } => {
                let argument = formulas
                    .take(step.formulas())
                    .map(|formula| self.rewrite(formula))
                    .collect();
                self.bindings.push(Binding::Call {
                    primitive: *primitive,
                    argument,
                    outputs: outputs.clone(),
                });
            }
        }
    }

    /// Binds a name of the derivation: later occurrences of its formula use it; a name for a name is not bound at all.
    fn define(&mut self, name: &Symbol, formula: usize, value: Node) {
        if matches!(value, Node::Symbol(_) | Node::Number(_)) {
            let number = self.shapes.number(&Node::Symbol(name.clone()));
            if value != Node::Symbol(name.clone()) {
                self.names.insert(number, value);
            }
            return;
        }
        if self.shapes.is_operation(formula) {
            self.names
                .entry(formula)
                .or_insert_with(|| Node::Symbol(name.clone()));
        }
        self.bindings.push(Binding::Value {
            name: name.clone(),
            value,
        });
    }

    /// The formula with its shared parts replaced by names, but not itself bound: its caller names it.
    fn rewrite_named(&mut self, formula: usize) -> Node {
        match (self.names.get(&formula), self.angle(formula)) {
            (Some(known), _) => known.clone(),
            (None, Some(_)) => self.rewrite(formula),
            (None, None) => self.with_parts_rewritten(formula),
        }
    }

    /// The formula with its shared parts replaced by names.
    fn rewrite(&mut self, formula: usize) -> Node {
        if let Some(known) = self.names.get(&formula) {
            return known.clone();
        }
        if let Some(angle) = self.angle(formula) {
            return self.sin_cos(formula, angle);
        }
        let value = self.with_parts_rewritten(formula);
        match self.shapes.is_operation(formula) && self.shapes.uses(formula) > 1 {
            true => self.bind(formula, value),
            false => value,
        }
    }

    fn with_parts_rewritten(&mut self, formula: usize) -> Node {
        match self.shapes.shape(formula).clone() {
            Shape::Leaf(node) => node,
            Shape::Sum(terms) => {
                let terms = terms.into_iter();
                Node::Sum(
                    terms
                        .map(|(minus, term)| (minus, self.rewrite(term)))
                        .collect(),
                )
            }
            Shape::Product(factors) => Node::Product(self.rewrite_all(factors)),
            Shape::Quotient(above, below) => {
                let above = self.rewrite(above);
                Node::Quotient(Box::new(above), Box::new(self.rewrite(below)))
            }
            Shape::Negative(inner) => Node::Negative(Box::new(self.rewrite(inner))),
            Shape::Call(function, arguments) => Node::Call(function, self.rewrite_all(arguments)),
        }
    }

    fn rewrite_all(&mut self, formulas: Vec<usize>) -> Vec<Node> {
        formulas
            .into_iter()
            .map(|formula| self.rewrite(formula))
            .collect()
    }

    fn bind(&mut self, formula: usize, value: Node) -> Node {
        self.count += 1;
        let name = format!("shared{}", self.count);
        let name = Symbol::new(Role::Intermediate, FIRST_INDEX + self.count, &name);
        let symbol = Node::Symbol(name.clone());
        self.names.insert(formula, symbol.clone());
        self.bindings.push(Binding::Value { name, value });
        symbol
    }

    /// The angle, where the formula is its sine or cosine.
    fn angle(&self, formula: usize) -> Option<usize> {
        match self.shapes.shape(formula) {
            Shape::Call(Function::Sin | Function::Cos, arguments) => arguments.first().copied(),
            _ => None,
        }
    }

    /// Binds sine and cosine of the angle together, as far as they are used.
    fn sin_cos(&mut self, formula: usize, angle: usize) -> Node {
        let value = self.rewrite(angle);
        let text = describe(&value);
        let name = |sharing: &mut Self, function: Function, prefix: &str| {
            let call = sharing.shapes.known(&Shape::Call(function, vec![angle]))?;
            let named = sharing.named_functions.get(&call).cloned();
            let symbol = named.unwrap_or_else(|| sharing.fresh(&format!("{prefix}_{text}")));
            sharing.names.insert(call, Node::Symbol(symbol.clone()));
            Some(symbol)
        };
        let sin = name(self, Function::Sin, "sin");
        let cos = name(self, Function::Cos, "cos");
        let bound = self.names.get(&formula).cloned();
        self.bindings.push(Binding::SinCos {
            sin,
            cos,
            angle: value,
        });
        bound.unwrap_or_else(Node::zero)
    }

    fn fresh(&mut self, wish: &str) -> Symbol {
        let name = self.taken.claim(wish);
        self.count += 1;
        Symbol::new(Role::Intermediate, FIRST_INDEX + self.count, &name)
    }
}
