//! Elementary functions of scalars, in terms of those that expressions know.

use super::super::value::Value;
use super::super::{Fallible, limits};
use super::function::Call;
use crate::domain::{ConstantSign, sign_of_constant};
use crate::expr::{Expr, Rational};
use num_traits::{One, ToPrimitive};

/// Functions of one scalar.
pub(super) fn of_one(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let [Value::Scalar(x)] = arguments else {
        return Err(call.refuse("one scalar", arguments));
    };
    let value = match call.name {
        "sin" => call.cos_sin(x)?.1,
        "cos" => call.cos_sin(x)?.0,
        "tan" => {
            let (cos, sin) = call.cos_sin(x)?;
            quotient(call, &sin, &cos)?
        }
        "exp" => x.exp(),
        "sqrt" => root(call, x)?,
        "log" if x.is_zero() || is_negative(x) => {
            return Err(call.undefined("logarithm of a number that is not positive"));
        }
        "log" => x.ln(),
        "asin" | "acos" | "atan" => inverse(call, x)?,
        "sinh" => x.sinh(),
        "cosh" => x.cosh(),
        _ => x.tanh(),
    };
    Ok(Value::Scalar(value))
}

/// Whether a number is below 0; false for what depends on symbols, and for a number of which the sign is undecided.
pub(super) fn is_negative(x: &Expr) -> bool {
    match x.as_rational() {
        Some(number) => number.is_negative(),
        None => sign_of_constant(x) == Some(ConstantSign::Negative),
    }
}

fn root(call: &Call<'_>, x: &Expr) -> Fallible<Expr> {
    match is_negative(x) {
        true => Err(call.undefined("square root of a negative number")),
        false => Ok(x.sqrt()),
    }
}

/// asin, acos and atan, by atan2.
fn inverse(call: &Call<'_>, x: &Expr) -> Fallible<Expr> {
    if call.name == "atan" {
        return Ok(x.atan2(&Expr::one()));
    }
    let square = &Expr::one() - &x.square();
    if is_negative(&square) {
        return Err(call.undefined(&format!("`{}` of a number outside −1 … 1", call.name)));
    }
    let other = square.sqrt();
    Ok(match call.name {
        "asin" => x.atan2(&other),
        _ => other.atan2(x),
    })
}

/// `atan2(y, x)` and `pow(x, n)`.
pub(super) fn of_two(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let [Value::Scalar(first), Value::Scalar(second)] = arguments else {
        return Err(call.refuse("two scalars", arguments));
    };
    match call.name {
        "atan2" if first.is_zero() && second.is_zero() => {
            Err(call.undefined("atan2(0, 0) is no angle"))
        }
        "atan2" => Ok(Value::Scalar(first.atan2(second))),
        _ => match second.as_rational() {
            Some(exponent) => Ok(Value::Scalar(power(call, first, &exponent)?)),
            None => Err(call.refuse("a scalar and a number as exponent", arguments)),
        },
    }
}

/// `x` to an integer, by products; to a multiple of ½, by the root; to another fraction, by exp and log.
fn power(call: &Call<'_>, x: &Expr, exponent: &Rational) -> Fallible<Expr> {
    let size = exponent.abs();
    let limit = Rational::from_integer(limits::LARGEST_POWER.into());
    if size > limit || size.denom() > limits::LARGEST_POWER.into() {
        let message = format!(
            "the exponent {exponent}: numerators and denominators go up to {}",
            limits::LARGEST_POWER
        );
        return Err(call.undefined(&message));
    }
    if is_negative(x) && !size.is_integer() {
        return Err(call.undefined("a broken power of a negative number"));
    }
    let times = size.numer().to_u32().unwrap_or(0);
    let value = match size.denom() {
        one if one.is_one() => x.pow(times),
        two if two == 2.into() => x.sqrt().pow(times),
        _ => (&x.ln() * &Expr::rational(size)).exp(),
    };
    match exponent.is_negative() {
        true => quotient(call, &Expr::one(), &value),
        false => Ok(value),
    }
}

fn quotient(call: &Call<'_>, a: &Expr, b: &Expr) -> Fallible<Expr> {
    let inverse = b
        .recip()
        .ok_or_else(|| call.undefined("division by zero"))?;
    Ok(a * &inverse)
}
