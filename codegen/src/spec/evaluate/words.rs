//! Names for values where the declarations are wanted in names: `let`s, and sums that are angles or stand under roots.

use super::super::value::Value;
use crate::expr::{Expr, Role, Symbol};
use crate::model::Named;
use std::collections::BTreeSet;

/// First index of the symbols made here, above those that a kernel numbers itself.
const FIRST_INDEX: usize = 0x4000;

/// The names so far.
pub(in super::super) struct Words {
    named: Vec<Named>,
    /// Those that no `let` gives, by index.
    automatic: BTreeSet<u16>,
    /// What the spec itself gives a name.
    taken: BTreeSet<String>,
}

impl Words {
    /// No names yet; those that are made keep clear of `taken`.
    pub fn new(taken: BTreeSet<String>) -> Self {
        Self {
            named: vec![],
            automatic: BTreeSet::new(),
            taken,
        }
    }

    /// The names, each with its value in those before it.
    pub fn finish(self) -> Vec<Named> {
        self.named
    }

    /// The value of a `let` with a symbol for each entry of which a name says more than it does itself.
    pub fn name_let(&mut self, value: &Value, name: &str) -> Value {
        let mut names = value.entry_names(name).into_iter();
        value.map(|entry| match names.next() {
            Some(name) => self.name_entry(entry, &name),
            None => entry.clone(),
        })
    }

    fn name_entry(&mut self, entry: &Expr, name: &str) -> Expr {
        let automatic = entry
            .as_symbol()
            .filter(|s| self.automatic.contains(&s.index));
        if let Some(symbol) = automatic.cloned() {
            return self.rename(&symbol, name);
        }
        match entry.is_plain() {
            true => entry.clone(),
            false => self.bind(name, entry.clone()),
        }
    }

    /// What was named before the `let` was known takes the name of the `let`.
    fn rename(&mut self, symbol: &Symbol, name: &str) -> Expr {
        let renamed = Symbol::new(symbol.role, symbol.index.into(), name);
        self.automatic.remove(&symbol.index);
        for named in &mut self.named {
            if named.symbol == *symbol {
                named.symbol = renamed.clone();
            }
        }
        Expr::symbol(&renamed)
    }

    fn bind(&mut self, name: &str, value: Expr) -> Expr {
        let symbol = Symbol::new(Role::Intermediate, FIRST_INDEX + self.named.len(), name);
        let itself = Expr::symbol(&symbol);
        self.named.push(Named { symbol, value });
        itself
    }

    fn bind_automatic(&mut self, name: &str, value: Expr) -> Expr {
        if let Some(known) = self.named.iter().find(|named| named.value == value) {
            return Expr::symbol(&known.symbol);
        }
        let name = self.free(name);
        let itself = self.bind(&name, value);
        let index = itself.as_symbol().map(|symbol| symbol.index);
        self.automatic.extend(index);
        itself
    }

    /// `angle`, `angle2`, …: the first that nothing else is called.
    fn free(&self, name: &str) -> String {
        let is_free = |name: &String| {
            let mut named = self.named.iter();
            !self.taken.contains(name) && named.all(|named| *named.symbol.name() != **name)
        };
        let others = (2..).map(|n| format!("{name}{n}"));
        let mut candidates = std::iter::once(name.to_owned()).chain(others);
        candidates.find(is_free).unwrap_or_default()
    }

    /// Sums whose sine or cosine is taken: kept as they are, so that nothing is multiplied out.
    pub fn name_angles(&mut self, function: &str, arguments: &mut [Value]) {
        let takes_angle = ["sin", "cos", "tan", "rot_x", "rot_y", "rot_z"].contains(&function);
        for argument in arguments.iter_mut().filter(|_| takes_angle) {
            if let Value::Scalar(angle) = argument
                && angle.terms().len() > 1
                && !angle.is_constant()
            {
                *angle = self.bind_automatic("angle", angle.clone());
            }
        }
    }

    /// Roots of sums.
    pub fn name_root(&mut self, function: &str, value: Value) -> Value {
        match (function, &value) {
            ("sqrt" | "norm", Value::Scalar(root)) if !root.is_plain() => {
                Value::Scalar(self.bind_automatic("root", root.clone()))
            }
            _ => value,
        }
    }
}
