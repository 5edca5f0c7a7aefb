//! Typed access to the TOML tree: every reader notes its errors in a [`Sink`] and goes on.

mod fields;
mod value;

pub(crate) use fields::Fields;
pub(crate) use value::Value;

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::suggest::{Suggestions, one_of};

/// Most bytes of a name: messages about the parts of an element begin with its name, and there may be as many as bytes in a file.
pub(crate) const LONGEST_NAME: usize = 1000;

/// Collects the errors of one source text.
#[derive(Debug, Default)]
pub(crate) struct Sink {
    errors: Vec<Diagnostic>,
    suggestions: Suggestions,
}

impl Sink {
    /// Notes an error.
    pub(crate) fn push(&mut self, error: Diagnostic) {
        self.errors.push(error);
    }

    /// Notes the `error` that `name` is none of the names `known` of the file, with the one that it most likely means; else with what `choice`
    /// begins, such as "a body is".
    pub(crate) fn unknown(&mut self, error: Diagnostic, name: &str, known: &[&str], choice: &str) {
        let near = self.suggestions.nearest(name, known);
        self.push(match near {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None => error.help(format!("{choice} {}", one_of(known.iter().copied()))),
        });
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
