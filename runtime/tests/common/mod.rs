//! Joints and mechanisms that the tests of this crate share.
#![allow(dead_code, reason = "each test file uses its own part of this module")]

pub mod actuation;
pub mod derived;
pub mod dual;
pub mod joints;
pub mod polar;
pub mod random;
pub mod readings;
pub mod several;
pub mod trees;
pub mod wall;
