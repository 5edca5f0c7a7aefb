//! No public call panics, whatever it is given: sizes, indices, NaN and infinity are errors, or NaN where a result can be no error.

#[path = "../../../../runtime/tests/common/mod.rs"]
mod common;

mod control;
mod dynamics;
mod integrate;
mod joints;
mod mechanism;
mod numbers;
mod steps;
mod support;
