//! The runtime on joints written by hand: spatial algebra, scalars, mechanisms, and the dynamics in all their forms.
//!
//! One program for all suites: each program compiles the same joints and equations, which takes more time than its tests.

#[path = "../common/mod.rs"]
mod common;

mod closed;
mod coupled;
mod dynamics;
mod group;
mod lanes;
mod mechanism;
mod parameters;
mod quasi;
mod recursive;
mod registry;
mod scalar;
mod several;
mod spatial;
mod time_function;
