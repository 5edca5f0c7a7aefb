//! Kernels with exponentials, as they are written, in doubles: finite and right wherever their value is a double.
//!
//! The reference is each kernel's expression before it was written, in enough bits for all that cancels.

use hamel_codegen::derived::{Derived, Kernel, Step};
use hamel_codegen::expr::{Expr, Number, Symbol};
use hamel_codegen::formula::{Binding, Node};
use hamel_codegen::precise::Precise;
use std::collections::BTreeMap;

/// Terms of order 1 cancel to what is below the smallest double, 2⁻¹⁰⁷⁴, with 900 bits left.
const BITS: usize = 2048;
/// Units in the last place of the entry.
const BOUND: f64 = 16.0;
/// Arguments of the exponentials.
const ARGUMENTS: [f64; 11] = [
    0.0, 1e-9, -1e-9, 1.0, -1.0, 7.2, -7.2, 720.0, -720.0, 1e4, -1e4,
];

/// A carriage on a path of this height over `u`, the place in units of `scale`.
fn ramp(height: &str) -> Derived {
    let height = height.replace('u', "(x / scale)");
    let text = format!(
        "hamel = 1;\n/// Ramp.\njoint ramp(scale: m > 0) {{ config x: R1; H = trans([x, 0, scale * {height}]); }}"
    );
    hamel_codegen::derive(&text, "ramp.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

/// Values of symbols: the place and the scale, and some number for each other.
struct At {
    scale: f64,
    place: f64,
}

impl At {
    fn value(&self, symbol: &Symbol) -> f64 {
        match symbol.name() {
            "scale" => self.scale,
            "x" => self.place,
            _ => 0.75 - 0.25 * f64::from(symbol.index),
        }
    }
}

/// A formula in doubles.
fn value(node: &Node, known: &BTreeMap<Symbol, f64>, at: &impl Fn(&Symbol) -> f64) -> f64 {
    let of = |part: &Node| value(part, known, at);
    match node {
        Node::Number(number) => 1.0.rational(number),
        Node::Pi => std::f64::consts::PI,
        Node::Symbol(symbol) => {
            let known = known.get(symbol).copied();
            known.unwrap_or_else(|| at(symbol))
        }
        Node::Sum(terms) => terms
            .iter()
            .map(|(minus, term)| if *minus { -of(term) } else { of(term) })
            .sum(),
        Node::Product(factors) => factors.iter().map(of).product(),
        Node::Quotient(above, below) => of(above) / of(below),
        Node::Negative(inner) => -of(inner),
        Node::Call(function, arguments) => {
            let arguments: Vec<f64> = arguments.iter().map(of).collect();
            1.0.function(*function, &arguments)
        }
    }
}

/// The entries of a kernel as it is written.
fn evaluated(derived: &Derived, kernel: &Kernel, at: &impl Fn(&Symbol) -> f64) -> Vec<f64> {
    let program = derived.program(kernel);
    let mut known = BTreeMap::new();
    for binding in &program.bindings {
        match binding {
            Binding::Value { name, value: of } => {
                let number = value(of, &known, at);
                known.insert(name.clone(), number);
            }
            other => panic!("{other:?}"),
        }
    }
    let outputs = program.outputs.iter();
    outputs.map(|node| value(node, &known, at)).collect()
}

/// The entries of a kernel before it was written.
fn entries(kernel: &Kernel) -> Vec<Expr> {
    let mut lines = BTreeMap::new();
    for step in &kernel.steps {
        let Step::Let(name, value) = step else {
            panic!("{step:?}");
        };
        let value = value.substitute(&lines);
        lines.insert(name.clone(), value);
    }
    let entries = kernel.outputs.iter().flat_map(|matrix| matrix.entries());
    entries.map(|entry| entry.substitute(&lines)).collect()
}

/// Distance from a number to the next.
fn ulp(number: f64) -> f64 {
    let size = number.abs().min(f64::MAX.next_down());
    size.next_up() - size
}

/// All kernels at all arguments; `exact` where the division by the scale is.
fn check(height: &str, scale: f64, exact: bool) {
    let derived = ramp(height);
    let mut faults = vec![];
    let place = |s: &&Symbol| s.name() == "x";
    for kernel in &derived.kernels {
        for (i, entry) in entries(kernel).iter().enumerate() {
            let by_place = entry
                .symbols()
                .iter()
                .find(place)
                .map(|x| entry.derivative(x));
            for argument in ARGUMENTS {
                let at = At {
                    scale,
                    place: argument * scale,
                };
                let precise = |expression: &Expr| {
                    let symbol = |s: &Symbol| Precise::from_f64(at.value(s), BITS);
                    expression.evaluate(&Precise::integer(1, BITS), &symbol)
                };
                let expected = precise(entry);
                // A factor beyond the range may be divided by scale².
                if expected.to_f64().abs() >= f64::MAX / (scale * scale).max(1.0) {
                    continue;
                }
                let found = evaluated(&derived, kernel, &|s: &Symbol| at.value(s))[i];
                let error = (Precise::from_f64(found, BITS) - expected.clone())
                    .abs()
                    .to_f64();
                // A factor below the normal numbers has lost digits before it is divided by scale².
                let factor = scale.max(1.0 / (scale * scale));
                let unit = ulp(expected.to_f64()).max(f64::from_bits(1) * factor);
                // Three roundings: of the place, of the quotient and of its multiples.
                let moved = by_place.as_ref().filter(|_| !exact);
                let moved = moved.map_or(0.0, |slope| (precise(slope).to_f64() * at.place).abs());
                let bound = BOUND * unit + 3.0 * f64::EPSILON * moved;
                let right = error <= bound;
                if !right {
                    let kind = kernel.kind;
                    let expected = expected.to_f64();
                    let ulps = error / unit;
                    faults.push(format!(
                        "{kind:?}[{i}] at {argument}: {found:e} for {expected:e}, {ulps:.1} ulp"
                    ));
                }
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{height}, scale {scale}\n{}",
        faults.join("\n")
    );
}

/// One test a form: with scales that divide exactly, and one that does not.
macro_rules! forms {
    ($($name:ident: $height:literal,)*) => {$(
        #[test]
        fn $name() {
            check($height, 1.0, true);
            check($height, 128.0, true);
            check($height, 0.005, false);
        }
    )*};
}

forms! {
    hyperbolic_tangent: "tanh(u)",
    hyperbolic_secant: "1 / cosh(u)",
    hyperbolic_sine: "sinh(u)",
    hyperbolic_cosine: "cosh(u)",
    sine_over_cosine: "sinh(u) / cosh(u)",
    logarithm_of_the_cosine: "log(cosh(u))",
    softplus: "log(1 + exp(u))",
    softplus_of_a_multiple: "log(1 + 3 * exp(u - 3))",
    softplus_falling: "log(exp(-u) + 1)",
    softplus_of_the_sum_of_two: "log(exp(u) + exp(-2 * u))",
    logarithm_of_three: "log(exp(u) + 1 + exp(2 * u))",
    logistic: "1 / (1 + exp(-u))",
    logistic_other: "exp(u) / (1 + exp(u))",
    logistic_slope: "exp(u) / pow(1 + exp(u), 2)",
    half_of_the_tangent: "exp(u) / (exp(u) + exp(-u))",
    root: "sqrt(1 + exp(2 * u))",
    root_below: "1 / sqrt(1 + exp(u))",
    root_of_the_sine: "cosh(u) / sqrt(1 + sinh(u) * sinh(u))",
    opposed: "exp(u) / exp(2 * u) * exp(u)",
    weighted: "exp(u) / (3 + 2 * exp(u))",
    nested: "log(2 + 1 / (1 + exp(u)))",
    difference: "log(exp(u) + 1 - exp(u) / (1 + exp(u)))",
    gudermannian: "atan(sinh(u))",
    fading_path: "1 / sqrt(1 + tanh(u) * tanh(u))",
    of_both_kinds: "exp(u) / cosh(u)",
    root_of_a_quotient: "sqrt(2 + exp(u) / (1 + exp(u)))",
    steep: "1 / (1 + exp(3 * u) + exp(u))",
}

/// Sums of exponentials of two coordinates: no scale is that of one term, and exponentials overflow together or against one another.
#[test]
fn sums_over_a_plane_stay_finite() {
    let heights = [
        "log(1 + exp(u) + 2 * exp(w) + exp(u - 3 * w))",
        "1 / sqrt(1 + exp(u) + exp(w))",
        "exp(u) / (exp(u) + exp(w)) / (1 + exp(w))",
        "sinh(u) / (1 + exp(u) + exp(w))",
    ];
    for height in heights {
        let text = format!(
            "hamel = 1;\n/// Dome.\njoint dome {{ config u: R1, w: R1; H = trans([u, w, {height}]); }}"
        );
        let derived = hamel_codegen::derive(&text, "dome.joint");
        let derived = derived.unwrap_or_else(|errors| panic!("{errors}"));
        for kernel in &derived.kernels {
            let entries = entries(kernel);
            for (u, w) in [-720.0, -7.2, 0.0, 1.0, 720.0, 1e4]
                .into_iter()
                .flat_map(|u| [-1e4, -720.0, 7.2, 800.0].map(|w| (u, w)))
            {
                let at = |s: &Symbol| match s.name() {
                    "u" => u,
                    "w" => w,
                    _ => 0.75 - 0.25 * f64::from(s.index),
                };
                let symbol = |s: &Symbol| Precise::from_f64(at(s), BITS);
                let found = evaluated(&derived, kernel, &at);
                for (entry, found) in entries.iter().zip(found) {
                    let expected = entry.evaluate(&Precise::integer(1, BITS), &symbol);
                    let size = expected.to_f64().abs();
                    if size.is_infinite() {
                        continue;
                    }
                    let error = (Precise::from_f64(found, BITS) - expected).abs().to_f64();
                    // Terms of order 1 may cancel.
                    let right = error <= BOUND * f64::EPSILON * size.max(1.0);
                    let kind = kernel.kind;
                    assert!(
                        right,
                        "{height}, {kind:?} at {u}, {w}: {found:e} for {size:e}"
                    );
                }
            }
        }
    }
}
