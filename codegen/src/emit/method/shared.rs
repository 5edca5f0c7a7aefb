//! Functions that kernels of one joint share: the derivatives that several need, or that would make one of them too long to read.
//!
//! They are words of the kernels ([`Word`]), in two functions: first derivatives (and what these are made of, where others use it too), and second
//! derivatives, which call the function of the first. A kernel that uses such a word asks for it instead of computing it.

use crate::derived::{Derived, Kernel, Method, Step, Word};
use crate::expr::{Expr, Symbol};
use crate::formula::names::NameSet;
use crate::formula::{Binding, Counts, Names, Program};
use crate::matrix::Matrix;
use std::collections::BTreeSet;

/// Operations of a kernel from which on it asks for second derivatives, and for first ones where relations do not define them: about 60 lines.
const LONG: usize = 120;

/// A function of Q that gives the values of words.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: &'static str,
    /// What it gives, in order.
    pub words: Vec<Symbol>,
    /// Its lines.
    pub steps: Vec<Step>,
}

impl Function {
    /// Its results.
    pub fn outputs(&self) -> Matrix {
        Matrix::column_vector(self.words.iter().map(Expr::symbol).collect())
    }
}

/// The functions of the joint, that of first derivatives before that of second ones; none where its kernels are short.
pub fn functions(derived: &Derived) -> Vec<Function> {
    let is_long = |body: &Derived| {
        let counts = |kernel: &Kernel| Counts::of_program(body.program(kernel));
        // Those of Q and v alone are the same for all bodies.
        let own = |kernel: &&Kernel| body.body == 0 || kernel.kind.is_of_body();
        let mut own = formulas(body).filter(own);
        own.any(|kernel| counts(kernel).total() > LONG)
    };
    let is_long = derived.bodies().any(is_long);
    if !is_long && derived.named.is_empty() {
        return vec![];
    }
    let kernels: Vec<&Kernel> = derived.bodies().flat_map(formulas).collect();
    let (all, [first, second]) = (definitions(&kernels), orders(derived));
    let second = if is_long { second } else { BTreeSet::new() };
    let apart = [&first, &second];
    let used: BTreeSet<Symbol> = kernels
        .iter()
        .flat_map(|kernel| used(kernel, &apart))
        .collect();
    let second = of_words("second_derivatives", &all, &second & &used);
    let first = of_words("first_derivatives", &all, &first & &used);
    match (first, second) {
        (Some(mut first), Some(mut second)) => {
            // What the second derivatives are made of besides the first is given with these.
            let own = without_words(&second.steps, &first.words);
            let own = closure(&own, &second.words.iter().cloned().collect());
            let needed: BTreeSet<Symbol> = own.iter().flat_map(symbols).collect();
            let bound = first.steps.iter().flat_map(Step::bound);
            first.words = bound
                .filter(|symbol| needed.contains(symbol) || first.words.contains(symbol))
                .cloned()
                .collect();
            second.steps = without_words(&own, &first.words);
            let middle = middle(derived, &mut second);
            [Some(first), middle, Some(second)]
                .into_iter()
                .flatten()
                .collect()
        }
        (first, second) => first.into_iter().chain(second).collect(),
    }
}

/// The second derivatives of relations, taken out of the function of what follows from them where that is long.
fn middle(derived: &Derived, second: &mut Function) -> Option<Function> {
    let program = Program::new(&second.steps, &[second.outputs()], &NameSet::default());
    if Counts::of_program(&program).total() <= LONG {
        return None;
    }
    let named = derived.named.iter().map(|word| word.symbol.clone());
    let named: BTreeSet<Symbol> = named
        .filter(|symbol| !second.words.contains(symbol))
        .collect();
    let middle = of_words("second_derivatives_of_relations", &second.steps, named)?;
    second.steps = without_words(&second.steps, &middle.words);
    Some(middle)
}

/// The lines of a kernel that does not compute what the functions give.
pub fn without(functions: &[Function], kernel: &Kernel) -> Vec<Step> {
    let steps = kernel.steps.clone();
    functions.iter().fold(steps, |steps, function| {
        without_words(&steps, &function.words)
    })
}

/// The program of lines, and the names of its symbols, those that `bound` binds among them.
pub fn program(
    bound: &[Step],
    steps: &[Step],
    outputs: &[Matrix],
    names: &Names,
) -> (Program, Names) {
    let mut names = names.clone();
    let bound = bound.iter().flat_map(Step::bound);
    bound.for_each(|symbol| names.claim(symbol));
    let program = Program::new(steps, outputs, names.taken());
    let bindings = program.bindings.iter().flat_map(Binding::names);
    bindings.for_each(|symbol| names.adopt(symbol));
    (program, names)
}

fn formulas(derived: &Derived) -> impl Iterator<Item = &Kernel> {
    let kernels = derived.kernels.iter();
    kernels.filter(|kernel| kernel.method == Method::Formula)
}

/// The words that are first derivatives and those that are second ones. Where relations define B these are its entries, and what their rates are made of.
fn orders(derived: &Derived) -> [BTreeSet<Symbol>; 2] {
    let names = |words: Vec<&Word>| -> BTreeSet<Symbol> {
        words.into_iter().map(|word| word.symbol.clone()).collect()
    };
    if derived.named.is_empty() {
        let (second, first) = derived.words.iter().partition(|word| word.along.len() > 1);
        return [names(first), names(second)];
    }
    let (entries, others): (Vec<&Word>, Vec<&Word>) = derived
        .named
        .iter()
        .partition(|word| !word.rates.is_empty());
    let rates = entries.iter().flat_map(|word| &word.rates);
    let rates: BTreeSet<Symbol> = rates.flat_map(Expr::symbols).collect();
    [names(entries), &names(others) & &rates]
}

/// The lines that define words in some kernel, each in that with the most lines of those that have it.
fn definitions(kernels: &[&Kernel]) -> Vec<Step> {
    let mut kernels = kernels.to_vec();
    kernels.sort_by_key(|kernel| std::cmp::Reverse(kernel.steps.len()));
    let mut known: Vec<Step> = vec![];
    for step in kernels.iter().flat_map(|kernel| &kernel.steps) {
        let is_known = |symbol: &Symbol| known.iter().any(|other| other.bound().contains(symbol));
        if !step.bound().iter().any(is_known) {
            known.push(step.clone());
        }
    }
    known
}

/// What a kernel uses where it does not compute these words.
fn used(kernel: &Kernel, apart: &[&BTreeSet<Symbol>]) -> BTreeSet<Symbol> {
    let results = kernel.outputs.iter().flat_map(Matrix::entries);
    let results: BTreeSet<Symbol> = results.flat_map(Expr::symbols).collect();
    let is_apart = |step: &Step| {
        step.bound()
            .iter()
            .any(|symbol| apart.iter().any(|words| words.contains(symbol)))
    };
    let others: Vec<Step> = kernel
        .steps
        .iter()
        .filter(|step| !is_apart(step))
        .cloned()
        .collect();
    let needed = closure(&others, &results);
    needed.iter().flat_map(symbols).chain(results).collect()
}

fn of_words(name: &'static str, all: &[Step], words: BTreeSet<Symbol>) -> Option<Function> {
    let steps = closure(all, &words);
    let bound = steps.iter().flat_map(Step::bound);
    let words: Vec<Symbol> = bound
        .filter(|symbol| words.contains(symbol))
        .cloned()
        .collect();
    (!words.is_empty()).then_some(Function { name, words, steps })
}

/// The lines that give these words, in order.
fn closure(steps: &[Step], words: &BTreeSet<Symbol>) -> Vec<Step> {
    let mut needed = words.clone();
    let mut found = vec![];
    loop {
        let of_needed = |step: &&Step| step.bound().iter().any(|symbol| needed.contains(symbol));
        let lines: Vec<Step> = steps.iter().filter(of_needed).cloned().collect();
        if lines.len() == found.len() {
            return lines;
        }
        needed.extend(lines.iter().flat_map(symbols));
        found = lines;
    }
}

fn without_words(steps: &[Step], words: &[Symbol]) -> Vec<Step> {
    let is_other = |step: &&Step| !step.bound().iter().any(|symbol| words.contains(symbol));
    steps.iter().filter(is_other).cloned().collect()
}

/// What a line is made of.
fn symbols(step: &Step) -> BTreeSet<Symbol> {
    match step {
        Step::Let(_, value) => value.symbols(),
        Step::Call { argument, .. } => argument.entries().iter().flat_map(Expr::symbols).collect(),
    }
}
