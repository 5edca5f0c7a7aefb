//! Few shared values: those that save most keep a name of their own, others stand in the formulas that use them.

use super::share::Binding;
use super::{Counts, Node, Program};
use crate::expr::{Role, Symbol};
use crate::formula::names::{NameSet, number_name};
use rustc_hash::FxHashMap;

/// Most shared values of a kernel of which no name says what they are.
const MOST: usize = 6;

/// The program with at most [`MOST`] shared values that are called by a letter and an index.
pub fn with_few_shared(mut program: Program, is_shared: impl Fn(&Symbol) -> bool) -> Program {
    loop {
        let uses = uses(&program);
        let shared = program.bindings.iter().enumerate();
        let shared = shared.filter_map(|(place, binding)| match binding {
            Binding::Value { name, value } if is_shared(name) && telling(value).is_none() => {
                let uses = uses.get(name).copied().unwrap_or(0);
                Some((saved(value, uses), place))
            }
            _ => None,
        });
        let shared: Vec<(usize, usize)> = shared.collect();
        let least = shared.iter().min().copied();
        match least {
            Some((gain, place)) if gain == 0 || shared.len() > MOST => {
                put_in(&mut program, place);
            }
            _ => return program,
        }
    }
}

/// The program with its shared values called by what they are, or else by a letter and an index.
pub fn named(
    mut program: Program,
    taken: &mut NameSet,
    is_shared: impl Fn(&Symbol) -> bool,
) -> Program {
    let mut index = 0;
    let mut renamed = FxHashMap::default();
    for binding in &mut program.bindings {
        binding.change(&mut |node| node.rename(&renamed));
        let Binding::Value { name, value } = binding else {
            continue;
        };
        if !is_shared(name) {
            continue;
        }
        let wish = telling(value).unwrap_or_else(|| {
            loop {
                index += 1;
                let letter = format!("t{index}");
                if taken.is_free(&letter) {
                    break letter;
                }
            }
        });
        let symbol = Symbol::new(name.role, name.index.into(), &taken.claim(&wish));
        let before = std::mem::replace(name, symbol.clone());
        renamed.insert(before, symbol);
    }
    let outputs = program.outputs.iter_mut();
    outputs.for_each(|node| node.rename(&renamed));
    program
}

/// Operations that a name for the value saves.
fn saved(value: &Node, uses: usize) -> usize {
    Counts::of(value).work() * uses.saturating_sub(1)
}

fn uses(program: &Program) -> FxHashMap<Symbol, usize> {
    let mut uses = FxHashMap::default();
    for formula in program.formulas() {
        formula.visit(&mut |node| {
            if let Node::Symbol(symbol) = node
                && symbol.role == Role::Intermediate
            {
                *uses.entry(symbol.clone()).or_default() += 1;
            }
        });
    }
    uses
}

/// Takes a binding away: its value stands where its name stood.
fn put_in(program: &mut Program, place: usize) {
    let Binding::Value { name, value } = program.bindings.remove(place) else {
        return;
    };
    program.change(&mut |node| {
        if node.put(&name, &value) {
            node.replace_by(|node| node.opened().polished());
        }
    });
}

/// What a value is called where that says what it is: `x_squared`, `inverse_x` of a name x.
pub fn telling(value: &Node) -> Option<String> {
    match value {
        Node::Product(factors) => match factors.as_slice() {
            [Node::Symbol(a), Node::Symbol(b)] if a == b => Some(format!("{}_squared", a.name())),
            [Node::Symbol(a), Node::Symbol(b)]
                if [a, b].map(|s| s.role) == [Role::Coordinate; 2] =>
            {
                Some(format!("{}_{}", a.name(), b.name()))
            }
            [Node::Number(n), Node::Symbol(a)] => Some(format!("{}_{}", number_name(n), a.name())),
            _ => None,
        },
        Node::Quotient(above, below) if above.is_one() => match below.as_ref() {
            Node::Symbol(divisor) => Some(format!("inverse_{}", divisor.name())),
            _ => None,
        },
        _ => None,
    }
}
