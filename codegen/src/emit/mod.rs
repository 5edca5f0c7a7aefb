//! Output: from derived kernels to Rust source, pages and terminal text.

mod combinations;
pub mod files;
pub mod formula;
pub mod names;
pub mod page;
pub mod report;
pub mod rust;
pub mod text;

pub use page::{drawing_file, explain_text, html_page, overview, page};
pub use report::{Accuracy, Report};

#[cfg(test)]
mod tests;
