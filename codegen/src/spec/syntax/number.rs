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
pub(in super::super) fn rational(text: &str, span: &Range<usize>) -> Fallible<Rational> {
    let wrong = |message: String| Box::new(Diagnostic::new(code::NUMBER, span.clone(), message));
    if text.len() > LONGEST {
        return Err(Box::new(
            wrong(format!("a number of more than {LONGEST} digits")).label("too long"),
        ));
    }
    let Some((digits, power)) = parts(text) else {
        let error = wrong(format!("`{text}` is not a number of the language"));
        return Err(Box::new(error.label("not a decimal number").help(
            "write digits, a point, an exponent: 12, 0.5, 1e-3; units belong to parameters",
        )));
    };
    let beyond = || {
        let message =
            format!("the last digit of `{text}` stands for a power of ten beyond ±{LONGEST}");
        Box::new(wrong(message).label("out of range"))
    };
    let size = u32::try_from(power.unsigned_abs()).unwrap_or(u32::MAX);
    let scale = match size as usize <= LONGEST {
        true => BigInt::from(10).pow(size),
        false => return Err(beyond()),
    };
    Ok(match power < 0 {
        true => Rational::new(digits, scale),
        false => Rational::from_integer(digits * scale),
    })
}

/// All digits as one whole number, and the power of ten of the last; none where the text is no decimal number.
fn parts(text: &str) -> Option<(BigInt, i64)> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    if whole.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let fraction = i64::try_from(fraction.len()).ok()?;
    let power = exponent.parse::<i64>().ok()?.checked_sub(fraction)?;
    Some((digits.parse().ok()?, power))
}
