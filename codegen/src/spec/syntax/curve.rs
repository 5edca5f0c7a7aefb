//! Curves: `curve lift(deg): mm = quintic periodic through [0, 0], [120, 8], …;`

use super::super::Fallible;
use super::super::ast::{Curve, Knots, Name};
use super::super::tokens::Tokens;
use super::statement::list;
use super::{number, unit};
use crate::expr::Rational;
use crate::expr::curve::{Ends, Kind, Outside};
use proc_macro2::Delimiter;
use std::ops::Range;

/// What stands behind `curve`.
pub(super) fn curve(tokens: &mut Tokens<'_>) -> Fallible<Curve> {
    let name = tokens.expect_name("the name of a curve")?;
    let argument = argument(tokens)?;
    tokens.expect(':', "`:` and the unit of the values")?;
    let unit = unit(tokens)?;
    tokens.expect('=', "`=`")?;
    let kind = word(
        tokens,
        &[("cubic", Kind::Cubic), ("quintic", Kind::Quintic)],
    )?;
    let ends = ends(tokens)?;
    let knots = knots(tokens)?;
    Ok(Curve {
        name,
        argument,
        unit,
        kind,
        ends,
        knots,
        outside: outside(tokens)?,
    })
}

/// `(unit)`
fn argument(tokens: &mut Tokens<'_>) -> Fallible<Name> {
    let Some((mut inside, _)) = tokens.group(Delimiter::Parenthesis) else {
        return Err(tokens.expected("`(` and the unit of the argument"));
    };
    let argument = unit(&mut inside)?;
    match inside.is_empty() {
        true => Ok(argument),
        false => Err(inside.expected("`)`")),
    }
}

/// One of several words.
fn word<T: Copy>(tokens: &mut Tokens<'_>, words: &[(&str, T)]) -> Fallible<T> {
    let found = tokens.peek_name().and_then(|name| {
        let mut words = words.iter();
        words.find(|(word, _)| *word == name.text)
    });
    match found {
        Some((_, meaning)) => {
            tokens.name();
            Ok(*meaning)
        }
        None => {
            let words: Vec<String> = words.iter().map(|(word, _)| format!("`{word}`")).collect();
            Err(tokens.expected(&words.join(" or ")))
        }
    }
}

/// `periodic`, `natural`, `clamped a, b`
fn ends(tokens: &mut Tokens<'_>) -> Fallible<Ends> {
    let words = [("periodic", 0), ("natural", 1), ("clamped", 2)];
    Ok(match word(tokens, &words)? {
        0 => Ends::Periodic,
        1 => Ends::Natural,
        _ => {
            let first = signed_number(tokens, "the slope at the first knot")?;
            tokens.expect(',', "`,` and the slope at the last knot")?;
            Ends::Clamped(first, signed_number(tokens, "the slope at the last knot")?)
        }
    })
}

fn knots(tokens: &mut Tokens<'_>) -> Fallible<Knots> {
    let start = tokens.span().start;
    let through = word(tokens, &[("through", true), ("from", false)])?;
    if through {
        return Ok(Knots::Points(list(tokens, point)?));
    }
    let file = tokens.expect_text("the name of a file, as a text")?;
    Ok(Knots::File(file, start..tokens.previous))
}

/// `[x, y]`
fn point(tokens: &mut Tokens<'_>) -> Fallible<(Range<usize>, [Rational; 2])> {
    let Some((mut inside, span)) = tokens.group(Delimiter::Bracket) else {
        return Err(tokens.expected("a knot `[x, y]`"));
    };
    let x = signed_number(&mut inside, "the argument at a knot")?;
    inside.expect(',', "`,` and the value at the knot")?;
    let y = signed_number(&mut inside, "the value at a knot")?;
    match inside.is_empty() {
        true => Ok((span, [x, y])),
        false => Err(inside.expected("`]`")),
    }
}

fn signed_number(tokens: &mut Tokens<'_>, what: &str) -> Fallible<Rational> {
    let negative = tokens.eat('-');
    let Some((literal, span)) = tokens.literal() else {
        return Err(tokens.expected(&format!("{what}, a number")));
    };
    let size = number::rational(&literal.to_string(), &span)?;
    Ok(if negative { -size } else { size })
}

/// `continue linear` or `continue polynomial`
fn outside(tokens: &mut Tokens<'_>) -> Fallible<Option<(Outside, Range<usize>)>> {
    let start = tokens.span().start;
    match tokens.peek_name() {
        Some(name) if name.text == "continue" => tokens.name(),
        _ => return Ok(None),
    };
    let words = [
        ("linear", Outside::Straight),
        ("polynomial", Outside::Polynomial),
    ];
    let outside = word(tokens, &words)?;
    Ok(Some((outside, start..tokens.previous)))
}
