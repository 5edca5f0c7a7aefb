//! Typed access to the TOML tree: every reader notes its errors in a [`Sink`] and goes on.

mod fields;
mod value;

pub(crate) use fields::Fields;
pub(crate) use value::Value;

use crate::diagnostics::{Diagnostic, Diagnostics};

/// Collects the errors of one source text.
#[derive(Debug, Default)]
pub(crate) struct Sink {
    errors: Vec<Diagnostic>,
}

impl Sink {
    /// Notes an error.
    pub(crate) fn push(&mut self, error: Diagnostic) {
        self.errors.push(error);
    }

    /// Number of errors so far.
    pub(crate) fn len(&self) -> usize {
        self.errors.len()
    }

    /// The errors noted, about the text `source`; `otherwise` is said where there are none.
    pub(crate) fn refuse(
        mut self,
        source_name: &str,
        source: &str,
        otherwise: &str,
    ) -> Diagnostics {
        if self.errors.is_empty() {
            self.push(Diagnostic::without_place(otherwise));
        }
        Diagnostics::new(source_name, source, self.errors)
    }
}
