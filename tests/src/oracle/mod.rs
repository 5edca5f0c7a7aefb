//! A second oracle for the equations of motion, which shares nothing with the generator or the runtime's algorithms.
//!
//! Seven joints are written down here by their definitions: H(Φ(Q, ϕ)) as a 4×4 matrix, and what their v means. From these
//! alone follow `L = ½ Σ tr(Ḣ Λ Ḣᵀ) − V` and `d/dt ∂L/∂ϕ̇ − ∂L/∂ϕ` at ϕ = 0, by truncated power series that are exact. The
//! mechanism is asked for its bodies' placements, masses and tree, and for nothing else.

mod jet;
mod joint;
mod lagrange;

pub use jet::Jet;
pub use joint::{Matrix4, OracleJoint};
pub use lagrange::{Motion, Oracle};
