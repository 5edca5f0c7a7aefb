//! A place where a claim fails, in words.

use crate::expr::Expr;
use crate::precise::{Interval, Point, Precise};
use crate::prepare::Prepared;
use std::fmt::{Display, Formatter};

/// The binary logarithm of a residual, beside its terms, that is large.
const LARGE: f64 = -10.0;
/// The binary logarithm of the largest number that is easy to picture.
const PLAIN: f64 = 20.0;

/// The power of 10 beyond which no number is held.
const BEYOND: u32 = 646_456_993;

/// Values of the scalars and parameters that matter, and the residual there.
#[derive(Clone, Debug)]
pub struct Place {
    values: Vec<(String, Precise)>,
    residual: Precise,
    size: Precise,
    /// Whether `residual` is a derivative of what should be 0.
    of_derivative: bool,
}

impl Place {
    /// The point at which an entry with this enclosure excludes 0; `size` encloses the sum of the sizes of its terms.
    pub fn new(
        joint: &Prepared,
        entry: &Expr,
        point: &Point,
        residual: &Interval,
        size: &Interval,
    ) -> Self {
        let held = entry.symbols();
        let symbols = joint
            .space
            .symbols()
            .into_iter()
            .filter(|symbol| held.contains(symbol));
        Self {
            values: symbols
                .map(|s| (s.spelling().to_string(), point.value(&s)))
                .collect(),
            residual: residual.nearest_to_zero(),
            size: size.high().clone(),
            of_derivative: false,
        }
    }

    /// The same place, where a derivative of the difference is not 0.
    pub fn of_derivative(self) -> Self {
        let of_derivative = true;
        Self {
            of_derivative,
            ..self
        }
    }

    /// The binary logarithm of the residual beside its terms, or beside 1 where these are smaller.
    fn relative_size(&self) -> f64 {
        self.residual.abs().log2() - self.size.log2().max(0.0)
    }

    /// That of both where the residual is larger; of two where it is large, that with numbers nearer to 1.
    pub fn larger(known: Option<Self>, other: Option<Self>) -> Option<Self> {
        let order = |place: &Self| (place.relative_size().min(LARGE), -place.extent());
        match (known, other) {
            (Some(known), Some(other)) if order(&known) < order(&other) => Some(other),
            (None, other) => other,
            (known, _) => known,
        }
    }

    /// Whether there is no need to look for a larger residual.
    pub fn is_large(&self) -> bool {
        self.relative_size() >= LARGE
    }

    /// Whether it says all there is to say: a large residual, and no number that is hard to picture.
    pub fn is_plain(&self) -> bool {
        let values = self.values.iter().map(|(_, value)| value);
        let mut sizes = values.chain([&self.residual]).map(Precise::log2);
        self.is_large() && sizes.all(|size| !size.is_finite() || size.abs() <= PLAIN)
    }

    /// How far the values are from numbers that people calculate with.
    fn extent(&self) -> f64 {
        let sizes = self.values.iter().map(|(_, value)| value.log2());
        sizes.filter(|size| size.is_finite()).map(f64::abs).sum()
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let values = self
            .values
            .iter()
            .map(|(name, value)| format!("{name} = {}", short(value)));
        let values: Vec<String> = values.collect();
        let at = match values.is_empty() {
            true => "everywhere".to_owned(),
            false => format!("at {}", values.join(", ")),
        };
        let what = match self.of_derivative {
            true => "the difference changes: a derivative of it is",
            false => "the difference is",
        };
        write!(f, "{at} {what} {}", short(&self.residual))?;
        match self.size.log2() > 1.0 + self.residual.abs().log2() {
            true => write!(f, ", beside terms of {}", short(&self.size)),
            false => Ok(()),
        }
    }
}

/// Six digits; numbers beyond doubles as a power of 10.
fn short(value: &Precise) -> String {
    let double = value.to_f64();
    let size = double.abs();
    if value.is_zero() || (1e-6..1e6).contains(&size) {
        let rounded = format!("{double:.6}");
        return rounded
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned();
    }
    if size.is_finite() && size > f64::MIN_POSITIVE {
        return format!("{double:.3e}");
    }
    let sign = if value.is_negative() { "-" } else { "" };
    if !value.is_finite() {
        return format!("{sign}1e{BEYOND} or more");
    }
    let decimals = value.abs().log2() * std::f64::consts::LOG10_2;
    format!("{sign}1e{decimals:.0}")
}
