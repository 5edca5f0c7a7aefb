//! What stands for tables in Parquet in a program that was built without it.

use super::table::Part;
use hamel_console::files::Draft;
use hamel_console::output::Failure;
use hamel_sweep::Cells;
use std::convert::Infallible;
use std::fs::File;
use std::io;
use std::path::Path;

/// What to build.
const ABSENT: &str = "this program was built without Parquet: build it with the feature, `cargo run --release -p hamel-cli --features parquet -- sweep …`, or use CSV";

/// A table, which there is none of.
pub struct Table {
    never: Infallible,
}

impl Table {
    /// Says what to build.
    ///
    /// # Errors
    /// Always.
    pub fn open(_: &Path) -> Result<Self, Failure> {
        Err(Failure::Options(ABSENT.into()))
    }

    /// Cannot be called.
    pub fn names(&self) -> &[String] {
        match self.never {}
    }

    /// Cannot be called.
    pub fn count(&self) -> u64 {
        match self.never {}
    }

    /// Cannot be called.
    pub fn rows(&mut self, _: usize, _: &Path) -> Result<Vec<Cells>, Failure> {
        match self.never {}
    }
}

/// No file is known as one that a sweep wrote.
pub fn is_own(_: &File) -> bool {
    false
}

/// Says what to build.
///
/// # Errors
/// Always.
pub fn check() -> Result<(), Failure> {
    Err(Failure::Options(ABSENT.into()))
}

/// Says what to build.
///
/// # Errors
/// Always.
pub fn write_part(_: Draft, _: &[String], _: &Part<'_>) -> io::Result<Draft> {
    Err(io::Error::other(ABSENT))
}

/// Says what to build.
///
/// # Errors
/// Always.
pub fn read_part(_: &Path, _: usize, _: &mut dyn FnMut(u64, &str, &[f64])) -> Result<(), Failure> {
    check()
}

/// Says what to build.
///
/// # Errors
/// Always.
pub fn write_small(_: Draft, _: (&str, &[String]), _: &[(&str, Vec<f64>)]) -> io::Result<Draft> {
    Err(io::Error::other(ABSENT))
}
