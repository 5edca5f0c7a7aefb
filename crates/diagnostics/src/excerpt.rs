//! The lines of a text around an error: what shows them need not read the others.

use std::ops::Range;

/// Whole lines of a text.
pub(super) struct Excerpt<'a> {
    /// The lines.
    pub(super) text: &'a str,
    /// Number of the first, from 1.
    pub(super) line: usize,
    /// Bytes of the text before them.
    before: usize,
}

impl<'a> Excerpt<'a> {
    /// The lines from the first to the last that `spans` touch.
    pub(super) fn around<'s>(
        source: &'a str,
        spans: impl Iterator<Item = &'s Range<usize>> + Clone,
    ) -> Self {
        let least = spans.clone().map(|span| span.start).min().unwrap_or(0);
        let largest = spans.map(|span| span.end.max(span.start)).max();
        let (least, largest) = (least.min(source.len()), largest.unwrap_or(0));
        let bytes = source.as_bytes();
        // What stands behind the last line is shown at its end.
        let inside = least.min(source.trim_end_matches('\n').len());
        let start = bytes[..inside].iter().rposition(|&b| b == b'\n');
        let start = start.map_or(0, |newline| newline + 1);
        let largest = largest.min(source.len());
        let end = bytes[largest..].iter().position(|&b| b == b'\n');
        let end = end.map_or(source.len(), |length| largest + length + 1);
        Self {
            text: &source[start..end],
            line: bytes[..start].iter().filter(|&&b| b == b'\n').count() + 1,
            before: start,
        }
    }

    /// `span` of the whole text as one of the excerpt, on boundaries of characters.
    pub(super) fn within(&self, span: &Range<usize>) -> Range<usize> {
        let boundary = |at: usize| {
            self.text
                .floor_char_boundary(at.saturating_sub(self.before))
        };
        let start = boundary(span.start);
        start..boundary(span.end).max(start)
    }
}
