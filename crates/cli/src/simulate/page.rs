//! The page of a run, as the file that `--html` names.

use super::accuracy::Accuracy;
use super::plan::Plan;
use hamel_console::files::{Draft, first_line};
use hamel_console::output::Failure;
use hamel_pictures::{Contents, Sample, Told};
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Whether a file is a page that was written before.
pub fn is_own(file: &File) -> bool {
    hamel_pictures::is_page(&first_line(file))
}

/// A page being recorded.
pub struct Page<'a> {
    plan: &'a Plan,
    page: hamel_pictures::Page<'a>,
    file: Draft,
    path: &'a Path,
}

impl<'a> Page<'a> {
    /// Begins the file that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.html else {
            return Ok(None);
        };
        let contents = Contents {
            has_efforts: plan.control.is_some(),
            has_steps: true,
            does_work: plan.does_work(),
        };
        Ok(Some(Self {
            page: hamel_pictures::Page::new(&plan.scene, contents, plan.settings.t_end),
            plan,
            file: output.open()?,
            path: output.path(),
        }))
    }

    /// Notes how long a step was.
    pub fn step(&mut self, time: f64) {
        self.page.step(time);
    }

    /// Takes the sample with this number.
    pub fn sample(&mut self, number: usize, sample: &Sample<'_>) {
        let is_last = number + 1 == self.plan.times.len();
        self.page.sample(number, sample, is_last);
    }

    /// Writes the page, with the error of the motion where that was estimated, and gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, accuracy: Option<&Accuracy>) -> Result<(), Failure> {
        let told = Told {
            method: &method(self.plan, accuracy),
            errors: accuracy.map(Accuracy::samples),
        };
        let page = self.page.html(&self.plan.meshes, &told);
        let page = page.map_err(|error| Failure::Page(error.to_string()))?;
        let written = self.file.write_all(page.as_bytes());
        written.map_err(|error| Failure::write(self.path, error))?;
        self.file.finish()
    }
}

/// Form, method and error at the end, in words.
fn method(plan: &Plan, accuracy: Option<&Accuracy>) -> String {
    let method = format!("{} form, {}", plan.settings.form_name(), plan.method());
    match accuracy {
        Some(accuracy) => format!("{method} · {}", accuracy.at_the_end()),
        None => method,
    }
}
