//! Formulas from text, by recursive descent.

use super::expression::{Function, Node, Operator};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::string::ToString;

/// What cannot be read of a formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("at character {}: {message}", .position + 1)]
pub struct SyntaxError {
    /// How many characters stand before what is wrong.
    pub position: usize,
    /// What is wrong.
    pub message: String,
}

/// How deeply formulas may be nested: each level takes room on the stack.
const DEEPEST: usize = 100;

/// The functions of one argument.
const FUNCTIONS: [(&str, Function); 8] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("step", Function::Step),
];

/// Those of two.
const CHOICES: [(&str, Operator); 2] = [("min", Operator::Smaller), ("max", Operator::Larger)];

/// What may stand where a number is wanted, for messages.
const OPERANDS: &str =
    "a number, `t`, `pi`, `(` or a function: sin, cos, tan, exp, log, sqrt, abs, step, min, max";

/// Reads a formula.
///
/// # Errors
/// The first thing that cannot be read.
pub(super) fn parse(text: &str) -> Result<Node, SyntaxError> {
    let mut parser = Parser {
        text,
        at: 0,
        depth: 0,
    };
    let node = parser.sum()?;
    match parser.peek() {
        None => Ok(node),
        Some(found) => Err(parser.error(format!("expected an operator, found `{found}`"))),
    }
}

struct Parser<'a> {
    text: &'a str,
    /// In bytes.
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// The next character that is not a space.
    fn peek(&mut self) -> Option<char> {
        let spaces = self.rest().len() - self.rest().trim_start().len();
        self.at += spaces;
        self.rest().chars().next()
    }

    /// Passes over `wanted`, if it comes next.
    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn error(&self, message: impl Into<String>) -> SyntaxError {
        self.error_at(self.at, message)
    }

    fn error_at(&self, at: usize, message: impl Into<String>) -> SyntaxError {
        let before = self.text.get(..at).unwrap_or_default();
        SyntaxError {
            position: before.chars().count(),
            message: message.into(),
        }
    }

    fn expect(&mut self, wanted: char, why: &str) -> Result<(), SyntaxError> {
        if self.take(wanted) {
            return Ok(());
        }
        let found = self.found();
        Err(self.error(format!("expected `{wanted}` {why}, found {found}")))
    }

    fn found(&mut self) -> String {
        self.peek()
            .map_or_else(|| "the end".to_string(), |found| format!("`{found}`"))
    }

    fn sum(&mut self) -> Result<Node, SyntaxError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("more than {DEEPEST} levels")));
        }
        let mut sum = self.product()?;
        loop {
            let operator = match self.peek() {
                Some('+') => Operator::Add,
                Some('-') => Operator::Subtract,
                _ => break,
            };
            self.at += 1;
            sum = pair(operator, sum, self.product()?);
        }
        self.depth -= 1;
        Ok(sum)
    }

    fn product(&mut self) -> Result<Node, SyntaxError> {
        let mut product = self.signed()?;
        loop {
            let operator = match self.peek() {
                Some('*') => Operator::Multiply,
                Some('/') => Operator::Divide,
                _ => return Ok(product),
            };
            self.at += 1;
            product = pair(operator, product, self.signed()?);
        }
    }

    /// A power with its sign: `-t^2` is `-(t^2)`.
    fn signed(&mut self) -> Result<Node, SyntaxError> {
        let mut is_negative = false;
        while matches!(self.peek(), Some('+' | '-')) {
            is_negative ^= self.peek() == Some('-');
            self.at += 1;
        }
        let node = self.power()?;
        Ok(match is_negative {
            true => Node::Negative(Box::new(node)),
            false => node,
        })
    }

    fn power(&mut self) -> Result<Node, SyntaxError> {
        let base = self.operand()?;
        if !self.take('^') {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("more than {DEEPEST} levels")));
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(pair(Operator::Power, base, exponent))
    }

    fn operand(&mut self) -> Result<Node, SyntaxError> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.expect(')', "that closes a parenthesis")?;
                Ok(inner)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() => self.named(),
            _ => {
                let found = self.found();
                Err(self.error(format!("expected {OPERANDS}; found {found}")))
            }
        }
    }

    fn number(&mut self) -> Result<Node, SyntaxError> {
        let bytes = self.rest().as_bytes();
        let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
        let mut length = 0;
        while digit(length) || bytes.get(length) == Some(&b'.') {
            length += 1;
        }
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        if matches!(bytes.get(length), Some(b'e' | b'E')) && digit(length + 1 + sign) {
            length += 1 + sign;
            while digit(length) {
                length += 1;
            }
        }
        let text = &self.rest()[..length];
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at += length;
                Ok(Node::Number(number))
            }
            _ => Err(self.error(format!("`{text}` is not a number that a double holds"))),
        }
    }

    /// `t`, `pi`, or a function with its arguments.
    fn named(&mut self) -> Result<Node, SyntaxError> {
        let start = self.at;
        let is_part = |c: &char| c.is_alphanumeric() || *c == '_';
        let name: String = self.rest().chars().take_while(is_part).collect();
        self.at += name.len();
        match &*name {
            "t" => return Ok(Node::Time),
            "pi" => return Ok(Node::Number(core::f64::consts::PI)),
            _ => {}
        }
        if let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            self.expect('(', "before the argument")?;
            let argument = self.sum()?;
            self.expect(')', "after the argument")?;
            return Ok(Node::Call(*function, Box::new(argument)));
        }
        if let Some((_, operator)) = CHOICES.iter().find(|(known, _)| *known == name) {
            self.expect('(', "before the arguments")?;
            let first = self.sum()?;
            self.expect(',', "between two arguments")?;
            let second = self.sum()?;
            self.expect(')', "after two arguments")?;
            return Ok(pair(*operator, first, second));
        }
        let message = format!("`{name}` is not known: expected {OPERANDS}");
        Err(self.error_at(start, message))
    }
}

fn pair(operator: Operator, first: Node, second: Node) -> Node {
    Node::Pair(operator, Box::new(first), Box::new(second))
}
