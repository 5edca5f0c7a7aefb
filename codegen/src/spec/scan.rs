//! What may reach the tokenizer: size, characters and brackets, so that neither it nor the parser recurses without bound.

use super::code;
use super::limits::LARGEST_SOURCE;
use crate::diagnostic::Diagnostic;
use std::ops::Range;

/// Deepest nesting of brackets.
const DEEPEST: usize = 64;
/// What the language is written with, outside comments, besides letters, digits and white space.
const PUNCTUATION: &str = "_+-*/^=<>.,:;";
/// Greek spellings of names of the language; the last is the macron of S̄.
const GREEK: &str = "Φϕφπ\u{304}";

/// Whether the text can be tokenized; else the reason is among the errors.
pub(super) fn check(source: &str, errors: &mut Vec<Diagnostic>) -> bool {
    if source.len() > LARGEST_SOURCE {
        let message = format!(
            "a spec has at most {LARGEST_SOURCE} bytes, this one has {}",
            source.len()
        );
        errors.push(Diagnostic::new(code::SIZE, 0..0, message));
        return false;
    }
    let mut scanner = Scanner {
        source,
        at: 0,
        open: vec![],
    };
    match scanner.run() {
        Ok(()) => true,
        Err(error) => {
            errors.push(*error);
            false
        }
    }
}

struct Scanner<'a> {
    source: &'a str,
    at: usize,
    open: Vec<(char, usize)>,
}

impl Scanner<'_> {
    fn run(&mut self) -> super::Fallible<()> {
        if self.source.starts_with('\u{feff}') {
            self.at = '\u{feff}'.len_utf8();
        }
        while let Some(character) = self.rest().chars().next() {
            let here = self.at..self.at + character.len_utf8();
            match character {
                '/' if self.rest().starts_with("//") => {
                    self.at += self.rest().find('\n').unwrap_or(self.rest().len())
                }
                '/' if self.rest().starts_with("/*") => self.block_comment()?,
                '"' => self.text()?,
                _ => {
                    self.at = here.end;
                    self.character(character, here)?;
                }
            }
        }
        match self.open.pop() {
            None => Ok(()),
            Some((bracket, at)) => Err(Box::new(
                Diagnostic::new(
                    code::BRACKETS,
                    at..at + 1,
                    format!("`{bracket}` is never closed"),
                )
                .label(format!("no `{}` for this one", partner(bracket))),
            )),
        }
    }

    fn rest(&self) -> &str {
        &self.source[self.at..]
    }

    fn character(&mut self, character: char, here: Range<usize>) -> super::Fallible<()> {
        match character {
            '(' | '[' | '{' => self.opened(character, here),
            ')' | ']' | '}' => self.closed(character, here),
            ' ' | '\t' | '\r' | '\n' => Ok(()),
            _ if character.is_ascii_alphanumeric()
                || PUNCTUATION.contains(character)
                || GREEK.contains(character) =>
            {
                Ok(())
            }
            _ => Err(Box::new(unreadable(character, here))),
        }
    }

    fn opened(&mut self, bracket: char, here: Range<usize>) -> super::Fallible<()> {
        self.open.push((bracket, here.start));
        match self.open.len() > DEEPEST {
            false => Ok(()),
            true => Err(Box::new(
                Diagnostic::new(
                    code::BRACKETS,
                    here,
                    format!("brackets nest deeper than {DEEPEST}"),
                )
                .label("one too many")
                .help("name a part of the expression with `let`"),
            )),
        }
    }

    fn closed(&mut self, bracket: char, here: Range<usize>) -> super::Fallible<()> {
        match self.open.pop() {
            Some((opened, _)) if partner(opened) == bracket => Ok(()),
            Some((opened, at)) => Err(Box::new(
                Diagnostic::new(
                    code::BRACKETS,
                    here,
                    format!("`{bracket}` does not close `{opened}`"),
                )
                .label(format!("`{}` is expected before this", partner(opened)))
                .note(format!(
                    "`{opened}` stands in line {}",
                    1 + self.source[..at].matches('\n').count()
                )),
            )),
            None => Err(Box::new(
                Diagnostic::new(code::BRACKETS, here, format!("`{bracket}` closes nothing"))
                    .label("no bracket is open here"),
            )),
        }
    }

    /// A text stands on one line and knows no escapes.
    fn text(&mut self) -> super::Fallible<()> {
        let start = self.at;
        let line = self.rest()[1..].lines().next().unwrap_or_default();
        let refused = |range: Range<usize>, message: &str| {
            let error = Diagnostic::new(code::CHARACTER, range, message);
            Err(Box::new(
                error.help("a text is written \"…\" on one line, without `\\`"),
            ))
        };
        let Some(length) = line.find('"') else {
            return refused(start..start + 1, "the text is never closed");
        };
        let text = &line[..length];
        if let Some(place) = text.find(|c: char| c == '\\' || c.is_control()) {
            let at = start + 1 + place;
            let end = at + text[place..].chars().next().map_or(1, char::len_utf8);
            return refused(at..end, "a character that a text cannot have");
        }
        self.at += length + 2;
        Ok(())
    }

    /// Block comments nest, as in Rust.
    fn block_comment(&mut self) -> super::Fallible<()> {
        let start = self.at;
        let mut depth = 0;
        loop {
            let rest = self.rest();
            let Some(next) = [rest.find("/*"), rest.find("*/")]
                .into_iter()
                .flatten()
                .min()
            else {
                let error = Diagnostic::new(
                    code::BRACKETS,
                    start..start + 2,
                    "the comment is never closed",
                );
                return Err(Box::new(error.label("no `*/` for this one")));
            };
            depth += if rest[next..].starts_with("/*") {
                1
            } else {
                -1
            };
            self.at += next + 2;
            if depth == 0 {
                return Ok(());
            }
        }
    }
}

fn partner(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

fn unreadable(character: char, here: Range<usize>) -> Diagnostic {
    let error = Diagnostic::new(
        code::CHARACTER,
        here,
        format!("{character:?} is not a character of the language"),
    );
    let error = error.label("outside a comment");
    match character {
        '#' => error.help("comments begin with `//`; a file whose comments begin with `#` may be a scene, for `hamel simulate`"),
        '\'' => error.help("names stand without quotes"),
        '²' | '³' => error.help("write pow(x, 2)"),
        '·' | '×' => error.help("a product is written `*`"),
        '−' => error.help("minus is the ASCII `-`"),
        _ if !character.is_ascii() => error.help("names are ASCII; of Greek letters only Φ, ϕ, π and S̄ are known, as Phi, phi, pi and S_bar"),
        _ => error,
    }
}
