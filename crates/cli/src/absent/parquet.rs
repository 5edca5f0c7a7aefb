//! What stands for Parquet in a program that was built without it.

use super::accuracy::Accuracy;
use super::columns::Columns;
use super::plan::Plan;
use hamel_console::output::Failure;
use std::convert::Infallible;
use std::fs::File;
use std::marker::PhantomData;

/// A Parquet file, which there is none of.
pub struct Parquet<'a> {
    never: Infallible,
    plan: PhantomData<&'a Plan>,
}

/// No file is known as a trajectory that was written before.
pub fn is_own(_: &File) -> bool {
    false
}

impl<'a> Parquet<'a> {
    /// Nothing, where nothing is asked for.
    ///
    /// # Errors
    /// A plan that asks for a file.
    pub fn create(plan: &'a Plan, _: &Columns<'_>) -> Result<Option<Self>, Failure> {
        match plan.parquet {
            None => Ok(None),
            Some(_) => Err(absent()),
        }
    }

    /// Cannot be called.
    pub fn write(&mut self, _: &[f64]) -> Result<(), Failure> {
        let _ = self.plan;
        match self.never {}
    }

    /// Cannot be called.
    pub fn finish(self, _: Option<&Accuracy>) -> Result<(), Failure> {
        match self.never {}
    }
}

/// Says what to build.
fn absent() -> Failure {
    Failure::Options(String::from(
        "this program was built without Parquet: build it with the feature, `cargo run --release -p hamel-cli --features parquet -- simulate …`",
    ))
}
