//! Errors of a scene file: collected, then rendered together under the lines that they are about.

use crate::source::Span;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use std::fmt;

/// Errors that are rendered; the others are counted.
const MOST_RENDERED: usize = 100;

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

    fn group<'a>(&'a self, source_name: &'a str, source: &'a str) -> Group<'a> {
        let title = Level::ERROR.primary_title(self.message.as_str());
        let group = match &self.span {
            Some(span) => title.element(self.snippet(span, source_name, source)),
            None => Group::with_title(title),
        };
        let help = self.help.iter();
        group.elements(help.map(|text| Level::HELP.message(text.as_str())))
    }

    fn snippet<'a>(
        &'a self,
        span: &Span,
        source_name: &'a str,
        source: &'a str,
    ) -> Snippet<'a, Annotation<'a>> {
        let labelled = |kind: AnnotationKind, span: &Span, label: &'a str| {
            let annotation = kind.span(within(source, span));
            if label.is_empty() {
                annotation
            } else {
                annotation.label(label)
            }
        };
        let context = self.context.as_deref();
        let context = context.map(|(span, label)| labelled(AnnotationKind::Context, span, label));
        Snippet::source(source)
            .path(source_name)
            .annotation(labelled(AnnotationKind::Primary, span, &self.label))
            .annotations(context)
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
        let end = floor_boundary(&self.source, byte);
        let before = &self.source[..end];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The mistakes as text with excerpts of the source, with terminal colours if `colour`; at most a hundred of them.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let reports = self.errors.iter().take(MOST_RENDERED).map(|error| {
            let group = error.group(&self.source_name, &self.source);
            renderer.render(&[group])
        });
        let mut text = reports.collect::<Vec<_>>().join("\n\n");
        if let Some(more) = self
            .errors
            .len()
            .checked_sub(MOST_RENDERED)
            .filter(|&n| n > 0)
        {
            text.push_str(&format!("\n\n… and {more} more errors"));
        }
        text.push('\n');
        text
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

/// `span`, moved onto character boundaries inside `source`.
fn within(source: &str, span: &Span) -> Span {
    let start = floor_boundary(source, span.start);
    let end = floor_boundary(source, span.end).max(start);
    start..end
}

/// The last character boundary of `source` at or before `byte`.
fn floor_boundary(source: &str, byte: usize) -> usize {
    (0..=byte.min(source.len()))
        .rev()
        .find(|&at| source.is_char_boundary(at))
        .unwrap_or(0)
}
