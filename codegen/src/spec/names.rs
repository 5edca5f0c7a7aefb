//! Which names a spec may give, and the nearest known name to an unknown one.

use super::ast::Name;
use super::code;
use crate::diagnostic::Diagnostic;
use proc_macro2::{Ident, Span, TokenTree};

/// Words that begin the statements of the language.
pub const STATEMENTS: &[&str] = &[
    "config", "relation", "home", "except", "require", "basis", "local", "velocity", "speeds",
    "bodies", "port", "pin", "let", "curve", "Phi", "H", "X", "A", "S_bar", "unproved",
];

/// Those of them that came after specs could use them as names, which they still can: no expression begins a statement.
const STILL_NAMES: &[&str] = &["bodies", "port", "pin", "curve"];

/// Words that belong to the language.
const WORDS: &[&str] = &[
    "hamel", "joint", "of", "in", "child", "parent", "phi", "pi", "I", "O",
];

/// Keys that a scene gives each joint besides its parameters; `type` is a keyword of Rust already.
const SCENE_KEYS: &[&str] = &["name"];

/// Most names that a suggestion lists.
const MOST_SUGGESTIONS: usize = 3;

/// Longest name that is compared with others, in bytes: the work grows with the square.
const LONGEST_COMPARED: usize = 64;

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

/// Whether a parameter may have the name, as far as scenes are concerned; else why not.
pub(super) fn check_parameter(name: &Name) -> Option<Diagnostic> {
    SCENE_KEYS
        .contains(&name.text.as_str())
        .then(|| reserved(name, "a key of each joint in a scene"))
}

/// Whether a joint may have the name; else why not. No expression speaks of joints, so that only Rust's words are taken.
pub(super) fn check_joint(name: &Name) -> Option<Diagnostic> {
    let taken = || is_rust_keyword(&name.text).then(|| reserved(name, "a keyword of Rust"));
    form_error(name, Form::Snake).or_else(taken)
}

/// Whether a body, a port or a pin may have the name; else why not. No expression speaks of them, and no name in Rust is made of theirs.
pub(super) fn check_unspoken(name: &Name) -> Option<Diagnostic> {
    form_error(name, Form::Snake)
}

fn form_error(name: &Name, form: Form) -> Option<Diagnostic> {
    let text = name.text.as_str();
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic());
    let lower = form == Form::Any || !text.contains(|c: char| c.is_ascii_uppercase());
    // Stored scalars are called after their factor, with an underscore between.
    let tidy = !(text.contains("__") || text.ends_with('_'));
    if starts && lower && tidy && text.chars().all(allowed) {
        return None;
    }
    let message = match form {
        Form::Snake => format!("`{text}` is not in snake case"),
        Form::Any if !tidy => format!("`{text}` has two underscores in a row, or one at its end"),
        Form::Any => format!("`{text}` is not a name of ASCII letters, digits and underscores"),
    };
    let error = Diagnostic::new(code::FORM, name.span.clone(), message)
        .label("this name is taken over into Rust");
    let suggestion = snake_case(text);
    let is_other = !suggestion.is_empty() && suggestion != text;
    Some(match (form == Form::Snake || !tidy) && is_other {
        true if is_rust_keyword(&suggestion) => error.help(format!(
            "choose another name: `{suggestion}` is a keyword of Rust"
        )),
        true => error.help(format!("write `{suggestion}`")),
        false => error.help("begin with an ASCII letter"),
    })
}

fn snake_case(text: &str) -> String {
    let mut words = String::new();
    for c in text
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || *c == '_')
    {
        let boundary = c.is_ascii_uppercase()
            && words.ends_with(|p: char| p.is_ascii_lowercase() || p.is_ascii_digit());
        let repeated = c == '_' && (words.is_empty() || words.ends_with('_'));
        if boundary {
            words.push('_');
        }
        if !repeated {
            words.push(c.to_ascii_lowercase());
        }
    }
    words
        .trim_end_matches('_')
        .trim_start_matches(|c: char| c.is_ascii_digit())
        .to_owned()
}

fn reserved_error(name: &Name, functions: &[&str]) -> Option<Diagnostic> {
    let text = name.text.as_str();
    let owner = if is_rust_keyword(text) {
        "a keyword of Rust"
    } else if STILL_NAMES.contains(&text) {
        return None;
    } else if STATEMENTS.contains(&text) || WORDS.contains(&text) {
        "a word of the language"
    } else if functions.contains(&text) {
        "a function of the language"
    } else {
        return None;
    };
    Some(reserved(name, owner))
}

fn reserved(name: &Name, owner: &str) -> Diagnostic {
    let message = format!("`{}` is {owner} and cannot be defined", name.text);
    Diagnostic::new(code::RESERVED, name.span.clone(), message)
        .label("reserved")
        .help("choose another name")
}

/// Keywords of all editions, reserved ones included; of a name whose form was checked.
fn is_rust_keyword(text: &str) -> bool {
    let ident = Ident::new(text, Span::call_site());
    text == "gen" || syn::parse2::<Ident>(TokenTree::from(ident).into()).is_err()
}

/// Advice that names the known names most similar to an unknown one, if any is similar enough to be meant.
pub(super) fn suggestion<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    if name.len() > LONGEST_COMPARED {
        return None;
    }
    let distance =
        |candidate: &str| strsim::damerau_levenshtein(&lookalike(name), &lookalike(candidate));
    let near = |distance: usize, candidate: &str| {
        distance <= 1.max(candidate.len() / 3) && distance < candidate.len()
    };
    let mut close: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST_COMPARED)
        .map(|candidate| (distance(candidate), candidate))
        .filter(|(distance, candidate)| near(*distance, candidate))
        .collect();
    close.sort_unstable();
    let best = close.first()?.0;
    let names = close
        .iter()
        .take_while(|(distance, _)| *distance == best)
        .take(MOST_SUGGESTIONS);
    let names: Vec<String> = names
        .map(|(_, candidate)| format!("`{candidate}`"))
        .collect();
    Some(format!("did you mean {}?", names.join(" or ")))
}

/// Case and the digit zero are easily mistaken.
fn lookalike(name: &str) -> String {
    name.to_ascii_lowercase().replace('0', "o")
}
