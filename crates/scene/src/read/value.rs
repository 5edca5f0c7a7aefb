//! One value of the tree, read as a number, a text, a vector, a matrix or a table.

use super::{Fields, LONGEST_NAME, Sink};
use crate::diagnostics::Diagnostic;
use crate::source::{Located, Span};
use crate::suggest::{nearest, one_of};
use crate::text::is_hidden;
use hamel_runtime::shown::Number;
use nalgebra::{DMatrix, Matrix3, SVector};
use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

/// A value and what messages call it.
#[derive(Clone, Debug)]
pub(crate) struct Value<'a> {
    owner: String,
    keys: String,
    /// Which part of the value under `keys` this is, such as "entry 2 of ", or nothing for all of it.
    part: String,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Value<'a> {
    /// The value under `keys` of the element that messages begin with, `owner`.
    pub(super) fn new(owner: String, keys: String, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self {
            owner,
            keys,
            part: String::new(),
            value,
        }
    }

    /// What messages call the value: "entry 2 of `com`".
    pub(crate) fn name(&self) -> String {
        format!("{}`{}`", self.part, self.keys)
    }

    /// Element and value, as messages begin: "body `x`: entry 2 of `com`".
    pub(crate) fn path(&self) -> String {
        format!("{}{}", self.owner, self.name())
    }

    /// Where the value stands.
    pub(crate) fn span(&self) -> Span {
        self.value.span()
    }

    /// A finite number, the f64 that is nearest to what is written.
    pub(crate) fn number(&self, sink: &mut Sink) -> Option<Located<f64>> {
        let number = match self.value.get_ref() {
            DeValue::Integer(integer) => integer_value(integer),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => return self.wrong_type("a number", sink),
        };
        match number {
            Some(number) if f64::is_finite(number) => Some(Located::new(number, self.span())),
            _ => {
                let digits = self.digits();
                let message = format!("{} is {digits}, not a finite number", self.path());
                sink.push(Diagnostic::new(self.span(), message));
                None
            }
        }
    }

    /// An integer number of at least 0.
    pub(crate) fn count(&self, sink: &mut Sink) -> Option<Located<u64>> {
        match self.value.get_ref() {
            DeValue::Integer(integer) => {
                match u64::from_str_radix(integer.as_str(), integer.radix()) {
                    Ok(count) => Some(Located::new(count, self.span())),
                    Err(_) => self.wrong_type("an integer of at least 0", sink),
                }
            }
            _ => self.wrong_type("an integer", sink),
        }
    }

    /// A text in one line, of [`LONGEST_NAME`] bytes at most.
    pub(crate) fn text(&self, sink: &mut Sink) -> Option<Located<String>> {
        let text = self.text_where(str::to_owned, is_hidden, sink)?;
        let length = text.value.len();
        if length <= LONGEST_NAME {
            return Some(text);
        }
        let path = self.path();
        let message = format!("{path} has {length} bytes, but may have {LONGEST_NAME} at most");
        sink.push(Diagnostic::new(text.span, message));
        None
    }

    /// A text that may have several lines, and tabs in them. Lines end in `\n`, whichever ends the file has.
    pub(crate) fn prose(&self, sink: &mut Sink) -> Option<Located<String>> {
        let refused = |c: char| c.is_control() && c != '\n' && c != '\t';
        self.text_where(|text| text.replace("\r\n", "\n"), refused, sink)
    }

    /// One of `names`.
    pub(crate) fn choice(&self, names: &[&'static str], sink: &mut Sink) -> Option<&'static str> {
        let text = self.text(sink)?;
        if let Some(known) = names.iter().find(|known| **known == text.value) {
            return Some(known);
        }
        let names = names.iter().copied();
        let known = one_of(names.clone());
        let message = format!("{} is {:?}, but must be {known}", self.path(), text.value);
        let error = Diagnostic::new(text.span, message);
        sink.push(match nearest(&text.value, names) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None => error,
        });
        None
    }

    /// Names and descriptions go to terminals and into tables, where characters that are not seen would do harm.
    fn text_where(
        &self,
        normal: impl Fn(&str) -> String,
        refused: impl Fn(char) -> bool,
        sink: &mut Sink,
    ) -> Option<Located<String>> {
        let DeValue::String(text) = self.value.get_ref() else {
            return self.wrong_type("a string", sink);
        };
        let text = normal(text);
        if let Some(character) = text.chars().find(|&c| refused(c)) {
            let path = self.path();
            let kind = match character.is_control() {
                true => "the control character",
                false => "a character that is not seen,",
            };
            let message = format!("{path} contains {kind} {character:?}");
            sink.push(Diagnostic::new(self.span(), message));
            return None;
        }
        Some(Located::new(text, self.span()))
    }

    /// A list of finite numbers, of any length.
    pub(crate) fn numbers(&self, sink: &mut Sink) -> Option<Located<Vec<f64>>> {
        let items = self.items("entry", "a list of numbers", sink)?;
        let numbers: Vec<_> = items.iter().map(|item| item.number(sink)).collect();
        let numbers: Option<Vec<f64>> = numbers.into_iter().map(|n| Some(n?.value)).collect();
        Some(Located::new(numbers?, self.span()))
    }

    /// `N` finite numbers.
    pub(crate) fn vector<const N: usize>(
        &self,
        sink: &mut Sink,
    ) -> Option<Located<SVector<f64, N>>> {
        let numbers = self.numbers(sink)?;
        self.check_length(numbers.value.len(), N, sink)?;
        Some(numbers.map(SVector::from_iterator))
    }

    /// Whether this is a list whose first item is a list.
    pub(crate) fn has_rows(&self) -> bool {
        let DeValue::Array(items) = self.value.get_ref() else {
            return false;
        };
        let first = items.iter().next();
        first.is_some_and(|item| matches!(item.get_ref(), DeValue::Array(_)))
    }

    /// Whether this is a list.
    pub(crate) fn is_list(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Array(_))
    }

    /// Whether it is a text.
    pub(crate) fn is_text(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::String(_))
    }

    /// Whether this is a table.
    pub(crate) fn is_table(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Table(_))
    }

    /// As many rows as columns of finite numbers, at least one.
    pub(crate) fn square_matrix(&self, sink: &mut Sink) -> Option<Located<DMatrix<f64>>> {
        let items = self.items("row", "rows of numbers", sink)?;
        let size = items.len();
        let rows: Vec<_> = items.iter().map(|row| row.numbers(sink)).collect();
        let mut entries = Vec::new();
        for (row, item) in rows.into_iter().zip(&items) {
            let row = row?.value;
            // Before there is room for all rows: a list of short ones may be long.
            item.check_length(row.len(), size, sink)?;
            entries.extend(row);
        }
        let matrix = DMatrix::from_row_slice(size, size, &entries);
        Some(Located::new(matrix, self.span()))
    }

    /// A finite number within a limit, which the message tells.
    pub(crate) fn number_within(
        &self,
        holds: impl Fn(f64) -> bool,
        limit: &str,
        sink: &mut Sink,
    ) -> Option<Located<f64>> {
        let number = self.number(sink)?;
        if holds(number.value) {
            return Some(number);
        }
        let (path, value) = (self.path(), number.value);
        let message = format!("{path} is {:?}, but must be {limit}", Number(value));
        sink.push(Diagnostic::new(number.span, message));
        None
    }

    /// A finite number of at least 0.
    pub(crate) fn not_negative(&self, sink: &mut Sink) -> Option<Located<f64>> {
        self.number_within(|number| number >= 0.0, "at least 0", sink)
    }

    /// Three rows of three finite numbers.
    pub(crate) fn matrix3(&self, sink: &mut Sink) -> Option<Located<Matrix3<f64>>> {
        let items = self.items("row", "three rows of three numbers", sink)?;
        self.check_length(items.len(), 3, sink)?;
        let rows: Vec<_> = items.iter().map(|row| row.vector::<3>(sink)).collect();
        let mut matrix = Matrix3::zeros();
        for (index, row) in rows.into_iter().enumerate() {
            matrix.set_row(index, &row?.value.transpose());
        }
        Some(Located::new(matrix, self.span()))
    }

    /// A table.
    pub(crate) fn table(&self, sink: &mut Sink) -> Option<Fields<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                let (owner, keys) = (self.owner.clone(), format!("{}.", self.keys));
                Some(Fields::nested(owner, keys, self.span(), table))
            }
            _ => self.wrong_type("a table", sink),
        }
    }

    /// A list of tables, each of which begins with its `[[header]]`.
    pub(crate) fn tables(&self, sink: &mut Sink) -> Option<Vec<(Span, &'a DeTable<'a>)>> {
        let items = match self.value.get_ref() {
            DeValue::Array(items) => items.iter(),
            _ => return self.not_tables(sink),
        };
        let tables = items.map(|item| match item.get_ref() {
            DeValue::Table(table) => Some((item.span(), table)),
            _ => None,
        });
        let tables: Option<Vec<_>> = tables.collect();
        tables.or_else(|| self.not_tables(sink))
    }

    fn not_tables<T>(&self, sink: &mut Sink) -> Option<T> {
        let message = format!("{} must be a list of tables", self.path());
        let help = format!("each of them begins with `[[{}]]`", self.keys);
        sink.push(Diagnostic::new(self.span(), message).help(help));
        None
    }

    /// The items of a list, which messages call `item` 1, 2, …
    pub(crate) fn items(
        &self,
        item: &str,
        expected: &str,
        sink: &mut Sink,
    ) -> Option<Vec<Value<'a>>> {
        let DeValue::Array(items) = self.value.get_ref() else {
            return self.wrong_type(expected, sink);
        };
        let items = items.iter().enumerate().map(|(index, value)| Self {
            part: format!("{item} {} of {}", index + 1, self.part),
            value,
            ..self.clone()
        });
        Some(items.collect())
    }

    fn check_length(&self, found: usize, size: usize, sink: &mut Sink) -> Option<()> {
        if found == size {
            return Some(());
        }
        let message = format!("{} has length {found}, not {size}", self.path());
        sink.push(Diagnostic::new(self.span(), message));
        None
    }

    fn wrong_type<T>(&self, expected: &str, sink: &mut Sink) -> Option<T> {
        let found = self.value.get_ref().type_str();
        let message = format!("{} must be {expected}", self.path());
        let article = if found.starts_with(['a', 'i']) {
            "an"
        } else {
            "a"
        };
        let error = Diagnostic::new(self.span(), message);
        sink.push(error.label(format!("this is {article} {found}")));
        None
    }

    /// The number as it is written.
    fn digits(&self) -> &str {
        match self.value.get_ref() {
            DeValue::Integer(integer) => integer.as_str(),
            DeValue::Float(float) => float.as_str(),
            _ => "",
        }
    }
}

/// Decimal digits go through the float parser, which rounds once; other radices are exact below 2¹²⁷.
fn integer_value(integer: &DeInteger<'_>) -> Option<f64> {
    if integer.radix() == 10 {
        return integer.as_str().parse().ok();
    }
    let exact = i128::from_str_radix(integer.as_str(), integer.radix()).ok()?;
    Some(exact as f64)
}
