//! Long formulas in names for what their entries share, as the emitted kernel computes them.

use super::notation::Notation;
use super::typeset::{Equation, Math};
use crate::derived::{Derived, Kernel};
use crate::emit::method::Method;
use crate::expr::Symbol;
use crate::formula::Binding;

/// Parts of a formula that a reader takes in as a whole: longer ones are written with names for what they share.
pub const LONGEST: usize = 300;

/// The values of a kernel, one for each of `names`, and after them w₁, w₂, … as they follow from each other; nothing for a
/// kernel that calls the runtime.
pub fn equations(
    derived: &Derived,
    notation: &Notation,
    kernel: &Kernel,
    names: &[Math],
) -> Option<Vec<Equation>> {
    let claimed = derived.names();
    let method = Method::new(derived, kernel, &claimed);
    let program = &method.program;
    let mut notation = notation.clone();
    let mut definitions = vec![];
    for binding in &program.bindings {
        match binding {
            // Names of the spec are told once, before all formulas.
            Binding::Value { name, .. } if is_word(derived, name) => {}
            Binding::Value { name, value } => {
                let left = Math::Letter('w').with_index(Math::integer(definitions.len() + 1));
                let right = notation.formula(value);
                notation.name(name, left.clone());
                definitions.push(Equation { left, right });
            }
            Binding::SinCos { sin, cos, angle } => {
                let angle = notation.formula(angle);
                let mut name = |symbol: &Option<Symbol>, function: &str| {
                    if let Some(symbol) = symbol {
                        let applied = vec![Math::Word(function.into()), angle.clone().grouped()];
                        notation.name(symbol, Math::Row(applied));
                    }
                };
                name(sin, "sin");
                name(cos, "cos");
            }
            Binding::Call { .. } => return None,
        }
    }
    let mut outputs = program.outputs.iter().map(|node| notation.formula(node));
    let results = kernel.outputs.iter().zip(names).map(|(matrix, name)| {
        let entries: Vec<Math> = outputs.by_ref().take(matrix.entries().len()).collect();
        let right = Math::Matrix(matrix.columns(), entries);
        Equation {
            left: name.clone(),
            right,
        }
    });
    Some(
        results
            .collect::<Vec<_>>()
            .into_iter()
            .chain(definitions)
            .collect(),
    )
}

/// Whether a line of a kernel is a name of the spec, or a derivative of one.
pub fn is_word(derived: &Derived, name: &Symbol) -> bool {
    derived.words.iter().any(|word| word.symbol == *name)
}
