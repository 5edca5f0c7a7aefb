//! What is fuzzed: the reader with its checks, and the whole pipeline with its output.

use hamel_codegen::diagnostic::Diagnostics;
use hamel_codegen::emit;
use hamel_diagnostics::Report;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What became of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was accepted.
    Accepted,
    /// It was refused, with errors that could be shown.
    Refused,
    /// Something that must never happen.
    Broken(String),
}

impl Outcome {
    /// Nothing, where the reader did what it should.
    ///
    /// # Panics
    /// Where something broke: so a fuzzer learns of it.
    pub fn sound(&self) {
        if let Self::Broken(why) = self {
            panic!("{why}");
        }
    }
}

/// Reads and checks a spec; shows what is wrong with it.
pub fn check(text: &str) -> Outcome {
    guarded(|| match hamel_codegen::spec::parse(text, "input.joint") {
        Ok(_) => Outcome::Accepted,
        Err(errors) => refused(text, &errors),
    })
}

/// Derives a spec, and writes its Rust and its page.
pub fn pipeline(text: &str) -> Outcome {
    guarded(|| {
        // A file is named after its joint.
        let file = match hamel_codegen::spec::parse(text, "input.joint") {
            Ok(spec) => format!("{}.joint", spec.name.value),
            Err(errors) => return refused(text, &errors),
        };
        let joint = match hamel_codegen::derive(text, &file) {
            Ok(joint) => joint,
            Err(errors) => return refused(text, &errors),
        };
        let written = emit::rust::file(&joint, &file, &emit::rust::Runtime::default()).map(|_| ());
        let page = emit::page(&joint, &file, &emit::Accuracy::default()).map(|_| ());
        match (written, page) {
            (Ok(()), Ok(())) => Outcome::Accepted,
            (Err(error), _) => Outcome::Broken(format!("no Rust: {error}")),
            (_, Err(error)) => Outcome::Broken(format!("no page: {error}")),
        }
    })
}

fn refused(text: &str, errors: &Diagnostics) -> Outcome {
    let misplaced = errors
        .errors
        .iter()
        .find(|error| text.get(error.span.clone()).is_none());
    match (errors.errors.is_empty(), misplaced) {
        (true, _) => Outcome::Broken("refused without an error".into()),
        (_, Some(error)) => Outcome::Broken(format!("an error outside the text: {error:?}")),
        _ => shown(errors.reports()),
    }
}

/// Prints what is wrong with an input: the first two errors, which would take most of the time of a run if they were all printed.
pub(super) fn shown<'a>(reports: impl Iterator<Item = Report<'a>>) -> Outcome {
    match hamel_diagnostics::render(reports.take(2), false).trim() {
        "" => Outcome::Broken("errors that show nothing".into()),
        _ => Outcome::Refused,
    }
}

/// The outcome of `work`; a panic breaks the input.
pub(super) fn guarded(work: impl FnOnce() -> Outcome) -> Outcome {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Outcome::Broken(format!("panic: {}", text.unwrap_or("of no text")))
    })
}
