//! Numbers, texts and lists as TOML.

use crate::text::is_hidden;
use toml_writer::{ToTomlKey, ToTomlValue, TomlKeyBuilder, TomlStringBuilder};

/// The shortest digits that read back as the same number; zero has no sign.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return String::from("0.0");
    }
    format!("{value:?}")
}

/// A text in quotes, in one line, in which all is seen.
pub(super) fn text(value: &str) -> String {
    let quoted = TomlStringBuilder::new(value).as_basic().to_toml_value();
    let mut shown = String::with_capacity(quoted.len());
    for c in quoted.chars() {
        match is_hidden(c) {
            true => shown.push_str(&format!("\\U{:08X}", u32::from(c))),
            false => shown.push(c),
        }
    }
    shown
}

/// Numbers in brackets.
pub(super) fn list<'a>(values: impl IntoIterator<Item = &'a f64>) -> String {
    let numbers: Vec<String> = values.into_iter().map(|&value| number(value)).collect();
    format!("[{}]", numbers.join(", "))
}

/// A matrix as the list of its rows.
pub(super) fn rows<'a, R>(rows: impl IntoIterator<Item = R>) -> String
where
    R: IntoIterator<Item = &'a f64>,
{
    let rows: Vec<String> = rows.into_iter().map(list).collect();
    format!("[{}]", rows.join(", "))
}

/// A name as a key: bare where TOML allows.
pub(super) fn key(name: &str) -> String {
    TomlKeyBuilder::new(name).as_default().to_toml_key()
}

/// A table in one line.
pub(super) fn table(entries: &[(&str, String)]) -> String {
    let entries: Vec<String> = entries
        .iter()
        .map(|(name, value)| format!("{} = {value}", key(name)))
        .collect();
    format!("{{ {} }}", entries.join(", "))
}
