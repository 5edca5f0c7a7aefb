//! Runtime of Hamel: what generated joints link into.
//!
//! A joint type implements [`joint::Joint`]; the generator `hamel-codegen` writes such implementations from `.joint`
//! files. A [`mechanism::Mechanism`] is a tree of bodies on such joints; [`dynamics`] evaluates its equations of motion in
//! Lagrangian and port-Hamiltonian form. Motions, controllers and compiled scenes are crates beside this one; users depend on `hamel`, which holds all
//! of them.
//!
//! Without default features the crate is `no_std`; mechanisms and what is built on them need the feature `alloc`, joints and
//! their kernels do not.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

pub use nalgebra;

pub mod curve;
#[cfg(feature = "alloc")]
pub mod dynamics;
#[cfg(feature = "alloc")]
pub mod elements;
#[cfg(feature = "alloc")]
pub mod erased;
#[cfg(not(feature = "alloc"))]
#[path = "unshared.rs"]
pub mod erased;
pub mod finite;
pub mod group;
pub mod joint;
#[cfg(feature = "alloc")]
pub mod lu;
mod matrix;
#[cfg(feature = "alloc")]
pub mod mechanism;
pub mod registry;
pub mod scalar;
pub mod shown;
pub mod spatial;
#[cfg(feature = "alloc")]
pub mod steps;
#[cfg(feature = "alloc")]
pub mod time_function;
mod unrolled;
