//! Errors of a spec: where, what, and what to do about it.

use crate::text::visible;
use hamel_diagnostics::{Place, Report};
use std::ops::Range;

/// One error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code, `E0101` and so on.
    pub code: &'static str,
    /// What is wrong, in one line.
    pub message: String,
    /// The bytes of the source to underline.
    pub span: Range<usize>,
    /// What stands at the underline.
    pub label: String,
    /// Derived matrices, residuals and the like.
    pub notes: Vec<String>,
    /// What to do.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at a span.
    pub fn new(code: &'static str, span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            span,
            label: String::new(),
            notes: vec![],
            help: None,
        }
    }

    /// With a text at the underline.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// With a note below. What is long is cut: its beginning says what is wrong.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        let note: String = note.into();
        self.notes.push(cut(note.lines().map(shortened)));
        self
    }

    fn report<'a>(&'a self, owner: &'a Diagnostics) -> Report<'a> {
        Report {
            code: Some(self.code),
            message: self.message.as_str().into(),
            place: Some(Place {
                source_name: &owner.file,
                source: &owner.source,
                primary: (self.span.clone(), &self.label),
                context: None,
            }),
            notes: &self.notes,
            help: self.help.as_slice(),
        }
    }

    /// With advice.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        let help: String = help.into();
        self.help = Some(cut(help.lines().map(str::to_owned)));
        self
    }
}

/// Most lines of a note or of advice.
const MOST_LINES: usize = 10;

/// The first lines, and how many more there are.
fn cut(lines: impl Iterator<Item = String>) -> String {
    let mut lines: Vec<String> = lines.collect();
    if lines.len() > MOST_LINES {
        let more = lines.len() - (MOST_LINES - 1);
        lines.truncate(MOST_LINES - 1);
        lines.push(format!("… and {more} more lines"));
    }
    lines.join("\n")
}

/// Longest line of a note, in characters.
const LONGEST_LINE: usize = 160;

fn shortened(line: &str) -> String {
    // Columns are aligned to their longest entry: where lines are cut, so is the blank space before shorter entries.
    let packed: String = match line.chars().count() > LONGEST_LINE {
        true => line.split_whitespace().collect::<Vec<_>>().join(" "),
        false => line.to_owned(),
    };
    match packed.chars().count() > LONGEST_LINE {
        true => packed
            .chars()
            .take(LONGEST_LINE - 2)
            .chain(" …".chars())
            .collect(),
        false => packed,
    }
}

/// All errors of one file, with its text, so that they can be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostics {
    /// Name of the file as the user gave it.
    pub file: String,
    /// Its text.
    pub source: String,
    /// The errors, in the order of the text.
    pub errors: Vec<Diagnostic>,
}

impl Diagnostics {
    /// The first errors in plain text, as rustc shows them, and the number of the others; what would not be seen is written out.
    pub fn render(&self) -> String {
        visible(&hamel_diagnostics::render(self.reports(), false))
    }

    /// The errors, ready to print.
    pub fn reports(&self) -> impl Iterator<Item = Report<'_>> {
        self.errors.iter().map(|error| error.report(self))
    }
}

impl std::fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for Diagnostics {}
