//! The spec language: text of a `.joint` file to a [`JointSpec`].
//!
//! Stages: `scan` bounds what may reach the tokenizer, `tokens` walks syn's token cursors with exact byte ranges,
//! `syntax` builds the tree of `ast` and recovers at each `;`, `evaluate` turns expressions into symbols, `declare`
//! assembles and checks the joint, `units` what everything is measured in. All errors of a file come back together. The reference of the language is
//! `joint-specs/README.md`.

mod ast;
pub mod code;
pub(crate) mod comments;
mod declare;
mod evaluate;
mod limits;
mod names;
mod scan;
mod syntax;
mod tokens;
mod units;
mod value;

pub use evaluate::FUNCTIONS;
pub use names::STATEMENTS;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::model::JointSpec;
use std::path::Path;

/// An error on its way to the list of a file.
type Fallible<T> = Result<T, Box<Diagnostic>>;

/// Reads the spec in `source`; `file` is its name as errors show it.
///
/// # Errors
/// All errors of syntax, names, shapes and meaning, in the order of the text; see [`code`]. What only proofs and
/// derivations can show (conditions that are always or never met, ranks, Φ(Q, 0) = Q, AᵀS̄ = 0) is not checked here.
pub fn parse(source: &str, file: &str) -> Result<JointSpec, Diagnostics> {
    parse_in(source, file, None)
}

/// The same of a spec in a folder, in which files with knots of curves are looked for.
///
/// # Errors
/// As [`parse`], and files that cannot be read.
pub fn parse_in(source: &str, file: &str, folder: Option<&Path>) -> Result<JointSpec, Diagnostics> {
    let mut errors = vec![];
    let spec = scan::check(source, &mut errors)
        .then(|| syntax::file(source, &mut errors))
        .flatten()
        .and_then(|file| declare::joint((source, folder), &file, &mut errors));
    match spec {
        Some(spec) if errors.is_empty() => Ok(spec),
        _ => Err(report(source, file, errors)),
    }
}

fn report(source: &str, file: &str, mut errors: Vec<Diagnostic>) -> Diagnostics {
    errors.sort_by_key(|error| (error.span.start, error.span.end));
    errors.dedup();
    Diagnostics {
        file: file.to_owned(),
        source: source.to_owned(),
        errors,
    }
}
