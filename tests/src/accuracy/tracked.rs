//! Numbers of 256 bits that know the largest summand they are made of.

use hamel_codegen::expr::{Function, Number, Rational};
use hamel_codegen::precise::Precise;
use num_traits::ToPrimitive;
use std::cell::RefCell;

/// Precision of the reference.
pub const BITS: usize = 256;

/// A value of a definition, with the scale that rounding errors of its evaluation are measured against.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The value.
    pub value: Precise,
    /// The largest summand, |value| or more.
    pub scale: f64,
    /// Whether the value is a double as it stands: an input, or a power of two times one.
    pub exact: bool,
}

impl Tracked {
    /// An input.
    pub fn input(value: f64) -> Self {
        Self {
            value: Precise::from_f64(value, BITS),
            scale: value.abs(),
            exact: true,
        }
    }

    /// A result with the scale given, or its own size where that is larger.
    pub fn computed(value: Precise, scale: f64) -> Self {
        let size = value.to_f64().abs();
        Self {
            scale: larger(size, scale),
            value,
            exact: false,
        }
    }

    /// Whether this is 0 without any summand.
    pub fn is_nothing(&self) -> bool {
        self.exact && self.value.is_zero()
    }

    /// `−self`.
    pub fn negative(&self) -> Self {
        Self {
            value: -&self.value,
            ..self.clone()
        }
    }

    /// The function with value `value` and slope `slope` here.
    pub fn mapped(&self, value: Precise, slope: &Precise) -> Self {
        let moved = match self.exact {
            true => 0.0,
            false => slope.to_f64().abs() * self.scale,
        };
        Self::computed(value, moved)
    }

    /// `self · other` where `self` is 1 or −1.
    fn by_unit(&self, other: &Self) -> Option<Self> {
        let is_unit = self.exact && self.scale == 1.0;
        is_unit.then(|| match self.value.is_negative() {
            true => other.negative(),
            false => other.clone(),
        })
    }

    fn is_power_of_two(&self) -> bool {
        let size = self.value.to_f64().abs();
        self.exact && size > 0.0 && size.to_bits().trailing_zeros() >= 52
    }
}

/// The larger of two sizes; NaN where either is, unlike `f64::max`.
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

impl Number for Tracked {
    fn rational(&self, value: &Rational) -> Self {
        let exact = Precise::integer(1, BITS).rational(value);
        let rounded = value.to_f64().unwrap_or(f64::NAN);
        let is_double = (&exact - &Precise::from_f64(rounded, BITS)).is_zero();
        Self {
            value: exact,
            scale: rounded.abs(),
            exact: is_double,
        }
    }

    fn plus(&self, other: &Self) -> Self {
        match (self.is_nothing(), other.is_nothing()) {
            (true, _) => other.clone(),
            (_, true) => self.clone(),
            _ => Self::computed(&self.value + &other.value, larger(self.scale, other.scale)),
        }
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_nothing() || other.is_nothing() {
            return Self::input(0.0);
        }
        if let Some(product) = self.by_unit(other).or_else(|| other.by_unit(self)) {
            return product;
        }
        let exact =
            (self.is_power_of_two() && other.exact) || (other.is_power_of_two() && self.exact);
        Self {
            exact,
            ..Self::computed(&self.value * &other.value, self.scale * other.scale)
        }
    }

    fn over(&self, other: &Self) -> Self {
        let (value, divisor) = (&self.value / &other.value, other.value.to_f64().abs());
        let of_divisor = value.to_f64().abs() * other.scale / divisor;
        Self::computed(value, larger(self.scale / divisor, of_divisor))
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match arguments {
            [] => Self::computed(self.value.function(function, &[]), 0.0),
            [x] if x.exact => Self::computed(value(function, &x.value), 0.0),
            [x] => x.mapped(value(function, &x.value), &slope(function, &x.value)),
            [y, x] => angle(y, x),
            _ => Self::input(f64::NAN),
        }
    }
}

/// atan2 and how far its inexact arguments move it.
fn angle(y: &Tracked, x: &Tracked) -> Tracked {
    let value = y.value.atan2(&x.value);
    let square = &y.value * &y.value + &x.value * &x.value;
    let by_y = y.mapped(value.clone(), &(&x.value / &square));
    let by_x = x.mapped(value.clone(), &(&y.value / &square));
    Tracked::computed(value, larger(by_y.scale, by_x.scale))
}

/// Stumpff functions of one argument from one pair of series: c_k = 1/k! − s c_{k+2}, downwards, which loses a few bits at s < 100.
struct Family {
    argument: Precise,
    values: Vec<Precise>,
}

/// c_0 … c_11: all that second derivatives of c_0 … c_3, and their scales, ask for.
const FAMILY: u32 = 12;

impl Family {
    fn new(s: &Precise) -> Self {
        let mut values = vec![s.same(0); FAMILY as usize];
        let mut factorial = (1..FAMILY).fold(s.same(1), |f, n| f * s.same(n.into()));
        for k in (0..FAMILY).rev() {
            let i = k as usize;
            values[i] = match values.get(i + 2) {
                Some(second) => s.same(1) / factorial.clone() - s * second,
                None => s.stumpff(k),
            };
            factorial = factorial / s.same(i64::from(k).max(1));
        }
        Self {
            argument: s.clone(),
            values,
        }
    }
}

/// The Stumpff function, from the family of the argument that was asked for last.
fn stumpff(order: u8, s: &Precise) -> Precise {
    thread_local! {
        static LAST: RefCell<Option<Family>> = const { RefCell::new(None) };
    }
    if u32::from(order) >= FAMILY || s.to_f64().abs() >= 100.0 {
        return s.stumpff(order.into());
    }
    LAST.with_borrow_mut(|last| {
        let family = match last.take() {
            Some(family) if (&family.argument - s).is_zero() => family,
            _ => Family::new(s),
        };
        last.insert(family).values[usize::from(order)].clone()
    })
}

fn value(function: Function, x: &Precise) -> Precise {
    match function {
        Function::Stumpff(k) => stumpff(k, x),
        _ => x.function(function, std::slice::from_ref(x)),
    }
}

/// The derivative of a function of one argument.
fn slope(function: Function, x: &Precise) -> Precise {
    match function {
        Function::Cos => -x.sin(),
        Function::Sin => x.cos(),
        Function::Exp => x.exp(),
        Function::Ln => x.same(1) / x.clone(),
        Function::Sqrt => x.same(1) / x.sqrt().halved(-1),
        Function::Recip => x.same(-1) / (x * x),
        Function::Stumpff(k) => {
            let ahead = x.same(k.into()) * stumpff(k + 2, x);
            (ahead - stumpff(k + 1, x)).halved(1)
        }
        Function::DexpInverse(n) => x.dexp_inverse(u32::from(n) + 1),
        Function::Group => x.same(1),
        Function::Pi | Function::Atan2 => x.same(0),
    }
}

#[cfg(test)]
mod tests {
    use super::{BITS, stumpff};
    use hamel_codegen::precise::Precise;

    #[test]
    fn families_are_stumpff_functions() {
        for s in [0.0, 1e-300, 0.5, 9.8, 39.0, -3.0, 99.0] {
            let s = Precise::from_f64(s, BITS);
            for k in 0..12_u8 {
                let error = &stumpff(k, &s) - &s.stumpff(k.into());
                // Six steps of the recurrence at s = 99 end near 1 from terms of e¹⁰: 2⁻²⁵⁶⁺³⁰.
                assert!(
                    error.to_f64().abs() < Precise::integer(1, BITS).halved(226).to_f64(),
                    "c{k}({s})"
                );
            }
        }
    }
}
