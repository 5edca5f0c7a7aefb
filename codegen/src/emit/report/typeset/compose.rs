//! From formulas of the ring to formulas on paper.

use super::Math;
use crate::expr::{Function, Rational, Symbol};
use crate::formula::Node;
use num_traits::One;

/// A formula whose symbols are set by `symbol`.
pub fn composed(node: &Node, symbol: &impl Fn(&Symbol) -> Math) -> Math {
    match node {
        Node::Number(value) => Math::Number(value.clone()),
        Node::Symbol(name) => symbol(name),
        Node::Pi => Math::Letter('π'),
        Node::Sum(terms) => sum(terms, symbol),
        Node::Product(factors) => product(factors, symbol),
        Node::Quotient(above, below) => quotient(above, below, symbol),
        Node::Negative(inner) => tight(inner, symbol).negative(),
        Node::Call(function, arguments) => call(*function, arguments, 1, symbol),
    }
}

fn sum(terms: &[(bool, Node)], symbol: &impl Fn(&Symbol) -> Math) -> Math {
    let mut row = vec![];
    for (i, (minus, term)) in terms.iter().enumerate() {
        match (i, minus) {
            (0, false) => {}
            (0, true) => row.push(Math::Minus),
            (_, false) => row.push(Math::Sign('+')),
            (_, true) => row.push(Math::Sign('−')),
        }
        row.push(tight(term, symbol));
    }
    Math::Row(row)
}

/// Equal neighbours become powers.
fn product(factors: &[Node], symbol: &impl Fn(&Symbol) -> Math) -> Math {
    let mut words = vec![];
    let mut rest = factors;
    while let Some(first) = rest.first() {
        let copies = rest.iter().take_while(|factor| *factor == first).count();
        words.push(power(first, copies, symbol));
        rest = &rest[copies..];
    }
    Math::product(words)
}

fn power(factor: &Node, exponent: usize, symbol: &impl Fn(&Symbol) -> Math) -> Math {
    match factor {
        Node::Call(function, arguments) => call(*function, arguments, exponent, symbol),
        _ => raised(atom(factor, symbol), exponent),
    }
}

fn raised(base: Math, exponent: usize) -> Math {
    match (exponent, base) {
        (1, base) => base,
        (_, base @ (Math::Part(..) | Math::Script(_, _, Some(_)))) => {
            base.grouped().raised_to(Math::integer(exponent))
        }
        (_, base) => base.raised_to(Math::integer(exponent)),
    }
}

/// Denominators of numbers go below the line: `a / (2 b)`, not `½ a / b`.
fn quotient(above: &Node, below: &Node, symbol: &impl Fn(&Symbol) -> Math) -> Math {
    let factors = match above {
        Node::Product(factors) => factors.clone(),
        single => vec![single.clone()],
    };
    let (above, below) = match factors.split_first() {
        Some((Node::Number(value), rest)) if !value.denom().is_one() => {
            let part = |part| Node::Number(Rational::from_integer(part));
            let above = std::iter::once(part(value.numer())).chain(rest.iter().cloned());
            let below = Node::product([part(value.denom()), below.clone()]);
            (Node::product(above), below)
        }
        _ => (above.clone(), below.clone()),
    };
    Math::Fraction(
        Box::new(composed(&above, symbol)),
        Box::new(composed(&below, symbol)),
    )
}

/// In parentheses where it is a sum.
fn tight(node: &Node, symbol: &impl Fn(&Symbol) -> Math) -> Math {
    match node {
        Node::Sum(_) => composed(node, symbol).grouped(),
        _ => composed(node, symbol),
    }
}

/// In parentheses where it is an operation.
fn atom(node: &Node, symbol: &impl Fn(&Symbol) -> Math) -> Math {
    match node {
        Node::Sum(_) | Node::Product(_) | Node::Quotient(..) | Node::Negative(_) => {
            composed(node, symbol).grouped()
        }
        Node::Number(value) if !value.denom().is_one() => Math::Number(value.clone()),
        _ => composed(node, symbol),
    }
}

/// A function, its exponent where its name can carry it: cos² θ.
fn call(
    function: Function,
    arguments: &[Node],
    exponent: usize,
    symbol: &impl Fn(&Symbol) -> Math,
) -> Math {
    let inner: Vec<Math> = arguments
        .iter()
        .map(|node| composed(node, symbol))
        .collect();
    let one = || Math::integer(1);
    let first = || Box::new(inner.first().cloned().unwrap_or_else(one));
    let name = match function {
        Function::Pi => return raised(Math::Letter('π'), exponent),
        Function::Sqrt => return raised(Math::Root(first()), exponent),
        Function::Recip => {
            return raised(Math::Fraction(Box::new(one()), first()).grouped(), exponent);
        }
        Function::Group => return raised(first().grouped(), exponent),
        Function::Cos => Math::Word("cos".into()),
        Function::Sin => Math::Word("sin".into()),
        Function::Exp => Math::Word("exp".into()),
        Function::Sinh => Math::Word("sinh".into()),
        Function::Cosh => Math::Word("cosh".into()),
        Function::Sech => Math::Word("sech".into()),
        Function::Tanh => Math::Word("tanh".into()),
        Function::LnCosh => Math::Word("ln cosh".into()),
        Function::Ln => Math::Word("ln".into()),
        Function::Ln1p => Math::Word("ln1p".into()),
        Function::Larger => Math::Word("max".into()),
        Function::Atan2 => Math::Word("atan2".into()),
        Function::Stumpff(order) => Math::Letter('c').with_index(Math::integer(order.into())),
        Function::Curve(curve, 0) => Math::Word(curve.name().into()),
        Function::Curve(curve, order) => {
            let primes = vec![Math::Letter('′'); order.into()];
            Math::Word(curve.name().into()).raised_to(Math::Row(primes))
        }
        Function::DexpInverse(0) => Math::Letter('G'),
        Function::DexpInverse(order) => {
            let primes = vec![Math::Letter('′'); order.into()];
            Math::Letter('G').raised_to(Math::Row(primes))
        }
    };
    let bare = matches!(
        (function, arguments),
        (
            Function::Cos
                | Function::Sin
                | Function::Sinh
                | Function::Cosh
                | Function::Sech
                | Function::Tanh
                | Function::LnCosh
                | Function::Ln,
            [Node::Symbol(_)]
        )
    );
    let name = raised(name, exponent);
    match bare {
        true => Math::Row(vec![name, Math::Space, *first()]),
        false => Math::Row(vec![name, listed(inner).grouped()]),
    }
}

/// Arguments with commas between them.
fn listed(arguments: Vec<Math>) -> Math {
    let mut row = vec![];
    for argument in arguments {
        if !row.is_empty() {
            row.push(Math::Sign(','));
        }
        row.push(argument);
    }
    match row.len() {
        1 => row.swap_remove(0),
        _ => Math::Row(row),
    }
}
