//! Errors of input files as they are printed: each under the lines that it is about, and of a long list the first fifty with the number of
//! the others. Specs, scenes, robots and the program all print theirs here.

mod excerpt;

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use excerpt::Excerpt;
use std::borrow::Cow;
use std::ops::Range;

/// Errors that a list prints; the others are counted.
pub const MOST_PRINTED: usize = 50;

/// One error, ready to print.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    /// A stable code, if errors of this kind have one.
    pub code: Option<&'a str>,
    /// What is wrong, in one line.
    pub message: Cow<'a, str>,
    /// Where it stands; `None` for what stands in no text.
    pub place: Option<Place<'a>>,
    /// Facts below the lines.
    pub notes: &'a [String],
    /// Advice below the facts.
    pub help: &'a [String],
}

/// Where in a text an error stands. Spans are ranges of bytes; where they leave the text or cut a character they are moved.
#[derive(Clone, Debug)]
pub struct Place<'a> {
    /// What the text is called.
    pub source_name: &'a str,
    /// The whole text.
    pub source: &'a str,
    /// What is wrong, and a word on it, which may be empty.
    pub primary: (Range<usize>, &'a str),
    /// A second place that has to do with it.
    pub context: Option<(Range<usize>, &'a str)>,
}

impl<'a> Report<'a> {
    /// An error that stands in no text.
    pub fn bare(message: impl Into<Cow<'a, str>>) -> Self {
        Self {
            code: None,
            message: message.into(),
            place: None,
            notes: &[],
            help: &[],
        }
    }

    fn group(&self) -> Group<'_> {
        let title = Level::ERROR.primary_title(&*self.message);
        let title = match self.code {
            Some(code) => title.id(code),
            None => title,
        };
        let group = match &self.place {
            Some(place) => title.element(place.snippet()),
            None => Group::with_title(title),
        };
        let notes = self.notes.iter().map(|text| Level::NOTE.message(text));
        let help = self.help.iter().map(|text| Level::HELP.message(text));
        group.elements(notes.chain(help))
    }
}

impl<'a> Place<'a> {
    fn snippet(&self) -> Snippet<'a, Annotation<'a>> {
        let context = self.context.as_ref();
        let spans = [Some(&self.primary), context].into_iter().flatten();
        let excerpt = Excerpt::around(self.source, spans.map(|(span, _)| span));
        let labelled = |kind: AnnotationKind, (span, label): &(Range<usize>, &'a str)| {
            let annotation = kind.span(excerpt.within(span));
            match label.is_empty() {
                true => annotation,
                false => annotation.label(*label),
            }
        };
        Snippet::source(excerpt.text)
            .line_start(excerpt.line)
            .path(self.source_name)
            .annotation(labelled(AnnotationKind::Primary, &self.primary))
            .annotations(context.map(|place| labelled(AnnotationKind::Context, place)))
    }
}

/// The errors as text, with colours for a terminal if `colour`: an empty line between two, and after [`MOST_PRINTED`] of them the number of
/// the others.
pub fn render<'a>(errors: impl IntoIterator<Item = Report<'a>>, colour: bool) -> String {
    let renderer = match colour {
        true => Renderer::styled(),
        false => Renderer::plain(),
    };
    first(errors, |error| renderer.render(&[error.group()])).join("\n\n")
}

/// The first [`MOST_PRINTED`] errors as `print` writes them, and the number of the others.
pub fn first<E>(
    errors: impl IntoIterator<Item = E>,
    print: impl FnMut(E) -> String,
) -> Vec<String> {
    let mut errors = errors.into_iter();
    let mut shown: Vec<String> = errors.by_ref().take(MOST_PRINTED).map(print).collect();
    match errors.count() {
        0 => {}
        1 => shown.push("… and one more error".into()),
        more => shown.push(format!("… and {more} more errors")),
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::{MOST_PRINTED, Place, Report, render};
    use std::ops::Range;

    fn report<'a>(
        source: &'a str,
        span: Range<usize>,
        context: Option<Range<usize>>,
    ) -> Report<'a> {
        Report {
            place: Some(Place {
                source_name: "a.toml",
                source,
                primary: (span, "here"),
                context: context.map(|span| (span, "there")),
            }),
            ..Report::bare("it is wrong")
        }
    }

    #[test]
    fn a_list_ends_after_fifty_with_the_number_of_the_others() {
        let list = |count: usize| render((0..count).map(|i| Report::bare(format!("e{i}"))), false);
        let titles = |count: usize| list(count).matches("error: e").count();
        assert_eq!(titles(MOST_PRINTED), MOST_PRINTED);
        assert!(!list(MOST_PRINTED).contains("more"));
        assert_eq!(titles(MOST_PRINTED + 1), MOST_PRINTED);
        assert!(list(MOST_PRINTED + 1).ends_with("\n\n… and one more error"));
        assert!(list(10 * MOST_PRINTED).ends_with("\n\n… and 450 more errors"));
    }

    #[test]
    fn lines_keep_their_numbers_and_places_out_of_the_text_are_moved_into_it() {
        let source = "one\ntwo\nthré\nfour\n";
        let shown = render([report(source, 8..13, Some(0..3))], false);
        assert!(
            shown.contains("a.toml:3:1") && shown.contains("1 | one"),
            "{shown}"
        );
        assert!(shown.contains("3 | thré"), "{shown}");
        // The middle of é, the end of the text, and beyond it.
        for span in [12..12, 18..18, 19..19, 40..50] {
            let shown = render([report(source, span, None)], false);
            assert!(shown.contains("here"), "{shown}");
        }
        assert!(render([report("", 0..0, None)], false).contains("it is wrong"));
    }
}
