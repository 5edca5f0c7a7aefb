//! Double-double numbers, and vectors of them.

use hamel::nalgebra::{Matrix3, Vector3};
use hamel_codegen::precise::Precise;

pub use super::double::Real;

/// Three of them.
pub type Vector = Vector3<Real>;
/// Nine of them.
pub type Matrix = Matrix3<Real>;

/// Precision in which numbers are written out.
const BITS: usize = 256;

/// Digits of a written number.
const DIGITS: usize = 28;

/// A double as it is.
pub fn real(value: f64) -> Real {
    Real::from(value)
}

pub fn vector(values: &Vector3<f64>) -> Vector {
    values.map(real)
}

pub fn matrix(values: &Matrix3<f64>) -> Matrix {
    values.map(real)
}

/// The number with 28 significant digits.
pub fn decimal(value: Real) -> String {
    let part = |part: f64| Precise::from_f64(part, BITS);
    digits(&(&part(value.high()) + &part(value.low())))
}

/// The number with 28 significant digits, the last one cut, in the notation of JSON.
pub(super) fn digits(value: &Precise) -> String {
    if value.is_zero() {
        return "0.0".into();
    }
    let text = value.to_string();
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let kept = mantissa.chars().scan(0, |count, c| {
        *count += usize::from(c.is_ascii_digit());
        (*count <= DIGITS).then_some(c)
    });
    let mut kept: String = kept.collect();
    if kept.ends_with('.') {
        kept.push('0');
    }
    let exponent = exponent.trim_start_matches('+');
    match exponent == "0" {
        true => kept,
        false => format!("{kept}e{exponent}"),
    }
}

/// The rotation nearest to a matrix of doubles that is one up to their rounding.
pub fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix {
    let mut rotation = self::matrix(matrix);
    let three = Matrix::identity() * real(3.0);
    // Newton's method for the polar factor doubles the digits: 16, 32.
    for _ in 0..3 {
        let gram = rotation.transpose() * rotation;
        rotation = rotation * (three - gram) * real(0.5);
    }
    rotation
}

/// The unit quaternion (w, x, y, z) of a rotation.
pub fn quaternion(rotation: &Matrix) -> [Real; 4] {
    let r = |i: usize, j: usize| rotation[(i, j)];
    let one = real(1.0);
    // Four times the square of each entry: the largest one divides.
    let squares = [
        one + r(0, 0) + r(1, 1) + r(2, 2),
        one + r(0, 0) - r(1, 1) - r(2, 2),
        one - r(0, 0) + r(1, 1) - r(2, 2),
        one - r(0, 0) - r(1, 1) + r(2, 2),
    ];
    let largest = (0..4).fold(0, |m, i| if squares[i] > squares[m] { i } else { m });
    let (x, y, z) = (r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
    let (xy, yz, zx) = (r(0, 1) + r(1, 0), r(1, 2) + r(2, 1), r(2, 0) + r(0, 2));
    let mut quaternion = match largest {
        0 => [squares[0], x, y, z],
        1 => [x, squares[1], xy, zx],
        2 => [y, xy, squares[2], yz],
        _ => [z, zx, yz, squares[3]],
    };
    let length = quaternion
        .iter()
        .fold(real(0.0), |sum, &q| sum + q * q)
        .sqrt();
    quaternion.iter_mut().for_each(|q| *q /= length);
    quaternion
}

/// The rotation of a quaternion of any length but 0.
pub fn rotation(q: &[Real]) -> Matrix {
    let (w, x, y, z) = (q[0], q[1], q[2], q[3]);
    let scale = real(2.0) / (w * w + x * x + y * y + z * z);
    let one = real(1.0);
    Matrix::new(
        one - scale * (y * y + z * z),
        scale * (x * y - w * z),
        scale * (x * z + w * y),
        scale * (x * y + w * z),
        one - scale * (x * x + z * z),
        scale * (y * z - w * x),
        scale * (x * z - w * y),
        scale * (y * z + w * x),
        one - scale * (x * x + y * y),
    )
}
