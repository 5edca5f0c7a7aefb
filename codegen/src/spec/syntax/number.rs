//! Numbers: integers and decimals, exact.

use super::super::{Fallible, code};
use crate::diagnostic::Diagnostic;
use crate::expr::Rational;
use num_bigint::BigInt;
use num_traits::Pow;
use std::ops::Range;

/// Longest number, in digits, and largest power of ten.
const LONGEST: usize = 64;

/// The exact value of a decimal literal.
pub(super) fn rational(text: &str, span: &Range<usize>) -> Fallible<Rational> {
    let wrong = |message: String| Box::new(Diagnostic::new(code::NUMBER, span.clone(), message));
    if text.len() > LONGEST {
        return Err(Box::new(
            wrong(format!("a number of more than {LONGEST} digits")).label("too long"),
        ));
    }
    exact(text).ok_or_else(|| {
        let error = wrong(format!("`{text}` is not a number of the language"));
        Box::new(
            error.label("not a decimal number").help(
                "write digits, a point, an exponent: 12, 0.5, 1e-3; units belong to parameters",
            ),
        )
    })
}

fn exact(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    if whole.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let power = exponent
        .parse::<i32>()
        .ok()?
        .checked_sub(i32::try_from(fraction.len()).ok()?)?;
    if power.unsigned_abs() as usize > LONGEST {
        return None;
    }
    let scale = BigInt::from(10).pow(power.unsigned_abs());
    let digits: BigInt = digits.parse().ok()?;
    Some(match power < 0 {
        true => Rational::new(digits, scale),
        false => Rational::from_integer(digits * scale),
    })
}
