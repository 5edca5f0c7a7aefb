//! Sine, cosine and Stumpff functions by their series.

use super::Wide;
use hamel_codegen::precise::Precise;
use std::cell::RefCell;

/// c₀ … c₁₁: all that second derivatives of c₀ … c₃, and their scales, ask for.
const STUMPFF_FAMILY: usize = 12;
/// The largest |s| at which c_k(s) is summed: the terms of c₁₀ then fall from the second on.
const LARGEST_ARGUMENT: f64 = 100.0;
/// Factors n of the last 1/n! that counts: 100⁸⁰/160! = 2⁻⁴¹⁷ of terms of order 1.
const FACTORIALS: usize = 180;
/// A term below this part of the first is left out.
const NEGLIGIBLE: f64 = 1e-82;
/// The largest angle that is reduced here: the number of quarter turns is an integer of 2⁴⁰ at most.
const LARGEST_ANGLE: f64 = 1e12;

/// Constants of this thread: 1/n!, and π/2 as a short leading part and the rest.
struct Constants {
    factorials: Vec<Wide>,
    quarter: (Wide, Wide),
}

impl Constants {
    fn new() -> Self {
        let mut factorials = vec![Wide::from_integer(1)];
        for n in 1..FACTORIALS {
            factorials.push(factorials[n - 1] / Wide::from_integer(n as u64));
        }
        // Three doubles are 159 bits: their product with a number of turns is exact.
        let mut rest = Precise::pi(512).halved(1);
        let mut leading = Wide::ZERO;
        for _ in 0..3 {
            let piece = rest.to_f64();
            leading = leading + Wide::from_f64(piece);
            rest = rest - Precise::from_f64(piece, 512);
        }
        Self {
            factorials,
            quarter: (leading, Wide::from_precise(&rest)),
        }
    }
}

thread_local! {
    static CONSTANTS: Constants = Constants::new();
    static LAST: RefCell<Option<(Wide, [Wide; STUMPFF_FAMILY])>> = const { RefCell::new(None) };
}

/// `Σ_j (−s)^j / (order + 2j)!` by Horner's rule.
fn series(order: usize, s: Wide, factorials: &[Wide]) -> Wide {
    let size = s.to_f64().abs();
    let (mut last, mut term) = (order, 1.0);
    while last + 4 < FACTORIALS && term > NEGLIGIBLE {
        term *= size / ((last + 1) * (last + 2)) as f64;
        last += 2;
    }
    let mut sum = factorials[last];
    while last > order {
        last -= 2;
        sum = factorials[last] - s * sum;
    }
    sum
}

/// c₀ … c₁₁ from two series: `c_k = 1/k! − s c_{k+2}`, downwards, which loses a few bits.
fn family(s: Wide) -> [Wide; STUMPFF_FAMILY] {
    CONSTANTS.with(|constants| {
        let mut values = [Wide::ZERO; STUMPFF_FAMILY];
        for k in (0..STUMPFF_FAMILY).rev() {
            values[k] = match k + 2 < STUMPFF_FAMILY {
                true => constants.factorials[k] - s * values[k + 2],
                false => series(k, s, &constants.factorials),
            };
        }
        values
    })
}

/// Stumpff function, from the family of the argument that was asked for last.
pub fn stumpff(order: u8, s: Wide) -> Wide {
    if usize::from(order) >= STUMPFF_FAMILY || s.to_f64().abs() >= LARGEST_ARGUMENT {
        return Wide::from_precise(&s.to_precise().stumpff(order.into()));
    }
    LAST.with_borrow_mut(|last| {
        let values = match last.take() {
            Some((argument, values)) if argument == s => values,
            _ => family(s),
        };
        last.insert((s, values)).1[usize::from(order)]
    })
}

impl Wide {
    /// Cosine and sine.
    pub fn cos_sin(self) -> (Self, Self) {
        let size = self.to_f64();
        if size.abs() > LARGEST_ANGLE {
            let x = self.to_precise();
            return (Self::from_precise(&x.cos()), Self::from_precise(&x.sin()));
        }
        CONSTANTS.with(|constants| {
            let turns = (size / std::f64::consts::FRAC_PI_2).round();
            let n = Self::from_f64(turns);
            let rest = (self - n * constants.quarter.0) - n * constants.quarter.1;
            let square = rest * rest;
            let cos = series(0, square, &constants.factorials);
            let sin = rest * series(1, square, &constants.factorials);
            match (turns as i64).rem_euclid(4) {
                0 => (cos, sin),
                1 => (-sin, cos),
                2 => (-cos, -sin),
                _ => (sin, -cos),
            }
        })
    }
}
