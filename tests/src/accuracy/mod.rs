//! How accurate compiled kernels are: against their definitions in 256 bits, in units of the last place.
//!
//! The reference is made from the spec alone: H, Φ, X, A and S̄ as it declares them, and the defining equations (17), (23), (28)
//! and (31), by exact truncated polynomials in ϕ, read once into a [`Program`] that is run at every point. Nothing that the generator
//! derives enters.
//!
//! **Unit.** A kernel's entry is measured in ulp of the largest summand of its definition: [`Tracked`] carries that size along. A
//! value found by solving a system is measured against how far relative errors of one ulp in the system's entries move it. A
//! function of an inexact argument (`cos(lead * q)`) is measured against how far one ulp of the argument moves it as well; of a
//! stored scalar it is not, that is exact.
//!
//! **Configurations** are what a caller can have: rounded to the type of the kernel, and so off the manifold by roundings. The
//! definition is evaluated at the rounded Q with `H⁻¹ = [Rᵀ −Rᵀp; 0 1]`, as a polynomial. A kernel may use the manifold's relations;
//! the stored scalars being rounded relatively, a relation then fails by an ulp of its largest summand, which is the unit.

mod at_zero;
mod compare;
mod declared;
mod definition;
mod environment;
mod finite;
mod grid;
mod jet;
mod node;
mod outputs;
mod pinned;
mod points;
mod program;
mod relations;
mod suite;
mod table;
mod tape;
mod tracked;
mod wide;

pub use compare::{Measured, Worst};
pub use definition::Definition;
pub(crate) use definition::numbers;
pub use finite::AtPhi;
pub use grid::Grid;
pub use jet::Jet;
pub use node::Node;
pub(crate) use outputs::{Arguments, arguments, formulas, home, moved, outputs, solutions};
pub use outputs::{Output, check_lanes, measure_duals};
pub(crate) use pinned::exact;
pub use points::{Case, Points};
pub use program::{Program, Sheet};
pub use suite::{check, measure};
pub use table::Table;
pub use tracked::Tracked;
pub use wide::{BITS, Wide};
