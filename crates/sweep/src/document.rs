//! The text of a scene, and the numbers in it that paths lead to.

use crate::path::{Path, shown};
use hamel::scene::suggest::nearest;
use std::fmt::Write;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Keys by which an element of a list is called, the first that it has.
const NAMES: [&str; 3] = ["name", "joint", "body"];

/// Most names that a message lists.
const LISTED: usize = 12;

/// Where a number stands in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// Which column has it.
    pub column: usize,
    /// Whether it is written without a point, as counts are.
    is_whole: bool,
    /// The keys that lead to it, elements of lists by their names where they have one.
    keys: Vec<String>,
}

/// A scene's text with places for the columns of a table.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    text: String,
    /// In the order of the text.
    places: Vec<Place>,
}

impl Document {
    /// Finds the numbers of `text`, a scene file without mistakes, that the columns name.
    ///
    /// # Errors
    /// Columns that name none, or one that another names; each in a line.
    pub fn new(text: &str, columns: &[impl AsRef<str>]) -> Result<Self, Vec<String>> {
        let (root, _) = DeTable::parse_recoverable(text);
        let mut places: Vec<Place> = Vec::new();
        let mut refused = Vec::new();
        for (column, name) in columns.iter().enumerate() {
            let name = name.as_ref();
            match place(root.get_ref(), name) {
                Ok(found) => {
                    let span = &found.span;
                    if let Some(other) = places.iter().find(|other| other.span == *span) {
                        let other = columns[other.column].as_ref();
                        refused.push(format!(
                            "columns `{}` and `{}` name the same number",
                            visible(other),
                            visible(name)
                        ));
                    }
                    places.push(Place { column, ..found });
                }
                Err(why) => refused.push(format!("column `{}`: {why}", visible(name))),
            }
        }
        places.sort_by_key(|place| place.span.start);
        match refused.is_empty() {
            true => Ok(Self {
                text: text.to_owned(),
                places,
            }),
            false => Err(refused),
        }
    }

    /// Whether a column changes the number under these keys.
    pub fn changes(&self, keys: &[&str]) -> bool {
        self.places.iter().any(|place| place.keys == keys)
    }

    /// Columns of numbers in the `initial` of bodies: the column, the body's name, and the keys from there.
    pub fn starts(&self) -> impl Iterator<Item = (usize, &str, Vec<&str>)> {
        self.places.iter().filter_map(|place| {
            let keys: Vec<&str> = place.keys.iter().map(String::as_str).collect();
            match keys.as_slice() {
                ["body", name, "initial", keys @ ..] => Some((place.column, *name, keys.to_vec())),
                _ => None,
            }
        })
    }

    /// The text as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text with these numbers, one for each column: what a row says instead of the file.
    pub fn with(&self, numbers: &[f64]) -> String {
        let mut text = String::with_capacity(self.text.len() + 8 * self.places.len());
        let mut end = 0;
        for place in &self.places {
            text.push_str(&self.text[end..place.span.start]);
            number(numbers[place.column], place.is_whole, &mut text);
            end = place.span.end;
        }
        text.push_str(&self.text[end..]);
        text
    }

    /// The column whose number, in the text of the row `numbers`, stands at the byte `at` or around it.
    pub fn column_at(&self, numbers: &[f64], at: &Range<usize>) -> Option<usize> {
        let mut shift = 0_isize;
        for place in &self.places {
            let mut own = String::new();
            number(numbers[place.column], place.is_whole, &mut own);
            let start = place.span.start.checked_add_signed(shift)?;
            if at.start < start + own.len() && start < at.end {
                return Some(place.column);
            }
            shift += own.len().cast_signed() - place.span.len().cast_signed();
        }
        None
    }
}

/// Appends the number with as many digits as tell it apart from all others.
fn number(number: f64, is_whole: bool, text: &mut String) {
    let is_count = is_whole && number.fract() == 0.0 && number.abs() < 2_f64.powi(53);
    // A string takes all that is written.
    let _ = match number {
        number if number.is_nan() => write!(text, "nan"),
        number if is_count => write!(text, "{number:.0}"),
        number => write!(text, "{number:?}"),
    };
}

/// The number that a column names; of which column it is, the caller knows.
fn place(root: &DeTable<'_>, column: &str) -> Result<Place, String> {
    let path = Path::parse(column)?;
    let mut at = Node::Table(root);
    let mut way = String::new();
    let mut keys = Vec::new();
    let mut found: Option<&Spanned<DeValue<'_>>> = None;
    for key in path.keys() {
        let next = at.child(key).map_err(|why| format!("{}{why}", of(&way)))?;
        shown(key, &mut way);
        let own = match at {
            Node::List(_) => name(next).unwrap_or(key),
            _ => key,
        };
        keys.push(own.to_owned());
        at = Node::of(next.get_ref());
        found = Some(next);
    }
    let found = found.ok_or("it is empty")?;
    match found.get_ref() {
        DeValue::Float(_) | DeValue::Integer(_) => Ok(Place {
            span: found.span(),
            column: 0,
            is_whole: found.get_ref().is_integer(),
            keys,
        }),
        DeValue::Array(items) if items.is_empty() => Err("it is an empty list".into()),
        DeValue::Array(items) => Err(format!(
            "it is a list, of which a column takes one number: `{way}.1` to `{way}.{}`",
            items.len()
        )),
        DeValue::Table(table) => Err(format!(
            "it is a table, of which a column takes one number: {}",
            listed(table.keys().map(|key| key.get_ref().as_ref()))
        )),
        other => Err(format!(
            "it is a {} in the scene, and a column takes a number",
            other.type_str()
        )),
    }
}

/// What keys are asked of.
enum Node<'a> {
    Table(&'a DeTable<'a>),
    List(&'a [Spanned<DeValue<'a>>]),
    Other(&'static str),
}

impl<'a> Node<'a> {
    fn of(value: &'a DeValue<'a>) -> Self {
        match value {
            DeValue::Table(table) => Self::Table(table),
            DeValue::Array(items) => Self::List(items),
            other => Self::Other(other.type_str()),
        }
    }

    fn child(&self, key: &str) -> Result<&'a Spanned<DeValue<'a>>, String> {
        match self {
            Self::Table(table) => {
                let known = || table.keys().map(|key| key.get_ref().as_ref());
                table.get(key).ok_or_else(|| unknown(key, known))
            }
            Self::List(items) => {
                let named = items.iter().find(|item| name(item) == Some(key));
                let number = key.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
                let found = named.or_else(|| items.get(number?));
                found.ok_or_else(|| match items.iter().any(|item| name(item).is_some()) {
                    true => unknown(key, || items.iter().filter_map(name)),
                    false => format!(
                        "there is no item `{}`: it is a list of {}, counted from 1",
                        visible(key),
                        items.len()
                    ),
                })
            }
            Self::Other(kind) => Err(format!("a {kind} has no `{}`", visible(key))),
        }
    }
}

/// What an element of a list is called.
fn name<'a>(item: &'a Spanned<DeValue<'a>>) -> Option<&'a str> {
    let table = item.get_ref().as_table()?;
    NAMES
        .iter()
        .find_map(|key| table.get(*key)?.get_ref().as_str())
}

fn unknown<'a, I: Iterator<Item = &'a str>>(key: &str, known: impl Fn() -> I) -> String {
    let key = visible(key);
    match nearest(&key, known()) {
        Some(near) => format!("the scene has no `{key}` there; did you mean `{near}`?"),
        None => format!(
            "the scene has no `{key}` there; it has {}. A column names a number that the scene file has",
            listed(known())
        ),
    }
}

fn of(way: &str) -> String {
    match way.is_empty() {
        true => String::new(),
        false => format!("in `{way}`: "),
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut names: Vec<String> = names.map(|name| format!("`{}`", visible(name))).collect();
    let others = names.len().saturating_sub(LISTED);
    names.truncate(LISTED);
    let list = names.join(", ");
    match others {
        0 => list,
        others => format!("{list} and {others} more"),
    }
}

fn visible(text: &str) -> String {
    hamel::scene::text::visible_line(text)
}
