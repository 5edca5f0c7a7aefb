//! Names for the values of formulas: telling ones, none used twice, none that Rust reserves.

use super::Node;
use super::layered::Layered;
use crate::expr::{Function, Rational};
use num_traits::{One, ToPrimitive};

/// Longest name made from a formula; longer formulas are named after the first symbols in them.
const LONGEST: usize = 36;

/// The names that are taken.
#[derive(Clone, Debug, Default)]
pub struct NameSet {
    taken: Layered<String, ()>,
    /// For each wish the identifier that it becomes, and the number that this may have next: names in long files are wished for thousands of times.
    next: Layered<String, (String, usize)>,
}

impl NameSet {
    /// Whether nothing has this name yet.
    pub fn is_free(&self, name: &str) -> bool {
        !self.taken.contains(name)
    }

    /// Takes all of these names.
    pub(super) fn reserve(&mut self, names: impl IntoIterator<Item = String>) {
        for name in names {
            self.taken.insert(name, ());
        }
    }

    /// Makes later copies cheap: they share the names that are taken now.
    pub(super) fn share(&mut self) {
        self.taken.share();
        self.next.share();
    }

    /// Takes a name: the one wished for, or that one with a number where it is taken or is a keyword.
    pub fn claim(&mut self, wish: &str) -> String {
        let (identifier, mut number) = match self.next.get(wish) {
            Some(known) => known.clone(),
            None => (identifier(wish), 1),
        };
        let name = loop {
            let name = match number {
                1 => identifier.clone(),
                _ => format!("{identifier}_{number}"),
            };
            number += 1;
            if self.is_free(&name) {
                break name;
            }
        };
        self.next.insert(wish.to_owned(), (identifier, number));
        self.taken.insert(name.clone(), ());
        name
    }
}

fn identifier(wish: &str) -> String {
    // By far most wishes are seen to be names at a glance: no keyword has an underscore.
    let is_plain = wish.contains('_')
        && wish.starts_with(|c: char| c.is_ascii_lowercase())
        && wish.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if is_plain {
        return wish.to_owned();
    }
    match syn::parse_str::<syn::Ident>(wish) {
        Ok(_) => wish.to_owned(),
        Err(_) => format!("{wish}_value"),
    }
}

const WORDS: [&str; 13] = [
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve",
];

pub(super) fn number_words() -> impl Iterator<Item = String> {
    WORDS
        .iter()
        .chain(&["half", "third", "quarter"])
        .map(|word| (*word).to_owned())
}

/// Whether the name is reserved for a number.
pub fn is_number_word(name: &str) -> bool {
    number_words().any(|word| word == name)
}

/// The name of a positive constant: `two`, `half`, `three_quarters`, `number_27`, `number_3e8`, `number_0_0177`, `ratio_3_7`.
///
/// A number of more than 17 digits is a `constant`: its value stands beside the name.
pub fn number_name(value: &Rational) -> String {
    let word = |n: &num_bigint::BigInt| {
        n.to_usize()
            .and_then(|n| WORDS.get(n))
            .map(|word| (*word).to_owned())
    };
    let (above, below) = (value.numer(), value.denom());
    if below.is_one() {
        return word(&above).unwrap_or_else(|| written("number", &[digits(&above.to_string())]));
    }
    let part = match below.to_u8() {
        Some(2) => Some("half"),
        Some(3) => Some("third"),
        Some(4) => Some("quarter"),
        _ => None,
    };
    match (part, word(&above), above.is_one()) {
        (Some(part), _, true) => part.to_owned(),
        (Some("half"), Some(count), false) => format!("{count}_halves"),
        (Some(part), Some(count), false) => format!("{count}_{part}s"),
        _ => match value.decimal() {
            Some(decimal) => written("number", &[decimal.replace('.', "_")]),
            None => written("ratio", &[above, below].map(|n| digits(&n.to_string()))),
        },
    }
}

/// Most digits of a number that its name spells.
const MOST_DIGITS: usize = 17;

fn written(prefix: &str, numbers: &[String]) -> String {
    match numbers.iter().all(|number| number.len() <= MOST_DIGITS) {
        true => format!("{prefix}_{}", numbers.join("_")),
        false => "constant".to_owned(),
    }
}

/// The digits of a whole number, four zeros or more at its end as a power of ten.
fn digits(number: &str) -> String {
    let leading = number.trim_end_matches('0');
    match number.len() - leading.len() {
        0..=3 => number.to_owned(),
        zeros => format!("{leading}e{zeros}"),
    }
}

/// A name for the value of a formula, made from what it is: `x_squared`, `q12_minus_q21`, `lead_over_pi`.
pub fn describe(node: &Node) -> String {
    let full = describe_fully(node);
    if full.len() <= LONGEST {
        return full;
    }
    let kind = match node {
        Node::Sum(_) => "sum",
        Node::Product(_) => "product",
        Node::Quotient(..) => "quotient",
        _ => "value",
    };
    let mut name = format!("{kind}_of");
    for symbol in distinct_symbols(node) {
        if name.len() + symbol.len() < LONGEST {
            name += &format!("_{symbol}");
        }
    }
    name
}

/// The names of the symbols in a formula, each once, in reading order.
fn distinct_symbols(node: &Node) -> Vec<String> {
    let mut symbols: Vec<String> = vec![];
    node.visit(&mut |part| {
        if let Node::Symbol(symbol) = part
            && !symbols.iter().any(|known| **known == *symbol.name())
        {
            symbols.push(symbol.name().to_string());
        }
    });
    symbols
}

fn describe_fully(node: &Node) -> String {
    match node {
        Node::Number(value) => number_name(value),
        Node::Symbol(symbol) => symbol.name().to_string(),
        Node::Pi => "pi".into(),
        Node::Sum(terms) => {
            let mut text = String::new();
            for (i, (minus, term)) in terms.iter().enumerate() {
                text += if i == 0 {
                    ""
                } else if *minus {
                    "_minus_"
                } else {
                    "_plus_"
                };
                text += &describe_fully(term);
            }
            text
        }
        Node::Product(factors) => describe_product(factors),
        Node::Quotient(above, below) if above.is_one() => {
            format!("inverse_{}", describe_fully(below))
        }
        Node::Quotient(above, below) => {
            format!("{}_over_{}", describe_fully(above), describe_fully(below))
        }
        Node::Negative(inner) => format!("minus_{}", describe_fully(inner)),
        Node::Call(function, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(describe_fully).collect();
            format!("{}_{}", function_name(*function), arguments.join("_"))
        }
    }
}

fn describe_product(factors: &[Node]) -> String {
    let mut words = vec![];
    let mut rest = factors;
    while let Some(first) = rest.first() {
        let copies = rest.iter().take_while(|factor| *factor == first).count();
        let word = describe_fully(first);
        words.push(match copies {
            1 => word,
            2 => format!("{word}_squared"),
            3 => format!("{word}_cubed"),
            _ => format!("{word}_power_{copies}"),
        });
        rest = &rest[copies..];
    }
    words.join("_")
}

fn function_name(function: Function) -> String {
    match function {
        Function::Pi => "pi".into(),
        Function::Cos => "cos".into(),
        Function::Sin => "sin".into(),
        Function::Exp => "exp".into(),
        Function::Sinh => "sinh".into(),
        Function::Cosh => "cosh".into(),
        Function::Sech => "sech".into(),
        Function::Tanh => "tanh".into(),
        Function::LnCosh => "ln_cosh".into(),
        Function::Ln => "ln".into(),
        Function::Ln1p => "ln_1p".into(),
        Function::Larger => "larger".into(),
        Function::Atan2 => "angle".into(),
        Function::Sqrt => "root".into(),
        Function::Stumpff(order) => format!("stumpff{order}"),
        Function::DexpInverse(order) => format!("dexp_inverse{order}"),
        Function::Curve(curve, 0) => curve.name().into(),
        Function::Curve(curve, 1) => format!("d_{}", curve.name()),
        Function::Curve(curve, order) => format!("d{order}_{}", curve.name()),
        Function::Recip => "inverse".into(),
        Function::Group => "sum".into(),
    }
}
