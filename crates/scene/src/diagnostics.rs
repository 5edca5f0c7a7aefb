//! Errors of a scene file: collected, then rendered together under the lines that they are about.

use crate::source::Span;
use crate::text::{is_visible, visible};
use hamel_diagnostics::{Place, Report};
use std::fmt;

/// One mistake in a source text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    message: String,
    span: Option<Span>,
    label: String,
    context: Option<Box<(Span, String)>>,
    help: Vec<String>,
}

impl Diagnostic {
    /// A mistake at `span`. The message names the element, the value and the limit.
    pub fn new(span: Span, message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            span: Some(span),
            label: String::new(),
            context: None,
            help: Vec::new(),
        }
    }

    /// A mistake that stands at no place of the text, such as a file that cannot be read.
    pub fn without_place(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            span: None,
            label: String::new(),
            context: None,
            help: Vec::new(),
        }
    }

    /// Adds a short text beside the underline.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Shows a second place that has to do with the mistake, with a short text beside it.
    #[must_use]
    pub fn context(mut self, span: Span, label: impl Into<String>) -> Self {
        self.context = Some(Box::new((span, label.into())));
        self
    }

    /// Adds a line of advice below the excerpt.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }

    /// What is wrong, in one line.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The byte range that it is about.
    pub fn span(&self) -> Option<&Span> {
        self.span.as_ref()
    }

    fn report<'a>(&'a self, owner: &'a Diagnostics) -> Report<'a> {
        let context = self.context.as_deref();
        let place = self.span.as_ref().map(|span| Place {
            source_name: &owner.source_name,
            source: &owner.source,
            primary: (span.clone(), &self.label),
            context: context.map(|(span, label)| (span.clone(), label.as_str())),
        });
        Report {
            code: None,
            message: self.message.as_str().into(),
            place,
            notes: &[],
            help: &self.help,
        }
    }
}

/// All mistakes found in one source text, in the order in which they stand there. Never empty.
///
/// `Display` renders them plainly; [`Diagnostics::render`] also in colour.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    source_name: String,
    source: String,
    errors: Vec<Diagnostic>,
}

impl Diagnostics {
    /// The mistakes `errors` of the text `source`, which messages call `source_name`.
    pub(crate) fn new(source_name: &str, source: &str, mut errors: Vec<Diagnostic>) -> Self {
        errors.sort_by_key(|error| error.span.as_ref().map_or((0, 0), |s| (s.start, s.end)));
        Self {
            source_name: source_name.to_owned(),
            source: source.to_owned(),
            errors,
        }
    }

    /// The mistakes, in the order of the text.
    pub fn errors(&self) -> &[Diagnostic] {
        &self.errors
    }

    /// Line and column of a byte of the text, both from 1; columns count characters.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let end = self.source.floor_char_boundary(byte);
        let before = &self.source[..end];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The first mistakes as text with excerpts of the source, with terminal colours if `colour`, and the number of the others. Where something in
    /// it would not be seen, that is written out, and there are no colours.
    pub fn render(&self, colour: bool) -> String {
        let plain = hamel_diagnostics::render(self.reports(), false);
        let mut text = match colour && is_visible(&plain) {
            true => hamel_diagnostics::render(self.reports(), true),
            false => visible(&plain),
        };
        text.push('\n');
        text
    }

    /// The mistakes, ready to print.
    pub fn reports(&self) -> impl Iterator<Item = Report<'_>> {
        self.errors.iter().map(|error| error.report(self))
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}
