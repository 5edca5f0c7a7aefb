//! Expressions: sums of products of signed values with indices and parts.

use super::super::ast::{Node, NodeKind};
use super::super::tokens::Tokens;
use super::super::{Fallible, code};
use super::number;
use crate::diagnostic::Diagnostic;
use proc_macro2::Delimiter;
use std::ops::Range;

/// Longest chain of operators of one precedence, and of indices and parts.
const LONGEST_CHAIN: usize = 256;
const LONGEST_ACCESS: usize = 8;

/// `[-] product ± product …`
pub(super) fn expression(tokens: &mut Tokens<'_>) -> Fallible<Node> {
    let start = tokens.span().start;
    let mut terms = vec![(false, product(tokens)?)];
    while let Some(minus) = either(tokens, '+', '-') {
        terms.push((minus, product(tokens)?));
    }
    chain(start..tokens.previous, terms, NodeKind::Sum)
}

/// `value * value / value …`
fn product(tokens: &mut Tokens<'_>) -> Fallible<Node> {
    let start = tokens.span().start;
    let mut factors = vec![(false, signed(tokens)?)];
    while let Some(divides) = either(tokens, '*', '/') {
        if tokens.peek('*') {
            return Err(power(tokens.span()));
        }
        factors.push((divides, signed(tokens)?));
    }
    chain(start..tokens.previous, factors, NodeKind::Product)
}

/// Takes one of two operators; true for the second.
fn either(tokens: &mut Tokens<'_>, first: char, second: char) -> Option<bool> {
    match tokens.eat(first) {
        true => Some(false),
        false => tokens.eat(second).then_some(true),
    }
}

fn chain(
    span: Range<usize>,
    mut items: Vec<(bool, Node)>,
    kind: fn(Vec<(bool, Node)>) -> NodeKind,
) -> Fallible<Node> {
    if items.len() > LONGEST_CHAIN {
        let message = format!("more than {LONGEST_CHAIN} operands in one chain");
        return Err(Box::new(
            Diagnostic::new(code::TOO_LARGE, span, message).help("name a part of it with `let`"),
        ));
    }
    match items.len() {
        1 => Ok(items.remove(0).1),
        _ => Ok(Node {
            span,
            kind: kind(items),
        }),
    }
}

fn signed(tokens: &mut Tokens<'_>) -> Fallible<Node> {
    let start = tokens.span().start;
    let mut negative = false;
    while tokens.eat('-') {
        negative = !negative;
    }
    let value = access(tokens)?;
    let span = start..value.span.end;
    Ok(match negative {
        true => Node {
            span,
            kind: NodeKind::Negative(Box::new(value)),
        },
        false => value,
    })
}

/// A value with its indices and parts: `Q[2, 3]`, `Q.x`.
fn access(tokens: &mut Tokens<'_>) -> Fallible<Node> {
    let mut value = primary(tokens)?;
    for _ in 0..LONGEST_ACCESS {
        let start = value.span.start;
        let kind = if tokens.peek_range() {
            return Ok(value);
        } else if tokens.eat('.') {
            let part = tokens.expect_name("the name of a part")?;
            NodeKind::Field(Box::new(value), part)
        } else if let Some((inside, _)) = tokens.group(Delimiter::Bracket) {
            NodeKind::Index(Box::new(value), list(inside, "an index")?)
        } else {
            return Ok(value);
        };
        value = Node {
            span: start..tokens.previous,
            kind,
        };
    }
    match tokens.peek('.') || tokens.peek_group(Delimiter::Bracket) {
        true => Err(tokens.expected(&format!(
            "at most {LONGEST_ACCESS} parts and indices in a row"
        ))),
        false => Ok(value),
    }
}

fn primary(tokens: &mut Tokens<'_>) -> Fallible<Node> {
    if let Some((literal, span)) = tokens.literal() {
        let number = number::rational(&literal.to_string(), &span)?;
        return Ok(Node {
            span,
            kind: NodeKind::Number(number),
        });
    }
    if let Some(name) = tokens.name() {
        return match tokens.group(Delimiter::Parenthesis) {
            None => Ok(Node {
                span: name.span,
                kind: NodeKind::Name(name.text),
            }),
            Some((inside, group)) => {
                let span = name.span.start..group.end;
                Ok(Node {
                    span,
                    kind: NodeKind::Call(name, list(inside, "an argument")?),
                })
            }
        };
    }
    if let Some((mut inside, span)) = tokens.group(Delimiter::Parenthesis) {
        let value = expression(&mut inside)?;
        return match inside.is_empty() {
            true => Ok(Node {
                span,
                kind: value.kind,
            }),
            false => Err(leftover(&inside, "an operator or `)`")),
        };
    }
    if let Some((inside, span)) = tokens.group(Delimiter::Bracket) {
        return Ok(Node {
            span,
            kind: NodeKind::Literal(rows(inside)?),
        });
    }
    Err(tokens.expected("a value"))
}

/// Expressions separated by commas, to the end.
fn list(mut tokens: Tokens<'_>, what: &str) -> Fallible<Vec<Node>> {
    let mut items = vec![];
    while !tokens.is_empty() {
        items.push(expression(&mut tokens)?);
        if !tokens.is_empty() && !tokens.eat(',') {
            return Err(leftover(
                &tokens,
                &format!("an operator, `,` or the end after {what}"),
            ));
        }
    }
    Ok(items)
}

/// `a, b; c, d`
fn rows(mut tokens: Tokens<'_>) -> Fallible<Vec<Vec<Node>>> {
    let mut rows = vec![vec![expression(&mut tokens)?]];
    while !tokens.is_empty() {
        if tokens.eat(',') {
            let entry = expression(&mut tokens)?;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        } else if tokens.eat(';') {
            rows.push(vec![expression(&mut tokens)?]);
        } else {
            return Err(leftover(&tokens, "an operator, `,`, `;` or `]`"));
        }
    }
    Ok(rows)
}

fn leftover(tokens: &Tokens<'_>, what: &str) -> Box<Diagnostic> {
    match tokens.peek('^') {
        true => power(tokens.span()),
        false => tokens.expected(what),
    }
}

/// The error that a power is written as an operator.
pub(super) fn power(span: Range<usize>) -> Box<Diagnostic> {
    let error = Diagnostic::new(code::POWER, span, "the language has no operator for powers")
        .label("not an operator");
    Box::new(error.help("write pow(x, n)"))
}
