//! The joint library twice: compiled, and interpreted from its specs.

mod common;
mod kernels;
mod refusals;
mod scenes;
