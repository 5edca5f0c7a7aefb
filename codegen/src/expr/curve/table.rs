//! The doubles of a curve, as kernels hold them: in the units of argument and value, each the nearest one to the exact number.

use super::{Curve, Definition, Outside};
use crate::expr::Rational;
use num_bigint::BigInt;
use num_traits::{One, Pow, ToPrimitive};

/// π times 10⁶⁴, cut off.
const PI_DIGITS: &str = "31415926535897932384626433832795028841971693993751058209749445923";

/// Knots and coefficients in doubles.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Knots, ascending.
    pub knots: Vec<f64>,
    /// Of each knot the coefficients of 1, t, t², … with t the distance from it, the last one twice: to the left and to the right of the knot.
    pub coefficients: Vec<f64>,
    /// What the curve is beyond its ends.
    pub outside: Outside,
}

impl Table {
    /// The table of a curve, with two knots or more and a polynomial between each two.
    pub(super) fn new(definition: &Definition) -> Self {
        let radians = pi() / Rational::from(180);
        let of_argument = match definition.of_degrees {
            true => radians.clone(),
            false => Rational::one(),
        };
        let of_value = match definition.in_degrees {
            true => radians,
            false => Rational::one(),
        };
        let double = |value: Rational| value.to_f64().unwrap_or(f64::NAN);
        let scaled = |knot: usize| {
            let (degree, [left, right]) = (definition.kind.degree(), sides(definition, knot));
            let mut scale = of_value.clone();
            let mut doubles = vec![];
            for power in 0..=degree {
                let ends = match power == degree {
                    true => vec![&left, &right],
                    false => vec![&right],
                };
                let of_power = ends
                    .into_iter()
                    .map(|side| &side[usize::from(power)] * &scale);
                doubles.extend(of_power.map(double));
                scale = &scale / &of_argument;
            }
            doubles
        };
        let knots = definition.knots.iter();
        Self {
            knots: knots.map(|knot| double(knot * &of_argument)).collect(),
            coefficients: (0..definition.knots.len()).flat_map(scaled).collect(),
            outside: definition.outside,
        }
    }

    /// A number of 32 bits that is the same on every machine, and hardly the same for two tables (Fowler, Noll and Vo's hash).
    fn tag(&self) -> u32 {
        let numbers = self.knots.iter().chain(&self.coefficients);
        let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
        let hash = bytes
            .chain([self.outside as u8])
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        (hash ^ (hash >> 32)) as u32
    }

    /// Whether all numbers are finite, and the knots are different doubles.
    pub fn is_sound(&self) -> bool {
        let mut numbers = self.knots.iter().chain(&self.coefficients);
        let mut pairs = self.knots.windows(2);
        numbers.all(|number| number.is_finite()) && pairs.all(|pair| pair[0] < pair[1])
    }
}

impl Curve {
    /// A name that tells it from curves of other joints: `lift_1f0a4b22`.
    pub fn distinct_name(&self) -> String {
        format!("{}_{:08x}", self.name(), self.table().tag())
    }

    /// Its numbers in doubles.
    pub fn table(&self) -> &'static Table {
        &self.0.table
    }
}

/// The polynomials to the left and to the right of a knot, in powers of the distance from it; beyond an end there is that of the end, or of the
/// other end where the curve is periodic.
fn sides(definition: &Definition, knot: usize) -> [Vec<Rational>; 2] {
    let last = definition.pieces.len() - 1;
    let periodic = definition.outside == Outside::Periodic;
    let at = |piece: usize, end: bool| match end {
        false => definition.pieces[piece].clone(),
        true => {
            let t = &definition.knots[piece + 1] - &definition.knots[piece];
            moved(&definition.pieces[piece], &t)
        }
    };
    match knot {
        0 if periodic => [at(last, true), at(0, false)],
        0 => [at(0, false), at(0, false)],
        knot if knot <= last => [at(knot - 1, true), at(knot, false)],
        _ if periodic => [at(last, true), at(0, false)],
        _ => [at(last, true), at(last, true)],
    }
}

/// The same polynomial in powers of the distance from another place.
fn moved(coefficients: &[Rational], by: &Rational) -> Vec<Rational> {
    let mut moved = coefficients.to_vec();
    for first in 0..moved.len() {
        for place in (first..moved.len() - 1).rev() {
            moved[place] = &moved[place] + &(by * &moved[place + 1]);
        }
    }
    moved
}

fn pi() -> Rational {
    let digits = PI_DIGITS.parse::<BigInt>().unwrap_or_default();
    Rational::new(digits, BigInt::from(10).pow(PI_DIGITS.len() as u32 - 1))
}
