#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "scene")]
mod builder;
#[cfg(feature = "scene")]
mod error;
#[cfg(feature = "scene")]
mod model;
#[cfg(feature = "scene")]
mod parameters;
#[cfg(feature = "scene")]
mod ports;
#[cfg(feature = "scene")]
mod simulation;

#[cfg(feature = "scene")]
pub use builder::{Body, Builder};
#[cfg(feature = "scene")]
pub use error::{BodyError, Error, UnknownName};
#[cfg(feature = "compiled")]
pub use hamel_compiled as compiled;
#[cfg(feature = "control")]
pub use hamel_control as control;
#[cfg(feature = "integrate")]
pub use hamel_integrate as integrate;
#[cfg(feature = "joints")]
pub use hamel_joints as joints;
pub use hamel_runtime::{
    curve, erased, finite, group, joint, nalgebra, registry, scalar, shown, spatial,
};
#[cfg(feature = "alloc")]
pub use hamel_runtime::{dynamics, elements, mechanism, steps, time_function};
#[cfg(feature = "scene")]
pub use hamel_scene as scene;
#[cfg(feature = "scene")]
pub use model::{Model, load, load_with};
#[cfg(feature = "scene")]
pub use ports::PortReading;
#[cfg(feature = "scene")]
pub use simulation::Simulation;
