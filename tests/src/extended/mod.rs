//! Dynamics of chains of revolute and ball joints in extended precision, on the same doubles as ours: what errors are measured against.
//!
//! Inverse dynamics are Newton's and Euler's equations of each body with 3-vectors in body axes; forward dynamics eliminate joint by joint
//! with 6×6 matrices. The two share no formula, so that one checks the other to all digits.

mod chain;
mod forward;
mod number;

pub use chain::{Chain, Freedoms};
pub use number::{BITS, Exact};
