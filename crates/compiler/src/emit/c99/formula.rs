//! Formulas in C.

use super::super::array;
use super::super::lines::{Formula, Place};
use super::lanes::LANES;
use crate::alike::Read;
use hamel_codegen::expr::Function as Known;
use hamel_codegen::expr::curve::Curve;

/// A formula where nothing stands beside it.
pub fn value(formula: &Formula) -> String {
    match formula {
        Formula::Number(number) => literal(*number),
        Formula::Column(column) => format!("numbers[{column}]"),
        Formula::Input(array, place) => format!("{}[{}]", input(*array), index(*place)),
        Formula::Lane(array, place) => match LANES * place {
            0 => format!("{array}[lane]"),
            first => format!("{array}[{first} + lane]"),
        },
        Formula::Source(name, entry) => format!("{name}[{entry}]"),
        Formula::Row(width, row, entry) => format!("{}[{row}][{entry}]", array(*width)),
        Formula::Name(name) => name.clone(),
        Formula::Sum(terms) => sum(terms),
        Formula::Product(a, b) => format!("{} * {}", left_factor(a), factor(b)),
        Formula::Quotient(a, b) => format!("{} / {}", left_factor(a), factor(b)),
        Formula::Negative(inner) => format!("-{}", factor(inner)),
        Formula::Call(function, arguments) => call(*function, arguments),
        Formula::Part(of, result) => format!("{}[{result}]", value(of)),
        // A line of its own, which calls a helper; of functions in Rust alone.
        Formula::Several(..) | Formula::Gathered(_) => literal(f64::NAN),
    }
}

/// A number, by the fewest digits that give it back.
pub fn literal(number: f64) -> String {
    match number {
        number if number.is_nan() => "NAN".to_owned(),
        number if number.is_infinite() && number < 0.0 => "-INFINITY".to_owned(),
        number if number.is_infinite() => "INFINITY".to_owned(),
        number => format!("{number:?}"),
    }
}

/// Name of an array that is read.
fn input(array: Read) -> &'static str {
    match array {
        Read::Argument(argument) => argument.name(),
        Read::Sines => "sines",
        Read::Cosines => "cosines",
    }
}

/// An index.
pub fn index(place: Place) -> String {
    let shifted = |base: String, offset: i64| match offset {
        0 => base,
        offset if offset < 0 => format!("{base} - {}", -offset),
        offset => format!("{base} + {offset}"),
    };
    match place {
        Place::Known(place) => place.to_string(),
        Place::Along { start, step } if step < 0 => format!("{start} - {} * i", -step),
        Place::Along { start, step: 1 } => shifted("i".to_owned(), start),
        Place::Along { start, step } => shifted(format!("{step} * i"), start),
        Place::Listed { column, offset } => shifted(format!("places[{column}]"), offset),
    }
}

/// A formula as a factor.
fn factor(formula: &Formula) -> String {
    let plain = value(formula);
    let stands_alone = match formula {
        Formula::Number(number) => number.is_sign_positive(),
        Formula::Call(..) => true,
        // Written as a call where it ends with a product.
        Formula::Sum(terms) => adds_product(terms),
        other => !other.computes(),
    };
    match stands_alone {
        true => plain,
        false => format!("({plain})"),
    }
}

/// The same as the first of several factors: they are taken from the left.
fn left_factor(formula: &Formula) -> String {
    match formula {
        Formula::Product(..) | Formula::Quotient(..) => value(formula),
        other => factor(other),
    }
}

/// Whether the last step of a sum is a multiply–add.
pub fn adds_product(terms: &[(bool, Formula)]) -> bool {
    let last = Formula::in_order(terms).into_iter().skip(1).last();
    last.is_some_and(|(_, term)| matches!(term, Formula::Product(..)))
}

/// Terms that are products are added by multiply–adds.
fn sum(terms: &[(bool, Formula)]) -> String {
    let mut terms = Formula::in_order(terms).into_iter();
    let Some((minus, first)) = terms.next() else {
        return literal(0.0);
    };
    let start = match minus {
        true => format!("-{}", factor(first)),
        false => value(first),
    };
    terms.fold(start, |sum, (minus, term)| match (term, minus) {
        (Formula::Product(a, b), true) => format!("mul_add(-{}, {}, {sum})", factor(a), value(b)),
        (Formula::Product(a, b), false) => format!("mul_add({}, {}, {sum})", value(a), value(b)),
        (term, true) => format!("{sum} - {}", factor(term)),
        (term, false) => format!("{sum} + {}", factor(term)),
    })
}

/// The function of a curve, of an argument and the order of a derivative.
pub fn curve_name(curve: Curve) -> String {
    format!("curve_{}", curve.distinct_name())
}

fn call(function: Known, arguments: &[Formula]) -> String {
    let mut arguments: Vec<String> = arguments.iter().map(value).collect();
    if let Known::Curve(curve, order) = function {
        arguments.push(order.to_string());
        return format!("{}({})", curve_name(curve), arguments.join(", "));
    }
    let name = match function {
        Known::Sin => "sin",
        Known::Cos => "cos",
        Known::Exp => "exp",
        Known::Sinh => "sinh",
        Known::Cosh => "cosh",
        Known::Sech => "sech",
        Known::Tanh => "tanh",
        Known::LnCosh => "ln_cosh",
        Known::Ln => "log",
        Known::Ln1p => "ln_1p_scaled",
        Known::Larger => "fmax",
        Known::Sqrt => "sqrt",
        Known::Atan2 => "atan2",
        Known::Stumpff(order) => {
            arguments.push(order.to_string());
            "stumpff"
        }
        Known::DexpInverse(order) => {
            arguments.push(order.to_string());
            "dexp_inverse"
        }
        // Folded when the graph was made.
        Known::Pi | Known::Recip | Known::Group => "",
        // Above.
        Known::Curve(..) => "",
    };
    format!("{name}({})", arguments.join(", "))
}
