//! Errors of a spec: where, what, and what to do about it.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
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

    /// With a note below. Long lines of a residual are cut: their beginning says what is wrong.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        let note: String = note.into();
        let lines: Vec<String> = note.lines().map(shortened).collect();
        self.notes.push(lines.join("\n"));
        self
    }

    /// With advice.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
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
    /// The errors in plain text, as rustc shows them.
    pub fn render(&self) -> String {
        self.render_with(&Renderer::plain())
    }

    /// The errors with terminal colours.
    pub fn render_coloured(&self) -> String {
        self.render_with(&Renderer::styled())
    }

    fn render_with(&self, renderer: &Renderer) -> String {
        let shown: Vec<String> = self
            .errors
            .iter()
            .map(|error| self.render_one(error, renderer))
            .collect();
        shown.join("\n\n")
    }

    fn render_one(&self, error: &Diagnostic, renderer: &Renderer) -> String {
        let end = self.source.len();
        let span = error.span.start.min(end)..error.span.end.min(end);
        let annotation = AnnotationKind::Primary
            .span(span)
            .label(error.label.as_str());
        let snippet = Snippet::source(self.source.as_str())
            .line_start(1)
            .path(self.file.as_str())
            .annotation(annotation);
        let title = Level::ERROR
            .primary_title(error.message.as_str())
            .id(error.code);
        let notes = error
            .notes
            .iter()
            .map(|note| Level::NOTE.message(note.as_str()));
        let help = error
            .help
            .iter()
            .map(|help| Level::HELP.message(help.as_str()));
        let group: Group<'_> = title.element(snippet).elements(notes.chain(help));
        renderer.render(&[group]).to_string()
    }
}

impl std::fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for Diagnostics {}
