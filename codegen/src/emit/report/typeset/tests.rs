//! Expressions that are easily set wrongly, in all three forms.

use super::{Math, composed, named};
use crate::expr::{Expr, Rational, Role, Symbol};
use crate::formula::factored;

fn symbol(name: &str) -> Expr {
    let index = name.bytes().next().unwrap_or_default();
    Expr::symbol(&Symbol::new(Role::Coordinate, index.into(), name))
}

fn set(expression: &Expr) -> Math {
    let node = factored(expression).polished();
    composed(&node, &|symbol| named(symbol.name()))
}

fn recip(expression: &Expr) -> Expr {
    expression.recip().expect("not zero")
}

/// Each expression with its text and its LaTeX.
fn corpus() -> Vec<(Expr, &'static str, &'static str)> {
    let (a, b, c) = (symbol("a"), symbol("b"), symbol("c"));
    let (one, half) = (Expr::one(), Expr::fraction(1, 2));
    vec![
        (Expr::zero(), "0", "0"),
        (-&a, "−a", "-a"),
        (&b - &a, "b − a", "b - a"),
        (-(&a + &b), "−(a + b)", r"-\left(a + b\right)"),
        (&a * &(&b - &c), "a (b − c)", r"a\,\left(b - c\right)"),
        (&a * &a.square(), "a³", "{a}^{3}"),
        (half.clone(), "½", r"\tfrac{1}{2}"),
        (-(&half * &a), "−½ a", r"-\tfrac{1}{2}\,a"),
        (recip(&a), "1 / a", r"\frac{1}{a}"),
        (
            &(&half * &a) * &recip(&(&b + &c)),
            "a / (2 (b + c))",
            r"\frac{a}{2\,\left(b + c\right)}",
        ),
        (
            recip(&(&one + &recip(&(&a + &b)))),
            "1 / (1 + 1 / (a + b))",
            r"\frac{1}{1 + \frac{1}{a + b}}",
        ),
        (
            recip(&(&a + &b)).square(),
            "1 / (a + b)²",
            r"\frac{1}{{\left(a + b\right)}^{2}}",
        ),
        (
            (&one + &(&a + &one).sqrt()).sqrt(),
            "√(1 + √(1 + a))",
            r"\sqrt{1 + \sqrt{1 + a}}",
        ),
        (
            &a.cos().square() * &b,
            "b cos² a",
            r"b\,{\mathrm{cos}}^{2}\,a",
        ),
        (
            (&a + &Expr::pi()).exp(),
            "exp(π + a)",
            r"\mathrm{exp}\left(\pi  + a\right)",
        ),
        (
            a.atan2(&(&b - &c)),
            "atan2(a, b − c)",
            r"\mathrm{atan2}\left(a, b - c\right)",
        ),
        (
            &symbol("theta_2") * &symbol("r_outer"),
            "r_outer θ₂",
            r"{r}_{\mathrm{outer}}\,{\theta }_{2}",
        ),
        (&symbol("lead") * &a, "a lead", r"a\,\mathrm{lead}"),
    ]
}

#[test]
fn text_and_latex_are_as_a_mathematician_writes_them() {
    for (expression, text, latex) in corpus() {
        let math = set(&expression);
        assert_eq!(math.text(), text, "{expression}");
        assert_eq!(math.latex(), latex, "{expression}");
    }
}

#[test]
fn mathml_shows_the_same_structure() {
    let (a, b) = (symbol("a"), symbol("b"));
    let root = (&a + &Expr::one()).sqrt();
    assert_eq!(
        set(&root).mathml(),
        "<msqrt><mrow><mn>1</mn><mo form=\"infix\">+</mo><mi>a</mi></mrow></msqrt>"
    );
    let quotient = &(-&a) * &recip(&b).square();
    assert_eq!(
        set(&quotient).mathml(),
        "<mrow><mo form=\"prefix\">−</mo><mfrac><mi>a</mi><msup><mi>b</mi><mn>2</mn></msup></mfrac></mrow>"
    );
}

#[test]
fn indices_and_marks_stay_apart() {
    let speed = Math::Letter('v')
        .marked(super::Mark::Bar)
        .with_index(Math::integer(2));
    assert_eq!(speed.text(), "v\u{304}₂");
    assert_eq!(speed.latex(), r"{\bar{v}}_{2}");
    let inverse = Math::Letter('S').with_index(Math::integer(0)).inverse();
    assert_eq!(inverse.text(), "S₀⁻¹");
    assert_eq!(inverse.latex(), "{S}_{0}^{-1}");
    assert_eq!(named("x_dot").text(), "x_dot");
    assert_eq!(named("l12").latex(), "{l}_{12}");
}

#[test]
fn short_decimals_are_written_as_such() {
    let number = |above: i64, below: i64| Math::Number(Rational::new(above.into(), below.into()));
    let [decimal, fraction, third] = [number(177, 10_000), number(5, 12), number(1, 3000)];
    assert_eq!([decimal.text(), decimal.latex()], ["0.0177", "0.0177"]);
    assert_eq!(decimal.mathml(), "<mn>0.0177</mn>");
    assert_eq!([fraction.text(), third.text()], ["(5/12)", "(1/3000)"]);
}
