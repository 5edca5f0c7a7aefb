//! A run as one page of HTML that needs nothing else: the bodies in three dimensions, moving, and plots along the time.
//!
//! The page is `crates/cli/src/html/`: a frame, a style and scripts, put together with what is told of the mechanism (JSON) and the
//! recorded numbers (base64). `docs/trajectories.md` says how these are laid out.

mod blob;
mod charts;
mod header;
mod solids;
mod text;
mod triangles;
mod unwrapped;

pub(super) use solids::Ellipsoid;

use super::accuracy::Accuracy;
use super::plan::Plan;
use blob::Blob;
use charts::Charts;
use hamel::integrate::Step;
use hamel::mechanism::Kinematics;
use hamel_console::files::{Draft, first_line};
use hamel_console::output::Failure;
use header::Header;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Frames that a page shows in a second at most; from samples nearer to each other it takes every so many.
const FRAMES_PER_SECOND: f64 = 60.0;

/// Poses of single bodies that a page holds at most: with 28 bytes each, 2.2 MB of base64.
const MOST_POSES: f64 = 60_000.0;

/// Part of the distance of two frames by which rounding may bring samples nearer.
const ROUNDING: f64 = 1e-9;

/// Whether a file is a page that was written before; the frame has this mark.
pub fn is_own(file: &File) -> bool {
    first_line(file).ends_with("<!-- hamel simulate -->")
}

/// A page being recorded.
pub struct Page<'a> {
    plan: &'a Plan,
    file: Draft,
    path: &'a Path,
    charts: Charts<'a>,
    blob: Blob,
    /// Least time between two frames, s.
    spacing: f64,
    last_frame: f64,
    /// Which samples are frames.
    samples: Vec<usize>,
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
        let bodies = plan.scene.mechanism.bodies().len() as f64;
        let charts = Charts::new(plan);
        Ok(Some(Self {
            blob: Blob::new(charts.columns()),
            charts,
            plan,
            file: output.open()?,
            path: output.path(),
            spacing: (1.0 / FRAMES_PER_SECOND).max(plan.settings.t_end * bodies / MOST_POSES),
            last_frame: f64::NEG_INFINITY,
            samples: Vec::new(),
        }))
    }

    /// Notes how long a step was.
    pub fn step(&mut self, time: f64) {
        self.charts.step(time);
    }

    /// Takes a sample as a frame, unless the frame before it is too near. The first and the last sample are frames.
    ///
    /// `efforts` are the controller's, empty without one.
    pub fn sample(&mut self, step: &Step<'_>, kinematics: &Kinematics, efforts: &[f64]) {
        self.charts.follow(step.configuration);
        let near = step.time - self.last_frame < self.spacing * (1.0 - ROUNDING);
        let is_last = step
            .sample
            .is_some_and(|sample| sample + 1 == self.plan.times.len());
        if near && !is_last {
            return;
        }
        self.last_frame = step.time;
        self.samples.extend(step.sample);
        let columns = self.charts.values(step, kinematics, efforts);
        let poses = kinematics.bodies.iter().map(|body| body.pose);
        self.blob.push(step.time, &columns, poses);
    }

    /// Writes the page, with the error of the motion where that was estimated, and gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, accuracy: Option<&Accuracy>) -> Result<(), Failure> {
        if let Some(accuracy) = accuracy {
            let errors = accuracy.samples();
            let frames = self.samples.iter().map(|&sample| errors.get(sample));
            let errors = frames.map(|error| error.copied().flatten().unwrap_or(f64::NAN));
            self.blob.add_column(errors);
            self.charts.add_error();
        }
        let charts = self.charts.into_described();
        let header = Header::new(
            self.plan,
            (self.blob.frames(), accuracy),
            &self.plan.meshes,
            charts,
        );
        let page = text::page(&header, &self.blob.bytes())?;
        let written = self.file.write_all(page.as_bytes());
        written.map_err(|error| Failure::write(self.path, error))?;
        self.file.finish()
    }
}
