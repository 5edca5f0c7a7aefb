//! Numbers of 256 bits that know the largest summand they are made of.

use super::wide::{BITS, Wide, stumpff};
use hamel_codegen::expr::{Function, Number, Rational};
use hamel_codegen::precise::Precise;
use num_traits::ToPrimitive;

/// A value of a definition, with the scale that rounding errors of its evaluation are measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// The value.
    pub value: Wide,
    /// The largest summand, |value| or more.
    pub scale: f64,
    /// Whether the value is a double as it stands: an input, or a power of two times one.
    pub exact: bool,
}

impl Tracked {
    /// An input.
    #[inline]
    pub fn input(value: f64) -> Self {
        Self {
            value: Wide::from_f64(value),
            scale: value.abs(),
            exact: true,
        }
    }

    /// A result with the scale given, or its own size where that is larger.
    #[inline]
    pub fn computed(value: Wide, scale: f64) -> Self {
        let size = value.to_f64().abs();
        Self {
            scale: larger(size, scale),
            value,
            exact: false,
        }
    }

    /// Whether this is 0 without any summand.
    #[inline]
    pub fn is_nothing(&self) -> bool {
        self.exact && self.value.is_zero()
    }

    /// `−self`.
    #[inline]
    pub fn negative(&self) -> Self {
        Self {
            value: -self.value,
            ..*self
        }
    }

    /// The function with value `value` and slope `slope` here.
    pub fn mapped(&self, value: Wide, slope: Wide) -> Self {
        let moved = match self.exact {
            true => 0.0,
            false => slope.to_f64().abs() * self.scale,
        };
        Self::computed(value, moved)
    }

    /// Whether this is 1 or −1 as it stands.
    #[inline]
    pub fn is_unit(&self) -> bool {
        self.exact && self.scale == 1.0
    }

    /// `self · other` where `self` is 1 or −1.
    #[inline]
    fn by_unit(&self, other: &Self) -> Option<Self> {
        self.is_unit().then(|| match self.value.is_negative() {
            true => other.negative(),
            false => *other,
        })
    }

    #[inline]
    fn is_power_of_two(&self) -> bool {
        self.exact && self.scale > 0.0 && self.scale.to_bits().trailing_zeros() >= 52
    }
}

/// The larger of two sizes; NaN where either is, unlike `f64::max`.
#[inline]
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

impl Number for Tracked {
    fn rational(&self, value: &Rational) -> Self {
        let exact = Precise::integer(1, BITS).rational(value);
        let rounded = value.to_f64().unwrap_or(f64::NAN);
        let is_double = (&exact - &Precise::from_f64(rounded, BITS)).is_zero();
        Self {
            value: Wide::from_precise(&exact),
            scale: rounded.abs(),
            exact: is_double,
        }
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        match (self.is_nothing(), other.is_nothing()) {
            (true, _) => *other,
            (_, true) => *self,
            _ => Self::computed(self.value + other.value, larger(self.scale, other.scale)),
        }
    }

    #[inline]
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
            ..Self::computed(self.value * other.value, self.scale * other.scale)
        }
    }

    fn over(&self, other: &Self) -> Self {
        let (value, divisor) = (self.value / other.value, other.value.to_f64().abs());
        let of_divisor = value.to_f64().abs() * other.scale / divisor;
        Self::computed(value, larger(self.scale / divisor, of_divisor))
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match arguments {
            [] => Self::computed(by_precise(function, &[]), 0.0),
            // Its argument is reduced by the period, and turned into the unit of the knots, in the numbers of the kernel.
            [x] if matches!(function, Function::Curve(..)) => {
                let moved = slope(function, x.value).to_f64().abs() * x.scale;
                Self::computed(value(function, x.value), moved)
            }
            [x] if x.exact => Self::computed(value(function, x.value), 0.0),
            [x] => x.mapped(value(function, x.value), slope(function, x.value)),
            [y, x] => angle(y, x),
            _ => Self::input(f64::NAN),
        }
    }
}

/// atan2 and how far its inexact arguments move it.
fn angle(y: &Tracked, x: &Tracked) -> Tracked {
    let value = by_precise(Function::Atan2, &[y.value, x.value]);
    let square = y.value * y.value + x.value * x.value;
    let by_y = y.mapped(value, x.value / square);
    let by_x = x.mapped(value, y.value / square);
    Tracked::computed(value, larger(by_y.scale, by_x.scale))
}

/// A function that definitions seldom use.
fn by_precise(function: Function, arguments: &[Wide]) -> Wide {
    let arguments: Vec<Precise> = arguments.iter().map(|x| x.to_precise()).collect();
    Wide::from_precise(&Precise::integer(1, BITS).function(function, &arguments))
}

fn value(function: Function, x: Wide) -> Wide {
    match function {
        Function::Stumpff(k) => stumpff(k, x),
        Function::Cos => x.cos_sin().0,
        Function::Sin => x.cos_sin().1,
        Function::Sqrt => x.sqrt(),
        Function::Recip => x.recip(),
        Function::Group => x,
        Function::Pi
        | Function::Exp
        | Function::Sinh
        | Function::Cosh
        | Function::Sech
        | Function::Tanh
        | Function::LnCosh
        | Function::Ln
        | Function::Ln1p
        | Function::Larger
        | Function::Atan2
        | Function::Curve(..)
        | Function::DexpInverse(_) => by_precise(function, &[x]),
    }
}

/// The derivative of a function of one argument.
fn slope(function: Function, x: Wide) -> Wide {
    match function {
        Function::Cos => -x.cos_sin().1,
        Function::Sin => x.cos_sin().0,
        Function::Exp => value(function, x),
        Function::Sinh => value(Function::Cosh, x),
        Function::Cosh => value(Function::Sinh, x),
        Function::Sech => -(value(Function::Tanh, x) * value(Function::Sech, x)),
        Function::Tanh => value(Function::Sech, x) * value(Function::Sech, x),
        Function::LnCosh => value(Function::Tanh, x),
        Function::Ln => x.recip(),
        Function::Sqrt => x.sqrt().recip().halved(1),
        Function::Recip => -(x * x).recip(),
        Function::Stumpff(k) => {
            let ahead = Wide::from_integer(k.into()) * stumpff(k + 2, x);
            (ahead - stumpff(k + 1, x)).halved(1)
        }
        Function::DexpInverse(n) => by_precise(Function::DexpInverse(n + 1), &[x]),
        Function::Curve(curve, n) => by_precise(Function::Curve(curve, n + 1), &[x]),
        Function::Group => Wide::from_integer(1),
        Function::Pi | Function::Ln1p | Function::Larger | Function::Atan2 => Wide::ZERO,
    }
}
