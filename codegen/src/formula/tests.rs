//! Formulas keep the value of their expression, are counted as they are written, and have names of their own.

use super::{Binding, Counts, Node, Program, factored};
use crate::expr::{Expr, Number, Role, Symbol, evaluate_f64};
use crate::formula::names::NameSet;
use crate::kernel::{Kernel, KernelKind, Method, Step, Structure};
use crate::matrix::Matrix;
use std::collections::BTreeMap;

fn symbol(name: &str, index: usize) -> Symbol {
    Symbol::new(Role::Coordinate, index, name)
}

fn x() -> [Expr; 4] {
    [0, 1, 2, 3].map(|i| Expr::symbol(&symbol(["a", "b", "c", "d"][i], i)))
}

fn value_of_symbol(symbol: &Symbol) -> f64 {
    0.3 + 0.7 * f64::from(symbol.index)
}

/// The value of a formula, independently of the expression that it came from.
fn value(node: &Node, symbols: &impl Fn(&Symbol) -> f64) -> f64 {
    let of = |node: &Node| value(node, symbols);
    match node {
        Node::Number(number) => 0.0.rational(number),
        Node::Symbol(symbol) => symbols(symbol),
        Node::Pi => std::f64::consts::PI,
        Node::Sum(terms) => terms
            .iter()
            .map(|(minus, term)| if *minus { -of(term) } else { of(term) })
            .sum(),
        Node::Product(factors) => factors.iter().map(of).product(),
        Node::Quotient(above, below) => of(above) / of(below),
        Node::Negative(inner) => -of(inner),
        Node::Call(function, arguments) => {
            let arguments: Vec<f64> = arguments.iter().map(of).collect();
            0.0.function(*function, &arguments)
        }
    }
}

fn run(program: &Program) -> Vec<f64> {
    let mut bound: BTreeMap<Symbol, f64> = BTreeMap::new();
    for binding in &program.bindings {
        let known = bound.clone();
        let lookup = |symbol: &Symbol| {
            known
                .get(symbol)
                .copied()
                .unwrap_or_else(|| value_of_symbol(symbol))
        };
        match binding {
            Binding::Value { name, value: node } => {
                _ = bound.insert(name.clone(), value(node, &lookup))
            }
            Binding::SinCos { sin, cos, angle } => {
                let angle = value(angle, &lookup);
                bound.extend(sin.clone().map(|name| (name, angle.sin())));
                bound.extend(cos.clone().map(|name| (name, angle.cos())));
            }
            Binding::Call { .. } => panic!("these programs call nothing"),
        }
    }
    let lookup = |symbol: &Symbol| {
        bound
            .get(symbol)
            .copied()
            .unwrap_or_else(|| value_of_symbol(symbol))
    };
    program
        .outputs
        .iter()
        .map(|output| value(output, &lookup))
        .collect()
}

fn expressions() -> Vec<Expr> {
    let [a, b, c, d] = x();
    let half = Expr::fraction(1, 2);
    let lead = Expr::symbol(&Symbol::new(Role::Parameter, 1, "lead"));
    let norm = (&a.square() + &b.square()).sqrt();
    vec![
        Expr::zero(),
        Expr::integer(-3),
        &a - &b,
        &b - &a,
        -(&a + &b),
        &(&(&a * &b) + &(&a * &c)) - &(&a * &d),
        &Expr::one() - &(&Expr::integer(2) * &(&b.square() + &c.square())),
        &half * &(&(&a * &d) - &(&b * &c)),
        &(&lead * &a) * &(&Expr::integer(2) * &Expr::pi()).recip().expect("not zero"),
        &(&a * &c) * &norm.recip().expect("not zero"),
        &(&a + &b).recip().expect("not zero") - &c,
        &(&a.sin() * &b.cos()) + &(&a.cos() * &(&b * &c).sin()),
        &(&a.square() + &b).stumpff(2) * &(&c - &(&a.square() + &b).stumpff(1)),
        (&a + &b).pow(4),
        &a.pow(5) - &b.atan2(&a).exp(),
    ]
}

/// Formulas reorder at most a dozen operations on numbers of order one: 1e-12 is thousands of roundings.
const ROUNDING: f64 = 1e-12;

#[test]
fn factoring_and_polishing_keep_the_value() {
    for expression in expressions() {
        let exact = evaluate_f64(&expression, &value_of_symbol);
        let node = factored(&expression);
        for (written, step) in [(&node, "factored"), (&node.clone().polished(), "polished")] {
            let found = value(written, &value_of_symbol);
            assert!(
                (found - exact).abs() <= ROUNDING * exact.abs().max(1.0),
                "{step} {expression}: {found} for {exact}"
            );
        }
    }
}

fn program(steps: Vec<Step>, entries: Vec<Expr>) -> Program {
    let outputs = vec![Matrix::column_vector(entries)];
    let kernel = Kernel {
        kind: KernelKind::Retract,
        steps,
        outputs,
        method: Method::Formula,
        structure: Structure::General,
    };
    let mut taken = NameSet::default();
    ["a", "b", "c", "d"]
        .iter()
        .for_each(|name| _ = taken.claim(name));
    Program::new(&kernel.steps, &kernel.outputs, &taken)
}

#[test]
fn sharing_keeps_the_values() {
    let found = run(&program(vec![], expressions()));
    for (expression, found) in expressions().iter().zip(found) {
        let exact = evaluate_f64(expression, &value_of_symbol);
        assert!(
            (found - exact).abs() <= ROUNDING * exact.abs().max(1.0),
            "{expression}: {found} for {exact}"
        );
    }
}

#[test]
fn intermediate_values_are_bound_before_they_are_used() {
    let [a, b, ..] = x();
    let root = Symbol::new(Role::Intermediate, 0, "root");
    let r = Expr::symbol(&root);
    let steps = vec![Step::Let(root, (&a + &b).sqrt())];
    let written = program(
        steps,
        vec![(&r * &a).sin(), (&r * &a).cos(), &(&r * &a) + &b],
    );
    let r = (value_of_symbol(&symbol("a", 0)) + value_of_symbol(&symbol("b", 1))).sqrt();
    let angle = r * 0.3;
    let exact = [angle.sin(), angle.cos(), angle + 1.0];
    for (found, exact) in run(&written).iter().zip(exact) {
        assert!((found - exact).abs() < ROUNDING, "{found} for {exact}");
    }
}

#[test]
fn names_for_names_vanish() {
    let [a, b, ..] = x();
    let (first, second) = (
        Symbol::new(Role::Intermediate, 0, "first"),
        Symbol::new(Role::Intermediate, 1, "second"),
    );
    let steps = vec![
        Step::Let(first.clone(), &a + &b),
        Step::Let(second.clone(), Expr::symbol(&first)),
    ];
    let written = program(
        steps,
        vec![Expr::symbol(&second), &Expr::symbol(&first) * &a],
    );
    assert_eq!(written.bindings.len(), 1);
    assert_eq!(written.outputs[0], Node::Symbol(first));
}

#[test]
fn operations_are_counted_as_written() {
    let [a, b, c, d] = x();
    let counts = |expression: &Expr| {
        let count = Counts::of(&factored(expression));
        [
            count.additions,
            count.multiplications,
            count.divisions,
            count.calls,
        ]
    };
    assert_eq!(counts(&a), [0, 0, 0, 0]);
    assert_eq!(counts(&(&(&a * &b) - &(&c * &d))), [1, 2, 0, 0]);
    assert_eq!(counts(&(&(&a * &b) + &(&a * &c))), [1, 1, 0, 0]);
    assert_eq!(counts(&(&Expr::fraction(1, 2) * &(&a - &b))), [1, 1, 0, 0]);
    assert_eq!(counts(&(&a + &b).recip().expect("not zero")), [1, 0, 1, 0]);
    assert_eq!(counts(&(&a * &b).exp()), [0, 1, 0, 1]);
    assert_eq!(counts(&a.pow(3)), [0, 2, 0, 0]);
}

#[test]
fn sine_and_cosine_of_one_angle_are_one_call() {
    let [a, b, ..] = x();
    let written = program(vec![], vec![a.sin(), a.cos(), &a.sin() * &b]);
    assert_eq!(Counts::of_program(&written).calls, 1);
    assert_eq!(written.bindings.len(), 1);
}

#[test]
fn a_difference_and_its_opposite_are_one_value() {
    let [a, b, c, d] = x();
    let written = program(vec![], vec![&(&a - &b) * &c, &(&b - &a) * &d]);
    assert_eq!(Counts::of_program(&written).additions, 1);
}

#[test]
fn a_shared_name_gives_way_to_a_name_that_is_taken() {
    let [a, b, c, _] = x();
    let kernel = Kernel {
        kind: KernelKind::Retract,
        steps: vec![],
        outputs: vec![Matrix::column_vector(vec![
            &(&a + &b) * &c,
            &(&a + &b) * &a,
        ])],
        method: Method::Formula,
        structure: Structure::General,
    };
    let mut taken = NameSet::default();
    taken.claim("t1");
    let written = Program::new(&kernel.steps, &kernel.outputs, &taken);
    let names: Vec<&str> = written
        .bindings
        .iter()
        .flat_map(Binding::names)
        .map(|name| name.name())
        .collect();
    assert_eq!(names, ["t2"]);
}

#[test]
fn the_opposite_of_a_difference_is_written_as_a_difference() {
    let [a, b, ..] = x();
    let node = factored(&(&b - &a)).polished();
    assert!(matches!(node, Node::Sum(_)), "{node:?}");
    let scaled = factored(&(&Expr::fraction(1, 2) * &(&b - &a))).polished();
    assert!(matches!(scaled, Node::Product(_)), "{scaled:?}");
}

/// Pseudorandom numbers below a bound, the same in each run (Numerical Recipes' linear congruential generator).
struct Random(u32);

impl Random {
    fn below(&mut self, bound: u32) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((self.0 >> 16) % bound) as usize
    }

    /// A sum of products of symbols and functions, with a few coefficients.
    fn expression(&mut self) -> Expr {
        let [a, b, c, d] = x();
        let root = (&a + &b).sqrt();
        let inverse = (&b.square() + &(&c * &d)).recip().expect("not zero");
        let atoms = [a.clone(), b.clone(), c, d, a.sin(), a.cos(), root, inverse];
        let mut sum = Expr::zero();
        for _ in 0..=self.below(9) {
            let coefficient = [-3, -2, -1, -1, 1, 1, 2, 5][self.below(8)];
            let mut term = Expr::fraction(coefficient, 1 + self.below(2) as i64);
            for _ in 0..=self.below(4) {
                term = &term * &atoms[self.below(8)];
            }
            sum += &term;
        }
        sum
    }
}

#[test]
fn programs_of_random_sums_keep_their_values() {
    let mut random = Random(1);
    for _ in 0..300 {
        let expressions: Vec<Expr> = (0..6).map(|_| random.expression()).collect();
        let found = run(&program(vec![], expressions.clone()));
        for (expression, found) in expressions.iter().zip(found) {
            let exact = evaluate_f64(expression, &value_of_symbol);
            let terms = expression.terms().map(|(monomial, coefficient)| {
                evaluate_f64(
                    &Expr::term(coefficient.clone(), monomial.clone()),
                    &value_of_symbol,
                )
            });
            let largest = terms.map(f64::abs).fold(0.0, f64::max);
            // 64 ulp of the largest term: ten terms of five factors, some of them rounded functions, on both sides.
            let bound = 64.0 * f64::EPSILON * largest;
            assert!(
                (found - exact).abs() <= bound,
                "{expression}: {found} for {exact}"
            );
        }
    }
}

#[test]
fn sums_are_shared_across_entries_and_factors() {
    let [a, b, c, d] = x();
    let sum = |factor: &Expr, rest: &Expr| &(&(&a * factor) + &(&b * factor)) + rest;
    // a + b is hidden in each entry behind another factor and another term that holds a.
    let entries = vec![
        sum(&c, &(&a * &d)),
        sum(&d, &(&a * &c)),
        sum(&(&c * &d), &(&a * &b)),
    ];
    let counts = Counts::of_program(&program(vec![], entries));
    // a + b, and one addition for each entry.
    assert_eq!(counts.additions, 4);
}

#[test]
fn from_three_quotients_on_one_reciprocal_serves() {
    let [a, b, c, d] = x();
    let inverse = (&a + &b).sqrt().recip().expect("not zero");
    let divisions = |entries: Vec<Expr>| Counts::of_program(&program(vec![], entries)).divisions;
    assert_eq!(divisions(vec![&a * &inverse, &b * &inverse]), 2);
    assert_eq!(
        divisions(vec![&a * &inverse, &c * &inverse, &d * &inverse]),
        1
    );
}

#[test]
fn products_in_sums_are_fused_and_differences_of_two_products_are_not() {
    let [a, b, c, d] = x();
    let fused = |expression: &Expr| Counts::of(&factored(expression)).fused;
    assert_eq!(fused(&(&(&a * &b) + &(&c * &d))), 1);
    assert_eq!(fused(&(&(&a * &b) - &(&c * &d))), 0);
    assert_eq!(fused(&(&Expr::one() - &(&c * &d))), 1);
    assert_eq!(fused(&(&a - &b)), 0);
}
