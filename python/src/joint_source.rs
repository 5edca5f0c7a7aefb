//! Where the spec of a joint comes from: a text, a file, or the joint library.

use crate::errors;
use hamel::joints;
use pyo3::prelude::*;
use std::path::PathBuf;

/// The text of a spec.
pub struct SpecSource {
    /// What messages call it.
    pub name: String,
    /// The text.
    pub text: String,
    /// Where files with knots of curves are, if it stands in a folder.
    pub folder: Option<PathBuf>,
}

impl SpecSource {
    /// A text where `given` is a `str` with a brace or a line break; else the path of a file, or the name of a joint of the library where there is one.
    ///
    /// # Errors
    /// What is neither `str` nor a path; a file that cannot be read.
    pub fn of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = given.py();
        if let Ok(text) = given.extract::<String>() {
            if text.contains(['{', '\n']) {
                return Ok(Self::of_text(text));
            }
            if let Some(spec) = joints::spec(&text) {
                return Ok(Self {
                    name: format!("{text}.joint"),
                    text: spec.to_owned(),
                    folder: None,
                });
            }
        }
        let path: PathBuf = given.extract().map_err(|_| {
            let message = format!("spec is {given:?}: it must be a text, a path, or the name of a joint of the library");
            errors::argument(py, message)
        })?;
        let name = path.display().to_string();
        let text = hamel_codegen::source::read(&path)
            .map_err(|error| errors::unread(py, &name, &format!("cannot read {name}: {error}")))?;
        Ok(Self {
            name,
            text,
            folder: path.parent().map(Into::into),
        })
    }

    /// A text.
    pub fn of_text(text: String) -> Self {
        Self {
            name: String::from("text"),
            text,
            folder: None,
        }
    }
}
