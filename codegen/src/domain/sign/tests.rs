//! What the signs of expressions are taken to be.

use crate::domain::Domain;
use crate::expr::Expr;
use crate::model::ConfigurationSpace;
use crate::spec;

fn check(parameters: &str, pose: &str) -> bool {
    check_with(parameters, "", pose)
}

fn check_with(parameters: &str, require: &str, pose: &str) -> bool {
    check_by(parameters, require, pose, |domain, e| domain.is_positive(e))
}

fn check_by(
    parameters: &str,
    require: &str,
    pose: &str,
    is_positive: impl Fn(&Domain<'_>, &Expr) -> bool,
) -> bool {
    let source = format!(
        "hamel = 1;\njoint test{parameters} {{ {require} config q: R1; H = trans_z({pose} + 0 * q); }}"
    );
    let joint = spec::parse(&source, "test.joint").expect("a valid spec");
    let expression: Expr = joint.pose.value.translation.at(2, 0).clone();
    let space = ConfigurationSpace::declared(&joint);
    is_positive(&Domain::new(&space), &expression)
}

#[test]
fn constants_outweigh_bounded_terms() {
    assert!(check("", "2 + sin(q)"));
    assert!(!check("", "1 + sin(q)"));
    assert!(!check("", "2 + q"));
    assert!(check("", "pi - 3"));
    assert!(!check("", "3 - pi"));
}

#[test]
fn even_powers_and_exponentials_are_not_negative() {
    assert!(check("", "1 + q * q"));
    assert!(!check("", "q * q"));
    assert!(check("", "cosh(q)"));
    assert!(check("(a: 1)", "a * a + q * q"));
    assert!(!check("(a: 1)", "a + q * q"));
    assert!(check(
        "(a: 1 > 0)",
        "1 + a * q * q / sqrt(q * q + a * a) / (q * q + a * a)"
    ));
    assert!(check("", "sqrt(1 + q * q)"));
    assert!(!check("", "sqrt(q * q)"));
}

#[test]
fn a_parameter_that_may_vanish_has_squares_that_may() {
    assert!(!check("(a: 1 >= 0)", "a * a + q * q"));
    assert!(check("(a: 1 >= 0)", "1 + a + a * a * a * q * q"));
    assert!(!check("(a: 1 <= 0)", "1 + a"));
}

/// By the discriminant, or at both ends of what is between them.
#[test]
fn quadratic_polynomials_in_one_function_have_the_sign_of_their_discriminant() {
    let two = "(p: 1 > 0, r: 1 > 0)";
    for (parameters, require, pose, is_positive) in [
        (two, "", "(p + r * cos(q)) * (p + r * cos(q)) + r * r", true),
        (two, "", "(p + r * cos(q)) * (p + r * cos(q))", false),
        ("(p: 1 > 0)", "", "q * q + 2 * p * q + 2 * p * p", true),
        ("(p: 1 > 0)", "", "q * q + 2 * p * q + p * p", false),
        (
            "(p: 1 > 0, r: 1 > 0, e: 1 > 0)",
            "require p > r + e;",
            "p * p - (r * sin(q) + e) * (r * sin(q) + e)",
            true,
        ),
        (
            "(p: 1 > 0, r: 1 > 0, e: 1 > 0)",
            "require p > r;",
            "p * p - (r * sin(q) + e) * (r * sin(q) + e)",
            false,
        ),
        ("(p: 1 > 0)", "", "3 * p * p + p * q - q * q", false),
        (
            two,
            "require p > r;",
            "(p * p + p * r * sin(q)) / (p * p + 2 * p * r * sin(q) + r * r)",
            true,
        ),
        (
            two,
            "",
            "(p * p + p * r * sin(q)) / (p * p + 2 * p * r * sin(q) + r * r)",
            false,
        ),
        ("", "", "2 * cosh(q) - 1.99", true),
        ("", "", "2 * cosh(q) - 2", false),
        ("(p: 1 > 0)", "", "p * cosh(q) * cosh(q) - p", false),
        (
            "(p: 1 > 0)",
            "",
            "p * cosh(q) * cosh(q) - 0.5 * p * sin(q)",
            true,
        ),
    ] {
        let found = check_by(parameters, require, pose, |domain, e| {
            domain.is_positive(e) || domain.has_positive_form(e)
        });
        assert_eq!(found, is_positive, "{parameters} {require} {pose}");
    }
}

/// Ends below 0, and requirements on parameters of either sign.
#[test]
fn parameters_of_unknown_sign_have_their_conditions() {
    for (parameters, require, pose, is_positive) in [
        ("(p: 1 > -1)", "", "1 + p", true),
        ("(p: 1 > -1)", "", "p + 0.9", false),
        ("(p: 1 >= -1)", "", "1 + p", false),
        ("(p: 1 > -2 < 2)", "", "4 - p * p", true),
        ("(p: 1 > -2 < 2)", "", "3.9 - p * p", false),
        ("(p: 1 > -1 < 1)", "", "1 + p * cos(q)", true),
        ("(p: 1 > -1)", "", "1 + p * cos(q)", false),
        ("(p: 1 > -1 < 1.1)", "", "1 + p * cos(q)", false),
        (
            "(p: 1 > -1 < 1, r: 1 > -1 < 1)",
            "",
            "2 + p * cos(q) - r * sin(2 * q)",
            true,
        ),
        (
            "(p: 1 > -1 < 1, r: 1 > -1 < 1)",
            "",
            "1.7 + p * cos(q) - r * sin(2 * q)",
            false,
        ),
        ("(p: 1)", "require p > -2;", "p + 3", true),
        ("(p: 1)", "require p > -2;", "p + 1", false),
        ("(p: 1, r: 1)", "require p + r > 0;", "p + r", true),
        ("(p: 1, r: 1)", "require p + r > 0;", "p - r", false),
        ("(p: 1, r: 1)", "require p * r > 0;", "1 + p * r", true),
        ("(p: 1, r: 1)", "require p * r > 1;", "p * r - 0.5", true),
        ("(p: 1, r: 1)", "require p * r > 1;", "p + r", false),
        (
            "(p: 1 > 0, r: 1 >= -1 <= 1)",
            "require p > 1;",
            "p + r",
            true,
        ),
        (
            "(p: 1 > 0, r: 1 >= -1 <= 1)",
            "require p > 0.5;",
            "p + r",
            false,
        ),
    ] {
        let found = check_with(parameters, require, pose);
        assert_eq!(found, is_positive, "{parameters} {require} {pose}");
    }
}

#[test]
fn conditions_between_parameters_are_multiplied_out() {
    for (parameters, require, pose) in [
        (
            "(a: 1 > 0, b: 1 > 0)",
            "require a > b;",
            "a * a - b * b * sin(q) * sin(q)",
        ),
        (
            "(a: 1 > 0, b: 1 > 0)",
            "require a > b;",
            "1 - b * b / (a * a) * sin(q) * sin(q)",
        ),
        (
            "(a: 1 > 0, b: 1 > 0, c: 1 > 0)",
            "require a > b + c;",
            "a - c * sin(q) + b * cos(q)",
        ),
        ("(a: 1 in 0..1)", "", "1 - a * a * cos(q)"),
        ("(a: 1 > 2)", "", "a - 2 * sin(q)"),
    ] {
        assert!(check_with(parameters, require, pose), "{pose}");
    }
    assert!(!check_with("(a: 1 in 0..=1)", "", "1 - a * cos(q)"));
    assert!(!check_with(
        "(a: 1 > 0, b: 1 > 0)",
        "require a > b;",
        "a - b * sin(q) - b * cos(q)"
    ));
}

#[test]
fn functions_of_parameters_have_the_signs_of_their_ranges() {
    assert!(check("(a: rad > 0 < 1.5)", "cos(a) / sin(a) + q * q"));
    assert!(check("(a: rad in -1..1)", "cos(3/2 * a)"));
    assert!(!check("(a: rad in -1..1)", "sin(a)"));
    assert!(!check("(a: rad > 0 < 1.6)", "cos(a)"));
    assert!(!check("(a: rad > 0)", "sin(a)"));
}

/// |(a, b) · n| ≤ √(a² + b²) for a unit vector n.
#[test]
fn unit_vectors_bound_what_is_linear_in_them() {
    assert!(check("", "3/2 + sin(q) + cos(q)"));
    assert!(!check("", "sqrt(2) + sin(q) + cos(q)"));
    assert!(check_with(
        "(a: 1 > 0, b: 1 > 0, c: 1 > 0)",
        "require c * c > a * a + b * b;",
        "c + a * sin(q) + b * cos(q)"
    ));
    assert!(!check(
        "(a: 1 > 0, b: 1 > 0, c: 1 > 0)",
        "c + a * sin(q) + b * cos(q)"
    ));
}

#[test]
fn expressions_of_few_bounded_variables_are_bounded_on_cells() {
    assert!(check("", "3 + cos(q) + cos(2 * q) + cos(3 * q)"));
    assert!(!check("", "1 + cos(q) + cos(2 * q)"));
    assert!(check(
        "(a: 1 in 0..=1)",
        "2 + a * cos(q) * sin(3 * q) - a * a / 2"
    ));
    assert!(!check("(a: 1 in 0..=1)", "1 + a * cos(q)"));
}

#[test]
fn powers_of_sines_are_bounded_by_those_of_multiples() {
    let positive = "(a: 1 > 0, b: 1 > 0)";
    // r² + r'² of r = a + b cos 2q is at least (a − b)².
    let arc = "pow(a + b * cos(2 * q), 2) + pow(2 * b * sin(2 * q), 2)";
    assert!(check_with(positive, "require a > b;", arc));
    assert!(!check_with(
        positive,
        "",
        "pow(a + b * cos(q), 2) + pow(b * sin(q), 2)"
    ));
    assert!(check(
        positive,
        "a * a * cos(q) * cos(q) + b * b * sin(q) * sin(q)"
    ));
    assert!(!check(
        positive,
        "a * a * cos(q) * cos(q) - b * b * sin(q) * sin(q)"
    ));
    assert!(check(
        positive,
        "1 + pow(a * (cos(q) * cos(q) - sin(q) * sin(q)) / b, 2)"
    ));
    assert!(check("", "3 - 4 * sin(q) * cos(q)"));
    assert!(!check("", "2 - 4 * sin(q) * cos(q)"));
    assert!(!check("", "1.9999 - 4 * sin(q) * cos(q)"));
    assert!(check(
        "(bend: rad in 0..1)",
        "cos(bend) * cos(q) * cos(q) + sin(q) * sin(q)"
    ));
    assert!(!check(
        "(bend: rad in 0..2)",
        "cos(bend) * cos(q) * cos(q) + sin(q) * sin(q)"
    ));
}

#[test]
fn squares_of_what_has_a_sign_are_positive() {
    assert!(check("", "pow(1.0000000001 + sin(q), 2)"));
    assert!(!check("", "pow(0.9999999999 + sin(q), 2)"));
}
