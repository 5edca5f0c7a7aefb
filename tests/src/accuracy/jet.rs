//! Polynomials of degree 3 in local coordinates, exactly: values with all derivatives up to the third.

use super::Node;
use hamel_codegen::expr::{Function, Number, Rational};
use std::collections::BTreeMap;

/// Variables from here on are only differentiated once: products of two of them are dropped.
pub const ONCE: usize = 64;

/// The highest degree that is ever asked for: second derivatives of an X that itself is a derivative of H.
pub const MOST: usize = 3;

/// `value + Σ terms`, one term a monomial `x_i x_j …` by its sorted indices, up to a degree; what is not listed is zero.
#[derive(Clone, Debug)]
pub struct Jet {
    /// The constant term.
    pub value: Node,
    /// Up to this degree terms are exact, and there are none beyond it.
    degree: usize,
    terms: BTreeMap<Vec<usize>, Node>,
}

impl Jet {
    /// A number.
    pub fn constant(value: Node) -> Self {
        Self {
            value,
            degree: MOST,
            terms: BTreeMap::new(),
        }
    }

    /// An input.
    pub fn input(value: f64) -> Self {
        Self::constant(Node::input(value))
    }

    /// `value + x_i`, for products of up to `degree` variables.
    pub fn variable(value: Node, i: usize, degree: usize) -> Self {
        Self {
            degree,
            terms: BTreeMap::from([(vec![i], Node::input(1.0))]),
            ..Self::constant(value)
        }
    }

    /// `value + Σ slope_i x_i`, and nothing known beyond.
    pub fn linear(value: Node, slopes: impl IntoIterator<Item = Node>) -> Self {
        let slopes = slopes.into_iter().enumerate();
        Self {
            degree: 1,
            terms: slopes.map(|(i, slope)| (vec![i], slope)).collect(),
            ..Self::constant(value)
        }
    }

    /// The coefficient of x_i.
    pub fn slope(&self, i: usize) -> Node {
        let found = self.terms.get([i].as_slice());
        found.cloned().unwrap_or(Node::input(0.0))
    }

    /// `∂/∂x_i`, to one degree less.
    pub fn partial(&self, i: usize) -> Self {
        let mut partial = Self {
            degree: self.degree.saturating_sub(1),
            ..Self::constant(self.slope(i))
        };
        for (monomial, value) in self.terms.iter().filter(|(m, _)| m.len() > 1) {
            if let Some(place) = monomial.iter().position(|j| *j == i) {
                let times = monomial.iter().filter(|j| **j == i).count();
                let mut rest = monomial.clone();
                rest.remove(place);
                let value = match times {
                    1 => value.clone(),
                    times => value.times(&Node::input(times as f64)),
                };
                partial.terms.insert(rest, value);
            }
        }
        partial
    }

    /// Without the variables from `ONCE` on.
    pub fn at_zero_of_once(&self) -> Self {
        let mut kept = self.clone();
        kept.terms
            .retain(|monomial, _| monomial.iter().all(|i| *i < ONCE));
        kept
    }

    fn is_nothing(&self) -> bool {
        self.value.is_nothing() && self.is_constant()
    }

    fn is_constant(&self) -> bool {
        self.terms.is_empty()
    }

    /// The part without the constant term.
    pub fn varying(&self) -> Self {
        Self {
            value: Node::input(0.0),
            ..self.clone()
        }
    }

    /// `f(self)` from the derivatives of f at its value, of which as many are made as there are degrees in what varies.
    fn mapped(&self, f: impl Fn(u8) -> Node) -> Self {
        if self.is_constant() {
            return Self::constant(f(0));
        }
        let n = self.varying();
        let (mut sum, mut power) = (Self::constant(f(0)), n.clone());
        let mut factorial = 1.0;
        for order in 1..=self.degree {
            if power.is_constant() {
                break;
            }
            factorial *= order as f64;
            let factor = match order {
                1 => f(1),
                _ => f(order as u8).over(&Node::input(factorial)),
            };
            sum = sum.plus(&power.scaled(&factor));
            power = power.times(&n);
        }
        sum
    }

    /// `self` with every coefficient times `factor`.
    fn scaled(&self, factor: &Node) -> Self {
        let terms = self.terms.iter().filter(|_| !factor.is_nothing());
        Self {
            value: self.value.times(factor),
            degree: self.degree,
            terms: terms
                .map(|(monomial, value)| (monomial.clone(), value.times(factor)))
                .collect(),
        }
    }

    fn add(&mut self, monomial: Vec<usize>, value: &Node) {
        let total = match self.terms.get(&monomial) {
            Some(known) => known.plus(value),
            None => value.clone(),
        };
        self.terms.insert(monomial, total);
    }

    /// Drops what is beyond the degree to which `other` is known as well.
    fn limited_by(&mut self, other: &Self) {
        let degree = self.degree.min(other.degree);
        if degree < self.degree {
            self.terms.retain(|monomial, _| monomial.len() <= degree);
            self.degree = degree;
        }
    }
}

/// The product of two monomials; nothing where two variables are differentiated once.
fn joined(a: &[usize], b: &[usize]) -> Option<Vec<usize>> {
    let mut both = [a, b].concat();
    both.sort_unstable();
    let once = both.iter().filter(|i| **i >= ONCE).count();
    (once <= 1).then_some(both)
}

impl Number for Jet {
    fn rational(&self, value: &Rational) -> Self {
        Self::constant(self.value.rational(value))
    }

    fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.limited_by(other);
        if self.is_nothing() {
            sum.value = other.value.clone();
        } else {
            sum.value = sum.value.plus(&other.value);
        }
        for (monomial, value) in &other.terms {
            if monomial.len() <= sum.degree {
                sum.add(monomial.clone(), value);
            }
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
        product = product.plus(&other.varying().scaled(&self.value));
        for (a, left) in &self.terms {
            for (b, right) in &other.terms {
                if a.len() + b.len() > product.degree {
                    continue;
                }
                if let Some(monomial) = joined(a, b) {
                    product.add(monomial, &left.times(right));
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

/// The angle of (x₀, y₀), and from there that of (x₀x + y₀y, x₀y − y₀x): small, `t − t³/3` of its tangent to third order.
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
    let tangent = across.over(&along);
    let cube = tangent.times(&tangent).times(&tangent);
    let third = Node::input(1.0).over(&Node::input(-3.0));
    start.plus(&tangent).plus(&cube.scaled(&third))
}

/// The value or a derivative, up to the third, of a function of one argument.
fn derivative(function: Function, order: u8, x: &Node) -> Node {
    let number = |value: i64| Node::input(value as f64);
    let at = |function: Function| x.function(function, std::slice::from_ref(x));
    let once = |function| derivative(function, order - 1, x);
    match (function, order) {
        (_, 0) => at(function),
        (Function::Cos, _) => once(Function::Sin).negative(),
        (Function::Sin, _) => once(Function::Cos),
        (Function::Exp, _) => at(Function::Exp),
        (Function::Sinh, _) => once(Function::Cosh),
        (Function::Cosh, _) => once(Function::Sinh),
        (Function::LnCosh, _) => once(Function::Tanh),
        (Function::Tanh | Function::Sech, _) => {
            fading(function, order, &at(Function::Sech), &at(Function::Tanh))
        }
        (Function::Ln, _) => once(Function::Recip),
        (Function::Sqrt, 1) => at(Function::Recip)
            .times(&at(Function::Sqrt))
            .times(&Node::input(0.5)),
        (Function::Sqrt, 2) => at(Function::Recip)
            .power(2)
            .times(&at(Function::Sqrt))
            .times(&Node::input(-0.25)),
        (Function::Sqrt, _) => at(Function::Recip)
            .power(3)
            .times(&at(Function::Sqrt))
            .times(&Node::input(0.375)),
        (Function::Recip, 1) => at(Function::Recip).power(2).negative(),
        (Function::Recip, 2) => at(Function::Recip).power(3).times(&number(2)),
        (Function::Recip, _) => at(Function::Recip).power(4).times(&number(-6)),
        (Function::Stumpff(k), _) => {
            let ahead = number(k.into()).times(&once(Function::Stumpff(k + 2)));
            let behind = once(Function::Stumpff(k + 1)).negative();
            ahead.plus(&behind).times(&Node::input(0.5))
        }
        (Function::DexpInverse(n), _) => once(Function::DexpInverse(n + 1)),
        (Function::Curve(curve, n), _) => at(Function::Curve(curve, n + order)),
        (Function::Group, 1) => number(1),
        // Ln1p and Larger are of written formulas, not of definitions.
        (
            Function::Group | Function::Pi | Function::Atan2 | Function::Ln1p | Function::Larger,
            _,
        ) => number(0),
    }
}

/// Derivatives of tangent and secant in terms of themselves.
fn fading(function: Function, order: u8, sech: &Node, tanh: &Node) -> Node {
    let number = |value: i32| Node::input(value.into());
    let square = sech.power(2);
    // Of secant and tangent: a times sech², b times tanh².
    let both = |a, b| {
        let first = square.times(&number(a));
        first.plus(&tanh.power(2).times(&number(b)))
    };
    match (function, order) {
        (Function::Tanh, 1) => square,
        (Function::Tanh, 2) => square.times(tanh).times(&number(-2)),
        (Function::Tanh, _) => square.times(&both(-2, 4)),
        (_, 1) => sech.times(tanh).negative(),
        (_, 2) => sech.times(&both(-1, 1)),
        _ => sech.times(tanh).times(&both(5, -1)),
    }
}

#[cfg(test)]
mod tests {
    use super::{Jet, MOST};
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
            sum.sinh(),
            sum.cosh(),
            sum.sech(),
            sum.tanh(),
            sum.cosh().ln(),
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

    /// Derivatives up to the third against those of the symbolic engine: 256 bits, less 56 for sums of a few terms of order 100.
    #[test]
    fn derivatives_are_those_of_the_function() {
        let symbols = [0, 1].map(|i| Symbol::new(Role::Local, i, ["x", "y"][i]));
        let [x, y] = symbols.each_ref().map(Expr::symbol);
        let values = [0.75, 1.25];
        let variables: Vec<Jet> = (0..2)
            .map(|i| Jet::variable(Node::input(values[i]), i, MOST))
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
                    for (k, c) in symbols.iter().enumerate() {
                        let third = first.derivative(b).derivative(c);
                        let error = known(&jet.partial(i).partial(j).slope(k))
                            - known(&still.evaluate(&third).value);
                        assert!(error.to_f64().abs() < smallest, "d{i} d{j} d{k} {f}");
                    }
                }
            }
        }
    }
}
