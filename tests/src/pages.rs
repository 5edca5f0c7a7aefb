//! The code on pages of `docs/`, compiled and run as documentation tests.

#[doc = include_str!("../../docs/library.md")]
mod library {}
