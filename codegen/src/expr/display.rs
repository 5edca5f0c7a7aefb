//! Expressions as text that a spec could hold: messages quote them, and what they quote can be pasted.
//!
//! Functions that arise in derivations alone have names of their own: `stumpff2`, `dexp_inverse1`.

use super::curve::Curve;
use super::{Application, Atom, Expr, Function, Monomial, Rational};
use num_bigint::BigInt;
use num_traits::One;
use std::fmt::{Display, Formatter, Result};

/// Digits of the largest integers that are written out; above, they have exponents.
const LONGEST_INTEGER: usize = 7;

impl Display for Expr {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if self.is_zero() {
            return f.write_str("0");
        }
        for (i, (monomial, coefficient)) in self.terms().rev().enumerate() {
            let sign = match (i, coefficient.is_negative()) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            };
            f.write_str(sign)?;
            let size = coefficient.abs();
            match (monomial.is_one(), size.is_one()) {
                (true, _) => f.write_str(&number(&size))?,
                (false, true) => write!(f, "{monomial}")?,
                (false, false) => write!(f, "{}*{monomial}", number(&size))?,
            }
        }
        Ok(())
    }
}

/// A positive number, with exponents where it or a part of it is long. All digits are there: numbers of specs are exact.
fn number(value: &Rational) -> String {
    match value.is_integer() {
        true => integer(&value.numer()),
        false => format!("{}/{}", integer(&value.numer()), integer(&value.denom())),
    }
}

fn integer(value: &BigInt) -> String {
    let digits = value.to_string();
    if digits.len() <= LONGEST_INTEGER {
        return digits;
    }
    let exponent = digits.len() - 1;
    let (first, rest) = digits.split_at(1);
    match rest.trim_end_matches('0') {
        "" => format!("{first}e{exponent}"),
        rest => format!("{first}.{rest}e{exponent}"),
    }
}

impl Display for Monomial {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut divisors = vec![];
        let mut first = true;
        for (atom, power) in self.factors() {
            match (divisor(atom), power < 0) {
                (Some(of), false) if is_atom(of) => divisors.push((of.to_string(), power)),
                (Some(of), false) => divisors.push((format!("({of})"), power)),
                (_, true) => divisors.push((atom.to_string(), -power)),
                (None, false) => {
                    for _ in 0..power {
                        f.write_str(if first { "" } else { "*" })?;
                        write!(f, "{atom}")?;
                        first = false;
                    }
                }
            }
        }
        if first {
            f.write_str("1")?;
        }
        for (divisor, power) in divisors {
            for _ in 0..power {
                write!(f, "/{divisor}")?;
            }
        }
        Ok(())
    }
}

/// Whether it can be divided by without brackets.
fn is_atom(expression: &Expr) -> bool {
    let mut terms = expression.terms();
    let (Some((monomial, coefficient)), None) = (terms.next(), terms.next()) else {
        return false;
    };
    let mut factors = monomial.factors();
    let only = factors
        .next()
        .is_some_and(|(atom, power)| power == 1 && divisor(atom).is_none());
    only && factors.next().is_none() && coefficient.is_one()
}

/// What a reciprocal divides by: the language has quotients alone.
fn divisor(atom: &Atom) -> Option<&Expr> {
    match atom {
        Atom::Apply(application) => match application.as_ref() {
            Application {
                function: Function::Recip,
                arguments,
                ..
            } => arguments.first(),
            _ => None,
        },
        Atom::Symbol(_) => None,
    }
}

impl Display for Atom {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Symbol(symbol) => f.write_str(symbol.spelling()),
            Self::Apply(application) => {
                if let (Function::Curve(curve, order), [argument]) =
                    (application.function, &application.arguments[..])
                {
                    return write_curve(f, curve, order, argument);
                }
                // Functions that the spec language has no name for, in its words.
                let (before, after) = match application.function {
                    Function::LnCosh => ("log(cosh(", "))"),
                    Function::Sech => ("1/cosh(", ")"),
                    _ => ("", ""),
                };
                if let ([argument], false) = (&application.arguments[..], after.is_empty()) {
                    return write!(f, "{before}{argument}{after}");
                }
                write!(f, "{}", application.function)?;
                if application.arguments.is_empty() {
                    return Ok(());
                }
                f.write_str("(")?;
                for (i, argument) in application.arguments.iter().enumerate() {
                    f.write_str(if i == 0 { "" } else { ", " })?;
                    write!(f, "{argument}")?;
                }
                f.write_str(")")
            }
        }
    }
}

/// `lift(q)`, `derivative(lift, q)`, `derivative(lift, q, 2)`.
fn write_curve(f: &mut Formatter<'_>, curve: Curve, order: u8, argument: &Expr) -> Result {
    let name = curve.name();
    match order {
        0 => write!(f, "{name}({argument})"),
        1 => write!(f, "derivative({name}, {argument})"),
        _ => write!(f, "derivative({name}, {argument}, {order})"),
    }
}

impl Display for Function {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Pi => f.write_str("pi"),
            Self::Cos => f.write_str("cos"),
            Self::Sin => f.write_str("sin"),
            Self::Exp => f.write_str("exp"),
            Self::Sinh => f.write_str("sinh"),
            Self::Cosh => f.write_str("cosh"),
            Self::Sech => f.write_str("sech"),
            Self::Tanh => f.write_str("tanh"),
            Self::LnCosh => f.write_str("log_cosh"),
            Self::Ln => f.write_str("log"),
            Self::Ln1p => f.write_str("log_1p"),
            Self::Larger => f.write_str("max"),
            Self::Atan2 => f.write_str("atan2"),
            Self::Sqrt => f.write_str("sqrt"),
            Self::Stumpff(order) => write!(f, "stumpff{order}"),
            Self::DexpInverse(order) => write!(f, "dexp_inverse{order}"),
            Self::Curve(curve, _) => f.write_str(curve.name()),
            Self::Recip => f.write_str("recip"),
            Self::Group => Ok(()),
        }
    }
}
