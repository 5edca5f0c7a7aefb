//! Expressions as text in the notation of the spec language.

use super::{Atom, Expr, Function, Monomial};
use num_traits::One;
use std::fmt::{Display, Formatter, Result};

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
                (true, _) => write!(f, "{size}")?,
                (false, true) => write!(f, "{monomial}")?,
                (false, false) => write!(f, "{size}*{monomial}")?,
            }
        }
        Ok(())
    }
}

impl Display for Monomial {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut divisors = vec![];
        let mut first = true;
        for (atom, power) in self.factors() {
            if power < 0 {
                divisors.push((atom, -power));
                continue;
            }
            for _ in 0..power {
                f.write_str(if first { "" } else { "*" })?;
                write!(f, "{atom}")?;
                first = false;
            }
        }
        if first {
            f.write_str("1")?;
        }
        for (atom, power) in divisors {
            for _ in 0..power {
                write!(f, "/{atom}")?;
            }
        }
        Ok(())
    }
}

impl Display for Atom {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Symbol(symbol) => f.write_str(&symbol.name),
            Self::Apply(application) => {
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

impl Display for Function {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Pi => f.write_str("pi"),
            Self::Cos => f.write_str("cos"),
            Self::Sin => f.write_str("sin"),
            Self::Exp => f.write_str("exp"),
            Self::Ln => f.write_str("log"),
            Self::Atan2 => f.write_str("atan2"),
            Self::Sqrt => f.write_str("sqrt"),
            Self::Stumpff(order) => write!(f, "stumpff{order}"),
            Self::DexpInverse(order) => write!(f, "dexp_inverse{order}"),
            Self::Recip => f.write_str("recip"),
            Self::Group => Ok(()),
        }
    }
}
