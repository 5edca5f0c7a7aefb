//! Evaluation in high precision: the numbers in which claims are tested and kernels are measured.
//!
//! A [`Precise`] is a binary floating-point number of a stated number of bits, an arithmetic for
//! [`Expr::evaluate`](crate::expr::Expr::evaluate). A [`Sampler`] draws random [`Point`]s of a joint: a configuration on the
//! manifold to that precision, parameters within their ranges, and all other arguments of kernels.

mod functions;
mod linear;
mod number;
mod operators;
mod point;
mod sampler;
mod start;
#[cfg(test)]
mod tests;

pub use number::Precise;
pub use point::Point;
pub use sampler::Sampler;
