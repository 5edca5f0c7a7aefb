//! Local coordinates in Phi: `phi`, `phi.R` of a factor, `phi.turn` of a degree of freedom, `phi[2]`.

use super::super::value::Value;
use super::super::{Fallible, code, names};
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use std::collections::BTreeMap;
use std::ops::Range;

/// The local coordinates as Phi sees them.
pub(in super::super) struct Locals {
    /// ϕ of each factor that has any, by the factor's name; of `local`s, all of them under no name.
    pub by_factor: BTreeMap<String, Value>,
    /// Each ϕ by the name of its degree of freedom.
    pub by_freedom: BTreeMap<String, Expr>,
    /// Each ϕ in order.
    pub all: Vec<Expr>,
    /// Number of parts that `phi` has; the whole is defined where there is one.
    pub parts: usize,
}

impl Locals {
    /// `phi`: the algebra element, or the column, of the only factor.
    pub fn whole(&self, span: &Range<usize>) -> Fallible<Value> {
        match (self.parts, self.by_factor.values().next()) {
            (1, Some(value)) => Ok(value.clone()),
            _ => {
                let names = match self.by_factor.len() == self.parts {
                    true => self.by_factor.keys().collect::<Vec<_>>(),
                    false => self
                        .by_factor
                        .keys()
                        .chain(self.by_freedom.keys())
                        .collect(),
                };
                let parts: Vec<String> = names.iter().map(|name| format!("`phi.{name}`")).collect();
                let error = Diagnostic::new(
                    code::SHAPES,
                    span.clone(),
                    "`phi` belongs to several factors",
                )
                .label("of which factor?");
                Err(Box::new(
                    error.help(format!("write {}", parts.join(" or "))),
                ))
            }
        }
    }

    /// `phi.name`
    pub fn part(&self, name: &str, span: &Range<usize>) -> Fallible<Value> {
        let freedom = || self.by_freedom.get(name).cloned().map(Value::Scalar);
        self.by_factor
            .get(name)
            .cloned()
            .or_else(freedom)
            .ok_or_else(|| {
                let error = Diagnostic::new(
                    code::FIELD,
                    span.clone(),
                    format!("`{name}` is neither a factor nor a degree of freedom"),
                );
                let error = error.label("no such part of phi");
                let known: Vec<&str> = self
                    .by_factor
                    .keys()
                    .chain(self.by_freedom.keys())
                    .map(String::as_str)
                    .collect();
                Box::new(match names::suggestion(name, known.iter().copied()) {
                    Some(advice) => error.help(advice),
                    None => error.help(format!("phi has the parts {}", known.join(", "))),
                })
            })
    }
}

/// The error that ϕ stands where it is not defined.
pub(super) fn outside_phi(span: &Range<usize>) -> Diagnostic {
    let error = Diagnostic::new(code::PHI, span.clone(), "`phi` is defined in Phi alone")
        .label("not known here");
    error.help("H, X, A and S_bar depend on Q alone; the derivation moves them along Phi")
}
