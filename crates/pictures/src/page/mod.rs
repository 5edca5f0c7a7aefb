//! A motion as one page of HTML that needs nothing else: the bodies in three dimensions, moving, and plots along the time.
//!
//! The page is `crates/pictures/src/html/`: a frame, a style and scripts, put together with the data of the mechanism (JSON) and the
//! recorded numbers (base64). `docs/trajectories.md` says how these are laid out.

mod blob;
mod charts;
mod header;
mod solids;
mod text;
mod triangles;
mod unwrapped;

pub use charts::{Contents, does_work};
pub(crate) use solids::Ellipsoid;

use crate::meshes::Meshes;
use crate::sample::Sample;
use blob::Blob;
use charts::Charts;
use hamel::scene::Scene;
use header::Header;

/// Frames that a page shows in a second at most; from samples nearer to each other it takes every so many.
const FRAMES_PER_SECOND: f64 = 60.0;

/// Poses of single bodies that a page holds at most: with 28 bytes each, 2.2 MB of base64.
const MOST_POSES: f64 = 60_000.0;

/// Part of the distance of two frames by which rounding may bring samples nearer.
const ROUNDING: f64 = 1e-9;

/// Whether a file with this first line is such a page.
pub fn is_page(first_line: &str) -> bool {
    first_line.ends_with("<!-- hamel simulate -->")
}

/// A page being recorded.
#[derive(Debug)]
pub struct Page<'a> {
    scene: &'a Scene,
    charts: Charts<'a>,
    blob: Blob,
    /// Least time between two frames, s.
    spacing: f64,
    last_frame: f64,
    /// Which samples are frames.
    samples: Vec<usize>,
}

/// What a page says of a motion beside its states.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// How it was found, in words.
    pub method: &'a str,
    /// The estimated error of each sample, where that was estimated; absent where it is not known.
    pub errors: Option<&'a [Option<f64>]>,
}

impl<'a> Page<'a> {
    /// Of a motion of `scene` that lasts `duration` s.
    pub fn new(scene: &'a Scene, contents: Contents, duration: f64) -> Self {
        let bodies = scene.mechanism.bodies().len() as f64;
        let charts = Charts::new(scene, contents);
        Self {
            scene,
            blob: Blob::new(charts.columns()),
            charts,
            spacing: (1.0 / FRAMES_PER_SECOND).max(duration * bodies / MOST_POSES),
            last_frame: f64::NEG_INFINITY,
            samples: Vec::new(),
        }
    }

    /// Notes the end of a step.
    pub fn step(&mut self, time: f64) {
        self.charts.step(time);
    }

    /// Takes the sample with this number as a frame, unless the frame before it is too near. The first and the last sample are frames.
    pub fn sample(&mut self, number: usize, sample: &Sample<'_>, is_last: bool) {
        self.charts.follow(sample.configuration);
        let near = sample.time - self.last_frame < self.spacing * (1.0 - ROUNDING);
        if near && !is_last {
            return;
        }
        self.last_frame = sample.time;
        self.samples.push(number);
        let columns = self.charts.values(sample);
        let poses = sample.kinematics.bodies.iter().map(|body| body.pose);
        self.blob.push(sample.time, &columns, poses);
    }

    /// The page.
    ///
    /// # Errors
    /// What JSON cannot hold.
    pub fn html(mut self, meshes: &Meshes, told: &Told<'_>) -> Result<String, serde_json::Error> {
        if let Some(errors) = told.errors {
            let frames = self.samples.iter().map(|&sample| errors.get(sample));
            let errors = frames.map(|error| error.copied().flatten().unwrap_or(f64::NAN));
            self.blob.add_column(errors);
            self.charts.add_error();
        }
        let frames = self.blob.frames();
        let charts = self.charts.into_described();
        let header = Header::new(self.scene, (frames, told.method), meshes, charts);
        text::page(&header, &self.blob.bytes())
    }
}
