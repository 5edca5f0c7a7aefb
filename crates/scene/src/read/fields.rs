//! The keys of one table: asked for by name, and whatever nobody asked for is an error.

use super::{Sink, Value};
use crate::diagnostics::Diagnostic;
use crate::source::{Located, Span};
use crate::suggest::{all_of, nearest, one_of};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table being read.
pub(crate) struct Fields<'a> {
    /// Beginning of messages: `body `x`: `, or nothing for the scene itself.
    owner: String,
    /// Keys that lead from the owner to this table: `initial.twist.`, or nothing.
    keys: String,
    span: Span,
    table: &'a DeTable<'a>,
    known: Vec<&'static str>,
}

impl<'a> Fields<'a> {
    /// The table of the element that messages begin with, `owner`: such as "body 1: ", or nothing for the scene.
    pub(crate) fn new(owner: String, span: Span, table: &'a DeTable<'a>) -> Self {
        Self::nested(owner, String::new(), span, table)
    }

    /// A table inside an element, reached by `keys`.
    pub(super) fn nested(owner: String, keys: String, span: Span, table: &'a DeTable<'a>) -> Self {
        Self {
            owner,
            keys,
            span,
            table,
            known: Vec::new(),
        }
    }

    /// Where the table stands.
    pub(crate) fn span(&self) -> Span {
        self.span.clone()
    }

    /// Beginning of messages about the element.
    pub(crate) fn owner(&self) -> &str {
        &self.owner
    }

    /// Changes the beginning of messages about the element, once its name is known.
    pub(crate) fn set_owner(&mut self, owner: String) {
        self.owner = owner;
    }

    /// The value of `key`, if present.
    pub(crate) fn optional(&mut self, key: &'static str) -> Option<Value<'a>> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        let value = self.table.get(key)?;
        Some(self.value(key, value))
    }

    /// The value of `key`; its absence is an error.
    pub(crate) fn required(&mut self, key: &'static str, sink: &mut Sink) -> Option<Value<'a>> {
        let value = self.optional(key);
        if value.is_none() {
            sink.push(self.missing(&[key]));
        }
        value
    }

    /// The one of `keys` that is present, with its index; two of them are an error, none is `None`.
    pub(crate) fn at_most_one(
        &mut self,
        keys: &[&'static str],
        sink: &mut Sink,
    ) -> Option<(usize, Value<'a>)> {
        let present: Vec<_> = keys
            .iter()
            .enumerate()
            .filter_map(|(index, key)| Some((index, self.optional(key)?)))
            .collect();
        if let [(_, first), (_, second), ..] = present.as_slice() {
            let (owner, a, b) = (&self.owner, first.name(), second.name());
            let message = format!("{owner}{a} and {b} exclude each other");
            let error = Diagnostic::new(second.span(), message).label("give only one of the two");
            sink.push(error.context(first.span(), "the other one"));
        }
        present.into_iter().next()
    }

    /// As [`Fields::at_most_one`], and none is an error.
    pub(crate) fn exactly_one(
        &mut self,
        keys: &[&'static str],
        sink: &mut Sink,
    ) -> Option<(usize, Value<'a>)> {
        let found = self.at_most_one(keys, sink);
        if found.is_none() {
            sink.push(self.missing(keys));
        }
        found
    }

    /// Notes every key that nobody asked for.
    pub(crate) fn finish(self, sink: &mut Sink) {
        self.finish_but(&[], sink);
    }

    /// The same; of keys that belong elsewhere, with the advice what to do instead.
    pub(crate) fn finish_but(self, elsewhere: &[(&str, &str, &str)], sink: &mut Sink) {
        for (key, value) in self.unclaimed() {
            let mut others = elsewhere.iter();
            if let Some((_, why, advice)) = others.find(|(other, ..)| *other == key.value) {
                let message = format!("{}{}: {why}", self.owner, value.name());
                sink.push(Diagnostic::new(key.span, message).help(*advice));
                continue;
            }
            let message = format!("{}unknown key {}", self.owner, value.name());
            let error = Diagnostic::new(key.span, message);
            let known = self.known.iter().copied();
            sink.push(match nearest(&key.value, known.clone()) {
                Some(near) => error.label(format!("did you mean `{near}`?")),
                None => error.help(format!("known keys are {}", all_of(known))),
            });
        }
    }

    /// The keys that nobody asked for, with their values, in the order of the text.
    pub(crate) fn unclaimed(&self) -> Vec<(Located<String>, Value<'a>)> {
        let entries = self.table.iter();
        let unclaimed = entries.filter(|(key, _)| !self.known.contains(&key.get_ref().as_ref()));
        let mut unclaimed: Vec<_> = unclaimed
            .map(|(key, value)| {
                let name = key.get_ref().clone().into_owned();
                let value = self.value(&name, value);
                (Located::new(name, key.span()), value)
            })
            .collect();
        unclaimed.sort_by_key(|(key, _)| key.span.start);
        unclaimed
    }

    fn value(&self, key: &str, value: &'a Spanned<DeValue<'a>>) -> Value<'a> {
        Value::new(self.owner.clone(), format!("{}{key}", self.keys), value)
    }

    fn missing(&self, keys: &[&str]) -> Diagnostic {
        let names: Vec<String> = keys
            .iter()
            .map(|key| format!("{}{key}", self.keys))
            .collect();
        let names = one_of(names.iter().map(String::as_str));
        Diagnostic::new(self.span(), format!("{}{names} is missing", self.owner))
    }
}
