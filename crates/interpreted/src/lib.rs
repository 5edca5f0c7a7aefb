//! Joints from a spec while the program runs: derived and proved by [`hamel_codegen`], and evaluated formula by formula behind the trait of the runtime.
//!
//! ```text
//! Derived      kernels in symbols, proved
//!    │  tape      formulas → operations, in the order of the Rust that the generator writes
//!    ▼
//! JointType    checks parameters, chooses a type of fixed sizes
//!    │  joint     Interpreted: impl Joint, in any scalar
//!    ▼
//! Shared       in a mechanism as any other joint
//! ```
//!
//! A joint that is compiled is faster: `docs/python.md` says by how much. Results differ by rounding alone.
//!
//! ```
//! use hamel_interpreted::JointType;
//! use hamel_runtime::registry::JointRegistry;
//!
//! let spec = "hamel = 1;\njoint pin_slot {\n    config theta: R1, x: R1;\n    H = trans_x(x) * rot_z(theta);\n}\n";
//! let derived = hamel_codegen::derive(spec, "pin_slot.joint").expect("a joint");
//! let mut registry = JointRegistry::new();
//! JointType::new(&derived).expect("not too large").register(&mut registry).expect("a new name");
//! let joint = registry.build("pin_slot", &[]).expect("it is there").expect("it has no parameters");
//! assert_eq!(joint.layout().freedoms, 2);
//! ```
#![forbid(unsafe_code)]

mod facts;
mod joint;
mod joint_type;
mod kernels;
mod relations;
mod sizes;
mod tape;

pub use joint::{Interpreted, MOST_RELATIONS};
pub use joint_type::{JointType, NameTaken};
pub use sizes::{MOST_FREEDOMS, MOST_STORED, TooLarge};
