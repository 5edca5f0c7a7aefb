//! The scene compiler: from one mechanism to code that holds nothing it does not need.
//!
//! ```text
//! SceneDescription + Derived joints
//!    │  describe    numbers for all that does not change, or the list of what is not compiled
//!    ▼
//! Model
//!    │  prune       frames that cost least; inertias that affect no joint moved to the root
//!    ▼
//! Link per body
//!    │  equations   recursions on the graph: articulated bodies, composite bodies, Newton–Euler
//!    ▼
//! Graph             every value once; zeros, ones and signs folded; of several recursions the one with the fewest operations
//!    │  alike       parts that repeat from body to body, where the whole would be long
//!    │  packs       operations that are the same for like limbs, side by side
//!    ▼
//! Plan or Packs
//!    │  emit        lines with telling names, loops over like bodies → Rust, C99
//!    ▼
//! module
//! ```
//!
//! [`stepping`] makes one step of a motion of the same model, with [`numbers`] that are given later, for programs that evaluate the graph themselves.
//!
//! [`Build`] is for build scripts; `hamel compile` does the same from the command line.

mod acting;
pub mod alike;
mod build;
mod chain;
mod check;
mod couple;
mod coupled;
mod describe;
pub mod emit;
pub mod equations;
mod explain;
pub mod functions;
pub mod graph;
mod joint;
mod linkage;
pub mod model;
pub mod numbers;
pub mod packs;
pub mod pairs;
mod products;
pub mod prune;
mod spatial;
pub mod stepping;
mod ties;

pub use build::{Build, Error, Language, Module, scene, scene_of};
pub use describe::Refused;
pub use explain::explain;
pub use products::{JointType, Product, Products};
