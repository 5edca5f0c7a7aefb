//! Building a kernel line by line, binding intermediate values to names.

use crate::expr::{Expr, Role, Symbol};
use crate::kernel::{Primitive, Step};
use crate::matrix::Matrix;

/// The lines of a kernel so far.
#[derive(Clone, Debug, Default)]
pub struct Steps {
    steps: Vec<Step>,
    names: usize,
}

impl Steps {
    /// The lines.
    pub fn finish(self) -> Vec<Step> {
        self.steps
    }

    fn fresh(&mut self, name: &str) -> Symbol {
        self.names += 1;
        Symbol::new(Role::Intermediate, self.names - 1, name)
    }

    /// Binds a value to a name; numbers, single symbols and their negatives stay as they are.
    pub fn bind(&mut self, name: &str, value: Expr) -> Expr {
        if value.is_constant() || value.as_symbol().is_some() || (-&value).as_symbol().is_some() {
            return value;
        }
        let symbol = self.fresh(name);
        let bound = Expr::symbol(&symbol);
        self.steps.push(Step::Let(symbol, value));
        bound
    }

    /// Binds each entry of a matrix: `prefix11` and so on, or `prefix1` for a column.
    pub fn bind_matrix(&mut self, prefix: &str, matrix: &Matrix) -> Matrix {
        let columns = matrix.columns();
        let names = (0..matrix.entries().len()).map(|n| match columns {
            1 => format!("{prefix}{}", n + 1),
            _ => format!("{prefix}{}{}", n / columns + 1, n % columns + 1),
        });
        let names: Vec<String> = names.collect();
        let mut next = 0;
        matrix.map(|entry| {
            next += 1;
            self.bind(&names[next - 1], entry.clone())
        })
    }

    /// Calls a runtime function.
    pub fn call(&mut self, primitive: Primitive, argument: Matrix, names: &[&str]) -> Vec<Expr> {
        let outputs: Vec<Symbol> = names.iter().map(|name| self.fresh(name)).collect();
        let values = outputs.iter().map(Expr::symbol).collect();
        self.steps.push(Step::Call {
            primitive,
            argument,
            outputs,
        });
        values
    }
}
