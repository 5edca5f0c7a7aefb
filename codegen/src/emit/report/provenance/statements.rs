//! The statements of a spec as text, with their lines.

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

/// The spec with blanks in place of comments: every byte keeps its place, every line its number.
fn without_comments(source: &str) -> String {
    let mut bare = String::with_capacity(source.len());
    let (mut depth, mut in_line) = (0_usize, false);
    let mut characters = source.char_indices().peekable();
    while let Some((at, c)) = characters.next() {
        let rest = &source[at..];
        let opens = !in_line && rest.starts_with("/*");
        let closes = depth > 0 && rest.starts_with("*/");
        in_line = c != '\n' && (in_line || (depth == 0 && rest.starts_with("//")));
        depth += usize::from(opens);
        match in_line || depth > 0 {
            true if c != '\n' => bare.extend(std::iter::repeat_n(' ', c.len_utf8())),
            _ => bare.push(c),
        }
        if opens || closes {
            bare.extend(characters.next().map(|_| ' '));
        }
        depth -= usize::from(closes);
    }
    bare
}
