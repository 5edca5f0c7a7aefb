//! A second judge of derived joints: the laws at points, in balls of any precision, without the generator's proofs.
//!
//! A law is *violated* where the enclosure of its residual excludes 0, a kernel is *undefined* where it has no value though the spec admits
//! the point. Both are facts, not estimates: points lie on the manifold exactly and every operation rounds outwards. A rank is taken to be
//! lost where its determinant cannot be told from 0 at the last precision.

mod ball;
mod curve;
mod evaluate;
mod grid;
mod jet;
mod laws;
mod magnitude;
mod point;
#[cfg(test)]
mod tests;

pub use ball::{Ball, with_precision};
pub use point::{Point, dimensions};

use hamel_codegen::derived::Derived;
use hamel_compiler::JointType;
use laws::{At, Domain, Residual};

/// Bits of the precisions that are tried one after the other.
const PRECISIONS: [usize; 3] = [128, 512, 2048];
/// A residual that is known to this many bits behind the point and holds 0 is taken for 0.
const KNOWN: i64 = -48;

/// What a point says of a joint.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every law holds as far as can be told.
    Holds,
    /// The point does not belong to the joint.
    Outside,
    /// This law is violated, and by how much.
    Violated(&'static str, f64),
    /// This law involves what has no value.
    Undefined(&'static str),
    /// More bits would be needed.
    Undecided(&'static str),
}

/// Judges a joint's kernels at a point.
pub fn judge(derived: &Derived, point: &Point) -> Verdict {
    judge_laws(derived, point, |at| at.laws())
}

/// Judges the products of a joint's kernels at a point.
pub fn judge_products(joint: &JointType, point: &Point) -> Verdict {
    judge_laws(&joint.derived, point, |at| at.products(joint))
}

fn judge_laws(derived: &Derived, point: &Point, laws: impl Fn(At<'_>) -> Vec<Residual>) -> Verdict {
    let mut last = Verdict::Undecided("domain");
    for bits in PRECISIONS {
        last = with_precision(bits, || judge_at(derived, point, bits, &laws));
        if !matches!(last, Verdict::Undecided(_)) {
            break;
        }
    }
    last
}

fn judge_at(
    derived: &Derived,
    point: &Point,
    bits: usize,
    laws: impl Fn(At<'_>) -> Vec<Residual>,
) -> Verdict {
    let at = At::new(derived, point);
    match at.domain() {
        Domain::Inside => {}
        Domain::Outside => return Verdict::Outside,
        Domain::Undecided => return Verdict::Undecided("domain"),
    }
    let residuals = laws(at);
    let verdicts: Vec<Verdict> = residuals
        .iter()
        .map(|residual| of_residual(residual, bits))
        .collect();
    let first = |wanted: fn(&Verdict) -> bool| verdicts.iter().find(|v| wanted(v)).cloned();
    first(|v| matches!(v, Verdict::Violated(..)))
        .or_else(|| first(|v| matches!(v, Verdict::Undefined(_))))
        .or_else(|| first(|v| matches!(v, Verdict::Undecided(_))))
        .unwrap_or(Verdict::Holds)
}

fn of_residual(residual: &Residual, bits: usize) -> Verdict {
    let Residual {
        law,
        value,
        regular,
    } = residual;
    let last = bits == PRECISIONS[PRECISIONS.len() - 1];
    let known = value.uncertainty().is_none_or(|exponent| exponent < KNOWN);
    if value.is_undefined() {
        return Verdict::Undefined(law);
    }
    match (regular, value.excludes_zero()) {
        (true, true) => Verdict::Holds,
        (true, false) if last && known || value.is_zero() => Verdict::Violated(law, value.to_f64()),
        (false, true) => Verdict::Violated(law, value.to_f64()),
        (false, false) if known => Verdict::Holds,
        _ => Verdict::Undecided(law),
    }
}
