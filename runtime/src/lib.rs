//! Runtime of Hamel: what generated joints link into.
//!
//! A joint type implements [`joint::Joint`]; the generator `hamel-codegen` writes such implementations from `.joint`
//! files. A [`mechanism::Mechanism`] is a tree of bodies on such joints; [`dynamics`] evaluates its equations of motion in
//! Lagrangian and port-Hamiltonian form; [`integrate`] advances the state on the joints' manifolds.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

pub use nalgebra;

pub mod dynamics;
pub mod erased;
pub mod finite;
pub mod integrate;
pub mod joint;
pub mod mechanism;
pub mod registry;
pub mod scalar;
pub mod spatial;
