//! Signs of real constants such as `exp(5) - 148`: by enclosures in more and more bits, never by doubles.

use crate::expr::Expr;
use crate::precise::Enclosure;

/// Bits of the enclosures, one after the other.
const PRECISIONS: [usize; 4] = [128, 512, 1024, 4096];
/// Bits of the last enclosure, from which on a sign is called undecided.
pub const LAST_PRECISION: usize = PRECISIONS[PRECISIONS.len() - 1];

/// What is known of a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstantSign {
    /// An enclosure lies above 0.
    Positive,
    /// An enclosure lies below 0.
    Negative,
    /// Every enclosure holds 0, or the constant has no value.
    Undecided,
}

/// The sign of an expression without symbols; `None` for others.
pub fn sign(expression: &Expr) -> Option<ConstantSign> {
    if !expression.symbols().is_empty() {
        return None;
    }
    let found = PRECISIONS.iter().find_map(|bits| {
        let value = Enclosure::new(*bits).of(expression);
        match (value.is_positive(), value.is_negative()) {
            (true, _) => Some(ConstantSign::Positive),
            (_, true) => Some(ConstantSign::Negative),
            _ => None,
        }
    });
    Some(found.unwrap_or(ConstantSign::Undecided))
}

#[cfg(test)]
mod tests {
    use super::{ConstantSign, sign};
    use crate::expr::{Expr, Rational, Role, Symbol};

    fn exp(power: i64) -> Expr {
        Expr::integer(power).exp()
    }

    #[test]
    fn differences_far_below_doubles_have_a_sign() {
        let ten = Rational::from_integer(10.into());
        let tiny = (0..300).fold(Expr::one(), |tiny, _| &tiny * &Expr::rational(ten.recip()));
        let nearly = &(&exp(5) * &exp(23)) - &exp(28);
        assert_eq!(sign(&(&nearly + &tiny)), Some(ConstantSign::Positive));
        assert_eq!(sign(&(&nearly - &tiny)), Some(ConstantSign::Negative));
        assert_eq!(
            sign(&(&Expr::pi() - &Expr::integer(3))),
            Some(ConstantSign::Positive)
        );
        assert_eq!(sign(&exp(-1_000_000)), Some(ConstantSign::Positive));
    }

    #[test]
    fn what_no_number_of_bits_decides_is_undecided() {
        let zero = &(&exp(5) * &exp(23)) - &exp(28);
        assert_eq!(sign(&zero), Some(ConstantSign::Undecided));
        let no_value = Expr::integer(-1).ln();
        assert_eq!(sign(&no_value), Some(ConstantSign::Undecided));
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        assert_eq!(sign(&x), None);
    }
}
