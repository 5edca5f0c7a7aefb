//! Rigid-body mechanisms of general joints.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "compiled")]
pub use hamel_compiled as compiled;
#[cfg(feature = "control")]
pub use hamel_control as control;
#[cfg(feature = "integrate")]
pub use hamel_integrate as integrate;
#[cfg(feature = "joints")]
pub use hamel_joints as joints;
#[cfg(feature = "alloc")]
pub use hamel_runtime::{dynamics, elements, mechanism, steps};
pub use hamel_runtime::{erased, finite, group, joint, nalgebra, registry, scalar, shown, spatial};
#[cfg(feature = "scene")]
pub use hamel_scene as scene;
