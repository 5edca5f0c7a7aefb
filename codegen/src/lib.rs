//! Symbolic generator of joint kernels: a `.joint` file in, proven and readable Rust out.
//!
//! [`derive()`] is the whole of it: parse, expand to first order in the local coordinates ϕ, prove, and hand over a
//! [`derived::Derived`], from which Rust and pages are made. Equation numbers
//! are those of Duindam and Stramigioli, *Singularity-free dynamic equations of open-chain mechanisms with general
//! holonomic and nonholonomic joints*.

pub mod algebra;
mod build;
pub mod derived;
pub mod diagnostic;
pub mod domain;
pub mod emit;
pub mod expand;
pub mod expr;
pub mod formula;
pub mod kernel;
pub mod manifold;
pub mod matrix;
pub mod model;
mod pipeline;
pub mod precise;
pub mod prepare;
pub mod prove;
mod simplify;
pub mod source;
pub mod spec;
pub mod text;
pub mod units;

pub use build::{Build, BuildError, GENERATE_VARIABLE};
pub use pipeline::{WORK_LIMIT, derive, derive_in};
