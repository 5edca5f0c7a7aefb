//! The code on pages of `docs/`, compiled and run as documentation tests.

#[doc = include_str!("../../docs/control.md")]
mod control {}

#[doc = include_str!("../../docs/library.md")]
mod library {}

#[doc = include_str!("../../docs/parameters.md")]
mod parameters {}
