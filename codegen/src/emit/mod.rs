//! Output: from derived kernels to Rust source, pages and terminal text.

pub mod files;
pub mod formula;
pub mod names;
pub mod page;
pub mod report;
pub mod rust;

pub use page::{explain_text, page};
pub use report::Report;

#[cfg(test)]
mod tests;
