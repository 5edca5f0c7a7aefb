//! Numbers in statements that may be quantities: a spec may write a length where it does not name one, as in `trans_x(r + 1)`, and expressions do not keep where a number stood.

use std::collections::BTreeSet;
use std::ops::Range;

/// The statements of a spec, in which numbers are looked for.
pub(super) struct Statements {
    /// Without comments, each with the place where it begins.
    all: Vec<(usize, String)>,
}

impl Statements {
    /// Those of a source.
    pub(super) fn new(source: &str) -> Self {
        let (mut all, mut start, mut depth) = (vec![], 0, 0_usize);
        let text = without_comments(source);
        for (at, sign) in text.match_indices(|c| ";{}()[]".contains(c)) {
            match sign {
                "(" | "[" => depth += 1,
                ")" | "]" => depth = depth.saturating_sub(1),
                // Rows of matrices end with a semicolon as well.
                _ if depth > 0 => {}
                _ => {
                    let statement = text[start..at].trim_start();
                    all.push((at - statement.len(), statement.to_owned()));
                    start = at + 1;
                }
            }
        }
        Self { all }
    }

    /// Whether the statement at this place, or a `let` that it names, has a number that may be a quantity.
    pub(super) fn has_quantity(&self, span: &Range<usize>) -> bool {
        let here =
            |(start, text): &&(usize, String)| *start < span.end && span.start < start + text.len();
        let mut open: Vec<&str> = self
            .all
            .iter()
            .filter(here)
            .map(|(_, text)| text.as_str())
            .collect();
        let mut seen = BTreeSet::new();
        while let Some(text) = open.pop() {
            // Entries 1 of matrices are numbers.
            let is_matrix = words(text)
                .next()
                .is_some_and(|word| ["X", "A", "S_bar"].contains(&word));
            if !is_matrix && has_quantity(text) || has_decimal(text) {
                return true;
            }
            for name in words(text).filter(|name| seen.insert(name.to_string())) {
                open.extend(self.definition(name));
            }
        }
        false
    }

    /// The `let` of that name.
    fn definition(&self, name: &str) -> Option<&str> {
        let texts = self.all.iter();
        let mut lets = texts.filter_map(|(_, text)| text.strip_prefix("let "));
        lets.find(|text| text.split('=').next().is_some_and(|own| own.trim() == name))
    }
}

/// The text with blanks in the place of comments.
fn without_comments(source: &str) -> String {
    let lines = source
        .split_inclusive('\n')
        .map(|line| match line.find("//") {
            Some(at) => {
                let blank: String = line[at..]
                    .chars()
                    .map(|c| {
                        if c == '\n' {
                            "\n".into()
                        } else {
                            " ".repeat(c.len_utf8())
                        }
                    })
                    .collect();
                format!("{}{blank}", &line[..at])
            }
            None => line.to_owned(),
        });
    lines.collect()
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !is_of_word(c))
        .filter(|word| word.starts_with(|c: char| c.is_alphabetic()))
}

/// Whether a number stands as a term or an entry, is a decimal, or is a factor 1. Integers that multiply or divide are numbers, as are exponents, orders and indices.
fn has_quantity(text: &str) -> bool {
    let mut opened: Vec<Opened> = vec![];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (at, length) = (text.len() - rest.len(), first.len_utf8());
        let before = text[..at].trim_end();
        match first {
            '(' | '[' => opened.push(Opened::after(before, first)),
            ')' | ']' => _ = opened.pop(),
            ',' => opened
                .iter_mut()
                .rev()
                .take(1)
                .for_each(|own| own.commas += 1),
            c if is_of_word(c) => {
                let end = rest
                    .find(|c: char| !is_of_word(c) && c != '.')
                    .unwrap_or(rest.len());
                let (word, after) = (&rest[..end], rest[end..].trim_start());
                let is_number =
                    c.is_ascii_digit() && opened.last().is_none_or(Opened::holds_quantities);
                if is_number && is_quantity(word, before, after) {
                    return true;
                }
                rest = &rest[end..];
                continue;
            }
            _ => {}
        }
        rest = &rest[length..];
    }
    false
}

/// Whether it has a number with a decimal point.
fn has_decimal(text: &str) -> bool {
    let mut places = text.match_indices('.');
    places.any(|(at, _)| text[at + 1..].starts_with(|c: char| c.is_ascii_digit()))
}

fn is_quantity(number: &str, before: &str, after: &str) -> bool {
    let is_zero = number.chars().all(|c| c == '0' || c == '.');
    let is_decimal = number.contains(['.', 'e']);
    let (follows, leads) = (before.ends_with(['*', '/']), after.starts_with(['*', '/']));
    let is_one = number == "1" && (before.ends_with('*') || after.starts_with('*'));
    !is_zero && (is_decimal || is_one || !(follows || leads))
}

/// A parenthesis or bracket that is not yet closed.
struct Opened {
    /// Whether it is an index, or the argument of a function that takes integers.
    is_index: bool,
    /// Whether its second argument is an exponent, or its third an order.
    orders_from: usize,
    commas: usize,
}

impl Opened {
    fn after(before: &str, sign: char) -> Self {
        let at = before
            .rfind(|c: char| !is_of_word(c))
            .map_or(0, |at| at + 1);
        let name = &before[at.min(before.len())..];
        let is_access =
            sign == '[' && before.ends_with(|c: char| is_of_word(c) || c == ')' || c == ']');
        Self {
            is_index: is_access || name == "I",
            orders_from: match name {
                "pow" => 1,
                "derivative" => 2,
                _ => usize::MAX,
            },
            commas: 0,
        }
    }

    fn holds_quantities(&self) -> bool {
        !self.is_index && self.commas < self.orders_from
    }
}

#[cfg(test)]
mod tests {
    use super::{Statements, has_quantity};

    #[test]
    fn terms_entries_and_decimals_may_be_quantities() {
        for text in [
            "r + 1",
            "[r, 1, 0]",
            "0.05 * q / r",
            "1 * a.c + rod * b.c",
            "-(0.3 / b) * q",
            "sqrt(a * (b + 2))",
        ] {
            assert!(has_quantity(text), "{text}");
        }
        for text in [
            "2 * l * a.c",
            "l / 2",
            "q * 3 / 2",
            "[r, 0, 0]",
            "pow(x, 2)",
            "R[3, 1] * l",
            "derivative(f, x, 2)",
            "I(3) * l",
            "a1 + b2",
            "l * (a.c - b.c)",
        ] {
            assert!(!has_quantity(text), "{text}");
        }
    }

    #[test]
    fn statements_are_read_with_the_lets_that_they_name() {
        let source = "joint x { let far = r + 1; // 1 + 1;\n let near = far * a.c; port p: rad = near; port q: rad = l; }";
        let statements = Statements::new(source);
        let at = |text: &str| {
            let start = source.find(text).expect("it stands there");
            start..start + text.len()
        };
        assert!(statements.has_quantity(&at("port p: rad = near")));
        assert!(!statements.has_quantity(&at("port q: rad = l")));
    }
}
