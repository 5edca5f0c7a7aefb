//! Text to tree: the version line, the joint's head, and its statements one by one.

mod curve;
mod expression;
pub(super) mod number;
mod pin;
mod range;
mod statement;

use super::ast::{File, Name, Parameter};
use super::tokens::Tokens;
use super::{Fallible, code};
use crate::diagnostic::Diagnostic;
use proc_macro2::{Delimiter, TokenStream};
use syn::buffer::TokenBuffer;

/// The version of the language that this generator reads.
const VERSION: &str = "1";

/// Reads a file; `None` where not even the joint's head can be read. Reasons are among the errors.
pub(super) fn file(source: &str, errors: &mut Vec<Diagnostic>) -> Option<File> {
    let file = match source.parse::<TokenStream>() {
        Ok(tokens) => {
            let buffer = TokenBuffer::new2(tokens);
            read(Tokens::new(source, buffer.begin()), errors)
        }
        Err(error) => {
            errors.push(unreadable(source, error.span().byte_range().start));
            None
        }
    };
    // All spans of the tree are byte ranges by now; the tokenizer would keep a copy of the text for ever.
    proc_macro2::extra::invalidate_current_thread_spans();
    file
}

fn unreadable(source: &str, start: usize) -> Diagnostic {
    let start = source.floor_char_boundary(start);
    let word = source[start..]
        .split(|c: char| c.is_whitespace() || ",;()[]".contains(c))
        .next()
        .unwrap_or_default();
    let error = Diagnostic::new(
        code::CHARACTER,
        start..start + word.len(),
        format!("`{word}` cannot be read"),
    );
    error.label("neither a name nor a number")
}

fn read(mut tokens: Tokens<'_>, errors: &mut Vec<Diagnostic>) -> Option<File> {
    let head = version(&mut tokens).and_then(|()| head(&mut tokens));
    let (docs, name, parameters) = match head {
        Ok(head) => head,
        Err(error) => {
            errors.push(*error);
            return None;
        }
    };
    let before = errors.len();
    let parameters = parameters
        .map(|inside| self::parameters(inside, errors))
        .unwrap_or_default();
    let Some((body, _)) = tokens.group(Delimiter::Brace) else {
        errors.push(*tokens.expected("`{` and the statements of the joint"));
        return None;
    };
    let statements = statement::all(body, errors);
    if !tokens.is_empty() {
        let error = Diagnostic::new(
            code::SURPLUS,
            tokens.span(),
            format!("unexpected {} after the joint", tokens.found()),
        );
        errors.push(
            error
                .label("after the end of the joint")
                .help("a file holds one joint; give each a file of its own"),
        );
    }
    let partial = errors.len() > before;
    Some(File {
        docs,
        name,
        parameters,
        statements,
        partial,
    })
}

/// `hamel = 1;`
fn version(tokens: &mut Tokens<'_>) -> Fallible<()> {
    let first = tokens.span();
    let starts = tokens.peek_name().is_some_and(|name| name.text == "hamel");
    if !starts {
        let error = Diagnostic::new(code::VERSION, first, "the version line is missing")
            .label("expected before this");
        return Err(Box::new(
            error.help(format!("begin the file with `hamel = {VERSION};`")),
        ));
    }
    tokens.name();
    tokens.expect('=', "`=` and the version of the language")?;
    match tokens.literal() {
        Some((literal, _)) if literal.to_string() == VERSION => {}
        Some((literal, span)) => {
            let error = Diagnostic::new(
                code::VERSION,
                span,
                format!("version {literal} of the language is not known"),
            );
            return Err(Box::new(
                error
                    .label("no such version")
                    .help(format!("this generator reads version {VERSION}; a file of a later one is read by a later generator")),
            ));
        }
        None => return Err(tokens.expected("the version of the language")),
    }
    tokens.expect(';', "`;`")
}

type Head<'a> = (Vec<String>, Name, Option<Tokens<'a>>);

/// `joint name` with the tokens of its parameters.
fn head<'a>(tokens: &mut Tokens<'a>) -> Fallible<Head<'a>> {
    let docs = tokens.docs();
    match tokens.peek_name() {
        Some(name) if name.text == "joint" => tokens.name(),
        _ => return Err(tokens.expected("`joint`")),
    };
    let name = tokens.expect_name("the name of the joint")?;
    let parameters = tokens
        .group(Delimiter::Parenthesis)
        .map(|(inside, _)| inside);
    Ok((docs, name, parameters))
}

fn parameters(mut tokens: Tokens<'_>, errors: &mut Vec<Diagnostic>) -> Vec<Parameter> {
    let mut parameters = vec![];
    while !tokens.is_empty() {
        match parameter(&mut tokens) {
            Ok(parameter) => parameters.push(parameter),
            Err(error) => {
                errors.push(*error);
                while !tokens.eat(',') && tokens.skip() {}
            }
        }
    }
    parameters
}

/// `name: unit,` where the comma may be missing at the end.
fn parameter(tokens: &mut Tokens<'_>) -> Fallible<Parameter> {
    let docs = tokens.docs();
    let name = tokens.expect_name("the name of a parameter")?;
    tokens.expect(':', "`:` and a unit")?;
    let unit = unit(tokens)?;
    let range = range::bounds(tokens)?;
    if !tokens.is_empty() {
        tokens.expect(',', "`,`, `)` or the range of the parameter")?;
    }
    Ok(Parameter {
        docs,
        name,
        unit,
        range,
    })
}

/// `m`, `1`, `m/rad`, `kg*m*m`: checked later, joined here without spaces.
fn unit(tokens: &mut Tokens<'_>) -> Fallible<Name> {
    let mut text = String::new();
    let mut span = tokens.span();
    loop {
        let part = tokens
            .name()
            .map(|name| name.text)
            .or_else(|| Some(tokens.literal()?.0.to_string()));
        text.push_str(&part.ok_or_else(|| tokens.expected("a unit"))?);
        span.end = tokens.previous;
        match ['*', '/']
            .into_iter()
            .find(|operator| tokens.eat(*operator))
        {
            Some(operator) => text.push(operator),
            None => return Ok(Name { text, span }),
        }
    }
}
