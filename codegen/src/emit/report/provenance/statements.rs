//! The statements of a spec as text, with their lines.

use crate::spec::comments::without_comments;
use std::ops::Range;

/// One statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// The line where it begins, counted from 1.
    pub line: usize,
    /// Its first word: `H`, `let`, ….
    pub keyword: String,
    /// The statement on one line, without comments.
    pub text: String,
    /// Its bytes in the spec.
    pub span: Range<usize>,
}

impl Statement {
    /// The name that a `let` defines.
    pub fn defines(&self) -> Option<&str> {
        let rest = self.text.strip_prefix("let ")?;
        words(rest).next()
    }

    /// Whether a name occurs in it.
    pub fn mentions(&self, name: &str) -> bool {
        words(&self.text).any(|word| word == name)
    }
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
        .filter(|word| !word.is_empty())
}

/// The statements of the joint in a spec that was parsed, in order.
pub fn statements(source: &str) -> Vec<Statement> {
    let bare = without_comments(source);
    let Some(start) = bare.find('{').map(|at| at + 1) else {
        return vec![];
    };
    let body = &bare[start..bare.rfind('}').unwrap_or(bare.len()).max(start)];
    let mut at = start;
    let mut found = vec![];
    let mut depth = 0_i32;
    let ends = |c: char| {
        depth += i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
        // Rows of matrices end with the same sign as statements.
        c == ';' && depth == 0
    };
    for part in body.split_inclusive(ends) {
        let begin = at + (part.len() - part.trim_start().len());
        at += part.len();
        let text = part.split_whitespace().collect::<Vec<_>>().join(" ");
        let keyword = words(&text).next().map(str::to_owned);
        if let Some(keyword) = keyword {
            found.push(Statement {
                line: 1 + bare[..begin].matches('\n').count(),
                keyword,
                span: begin..at,
                text,
            });
        }
    }
    found
}
