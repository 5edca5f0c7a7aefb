//! Pictures of a motion: bodies as the page draws them, at one instant or at several, as SVG or PNG, or moving as GIF.
//!
//! For SVG the faces of a solid must never hide each other: it is convex solids that are put in order, and cut where they go through each other. A picture of pixels
//! compares distances in each of them, and so shows meshes too.

mod colors;
mod order;
mod raster;
mod scenery;
mod solid;
mod stage;
mod svg;
mod view;

use super::plan::Plan;
use super::progress;
use crate::meshes::Meshes;
use hamel::mechanism::Kinematics;
use hamel::spatial::Pose;
use hamel_console::files::{Draft, Output, first_line};
use hamel_console::output::{Failure, tell};
use hamel_scene::{Notice, Severity};
use raster::Playing;
use scenery::Scenery;
use std::fs::File;
use std::io::{self, Write};

/// Width and height of a still picture, pixels.
const SIZE: (u16, u16) = (960, 640);

/// Instants that are kept at most to choose from.
const MOST_KEPT: usize = 512;

/// Whether a file is a picture as SVG that was written before.
pub fn is_own(file: &File) -> bool {
    first_line(file) == svg::FIRST_LINE
}

/// Whether a file is a picture as PNG that was written before.
pub use raster::is_own_png;

/// Whether a file is a motion as GIF that was written before.
pub use raster::is_own_gif;

/// Where pictures of a motion go, as far as they are asked for.
#[derive(Debug)]
pub struct Outputs {
    pub svg: Option<Output>,
    pub png: Option<Output>,
    pub gif: Option<Output>,
    /// How many instants a still picture shows.
    pub instants: usize,
}

impl Outputs {
    /// Those that are asked for.
    pub fn files(&self) -> impl Iterator<Item = &Output> {
        [&self.svg, &self.png, &self.gif].into_iter().flatten()
    }

    /// Whether one of them shows meshes.
    pub const fn has_meshes(&self) -> bool {
        self.png.is_some() || self.gif.is_some()
    }
}

/// Pictures being recorded.
pub struct Pictures<'a> {
    plan: &'a Plan,
    svg: Option<Draft>,
    png: Option<Draft>,
    gif: Option<Draft>,
    kept: Kept,
}

/// The bodies at one time.
#[derive(Clone, Debug)]
struct Instant {
    time: f64,
    poses: Vec<Pose<f64>>,
}

/// Samples spread over the motion so far, and the last one.
#[derive(Debug)]
struct Kept {
    some: Vec<Instant>,
    /// Of how many samples one is kept.
    stride: usize,
    seen: usize,
    last: Option<Instant>,
}

impl<'a> Pictures<'a> {
    /// Begins the files that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan) -> Result<Option<Self>, Failure> {
        let outputs = &plan.pictures;
        if outputs.files().next().is_none() {
            return Ok(None);
        }
        let open = |output: &Option<Output>| output.as_ref().map(Output::open).transpose();
        Ok(Some(Self {
            plan,
            svg: open(&outputs.svg)?,
            png: open(&outputs.png)?,
            gif: open(&outputs.gif)?,
            kept: Kept::new(),
        }))
    }

    /// Takes a sample.
    pub fn sample(&mut self, time: f64, kinematics: &Kinematics) {
        let poses = kinematics.bodies.iter().map(|body| body.pose).collect();
        self.kept.push(Instant { time, poses });
    }

    /// Draws the pictures, and gives the files their names.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        let (scene, outputs) = (&self.plan.scene, &self.plan.pictures);
        let instants = self.kept.chosen(outputs.instants);
        let svg = finished(self.svg, &outputs.svg, |file| {
            // Faces are drawn from the farthest to the nearest, for which they have to be few and convex.
            let no_meshes = Meshes::default();
            let scenery = Scenery::new(scene, &no_meshes);
            file.write_all(svg::picture(&scene.name, &scenery, &instants).as_bytes())
        });
        let scenery = Scenery::new(scene, &self.plan.meshes).round();
        let png = finished(self.png, &outputs.png, |file| {
            raster::write_png(&scenery, &instants, file)
        });
        let gif = finished(self.gif, &outputs.gif, |file| {
            let playing = Playing::of(self.kept.duration(), self.kept.some.len());
            if !self.plan.quiet {
                tell(note(playing).as_slice());
            }
            let mut instants = self.kept.chosen(playing.count);
            // One sample may be the nearest of two times.
            instants.dedup_by(|a, b| a.time == b.time);
            let bar = progress::working("choosing the colours of the GIF", self.plan.quiet);
            let told = |drawn| {
                let count = instants.len();
                bar.set_message(format!("drawing the GIF: {drawn} of {count} pictures"));
            };
            let written = raster::write_gif(&scenery, &instants, playing, file, &told);
            bar.finish_and_clear();
            written
        });
        svg.and(png).and(gif)
    }
}

/// Writes a file that was asked for, and gives it its name.
fn finished(
    draft: Option<Draft>,
    output: &Option<Output>,
    write: impl FnOnce(&mut Draft) -> io::Result<()>,
) -> Result<(), Failure> {
    let (Some(mut file), Some(output)) = (draft, output) else {
        return Ok(());
    };
    write(&mut file).map_err(|error| Failure::write(output.path(), error))?;
    file.finish()
}

/// What to tell of how a motion plays, if it plays at another speed than its own.
fn note(playing: Playing) -> Option<Notice> {
    (playing.speed != 1.0).then(|| Notice {
        severity: Severity::Note,
        message: format!(
            "the GIF plays at {:.3} times the speed of the motion",
            playing.speed
        ),
        elements: vec![],
    })
}

impl Kept {
    const fn new() -> Self {
        Self {
            some: Vec::new(),
            stride: 1,
            seen: 0,
            last: None,
        }
    }

    fn push(&mut self, instant: Instant) {
        if self.seen.is_multiple_of(self.stride) {
            if self.some.len() == MOST_KEPT {
                let mut index = 0;
                self.some.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
            if self.seen.is_multiple_of(self.stride) {
                self.some.push(instant.clone());
            }
        }
        self.seen += 1;
        self.last = Some(instant);
    }

    /// From the first instant to the last, s.
    fn duration(&self) -> f64 {
        let ends = self.some.first().zip(self.last.as_ref());
        ends.map_or(0.0, |(first, last)| last.time - first.time)
    }

    /// So many instants at equal distances from the first to the last, which is always there.
    fn chosen(&self, count: usize) -> Vec<Instant> {
        let (Some(first), Some(last)) = (self.some.first(), &self.last) else {
            return vec![];
        };
        let earlier = (0..count.saturating_sub(1)).filter_map(|k| {
            let part = k as f64 / (count - 1) as f64;
            let time = first.time + part * (last.time - first.time);
            let distance = |instant: &&Instant| (instant.time - time).abs();
            let mut some = self.some.iter();
            let start = some.next()?;
            let nearest = some.fold(start, |best, other| {
                match distance(&other) < distance(&best) {
                    true => other,
                    false => best,
                }
            });
            Some(nearest.clone())
        });
        earlier.chain([last.clone()]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Instant, Kept};

    #[test]
    fn instants_are_spread_from_the_first_to_the_last() {
        let mut kept = Kept::new();
        for sample in 0..5000 {
            let (time, poses) = (f64::from(sample), vec![]);
            kept.push(Instant { time, poses });
        }
        assert!(kept.some.len() <= super::MOST_KEPT);
        let times = |count| {
            kept.chosen(count)
                .iter()
                .map(|at| at.time)
                .collect::<Vec<_>>()
        };
        assert_eq!(times(1), [4999.0]);
        let three = times(3);
        assert_eq!((three[0], three[2]), (0.0, 4999.0));
        assert!((three[1] - 2499.5).abs() <= 16.0, "{three:?}");
    }
}
