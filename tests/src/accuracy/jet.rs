//! Polynomials of degree 2 in local coordinates, exactly: values with all first and second derivatives.

use super::Node;
use hamel_codegen::expr::{Function, Number, Rational};
use std::collections::BTreeMap;

/// Variables from here on are only differentiated once: products of two of them are dropped.
pub const ONCE: usize = 64;

/// `value + Σ first_i x_i + Σ_{i ≤ j} second_ij x_i x_j`; what is not listed is zero.
#[derive(Clone, Debug)]
pub struct Jet {
    /// The constant term.
    pub value: Node,
    first: BTreeMap<usize, Node>,
    second: BTreeMap<(usize, usize), Node>,
}

impl Jet {
    /// A number.
    pub fn constant(value: Node) -> Self {
        Self {
            value,
            first: BTreeMap::new(),
            second: BTreeMap::new(),
        }
    }

    /// An input.
    pub fn input(value: f64) -> Self {
        Self::constant(Node::input(value))
    }

    /// `value + x_i`.
    pub fn variable(value: Node, i: usize) -> Self {
        Self {
            first: BTreeMap::from([(i, Node::input(1.0))]),
            ..Self::constant(value)
        }
    }

    /// The coefficient of x_i.
    pub fn slope(&self, i: usize) -> Node {
        self.first.get(&i).cloned().unwrap_or(Node::input(0.0))
    }

    /// `∂/∂x_i` to first order in the others.
    pub fn partial(&self, i: usize) -> Self {
        let mut first = BTreeMap::new();
        for (&(a, b), value) in &self.second {
            match (a == i, b == i) {
                (true, true) => _ = first.insert(i, value.times(&Node::input(2.0))),
                (true, false) => _ = first.insert(b, value.clone()),
                (false, true) => _ = first.insert(a, value.clone()),
                _ => {}
            }
        }
        Self {
            value: self.slope(i),
            first,
            second: BTreeMap::new(),
        }
    }

    /// Without the variables from `ONCE` on.
    pub fn at_zero_of_once(&self) -> Self {
        let mut kept = self.clone();
        kept.first.retain(|i, _| *i < ONCE);
        kept.second.retain(|(_, j), _| *j < ONCE);
        kept
    }

    fn is_nothing(&self) -> bool {
        self.value.is_nothing() && self.is_constant()
    }

    fn is_constant(&self) -> bool {
        self.first.is_empty() && self.second.is_empty()
    }

    /// The part without the constant term.
    fn varying(&self) -> Self {
        Self {
            value: Node::input(0.0),
            ..self.clone()
        }
    }

    /// `f(self)` from f, f′ and f″ at its value; the derivatives are made only where something varies.
    fn mapped(&self, f: impl Fn(u8) -> Node) -> Self {
        let start = Self::constant(f(0));
        if self.is_constant() {
            return start;
        }
        let n = self.varying();
        let half = Self::constant(f(2).times(&Node::input(0.5)));
        let slope = Self::constant(f(1)).plus(&half.times(&n));
        start.plus(&slope.times(&n))
    }

    /// `self` with every coefficient times `factor`.
    fn scaled(&self, factor: &Node) -> Self {
        Self {
            value: self.value.times(factor),
            first: scaled(&self.first, factor),
            second: scaled(&self.second, factor),
        }
    }
}

fn scaled<K: Ord + Copy>(terms: &BTreeMap<K, Node>, factor: &Node) -> BTreeMap<K, Node> {
    terms
        .iter()
        .filter(|_| !factor.is_nothing())
        .map(|(key, value)| (*key, value.times(factor)))
        .collect()
}

fn add<K: Ord + Copy>(sum: &mut BTreeMap<K, Node>, key: K, value: &Node) {
    let total = match sum.get(&key) {
        Some(known) => known.plus(value),
        None => value.clone(),
    };
    sum.insert(key, total);
}

impl Number for Jet {
    fn rational(&self, value: &Rational) -> Self {
        Self::constant(self.value.rational(value))
    }

    fn plus(&self, other: &Self) -> Self {
        if self.is_nothing() {
            return other.clone();
        }
        let mut sum = self.clone();
        sum.value = sum.value.plus(&other.value);
        for (key, value) in &other.first {
            add(&mut sum.first, *key, value);
        }
        for (key, value) in &other.second {
            add(&mut sum.second, *key, value);
        }
        sum
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_constant() {
            return other.scaled(&self.value);
        }
        if other.is_constant() {
            return self.scaled(&other.value);
        }
        let mut product = self.scaled(&other.value);
        let varying = other.varying().scaled(&self.value);
        product = product.plus(&varying);
        for (&i, a) in &self.first {
            for (&j, b) in &other.first {
                if i < ONCE || j < ONCE {
                    add(&mut product.second, (i.min(j), i.max(j)), &a.times(b));
                }
            }
        }
        product
    }

    fn over(&self, other: &Self) -> Self {
        if other.is_constant() {
            return self.scaled(&Node::input(1.0).over(&other.value));
        }
        self.times(&other.function(Function::Recip, std::slice::from_ref(other)))
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match arguments {
            [] => Self::constant(self.value.function(function, &[])),
            [x] => x.mapped(|order| derivative(function, order, &x.value)),
            [y, x] => angle(y, x),
            _ => Self::input(f64::NAN),
        }
    }
}

/// The angle of (x₀, y₀), and from there that of (x₀x + y₀y, x₀y − y₀x): small, so that its tangent is itself to second order.
fn angle(y: &Jet, x: &Jet) -> Jet {
    let start = Jet::constant(
        y.value
            .function(Function::Atan2, &[y.value.clone(), x.value.clone()]),
    );
    if y.is_constant() && x.is_constant() {
        return start;
    }
    let across = y
        .varying()
        .scaled(&x.value)
        .plus(&x.varying().scaled(&y.value.negative()));
    let along = y.scaled(&y.value).plus(&x.scaled(&x.value));
    start.plus(&across.over(&along))
}

/// The value, first or second derivative of a function of one argument.
fn derivative(function: Function, order: u8, x: &Node) -> Node {
    let number = |value: i64| Node::input(value as f64);
    let at = |function: Function| x.function(function, std::slice::from_ref(x));
    let once = |function| derivative(function, order - 1, x);
    match (function, order) {
        (_, 0) => at(function),
        (Function::Cos, _) => once(Function::Sin).negative(),
        (Function::Sin, _) => once(Function::Cos),
        (Function::Exp, _) => at(Function::Exp),
        (Function::Ln, _) => once(Function::Recip),
        (Function::Sqrt, 1) => at(Function::Recip)
            .times(&at(Function::Sqrt))
            .times(&Node::input(0.5)),
        (Function::Sqrt, _) => {
            let recip = at(Function::Recip);
            recip
                .times(&recip)
                .times(&at(Function::Sqrt))
                .times(&Node::input(-0.25))
        }
        (Function::Recip, 1) => at(Function::Recip).power(2).negative(),
        (Function::Recip, _) => at(Function::Recip).power(3).times(&number(2)),
        (Function::Stumpff(k), _) => {
            let ahead = number(k.into()).times(&once(Function::Stumpff(k + 2)));
            let behind = once(Function::Stumpff(k + 1)).negative();
            ahead.plus(&behind).times(&Node::input(0.5))
        }
        (Function::DexpInverse(n), _) => once(Function::DexpInverse(n + 1)),
        (Function::Group, 1) => number(1),
        (Function::Group | Function::Pi | Function::Atan2, _) => number(0),
    }
}

#[cfg(test)]
mod tests {
    use super::Jet;
    use crate::accuracy::environment::Environment;
    use crate::accuracy::{Node, Wide};
    use hamel_codegen::expr::{Expr, Role, Symbol};

    /// Every function of the language, of arguments that mix two variables.
    fn functions(x: &Expr, y: &Expr) -> Vec<Expr> {
        let sum = &(x * y) + &Expr::integer(2);
        let recip = sum.recip().expect("not zero");
        vec![
            sum.sin(),
            &sum.cos() * x,
            sum.exp(),
            sum.ln(),
            sum.sqrt(),
            &recip * y,
            &x.atan2(y) * x,
            sum.stumpff(0),
            sum.stumpff(3),
            x.dexp_inverse(1),
        ]
    }

    fn known(node: &Node) -> Wide {
        node.known().expect("arguments are known").value
    }

    /// First and second derivatives against those of the symbolic engine: 256 bits, less 56 for sums of a few terms of order 100.
    #[test]
    fn derivatives_are_those_of_the_function() {
        let symbols = [0, 1].map(|i| Symbol::new(Role::Local, i, ["x", "y"][i]));
        let [x, y] = symbols.each_ref().map(Expr::symbol);
        let values = [0.75, 1.25];
        let variables: Vec<Jet> = (0..2)
            .map(|i| Jet::variable(Node::input(values[i]), i))
            .collect();
        let constants: Vec<Jet> = values.iter().map(|v| Jet::input(*v)).collect();
        let moving = Environment::default().with(&symbols, &variables);
        let still = Environment::default().with(&symbols, &constants);
        let smallest = f64::powi(0.5, 200);
        for f in functions(&x, &y) {
            let jet = moving.evaluate(&f);
            for (i, a) in symbols.iter().enumerate() {
                let first = f.derivative(a);
                let error = known(&jet.slope(i)) - known(&still.evaluate(&first).value);
                assert!(error.to_f64().abs() < smallest, "d{i} {f}");
                for (j, b) in symbols.iter().enumerate() {
                    let second = known(&still.evaluate(&first.derivative(b)).value);
                    let error = known(&jet.partial(i).slope(j)) - second;
                    assert!(error.to_f64().abs() < smallest, "d{i} d{j} {f}");
                }
            }
        }
    }
}
