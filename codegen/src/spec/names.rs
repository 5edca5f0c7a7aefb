//! Which names a spec may give, and the nearest known name to an unknown one.

use super::ast::Name;
use super::code;
use crate::diagnostic::Diagnostic;
use proc_macro2::{Ident, Span, TokenTree};

/// What may begin a statement.
pub(super) const STATEMENTS: &[&str] =
    &["config", "basis", "local", "velocity", "speeds", "let", "Phi", "H", "X", "A", "S_bar"];

/// Words that belong to the language.
const WORDS: &[&str] = &["hamel", "joint", "of", "in", "child", "parent", "phi", "pi", "I", "O"];

/// Joints whose type would carry the name of a type that generated code uses.
const TYPES: &[&str] = &[
    "clone", "copy", "debug", "default", "iterator", "joint", "none", "option", "pose", "result", "s_matrix", "s_vector", "scalar",
    "send", "sized", "some", "string", "structure", "structures", "sync", "vec", "velocity_frame",
];

/// How a name is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Lower case with underscores.
    Snake,
    /// Letters, digits and underscores; a factor may be called `Q`.
    Any,
}

/// Whether the name may be defined; else why not.
pub(super) fn check(name: &Name, form: Form, functions: &[&str]) -> Option<Diagnostic> {
    form_error(name, form).or_else(|| reserved_error(name, functions))
}

/// Whether a joint may have the name; else why not.
pub(super) fn check_joint(name: &Name, functions: &[&str]) -> Option<Diagnostic> {
    let taken = || {
        let message = format!("a joint cannot be called `{}`: generated code uses a type of that name", name.text);
        Diagnostic::new(code::RESERVED, name.span.clone(), message).label("taken").help(format!("call it `{}_joint`, say", name.text))
    };
    check(name, Form::Snake, functions).or_else(|| TYPES.contains(&name.text.as_str()).then(taken))
}

fn form_error(name: &Name, form: Form) -> Option<Diagnostic> {
    let text = name.text.as_str();
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic());
    let lower = form == Form::Any || !text.contains(|c: char| c.is_ascii_uppercase());
    let tidy = form == Form::Any || !(text.contains("__") || text.ends_with('_'));
    if starts && lower && tidy && text.chars().all(allowed) {
        return None;
    }
    let message = match form {
        Form::Snake => format!("`{text}` is not in snake case"),
        Form::Any => format!("`{text}` is not a name of ASCII letters, digits and underscores"),
    };
    let error = Diagnostic::new(code::FORM, name.span.clone(), message).label("this name is taken over into Rust");
    let suggestion = snake_case(text);
    Some(match form == Form::Snake && !suggestion.is_empty() && suggestion != text {
        true => error.help(format!("write `{suggestion}`")),
        false => error.help("begin with an ASCII letter"),
    })
}

fn snake_case(text: &str) -> String {
    let mut words = String::new();
    for c in text.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_') {
        let boundary = c.is_ascii_uppercase() && words.ends_with(|p: char| p.is_ascii_lowercase() || p.is_ascii_digit());
        let repeated = c == '_' && (words.is_empty() || words.ends_with('_'));
        if boundary {
            words.push('_');
        }
        if !repeated {
            words.push(c.to_ascii_lowercase());
        }
    }
    words.trim_end_matches('_').trim_start_matches(|c: char| c.is_ascii_digit()).to_owned()
}

fn reserved_error(name: &Name, functions: &[&str]) -> Option<Diagnostic> {
    let text = name.text.as_str();
    let owner = if is_rust_keyword(text) {
        "a keyword of Rust"
    } else if STATEMENTS.contains(&text) || WORDS.contains(&text) {
        "a word of the language"
    } else if functions.contains(&text) {
        "a function of the language"
    } else {
        return None;
    };
    let message = format!("`{text}` is {owner} and cannot be defined");
    Some(Diagnostic::new(code::RESERVED, name.span.clone(), message).label("reserved").help("choose another name"))
}

/// Keywords of all editions, reserved ones included; of a name whose form was checked.
fn is_rust_keyword(text: &str) -> bool {
    let ident = Ident::new(text, Span::call_site());
    text == "gen" || syn::parse2::<Ident>(TokenTree::from(ident).into()).is_err()
}

/// The most similar candidate, if any is similar enough to be meant.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_ascii_lowercase();
    let likeness = |candidate: &str| strsim::damerau_levenshtein(&lower, &candidate.to_ascii_lowercase());
    let close = |distance: usize, candidate: &str| distance <= 1.max(candidate.len() / 3) && distance < candidate.len();
    candidates
        .into_iter()
        .map(|candidate| (likeness(candidate), candidate))
        .filter(|(distance, candidate)| close(*distance, candidate))
        .min()
        .map(|(_, candidate)| candidate)
}
