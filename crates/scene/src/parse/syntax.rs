//! Errors of the TOML parser, freed of those that only follow from others.

use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use toml::de::Error;

/// Notes the first syntax error of each line. After a bracket that nobody closes, which swallows the rest of the file, only
/// the first of all.
pub(super) fn report(text: &str, errors: &[Error], sink: &mut Sink) {
    let end = text.len();
    let place = |error: &Error| error.span().map_or(end, |span| span.start);
    let mut errors: Vec<&Error> = errors.iter().collect();
    errors.sort_by_key(|error| place(error));
    let unclosed = errors.iter().find(|error| {
        let message = error.message();
        message.starts_with("unclosed array") || message.starts_with("unclosed inline table")
    });
    let unclosed = unclosed.map(|error| {
        error
            .message()
            .split(',')
            .next()
            .unwrap_or_default()
            .to_owned()
    });
    if unclosed.is_some() {
        errors.truncate(1);
    }
    let mut reported_to = 0;
    for error in errors {
        let start = place(error);
        if start < reported_to {
            continue;
        }
        reported_to = text[start.min(end)..]
            .find('\n')
            .map_or(end, |length| start + length);
        let message = format!("not valid TOML: {}", error.message());
        let error = Diagnostic::new(error.span().unwrap_or(end..end), message);
        sink.push(match &unclosed {
            Some(what) => error.help(format!(
                "{what}: a bracket before this place has no partner"
            )),
            None => error,
        });
    }
}
