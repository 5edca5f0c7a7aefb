//! `pin`: where bodies of a joint hold each other.

use super::super::Fallible;
use super::super::ast::{Pin, PinEnd};
use super::super::tokens::Tokens;
use super::expression;
use super::statement::keyword;
use crate::model::Axis;

/// `name: body at point = body at point`, then `about axis` and `along axis`, each at most once.
pub(super) fn pin(tokens: &mut Tokens<'_>, docs: Vec<String>) -> Fallible<Pin> {
    let name = tokens.expect_name("the name of a pin")?;
    tokens.expect(':', "`:` and a body")?;
    let start = tokens.span().start;
    let first = end(tokens)?;
    tokens.expect('=', "`=` and the other body")?;
    let ends = [first, end(tokens)?];
    let (mut about, mut along) = (None, None);
    while let Some(word) = tokens.peek_name() {
        let axis = match word.text.as_str() {
            "about" if about.is_none() => &mut about,
            "along" if along.is_none() => &mut along,
            _ => break,
        };
        tokens.name();
        *axis = Some(self::axis(tokens)?);
    }
    Ok(Pin {
        docs,
        name,
        ends,
        about,
        along,
        span: start..tokens.previous,
    })
}

fn end(tokens: &mut Tokens<'_>) -> Fallible<PinEnd> {
    let body = tokens.expect_name("the name of a body, or `parent`")?;
    keyword(tokens, "at")?;
    let point = expression::expression(tokens)?;
    Ok(PinEnd { body, point })
}

fn axis(tokens: &mut Tokens<'_>) -> Fallible<Axis> {
    let axis = match tokens.peek_name().map(|name| name.text).as_deref() {
        Some("x") => Axis::X,
        Some("y") => Axis::Y,
        Some("z") => Axis::Z,
        _ => return Err(tokens.expected("`x`, `y` or `z`")),
    };
    tokens.name();
    Ok(axis)
}
