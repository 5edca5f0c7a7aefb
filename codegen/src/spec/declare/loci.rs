//! `except`: sets that the configuration must stay away from.

use super::super::ast::Equation;
use super::super::code;
use super::super::comments::one_line;
use super::super::evaluate::Evaluator;
use super::once::At;
use super::{Context, equation, home};
use crate::diagnostic::Diagnostic;
use crate::expr::{Expr, Symbol};
use crate::model::{Declared, Locus};
use std::collections::BTreeMap;

/// All loci; those that are wrong are reported and left out. `home` is the declared one.
pub(super) fn loci(
    context: &Context<'_>,
    home: Option<&[Expr]>,
    source: &str,
    evaluator: &mut Evaluator<'_>,
) -> Vec<Declared<Locus>> {
    let manifold = &context.manifold.value;
    let at_home = match (home, context.statements.relations.is_empty()) {
        (Some(home), _) => Some(home::substitution(manifold, home)),
        (None, true) => Some(home::substitution(manifold, &manifold.home())),
        // Home is missing or wrong, which was reported.
        (None, false) => None,
    };
    let exceptions = &context.statements.exceptions;
    exceptions
        .iter()
        .filter_map(|at| {
            let function = evaluator.bounded("except", at.span, |evaluator| {
                let function = equation::scalar(at.value, evaluator)?;
                match check(context, *at, &function, at_home.as_ref()) {
                    None => Some(function),
                    Some(error) => {
                        evaluator.report(error);
                        None
                    }
                }
            })?;
            Some(Declared {
                value: Locus {
                    function,
                    text: one_line(&source[at.value.span()]),
                    docs: at.value.docs.join("\n"),
                },
                span: at.span.clone(),
            })
        })
        .collect()
}

/// Why this is no set to stay away from, if it is none.
fn check(
    context: &Context<'_>,
    at: At<'_, Equation>,
    function: &Expr,
    at_home: Option<&BTreeMap<Symbol, Expr>>,
) -> Option<Diagnostic> {
    let error = |message: &str| Diagnostic::new(code::LOCUS, at.value.span(), message);
    let normal = context.manifold.value.ideal().normal_form(function);
    if normal.is_zero() {
        return Some(
            error("this equation holds everywhere")
                .label("excludes every configuration")
                .help("on the manifold of Q both sides are equal"),
        );
    }
    if !equation::of_configuration(&normal) {
        let error = error("this equation does not depend on the configuration")
            .label(format!("left minus right is {normal}"));
        return Some(error.help("a condition on parameters is `require a > b;`"));
    }
    at_home
        .is_some_and(|at_home| home::value_at(function, at_home).is_zero())
        .then(|| {
            error("this equation holds at home")
                .label("excludes the configuration in which a mechanism starts")
                .help("declare another configuration by `home = …;`")
        })
}
