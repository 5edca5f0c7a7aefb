//! Where something stands in a source text.

use std::ops::Range;

/// Byte range in the source text.
pub type Span = Range<usize>;

/// A value and the place that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Its byte range in the source text.
    pub span: Span,
}

impl<T> Located<T> {
    /// `value`, read from `span`.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }

    /// The same place, another value.
    pub fn map<U>(self, map: impl FnOnce(T) -> U) -> Located<U> {
        Located::new(map(self.value), self.span)
    }
}
