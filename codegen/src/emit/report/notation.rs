//! Formulas as text in the symbols of the paper: `Q₁₁ v₁ − ½ (a + b)`.

use crate::derived::Derived;
use crate::emit::formula::{Node, factored};
use crate::expr::{Expr, Function, Rational, Symbol};
use crate::manifold::{Factor, Kind};
use num_traits::One;
use std::collections::BTreeMap;

/// How a joint's symbols are written.
#[derive(Clone, Debug)]
pub struct Notation {
    by_symbol: BTreeMap<Symbol, String>,
}

impl Notation {
    /// The notation of a joint: coordinates after their factor, ϕ, v, p and v̄ numbered.
    pub fn new(derived: &Derived) -> Self {
        let mut by_symbol = BTreeMap::new();
        let arguments = &derived.arguments;
        let factors = derived.spec.manifold.value.factors();
        let names: Vec<String> = factors.iter().flat_map(names_of_factor).collect();
        for (symbol, name) in arguments.configuration.iter().zip(&names) {
            by_symbol.insert(symbol.clone(), name.clone());
        }
        for (symbol, name) in arguments.target.iter().zip(&names) {
            by_symbol.insert(symbol.clone(), format!("{name}′"));
        }
        let numbered = [
            (&arguments.local, "ϕ"),
            (&arguments.velocity, "v"),
            (&arguments.momentum, "p"),
            (&arguments.speeds, "v\u{304}"),
            (&arguments.wrench, "h"),
        ];
        for (symbols, letter) in numbered {
            for (i, symbol) in symbols.iter().enumerate() {
                let name = if symbols.len() == 1 {
                    letter.to_owned()
                } else {
                    format!("{letter}{}", subscript(i + 1))
                };
                by_symbol.insert(symbol.clone(), name);
            }
        }
        for parameter in &derived.spec.parameters {
            by_symbol.insert(parameter.symbol.clone(), letter(&parameter.symbol.name));
        }
        Self { by_symbol }
    }

    /// A symbol.
    pub fn symbol(&self, symbol: &Symbol) -> String {
        self.by_symbol
            .get(symbol)
            .cloned()
            .unwrap_or_else(|| letter(&symbol.name))
    }

    /// An expression, with common factors pulled out.
    pub fn expression(&self, expression: &Expr) -> String {
        self.formula(&factored(expression).polished())
    }

    /// A formula.
    pub fn formula(&self, node: &Node) -> String {
        match node {
            Node::Number(value) => number(value),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Pi => "π".into(),
            Node::Sum(terms) => self.sum(terms),
            Node::Product(factors) => self.product(factors),
            Node::Quotient(above, below) => format!("{} / {}", self.tight(above), self.atom(below)),
            Node::Negative(inner) => format!("−{}", self.tight(inner)),
            Node::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn sum(&self, terms: &[(bool, Node)]) -> String {
        let mut text = String::new();
        for (i, (minus, term)) in terms.iter().enumerate() {
            text += if i == 0 {
                ""
            } else if *minus {
                " − "
            } else {
                " + "
            };
            text += &self.tight(term);
        }
        text
    }

    fn product(&self, factors: &[Node]) -> String {
        let mut words = vec![];
        let mut rest = factors;
        while let Some(first) = rest.first() {
            let copies = rest.iter().take_while(|factor| *factor == first).count();
            let power = if copies > 1 {
                superscript(copies)
            } else {
                String::new()
            };
            words.push(self.atom(first) + &power);
            rest = &rest[copies..];
        }
        words.join(" ")
    }

    fn call(&self, function: Function, arguments: &[Node]) -> String {
        let inner: Vec<String> = arguments
            .iter()
            .map(|argument| self.formula(argument))
            .collect();
        let inner = inner.join(", ");
        let spaced = |name: &str| match arguments {
            [Node::Symbol(_)] => format!("{name} {inner}"),
            _ => format!("{name}({inner})"),
        };
        match function {
            Function::Pi => "π".into(),
            Function::Cos => spaced("cos"),
            Function::Sin => spaced("sin"),
            Function::Exp => format!("exp({inner})"),
            Function::Ln => spaced("ln"),
            Function::Atan2 => format!("atan2({inner})"),
            Function::Sqrt => format!("√({inner})"),
            Function::Stumpff(order) => format!("c{}({inner})", subscript(order.into())),
            Function::DexpInverse(0) => format!("G({inner})"),
            Function::DexpInverse(order) => format!("G{}({inner})", "′".repeat(order.into())),
            Function::Recip => format!("1 / ({inner})"),
        }
    }

    /// In parentheses where it is a sum.
    fn tight(&self, node: &Node) -> String {
        match node {
            Node::Sum(_) => format!("({})", self.formula(node)),
            _ => self.formula(node),
        }
    }

    /// In parentheses where it is an operation.
    fn atom(&self, node: &Node) -> String {
        match node {
            Node::Sum(_) | Node::Product(_) | Node::Quotient(..) | Node::Negative(_) => {
                format!("({})", self.formula(node))
            }
            _ => self.formula(node),
        }
    }
}

/// The stored scalars of a factor: `Q₁₁`, `q.w`, `θ`.
fn names_of_factor(factor: &Factor) -> Vec<String> {
    let name = letter(&factor.name);
    let entries = |rows: usize, columns: usize| -> Vec<String> {
        let entry = |n: usize| {
            format!(
                "{name}{}{}",
                subscript(n / columns + 1),
                subscript(n % columns + 1)
            )
        };
        (0..rows * columns).map(entry).collect()
    };
    let fields = |letters: &str| {
        letters
            .chars()
            .map(|field| format!("{name}.{field}"))
            .collect()
    };
    match factor.kind {
        Kind::Real(1) => vec![name],
        Kind::Real(size) => (1..=size)
            .map(|n| format!("{name}{}", subscript(n)))
            .collect(),
        Kind::S1 => fields("cs"),
        Kind::S3 => fields("wxyz"),
        Kind::S2 => fields("xyz"),
        Kind::So2 => entries(2, 2),
        Kind::Se2 => entries(2, 3),
        Kind::So3 => entries(3, 3),
        Kind::Se3 => entries(3, 4),
    }
}

/// Names of Greek letters as letters.
fn letter(name: &str) -> String {
    let greek = match name {
        "alpha" => "α",
        "beta" => "β",
        "gamma" => "γ",
        "delta" => "δ",
        "epsilon" => "ε",
        "theta" => "θ",
        "lambda" => "λ",
        "mu" => "μ",
        "rho" => "ρ",
        "sigma" => "σ",
        "tau" => "τ",
        "psi" => "ψ",
        "omega" => "ω",
        other => other,
    };
    greek.to_owned()
}

/// The number in subscript digits.
pub fn subscript(n: usize) -> String {
    digits(n, '₀')
}

fn superscript(n: usize) -> String {
    let raised = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string()
        .chars()
        .filter_map(|digit| raised.get(digit.to_digit(10)? as usize))
        .collect()
}

fn digits(n: usize, zero: char) -> String {
    let shifted = |digit: char| char::from_u32(zero as u32 + digit.to_digit(10)?);
    n.to_string().chars().filter_map(shifted).collect()
}

fn number(value: &Rational) -> String {
    let known = [
        ((1, 2), "½"),
        ((1, 3), "⅓"),
        ((2, 3), "⅔"),
        ((1, 4), "¼"),
        ((3, 4), "¾"),
        ((1, 6), "⅙"),
        ((1, 8), "⅛"),
    ];
    let is = |(above, below): (i32, i32)| *value == Rational::new(above.into(), below.into());
    match known.iter().find(|(fraction, _)| is(*fraction)) {
        Some((_, text)) => (*text).to_owned(),
        None if value.denom().is_one() => value.to_string(),
        None => format!("({value})"),
    }
}
