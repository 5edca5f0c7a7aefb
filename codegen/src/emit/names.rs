//! Names in emitted code: telling ones for shared terms, none used twice, none that Rust or the emitted code reserves.

use super::formula::Node;
use crate::derived::Derived;
use crate::expr::{Function, Rational, Role, Symbol};
use num_traits::{One, ToPrimitive};
use std::collections::{BTreeMap, BTreeSet};

/// Longest name made from a formula; longer formulas are named after the first symbols in them.
const LONGEST: usize = 36;

/// Names that every kernel and `build` may use: their arguments, the constants, and what is imported.
const RESERVED: &[&str] = &[
    "q",
    "phi",
    "v",
    "p",
    "rate",
    "target",
    "speeds",
    "h",
    "zero",
    "one",
    "pi",
    "relations",
    "relation",
    "values",
    "sum",
    "rotation",
    "nearest_rotation",
    "start",
    "moved",
    "tangent",
    "tangent_there",
    "from_rows",
    "rows_at",
    "dot",
    "part",
    "put",
    "put_block",
    "stacked",
    "differential",
    "local_rate",
    "nearest",
    "self",
    "core",
    "hamel",
    "std",
    "alloc",
];

/// Names of types in emitted files, which a joint must not take.
const RESERVED_TYPES: &[&str] = &[
    "Arc",
    "AnyJoint",
    "Joint",
    "JointEntry",
    "Limit",
    "Patterns",
    "Pose",
    "ParameterError",
    "ParameterInfo",
    "Scalar",
    "SMatrix",
    "SVector",
    "Self",
    "Structure",
    "Structures",
    "VelocityFrame",
    "T",
    "Clone",
    "Copy",
    "Debug",
    "PartialEq",
    "Option",
    "Some",
    "None",
    "Result",
    "Ok",
    "Err",
    "Iterator",
];

/// The names that are taken.
#[derive(Clone, Debug, Default)]
pub struct NameSet {
    taken: BTreeSet<String>,
    /// The number that a name may have next: names in long files are wished for thousands of times.
    next: BTreeMap<String, usize>,
}

impl NameSet {
    /// Whether nothing has this name yet.
    pub fn is_free(&self, name: &str) -> bool {
        !self.taken.contains(name)
    }

    /// Takes a name: the one wished for, or that one with a number where it is taken or is a keyword.
    pub fn claim(&mut self, wish: &str) -> String {
        if let Some(next) = self.next.get_mut(wish) {
            loop {
                let name = format!("{}_{next}", identifier(wish));
                *next += 1;
                if self.taken.insert(name.clone()) {
                    return name;
                }
            }
        }
        self.next.insert(wish.to_owned(), 2);
        let name = identifier(wish);
        match self.taken.insert(name.clone()) {
            true => name,
            false => self.claim(wish),
        }
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

/// What is added to the name of a symbol whose own is taken.
fn role_name(role: Role) -> &'static str {
    match role {
        Role::Parameter | Role::Constant => "parameter",
        Role::Coordinate => "coordinate",
        Role::Target => "target",
        Role::Local => "local",
        Role::Velocity => "velocity",
        Role::Speed => "speed",
        Role::Momentum => "momentum",
        Role::Wrench => "wrench",
        Role::Inertia => "inertia",
        Role::Intermediate => "value",
    }
}

/// The identifiers of a joint's symbols in every kernel.
#[derive(Clone, Debug)]
pub struct Names {
    by_symbol: BTreeMap<Symbol, String>,
    taken: NameSet,
}

impl Names {
    /// Names for the parameters and for the arguments of all kernels.
    pub fn new(derived: &Derived) -> Self {
        let mut names = Self::reserved();
        let arguments = &derived.arguments;
        names.claim_coordinates(&arguments.configuration);
        let parameters = derived
            .spec
            .parameters
            .iter()
            .map(|parameter| &parameter.symbol);
        let others = [
            &arguments.target,
            &arguments.local,
            &arguments.velocity,
            &arguments.speeds,
            &arguments.momentum,
            &arguments.wrench,
        ];
        parameters
            .chain(others.into_iter().flatten())
            .for_each(|symbol| names.claim(symbol));
        names
    }

    /// Names of the parameters in `build`, where nothing else has a name but its argument and the constants.
    pub fn of_parameters(derived: &Derived) -> Self {
        let mut names = Self::reserved();
        let parameters = derived.spec.parameters.iter();
        parameters.for_each(|parameter| names.claim(&parameter.symbol));
        names
    }

    fn reserved() -> Self {
        let mut taken = NameSet::default();
        let reserved = RESERVED.iter().map(|name| (*name).to_owned());
        taken.taken.extend(reserved.chain(number_words()));
        Self {
            by_symbol: BTreeMap::new(),
            taken,
        }
    }

    /// A single coordinate called `q` may shadow the argument that it is read from.
    fn claim_coordinates(&mut self, coordinates: &[Symbol]) {
        for symbol in coordinates {
            match symbol.name.as_ref() == "q" {
                true => _ = self.by_symbol.insert(symbol.clone(), "q".to_owned()),
                false => self.claim(symbol),
            }
        }
    }

    /// Gives a symbol its name.
    pub fn claim(&mut self, symbol: &Symbol) {
        if !self.by_symbol.contains_key(symbol) {
            let name = match self.taken.is_free(&symbol.name) {
                true => self.taken.claim(&symbol.name),
                false => self
                    .taken
                    .claim(&format!("{}_{}", symbol.name, role_name(symbol.role))),
            };
            self.by_symbol.insert(symbol.clone(), name);
        }
    }

    /// Gives a symbol a name that is already its own.
    pub fn adopt(&mut self, symbol: &Symbol) {
        self.by_symbol
            .entry(symbol.clone())
            .or_insert_with(|| symbol.name.to_string());
    }

    /// The name of a symbol.
    pub fn get<'a>(&'a self, symbol: &'a Symbol) -> &'a str {
        self.by_symbol
            .get(symbol)
            .map_or(&symbol.name, String::as_str)
    }

    /// All names that are taken.
    pub fn taken(&self) -> &NameSet {
        &self.taken
    }
}

/// The name of a joint's type: `planar_euclidean` is `PlanarEuclidean`.
pub fn type_name(joint: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().map(|letter| letter.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    let name: String = joint.split('_').map(capital).collect();
    match RESERVED_TYPES.contains(&name.as_str()) {
        true => format!("{name}Joint"),
        false => name,
    }
}

const WORDS: [&str; 13] = [
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve",
];

fn number_words() -> impl Iterator<Item = String> {
    WORDS
        .iter()
        .chain(&["half", "third", "quarter"])
        .map(|word| (*word).to_owned())
}

/// Whether the name is reserved for a number.
pub fn is_number_word(name: &str) -> bool {
    number_words().any(|word| word == name)
}

/// The name of a positive constant: `two`, `half`, `three_quarters`, `number_27`, `ratio_3_7`.
pub fn number_name(value: &Rational) -> String {
    let word = |n: &num_bigint::BigInt| {
        n.to_usize()
            .and_then(|n| WORDS.get(n))
            .map(|word| (*word).to_owned())
    };
    let denominator = value.denom();
    if denominator.is_one() {
        return word(&value.numer())
            .unwrap_or_else(|| short("number", &[value.numer().to_string()]));
    }
    let part = match denominator.to_u8() {
        Some(2) => Some("half"),
        Some(3) => Some("third"),
        Some(4) => Some("quarter"),
        _ => None,
    };
    match (part, word(&value.numer()), value.numer().is_one()) {
        (Some(part), _, true) => part.to_owned(),
        (Some("half"), Some(count), false) => format!("{count}_halves"),
        (Some(part), Some(count), false) => format!("{count}_{part}s"),
        _ => short(
            "ratio",
            &[value.numer().to_string(), denominator.to_string()],
        ),
    }
}

/// Long numbers are cut: the value stands beside the name.
fn short(prefix: &str, numbers: &[String]) -> String {
    let cut = |number: &String| number.chars().take(8).collect::<String>();
    let parts: Vec<String> = numbers.iter().map(cut).collect();
    format!("{prefix}_{}", parts.join("_"))
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
            && !symbols.iter().any(|known| **known == *symbol.name)
        {
            symbols.push(symbol.name.to_string());
        }
    });
    symbols
}

fn describe_fully(node: &Node) -> String {
    match node {
        Node::Number(value) => number_name(value),
        Node::Symbol(symbol) => symbol.name.to_string(),
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
        Function::Recip => "inverse".into(),
        Function::Group => "sum".into(),
    }
}
