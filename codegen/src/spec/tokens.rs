//! A cursor over the tokens of a spec, with the byte range of each.

use super::ast::Name;
use super::{Fallible, code};
use crate::diagnostic::Diagnostic;
use proc_macro2::{Delimiter, Literal};
use std::ops::Range;
use syn::buffer::Cursor;

/// Most characters of a token that a message shows.
const LONGEST_SHOWN: usize = 40;

/// `>`, `>=`, `<` or `<=`.
pub(super) struct Comparison {
    pub greater: bool,
    pub included: bool,
    pub span: Range<usize>,
}

/// The tokens between two brackets, or of a whole file.
#[derive(Clone)]
pub(super) struct Tokens<'a> {
    source: &'a str,
    cursor: Cursor<'a>,
    /// End of the token before the cursor.
    pub previous: usize,
    /// Where the tokens end: the closing bracket, or the end of the file.
    end: Range<usize>,
}

impl<'a> Tokens<'a> {
    /// All tokens of a file.
    pub fn new(source: &'a str, cursor: Cursor<'a>) -> Self {
        let end = source.len()..source.len();
        Self {
            source,
            cursor,
            previous: 0,
            end,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.cursor.eof()
    }

    /// The bytes of the next token; of a bracketed group, its opening bracket.
    pub fn span(&self) -> Range<usize> {
        if self.is_empty() {
            return self.end.clone();
        }
        match self.cursor.any_group() {
            Some((_, _, span, _)) => span.open().byte_range(),
            None => self.cursor.span().byte_range(),
        }
    }

    /// The next token for an error message.
    pub fn found(&self) -> String {
        match self.span() {
            span if span.is_empty() => "the end of the file".into(),
            span => format!("`{}`", shortened(&self.source[span])),
        }
    }

    /// Whether the next token is the first of its line.
    pub fn starts_line(&self) -> bool {
        self.source
            .get(self.previous..self.span().start)
            .is_some_and(|between| between.contains('\n'))
    }

    pub fn peek(&self, character: char) -> bool {
        self.cursor
            .punct()
            .is_some_and(|(punct, _)| punct.as_char() == character)
    }

    /// Whether the next two tokens are `..`.
    pub fn peek_range(&self) -> bool {
        let dot = |cursor: Cursor<'a>| {
            let (punct, rest) = cursor.punct()?;
            (punct.as_char() == '.').then_some(rest)
        };
        dot(self.cursor).and_then(dot).is_some()
    }

    /// Takes `>`, `>=`, `<` or `<=`.
    pub fn comparison(&mut self) -> Option<Comparison> {
        let start = self.span().start;
        let greater = self.eat('>');
        if !greater && !self.eat('<') {
            return None;
        }
        let included = self.eat('=');
        Some(Comparison {
            greater,
            included,
            span: start..self.previous,
        })
    }

    pub fn peek_group(&self, delimiter: Delimiter) -> bool {
        self.cursor.group(delimiter).is_some()
    }

    /// The next token as a name, without taking it.
    pub fn peek_name(&self) -> Option<Name> {
        let (ident, _) = self.cursor.ident()?;
        Some(Name {
            text: ascii_spelling(&ident.to_string()),
            span: ident.span().byte_range(),
        })
    }

    pub fn name(&mut self) -> Option<Name> {
        let (ident, rest) = self.cursor.ident()?;
        let name = Name {
            text: ascii_spelling(&ident.to_string()),
            span: ident.span().byte_range(),
        };
        self.advance(rest, name.span.end);
        Some(name)
    }

    pub fn expect_name(&mut self, what: &str) -> Fallible<Name> {
        self.name().ok_or_else(|| self.expected(what))
    }

    pub fn eat(&mut self, character: char) -> bool {
        match self.cursor.punct() {
            Some((punct, rest)) if punct.as_char() == character => {
                self.advance(rest, punct.span().byte_range().end);
                true
            }
            _ => false,
        }
    }

    pub fn expect(&mut self, character: char, what: &str) -> Fallible<()> {
        match self.eat(character) {
            true => Ok(()),
            false => Err(self.expected(what)),
        }
    }

    pub fn literal(&mut self) -> Option<(Literal, Range<usize>)> {
        let (literal, rest) = self.cursor.literal()?;
        let span = literal.span().byte_range();
        self.advance(rest, span.end);
        Some((literal, span))
    }

    /// A text between quotes.
    pub fn expect_text(&mut self, what: &str) -> Fallible<Name> {
        let here = self.span();
        let quoted = self
            .cursor
            .literal()
            .map(|(literal, _)| literal.to_string());
        let text = quoted
            .as_deref()
            .and_then(|text| text.strip_prefix('"')?.strip_suffix('"'));
        match text.map(str::to_owned) {
            Some(text) => {
                self.literal();
                Ok(Name { text, span: here })
            }
            None => Err(self.expected(what)),
        }
    }

    /// The tokens of a bracketed group, and its bytes.
    pub fn group(&mut self, delimiter: Delimiter) -> Option<(Self, Range<usize>)> {
        let (inside, span, rest) = self.cursor.group(delimiter)?;
        let inside = Self {
            source: self.source,
            cursor: inside,
            previous: span.open().byte_range().end,
            end: span.close().byte_range(),
        };
        self.advance(rest, span.close().byte_range().end);
        Some((inside, span.join().byte_range()))
    }

    /// Doc comments before the next token, line by line.
    pub fn docs(&mut self) -> Vec<String> {
        let mut lines = vec![];
        while self.peek('#') {
            let comment = self.span();
            self.eat('#');
            self.eat('!');
            self.group(Delimiter::Bracket);
            self.previous = comment.end;
            lines.extend(doc_lines(&self.source[comment]));
        }
        lines
    }

    /// Skips one token or group; false at the end.
    pub fn skip(&mut self) -> bool {
        let Some((tree, rest)) = self.cursor.token_tree() else {
            return false;
        };
        self.advance(rest, tree.span().byte_range().end);
        true
    }

    /// The error that something else stands here.
    pub fn expected(&self, what: &str) -> Box<Diagnostic> {
        let message = format!("expected {what}, found {}", self.found());
        Box::new(
            Diagnostic::new(code::EXPECTED, self.span(), message).label(format!("expected {what}")),
        )
    }

    fn advance(&mut self, rest: Cursor<'a>, end: usize) {
        self.cursor = rest;
        self.previous = end;
    }
}

/// The first line of a token, and not too much of it.
fn shortened(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    match line.char_indices().nth(LONGEST_SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// Greek spellings are the same names.
fn ascii_spelling(name: &str) -> String {
    match name {
        "Φ" => "Phi",
        "ϕ" | "φ" => "phi",
        "π" => "pi",
        "S\u{304}" => "S_bar",
        _ => name,
    }
    .to_owned()
}

/// The text of a doc comment without its marks.
fn doc_lines(comment: &str) -> Vec<String> {
    let unindented = |line: &str| line.strip_prefix(' ').unwrap_or(line).trim_end().to_owned();
    if let Some(line) = comment
        .strip_prefix("///")
        .or_else(|| comment.strip_prefix("//!"))
    {
        return vec![unindented(line)];
    }
    let inner = comment
        .get(3..comment.len().saturating_sub(2))
        .unwrap_or_default()
        .trim();
    let unmarked = |line: &str| unindented(line.trim_start().trim_start_matches('*'));
    inner.lines().map(unmarked).collect()
}
