//! The range of a parameter: `> 0`, `>= 0 < 5`, `in 0..=1`.

use super::super::ast::{Bound, Bounds};
use super::super::tokens::{Comparison, Tokens};
use super::super::{Fallible, code};
use super::expression;
use crate::diagnostic::Diagnostic;

/// The range that begins here, if one does.
pub(super) fn bounds(tokens: &mut Tokens<'_>) -> Fallible<Option<Bounds>> {
    let start = tokens.span().start;
    let within = tokens.peek_name().is_some_and(|name| name.text == "in");
    let (lower, upper) = match within {
        true => interval(tokens)?,
        false => comparisons(tokens)?,
    };
    Ok((lower.is_some() || upper.is_some()).then_some(Bounds {
        span: start..tokens.previous,
        lower,
        upper,
    }))
}

type Ends = (Option<Bound>, Option<Bound>);

/// `> a`, `< b`, or both one after the other.
fn comparisons(tokens: &mut Tokens<'_>) -> Fallible<Ends> {
    let mut ends: Ends = (None, None);
    while let Some(comparison) = tokens.comparison() {
        let end = match comparison.greater {
            true => &mut ends.0,
            false => &mut ends.1,
        };
        if end.is_some() {
            return Err(Box::new(repeated(comparison)));
        }
        *end = Some(Bound {
            value: expression::expression(tokens)?,
            included: comparison.included,
        });
    }
    Ok(ends)
}

fn repeated(comparison: Comparison) -> Diagnostic {
    let message = "a second bound on the same side";
    let error = Diagnostic::new(code::EXPECTED, comparison.span, message).label("one too many");
    error.help("a range has one lower and one upper bound: `> 0 < 5`")
}

/// `in a..b`, `in a..=b`, `in a..`: the lower end belongs to the range, the upper with `=`.
fn interval(tokens: &mut Tokens<'_>) -> Fallible<Ends> {
    tokens.name();
    let lower = match tokens.peek_range() {
        true => None,
        false => Some(Bound {
            value: expression::expression(tokens)?,
            included: true,
        }),
    };
    if !tokens.peek_range() {
        return Err(tokens.expected("an operator or `..`"));
    }
    tokens.eat('.');
    tokens.eat('.');
    let included = tokens.eat('=');
    let open = !included && lower.is_some() && (tokens.is_empty() || tokens.peek(','));
    let upper = match open {
        true => None,
        false => Some(Bound {
            value: expression::expression(tokens)?,
            included,
        }),
    };
    Ok((lower, upper))
}
