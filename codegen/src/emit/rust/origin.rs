//! Which lines of a body compute what one statement of the spec declares: the functions that stand in it.

use crate::derived::{Derived, KernelKind};
use crate::emit::formula::{Binding, Node, factored};
use crate::emit::report::{Statement, sources};
use crate::expr::{Application, Atom, Expr, Function, Symbol};
use crate::matrix::Matrix;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The functions of coordinates and parameters that statements declare, each with the line that declares it.
pub struct Origins {
    by_function: BTreeMap<Node, String>,
}

impl Origins {
    /// The functions in the statements that a kernel comes from; none where it comes from a single one, which its
    /// documentation names.
    pub fn new(derived: &Derived, kind: KernelKind) -> Self {
        let sources = sources(&derived.spec, kind);
        let mut by_function = BTreeMap::new();
        if sources.len() > 1 {
            for (span, value) in declared(derived) {
                let statement = sources
                    .iter()
                    .find(|source| source.span.contains(&span.start));
                for function in functions(&value) {
                    if let Some(Statement { line, keyword, .. }) = statement {
                        let origin = || format!("line {line} `{keyword}`");
                        by_function.entry(function).or_insert_with(origin);
                    }
                }
            }
        }
        Self { by_function }
    }

    /// For each line of a body, the statement that holds its function.
    pub fn of(&self, bindings: &[Binding]) -> Vec<Option<&str>> {
        let mut values: BTreeMap<&Symbol, Node> = BTreeMap::new();
        let mut origins = vec![];
        for binding in bindings {
            let functions = match binding {
                Binding::Value { name, value } => {
                    let value = expanded(value, &values);
                    values.insert(name, value.clone());
                    vec![value]
                }
                Binding::SinCos { angle, .. } => {
                    let angle = expanded(angle, &values);
                    let both = [Function::Sin, Function::Cos];
                    both.map(|function| Node::Call(function, vec![angle.clone()]))
                        .to_vec()
                }
                Binding::Call { .. } => vec![],
            };
            let origin = functions
                .iter()
                .find_map(|function| self.by_function.get(function));
            origins.push(origin.map(String::as_str));
        }
        origins
    }
}

/// The matrices that the spec declares, with their places.
fn declared(derived: &Derived) -> Vec<(Range<usize>, Matrix)> {
    let spec = &derived.spec;
    let pose = &spec.pose;
    let others = [&spec.twist_map, &spec.constraint, &spec.speed_basis];
    let mut declared = vec![
        (pose.span.clone(), pose.value.rotation.clone()),
        (pose.span.clone(), pose.value.translation.clone()),
    ];
    let others = others.into_iter().flatten();
    declared.extend(others.map(|matrix| (matrix.span.clone(), matrix.value.clone())));
    declared
}

/// Every function in a matrix, as formulas.
fn functions(matrix: &Matrix) -> BTreeSet<Node> {
    let mut found = BTreeSet::new();
    for entry in matrix.entries() {
        collect(entry, &mut found);
    }
    found
}

fn collect(expression: &Expr, found: &mut BTreeSet<Node>) {
    for atom in expression.atoms() {
        if let Atom::Apply(application) = &atom
            && application.function != Function::Pi
        {
            let Application { arguments, .. } = application.as_ref();
            if application.function != Function::Group {
                found.insert(factored(&Expr::atom(atom.clone())));
            }
            arguments
                .iter()
                .for_each(|argument| collect(argument, found));
        }
    }
}

/// The formula with names replaced by their values.
fn expanded(node: &Node, values: &BTreeMap<&Symbol, Node>) -> Node {
    match node {
        Node::Symbol(symbol) => values.get(symbol).unwrap_or(node).clone(),
        other => other.map_parts(&mut |part| expanded(part, values)),
    }
}
