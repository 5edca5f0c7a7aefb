//! Motions in extended precision by equations that share nothing with the runtime's: what its motions are measured against.
//!
//! Every body moves by Newton's and Euler's equations in all six degrees of freedom, and joints are rows that its acceleration must satisfy, whose
//! multipliers a linear system gives: no tree recursion, no local coordinates, no generated kernel. State is position, quaternion, velocity and
//! angular velocity of each body, in double-double numbers (106 bits); steps are extrapolated midpoint steps of order 16 and 20. [`closed`]
//! has the motions that are known in closed form, in 256 bits.

pub mod closed;
mod constraint;
mod double;
mod extrapolation;
mod joint;
mod load;
mod number;
mod record;
mod scene;
mod solve;
mod system;

pub use extrapolation::Extrapolation;
pub use number::{Matrix, Real, Vector, decimal, real};
pub use record::{BodyRecord, Record, distance};
pub use scene::{Unsupported, World};
pub use system::{STATE, System};
