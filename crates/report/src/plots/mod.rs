//! Figures as SVG: logarithmic axes, one colour and one mark for each method throughout.

mod axes;
mod drift;
mod peers;
mod stability;
mod style;
mod work;

pub use drift::drawing as drift;
pub use peers::drawing as peers;
pub use stability::drawing as stability;
pub use work::{forms, implementations, representations};

use hamel_console::output::Failure;

/// A drawing that the library refuses.
fn refused<E: std::fmt::Display>(error: E) -> Failure {
    Failure::Page(format!("a figure cannot be drawn: {error}"))
}
