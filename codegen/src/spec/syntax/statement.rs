//! Statements, and recovery at the end of each.

use super::super::ast::{
    Basis, Equation, Name, Port, Requirement, Statement, StatementKind, Target,
};
use super::super::names::{self, STATEMENTS};
use super::super::tokens::Tokens;
use super::super::{Fallible, code};
use super::{expression, unit};
use crate::diagnostic::Diagnostic;
use proc_macro2::Delimiter;

/// All statements of a joint; of each that cannot be read, one error.
pub(in super::super) fn all(
    mut tokens: Tokens<'_>,
    errors: &mut Vec<Diagnostic>,
) -> Vec<Statement> {
    let mut statements = vec![];
    loop {
        let docs = tokens.docs();
        if tokens.is_empty() {
            return statements;
        }
        let start = tokens.span().start;
        match statement(&mut tokens, docs) {
            Ok(kind) => statements.push(Statement {
                span: start..tokens.previous,
                kind,
            }),
            Err(error) => {
                errors.push(*error);
                recover(&mut tokens, start);
            }
        }
    }
}

/// Goes on behind the next `;`, or at a line that begins a statement.
fn recover(tokens: &mut Tokens<'_>, start: usize) {
    let begins_statement = |tokens: &Tokens<'_>| {
        let known = tokens
            .peek_name()
            .is_some_and(|name| STATEMENTS.contains(&name.text.as_str()));
        known && tokens.starts_line() && tokens.span().start > start
    };
    while !tokens.eat(';') {
        if begins_statement(tokens) || !tokens.skip() {
            return;
        }
    }
}

fn statement(tokens: &mut Tokens<'_>, docs: Vec<String>) -> Fallible<StatementKind> {
    let word = tokens.expect_name("a statement")?;
    let kind = match word.text.as_str() {
        "config" => StatementKind::Config(list(tokens, factor)?),
        "basis" => StatementKind::Basis(basis(tokens)?),
        "local" => StatementKind::Local(list(tokens, |t| {
            t.expect_name("the name of a local coordinate")
        })?),
        "speeds" => StatementKind::Speeds(list(tokens, |t| t.expect_name("the name of a speed"))?),
        "bodies" => StatementKind::Bodies(list(tokens, |t| t.expect_name("the name of a body"))?),
        "port" => StatementKind::Port(port(tokens, docs)?),
        "pin" => StatementKind::Pin(super::pin::pin(tokens, docs)?),
        "velocity" => velocity(tokens)?,
        "relation" => StatementKind::Relation(equation(tokens, docs)?),
        "except" => StatementKind::Except(equation(tokens, docs)?),
        "require" => StatementKind::Require(requirement(tokens)?),
        "unproved" => {
            let claim = tokens.expect_name("the name of a claim")?;
            keyword(tokens, "because")?;
            StatementKind::Unproved(claim, tokens.expect_text("the reason, as a text")?)
        }
        "let" => {
            let name = tokens.expect_name("a name")?;
            tokens.expect('=', "`=`")?;
            StatementKind::Let(name, expression::expression(tokens)?)
        }
        "curve" => StatementKind::Curve(super::curve::curve(tokens)?),
        "H" if tokens.eat('.') => {
            let body = tokens.expect_name("the name of a body")?;
            tokens.expect('=', "`=`")?;
            StatementKind::BodyPose(body, vec![expression::expression(tokens)?])
        }
        other => match Target::ALL
            .into_iter()
            .find(|target| target.name() == other)
        {
            Some(target) => assignment(tokens, target)?,
            None => return Err(unknown(&word, tokens)),
        },
    };
    match tokens.eat(';') {
        true => Ok(kind),
        false => Err(unfinished(tokens)),
    }
}

fn unknown(keyword: &Name, tokens: &Tokens<'_>) -> Box<Diagnostic> {
    let message = format!("there is no statement `{}`", keyword.text);
    let error =
        Diagnostic::new(code::STATEMENT, keyword.span.clone(), message).label("not a statement");
    let advice = names::suggestion(&keyword.text, STATEMENTS.iter().copied());
    Box::new(error.help(match advice {
        Some(advice) => advice,
        None if tokens.peek('=') => format!(
            "an auxiliary value is defined by `let {} = …;`",
            keyword.text
        ),
        None => format!("statements are {}", STATEMENTS.join(", ")),
    }))
}

fn unfinished(tokens: &Tokens<'_>) -> Box<Diagnostic> {
    if tokens.peek('^') {
        return expression::power(tokens.span());
    }
    if tokens.is_empty() || tokens.starts_line() {
        let here = tokens.previous..tokens.previous;
        let error = Diagnostic::new(
            code::EXPECTED,
            here,
            format!("expected `;`, found {}", tokens.found()),
        );
        return Box::new(error.label("expected `;` here"));
    }
    tokens.expected("an operator or `;`")
}

/// One or more items, separated by commas.
pub(super) fn list<'a, T>(
    tokens: &mut Tokens<'a>,
    item: impl Fn(&mut Tokens<'a>) -> Fallible<T>,
) -> Fallible<Vec<T>> {
    let mut items = vec![item(tokens)?];
    while tokens.eat(',') {
        items.push(item(tokens)?);
    }
    Ok(items)
}

fn factor(tokens: &mut Tokens<'_>) -> Fallible<(Name, Name)> {
    let name = tokens.expect_name("the name of a factor")?;
    tokens.expect(':', "`:` and a manifold")?;
    Ok((name, tokens.expect_name("a manifold")?))
}

fn basis(tokens: &mut Tokens<'_>) -> Fallible<Basis> {
    let elements = list(tokens, |tokens| {
        let name = tokens.expect_name("the name of a basis element")?;
        let value = tokens
            .eat('=')
            .then(|| expression::expression(tokens))
            .transpose()?;
        Ok((name, value))
    })?;
    keyword(tokens, "of")?;
    let algebra = tokens.expect_name("a Lie algebra")?;
    let factor = match tokens.group(Delimiter::Parenthesis) {
        Some((mut inside, _)) => {
            let name = inside.expect_name("the name of a factor")?;
            if !inside.is_empty() {
                return Err(inside.expected("`)`"));
            }
            Some(name)
        }
        None => None,
    };
    Ok(Basis {
        elements,
        algebra,
        factor,
    })
}

/// `name: unit = value`
fn port(tokens: &mut Tokens<'_>, docs: Vec<String>) -> Fallible<Port> {
    let name = tokens.expect_name("the name of a port")?;
    tokens.expect(':', "`:` and a unit")?;
    let unit = unit(tokens)?;
    tokens.expect('=', "`=` and an angle or a length")?;
    let value = expression::expression(tokens)?;
    Ok(Port {
        docs,
        name,
        unit,
        value,
    })
}

fn velocity(tokens: &mut Tokens<'_>) -> Fallible<StatementKind> {
    keyword(tokens, "in")?;
    match tokens.peek_name().map(|name| name.text).as_deref() {
        Some(frame @ ("child" | "parent")) => {
            tokens.name();
            Ok(StatementKind::Velocity {
                child: frame == "child",
            })
        }
        _ => Err(tokens.expected("`child` or `parent`")),
    }
}

/// `a = b`
fn equation(tokens: &mut Tokens<'_>, docs: Vec<String>) -> Fallible<Equation> {
    let left = expression::expression(tokens)?;
    if let Some(comparison) = tokens.comparison() {
        let message = "an equation is written with `=`";
        let error = Diagnostic::new(code::EXPECTED, comparison.span, message);
        let error = error.label("expected `=`");
        return Err(Box::new(
            error.help("a condition on parameters is `require a > b;`"),
        ));
    }
    tokens.expect('=', "an operator or `=` and the other side")?;
    if tokens.peek('=') {
        let error = tokens.expected("one `=` and the other side");
        return Err(Box::new(error.help("an equation is written with one `=`")));
    }
    let right = expression::expression(tokens)?;
    Ok(Equation { docs, left, right })
}

/// `a > b` or `a < b`
fn requirement(tokens: &mut Tokens<'_>) -> Fallible<Requirement> {
    let first = expression::expression(tokens)?;
    let Some(comparison) = tokens.comparison() else {
        return Err(tokens.expected("an operator, `>` or `<`"));
    };
    if comparison.included {
        let message = "a requirement is strict: `>` or `<`";
        let error = Diagnostic::new(code::EXPECTED, comparison.span, message);
        return Err(Box::new(error.label("expected `>` or `<`").help(
            "a joint whose parameters lie on the border of what is possible has no room to move",
        )));
    }
    let second = expression::expression(tokens)?;
    let (larger, smaller) = match comparison.greater {
        true => (first, second),
        false => (second, first),
    };
    Ok(Requirement { larger, smaller })
}

pub(super) fn keyword(tokens: &mut Tokens<'_>, word: &str) -> Fallible<()> {
    match tokens.peek_name() {
        Some(name) if name.text == word => {
            tokens.name();
            Ok(())
        }
        _ => Err(tokens.expected(&format!("`{word}`"))),
    }
}

fn assignment(tokens: &mut Tokens<'_>, target: Target) -> Fallible<StatementKind> {
    let is_guess =
        target == Target::Home && tokens.peek_name().is_some_and(|name| name.text == "near");
    let target = match is_guess {
        true => {
            tokens.name();
            Target::Near
        }
        false => {
            tokens.expect('=', "`=`")?;
            target
        }
    };
    let values = match target {
        Target::Retract | Target::Home | Target::Near => list(tokens, expression::expression)?,
        _ => vec![expression::expression(tokens)?],
    };
    Ok(StatementKind::Assign(target, values))
}
