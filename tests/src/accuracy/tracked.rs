//! Numbers of 256 bits that know the largest summand they are made of.

use hamel_codegen::expr::{Function, Number, Rational};
use hamel_codegen::precise::Precise;
use num_traits::ToPrimitive;

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
            [x] => {
                let (value, slope) = with_slope(function, &x.value);
                x.mapped(value, &slope)
            }
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

/// A function and its derivative.
pub fn with_slope(function: Function, x: &Precise) -> (Precise, Precise) {
    let at = |function| x.function(function, std::slice::from_ref(x));
    let value = at(function);
    let slope = match function {
        Function::Cos => -x.sin(),
        Function::Sin => x.cos(),
        Function::Exp => value.clone(),
        Function::Ln => x.same(1) / x.clone(),
        Function::Sqrt => x.same(1) / value.halved(-1),
        Function::Recip => -(&value * &value),
        Function::Stumpff(k) => {
            let ahead = x.same(k.into()) * x.stumpff(u32::from(k) + 2);
            (ahead - x.stumpff(u32::from(k) + 1)).halved(1)
        }
        Function::DexpInverse(n) => x.dexp_inverse(u32::from(n) + 1),
        Function::Pi | Function::Atan2 => x.same(0),
    };
    (value, slope)
}
