//! Evaluation in high precision: the numbers in which claims are tested and kernels are measured.
//!
//! A [`Precise`] is a binary floating-point number of a stated number of bits, an arithmetic for
//! [`Expr::evaluate`](crate::expr::Expr::evaluate). A [`Sampler`] draws random [`Point`]s of a joint: a configuration on the
//! manifold to that precision, parameters within their ranges, and all other arguments of kernels. An [`Interval`] encloses every value
//! that an expression takes while symbols stay within others: what it excludes is excluded.

mod enclosure;
mod functions;
mod interval;
mod linear;
mod number;
mod operators;
mod point;
mod sampler;
mod start;
#[cfg(test)]
mod tests;

pub use enclosure::Enclosure;
pub use interval::Interval;
pub use interval::curve::range as range_of_curve;
pub use number::Precise;
pub use point::Point;
pub use sampler::Sampler;
